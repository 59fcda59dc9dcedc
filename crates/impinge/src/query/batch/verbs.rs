//! Queries at many poses.

use std::sync::Arc;

use super::answers::{Answers, Status};
use super::broadcast::{Broadcast, BroadcastError};
use super::execution::Execution;
use super::poses::Poses;
use super::side::Side;
use crate::budget::Stopped;
use crate::query::penetration::solid;
use crate::query::{
    Cache, ContactOptions, Curves, Deeper, Depth, Distance, LimitedPairs, Manifold, Penetrates, Penetration, Placed,
    Proximity, Query, nearness, proximity,
};
use crate::shape::Shape;

/// Two things and the poses at which queries compare them. Cloning it is fast.
///
/// Every query returns [`Answers`]: a value and a [`Status`] for each row. The values are in the
/// world frame, with the accuracy of the query of the same name in [`query`](crate::query). A row
/// with an invalid pose gets the safe answer that the query names here.
#[derive(Clone, Debug)]
pub struct Batch<'e> {
    sides: Arc<[Side; 2]>,
    broadcast: Broadcast,
    execution: Execution<'e>,
}

impl<'e> Batch<'e> {
    /// Returns a batch of two things at their poses. Each of the two is a mesh, a solid
    /// (`mesh.solid()`), a shape or a compound. Each pose maps the frame of its thing to the world
    /// frame.
    ///
    /// Invalid poses are no error here: their rows get a [`Status`].
    ///
    /// # Errors
    /// If the leading axes of the poses do not broadcast.
    pub fn new(
        a: impl Into<Shape>,
        b: impl Into<Shape>,
        poses_a: impl Into<Poses>,
        poses_b: impl Into<Poses>,
    ) -> Result<Self, BroadcastError> {
        let sides = [Side::new(a.into(), poses_a.into()), Side::new(b.into(), poses_b.into())];
        let broadcast = Broadcast::new(sides[0].poses().shape(), sides[1].poses().shape())?;
        let sides = sides.map(|side| side.shared_by(broadcast.rows()));
        Ok(Self { sides: Arc::new(sides), broadcast, execution: Execution::default() })
    }

    /// Returns this batch with options: threads, a budget, a progress callback.
    #[must_use]
    pub fn with_execution(self, execution: Execution<'e>) -> Self {
        Self { execution, ..self }
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.broadcast.rows()
    }

    /// Returns the length of each leading axis of the answers.
    #[must_use]
    pub fn shape(&self) -> &[usize] {
        self.broadcast.shape()
    }

    /// Returns the poses of the first and of the second thing. A pose that its thing does not
    /// accept is invalid, for example a pose of a round shape that is not rigid.
    #[must_use]
    pub fn poses(&self) -> [&Poses; 2] {
        self.sides.each_ref().map(Side::poses)
    }

    /// Returns the result of `ask` for each row. `ask` gets a query with the budget and with a
    /// cache that consecutive rows share, and the two things at their poses. A row with an invalid
    /// pose gets `safe`, and so do rows that are not complete when a limit of the budget is reached
    /// ([`Status::OutOfBudget`]).
    ///
    /// # Errors
    /// [`Stopped`] if the budget canceled the batch, or if the memory for the answers cannot be
    /// allocated.
    pub fn each<T: Clone + Send + Sync>(
        &self,
        safe: T,
        ask: impl Fn(Query<'_>, Placed<'_>, Placed<'_>) -> T + Sync,
    ) -> Result<Answers<T>, Stopped> {
        let budget = self.execution.budget();
        let answer = |cache: &mut Cache, row: usize| {
            let sources = self.broadcast.sources(row);
            // Placing a compound of many parts takes longer than most questions.
            if budget.stopped().is_none() {
                let [a, b] = match [0, 1].map(|side| self.sides[side].at(sources[side])) {
                    [Ok(a), Ok(b)] => [a, b],
                    [Err(fault), _] | [_, Err(fault)] => return (safe.clone(), Status::of(&fault)),
                };
                let found = ask(Query::new().with_cache(cache).with_budget(budget), a, b);
                if budget.stopped().is_none() {
                    return (found, Status::Ok);
                }
            } else if let [Err(fault), _] | [_, Err(fault)] = [0, 1].map(|side| self.sides[side].check(sources[side])) {
                return (safe.clone(), Status::of(fault));
            }
            (safe.clone(), Status::OutOfBudget)
        };
        let answers = self.execution.all_rows(self.rows(), Cache::default, answer)?;
        let (values, status) = answers.into_iter().unzip();
        Ok(Answers { shape: self.broadcast.shape().to_vec(), values, status })
    }

    /// Returns for each row whether the two things have a point in common, or that this is
    /// undecided, as [`proximity`](crate::query::proximity()). Touching counts. A row with an
    /// invalid pose gets `Undecided`.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn proximity(&self) -> Result<Answers<Proximity>, Stopped> {
        let answers = self.each(Proximity::Undecided, |query, a, b| query.proximity(a, b))?;
        Ok(answers.mark_undecided(|&found| found == Proximity::Undecided))
    }

    /// Returns [`intersects`](crate::query::intersects()) of the two things for each row. A row
    /// with an invalid pose gets `true`, the safe answer.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn intersects(&self) -> Result<Answers<bool>, Stopped> {
        Ok(self.proximity()?.map(|found| found != Proximity::Apart))
    }

    /// Returns [`nearness`](crate::query::nearness()) of the two things for each row, with a
    /// clearance in world units. A row with an invalid pose gets `Undecided`.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn nearness(&self, clearance: f64) -> Result<Answers<Proximity>, Stopped> {
        let answers = self.each(Proximity::Undecided, |query, a, b| query.nearness(a, b, clearance))?;
        Ok(answers.mark_undecided(|&found| found == Proximity::Undecided))
    }

    /// Returns [`within`](crate::query::within()) of the two things for each row, with a clearance
    /// in world units. A row with an invalid pose gets `true`, the safe answer.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn within(&self, clearance: f64) -> Result<Answers<bool>, Stopped> {
        Ok(self.nearness(clearance)?.map(|found| found != Proximity::Apart))
    }

    /// Returns [`distance`](crate::query::distance()) of the two things for each row. For a row
    /// with an invalid pose both bounds are zero and there are no nearest points. This proves
    /// nothing: check the status of the row.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn distance(&self) -> Result<Answers<Distance>, Stopped> {
        const SAFE: Distance = Distance { lower: 0.0, upper: 0.0, witness: None, proximity: Proximity::Undecided };
        let answers = self.each(SAFE, |query, a, b| query.distance(a, b))?;
        Ok(answers.mark_undecided(|found| found.proximity == Proximity::Undecided))
    }

    /// Returns [`penetrates`](crate::query::penetrates()) of the two things for each row. A row
    /// with an invalid pose gets `Undecided`.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn penetrates(&self) -> Result<Answers<Penetrates>, Stopped> {
        let answers = self.each(Penetrates::Undecided, |query, a, b| query.penetrates(a, b))?;
        Ok(answers.mark_undecided(|&found| found == Penetrates::Undecided))
    }

    /// Returns [`penetration`](crate::query::penetration()) of the two things for each row. A row
    /// with an invalid pose gets [`Penetration::UNKNOWN`], a depth between zero and infinity.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn penetration(&self) -> Result<Answers<Option<Penetration>>, Stopped> {
        let answers = self.each((Some(Penetration::UNKNOWN), false), |query, a, b| {
            let found = query.penetration(&a, &b);
            // A lower bound above zero proves that the things intersect.
            let may_touch = found.is_some_and(|found| found.lower == 0.0);
            (found, may_touch && proximity(solid(&a), solid(&b)) == Proximity::Undecided)
        })?;
        Ok(answers.mark_undecided(|found| found.1).map(|found| found.0))
    }

    /// Returns [`depth`](crate::query::depth()) of the two things for each row. For a row with an
    /// invalid pose the bounds are zero and infinity, which proves nothing: check the status of the
    /// row.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn depth(&self) -> Result<Answers<Depth>, Stopped> {
        const UNKNOWN: Depth = Depth { lower: 0.0, upper: f64::INFINITY, point: None, is_proved: false };
        let answers = self.each(UNKNOWN, |query, a, b| query.depth(a, b))?;
        Ok(answers.mark_undecided(|found| !found.is_proved))
    }

    /// Returns [`deeper`](crate::query::deeper()) of the two things for each row, with a threshold
    /// in world units. A row with an invalid pose gets `Undecided`.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    ///
    /// # Panics
    /// If `threshold` is negative or NaN.
    pub fn deeper(&self, threshold: f64) -> Result<Answers<Deeper>, Stopped> {
        let answers = self.each(Deeper::Undecided, |query, a, b| query.deeper(a, b, threshold))?;
        Ok(answers.mark_undecided(|&found| found == Deeper::Undecided))
    }

    /// Returns [`contacts`](crate::query::contacts()) of the two things for each row, with these
    /// options. A row with an invalid pose gets an empty list. This proves nothing: check the
    /// status of the row.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn contacts(&self, options: ContactOptions) -> Result<Answers<Vec<Manifold>>, Stopped> {
        let is_exact = self.sides.iter().all(Side::is_exact);
        let answers = self.each((Vec::new(), false), |query, a, b| {
            let found = query.with_contacts(options).contacts(&a, &b);
            let may_touch = !is_exact && !found.is_empty();
            (found, may_touch && nearness(&a, &b, options.margin.max(0.0)) == Proximity::Undecided)
        })?;
        Ok(answers.mark_undecided(|found| found.1).map(|found| found.0))
    }

    /// Returns [`intersecting_pairs`](crate::query::intersecting_pairs()) for each row. The list is
    /// empty if one of the things is not a mesh. A row with an invalid pose gets an empty list too:
    /// check the status of the row.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn intersecting_pairs(&self) -> Result<Answers<Vec<[u32; 2]>>, Stopped> {
        self.each(Vec::new(), |query, a, b| match (a.mesh(), b.mesh()) {
            (Some(a), Some(b)) => query.intersecting_pairs(a, b),
            _ => Vec::new(),
        })
    }

    /// Returns [`intersecting_pairs_up_to`](crate::query::intersecting_pairs_up_to()) for each row.
    /// The list is empty if one of the things is not a mesh. A row with an invalid pose gets an
    /// empty list too: check the status of the row.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn intersecting_pairs_up_to(&self, limit: usize) -> Result<Answers<LimitedPairs>, Stopped> {
        let none = LimitedPairs { pairs: Vec::new(), truncated: false };
        self.each(none.clone(), |query, a, b| match (a.mesh(), b.mesh()) {
            (Some(a), Some(b)) => query.intersecting_pairs_up_to(a, b, limit),
            _ => none.clone(),
        })
    }

    /// Returns for each row the curves along which the surfaces intersect, in the world frame, as
    /// [`intersection_curves`](crate::query::intersection_curves()) does. There are
    /// no curves if one of the things is not a mesh. A row with an invalid pose has no curves
    /// either: check the status of the row.
    ///
    /// # Errors
    /// As for [`each`](Self::each).
    pub fn intersection_curves(&self) -> Result<Answers<Curves>, Stopped> {
        self.each(Curves::default(), |query, a, b| match (a.mesh(), b.mesh()) {
            (Some(a), Some(b)) => query.intersection_curves(a, b),
            _ => Curves::default(),
        })
    }
}

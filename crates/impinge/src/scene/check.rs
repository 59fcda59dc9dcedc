//! Checks which pairs of parts intersect, penetrate or come near.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::OnceLock;

use super::configurations::Configurations;
use super::near::{PlacedPart, pairs_near};
use super::parts::{PartId, Scene};
use crate::budget::{Budget, Stopped};
use crate::query::batch::{Answers, Execution, Status};
use crate::query::{Cache, Penetrates, Proximity, Query};

/// Question that a check answers for each pair of parts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Question {
    /// Whether the parts intersect, as [`intersects`](crate::query::intersects).
    Intersects,
    /// Whether the interiors of the parts intersect, as [`penetrates`](crate::query::penetrates()).
    /// Meshes count as solids.
    Penetrates,
    /// Whether the distance of the parts is at most this clearance, in world units, as
    /// [`within`](crate::query::within()).
    Within(f64),
}

/// When the check of a configuration ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stop {
    /// At the first pair for which the answer is yes, in the order of the parts.
    First,
    /// After all pairs were checked.
    All,
}

/// A pair of parts for which the answer to a [`Question`] is yes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FoundPair {
    /// The two parts, the smaller handle first.
    pub parts: [PartId; 2],
    /// `true` if the answer is yes only to be safe: nothing was proved about the pair, or a pose is
    /// faulty.
    pub is_undecided: bool,
}

/// Broad phase of one configuration: all that is needed to divide its check among several calls of
/// [`Scene::check_pairs`].
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    /// Pairs of parts whose boxes are near each other, sorted. For all other pairs that the scene
    /// admits, the answer is no.
    pub pairs: Vec<[PartId; 2]>,
    /// Lower and upper corner of the box of each part in the world, which is grown by half of a
    /// clearance. `None` for a part that is unbounded, empty or has a faulty pose.
    pub boxes: Vec<Option<[[f64; 3]; 2]>>,
    /// Status of the first part with a faulty pose, or [`Status::Ok`].
    pub status: Status,
}

impl Scene {
    /// Returns the pairs of parts for which the answer to a question is yes, at the poses of the
    /// scene, sorted. Undecided pairs are included.
    ///
    /// # Errors
    /// Returns the errors of [`check`](Self::check).
    ///
    /// # Complexity
    /// The broad phase takes about linear time. Each pair whose boxes are near costs one query.
    pub fn pairs(&self, question: Question) -> Result<Vec<[PartId; 2]>, Stopped> {
        let mut found = self.check(question, Stop::All, &self.configurations(), Execution::default())?;
        let pairs = found.values.pop().unwrap_or_default();
        Ok(pairs.into_iter().map(|pair| pair.parts).collect())
    }

    /// Returns for each configuration the pairs of parts for which the answer to a question is yes,
    /// sorted. Undecided pairs are included. With [`Stop::First`] it returns the first pair only.
    ///
    /// A part with a faulty pose counts as near every other part. If a configuration has faulty
    /// poses, its status is that of the first such part. Otherwise it depends on whether one of the
    /// pairs found is undecided. Pairs of parts that do not move are checked once. Consecutive
    /// configurations share a [`Cache`] for each pair.
    ///
    /// # Errors
    /// Returns [`Stopped`] if a limit of the budget of `execution` was reached, or if there is not
    /// enough memory for the answers.
    ///
    /// # Panics
    /// Panics if the configurations belong to another scene.
    ///
    /// # Complexity
    /// For each configuration, the broad phase takes about linear time in the number of parts. Each
    /// pair whose boxes are near costs one query.
    pub fn check(
        &self,
        question: Question,
        stop: Stop,
        configurations: &Configurations<'_>,
        execution: Execution<'_>,
    ) -> Result<Answers<Vec<FoundPair>>, Stopped> {
        let rows = configurations.rows();
        let mut check = Check::new(self, question, configurations);
        if rows > 0 {
            check.placed_parts = check.still_parts();
            check.still = check.still_pairs(stop, execution)?;
        }
        // Memory that runs out in one row ends all rows.
        let stopped = OnceLock::new();
        let found = execution.rows(rows, HashMap::new, |caches, row| {
            let found = check.row(row, stop, caches, execution.budget()).unwrap_or_else(|reason| {
                _ = stopped.set(reason);
                Vec::new()
            });
            (found, check.status(row))
        })?;
        if let Some(&reason) = stopped.get() {
            return Err(reason);
        }
        let (values, status): (Vec<Vec<FoundPair>>, Vec<Status>) = found.into_iter().unzip();
        let answers = Answers { shape: configurations.shape().to_vec(), values, status };
        Ok(answers.mark_undecided(|pairs| pairs.iter().any(|pair| pair.is_undecided)))
    }

    /// Returns the broad phase of one row of configurations. [`check_pairs`](Self::check_pairs) of
    /// all its pairs, in any division, finds the pairs that [`check`](Self::check) finds in this
    /// row with [`Stop::All`].
    ///
    /// # Errors
    /// Returns [`Stopped`] if a limit of the budget was reached, or if memory ran out.
    ///
    /// # Panics
    /// Panics if the configurations belong to another scene, or if there is no such row.
    ///
    /// # Complexity
    /// About linear in the number of parts and pairs.
    pub fn candidates(
        &self,
        question: Question,
        configurations: &Configurations<'_>,
        row: usize,
        budget: &Budget<'_>,
    ) -> Result<Candidates, Stopped> {
        assert!(row < configurations.rows(), "there is no configuration {row}");
        let check = Check::new(self, question, configurations);
        let placed_parts: Vec<Cow<'_, PlacedPart>> =
            self.parts().map(|part| Cow::Owned(check.placed(part, row))).collect();
        let pairs = pairs_near(self, &placed_parts, budget, |_, _| true)?;
        let boxes = placed_parts.iter().map(|part| part.bounds().map(|bounds| [bounds.min(), bounds.max()]));
        Ok(Candidates { pairs, boxes: boxes.collect(), status: check.status(row) })
    }

    /// Checks some pairs of parts in one row of configurations. Returns those for which the answer
    /// is yes, in their order; undecided pairs are included.
    ///
    /// # Errors
    /// Returns [`Stopped`] if a limit of the budget of `execution` was reached, or if memory ran
    /// out.
    ///
    /// # Panics
    /// Panics if the configurations belong to another scene, or if there is no such row or part.
    ///
    /// # Complexity
    /// One query for each pair.
    pub fn check_pairs(
        &self,
        question: Question,
        pairs: &[[PartId; 2]],
        configurations: &Configurations<'_>,
        row: usize,
        execution: Execution<'_>,
    ) -> Result<Vec<FoundPair>, Stopped> {
        assert!(row < configurations.rows(), "there is no configuration {row}");
        let check = Check::new(self, question, configurations);
        let mut placed_parts = vec![Cow::Owned(PlacedPart::Nowhere); self.parts().len()];
        for &part in pairs.iter().flatten() {
            if matches!(*placed_parts[part.index()], PlacedPart::Nowhere) {
                placed_parts[part.index()] = Cow::Owned(check.placed(part, row));
            }
        }
        check.pairs(pairs, &placed_parts, execution)
    }
}

/// Number of pairs that are checked together if the first one is wanted. With fewer, threads wait
/// for each other; with more, more pairs after the first are checked.
const PAIRS_PER_WAVE: usize = 1 << 10;

struct Check<'c> {
    scene: &'c Scene,
    question: Question,
    configurations: &'c Configurations<'c>,
    /// Placements of the parts that have one pose in all configurations. The other parts are
    /// [`PlacedPart::Nowhere`].
    placed_parts: Vec<PlacedPart>,
    /// Pairs of parts that do not move for which the answer is yes, sorted. With [`Stop::First`]
    /// there is no more than the first.
    still: Vec<FoundPair>,
}

impl<'c> Check<'c> {
    /// Returns a check without placements.
    ///
    /// # Panics
    /// Panics if the configurations belong to another scene.
    fn new(scene: &'c Scene, question: Question, configurations: &'c Configurations<'c>) -> Self {
        assert!(
            std::ptr::eq(scene, configurations.scene()),
            "the configurations belong to another scene: make them with `configurations` of this scene"
        );
        Self { scene, question, configurations, placed_parts: Vec::new(), still: Vec::new() }
    }

    /// Returns the placements of the parts that have one pose in all configurations; the other
    /// parts are nowhere.
    fn still_parts(&self) -> Vec<PlacedPart> {
        let of = |part: PartId| {
            if self.configurations.is_still(part) { self.placed(part, 0) } else { PlacedPart::Nowhere }
        };
        self.scene.parts().map(of).collect()
    }

    /// Returns the pairs of parts that do not move for which the answer is yes, or only the first.
    fn still_pairs(&self, stop: Stop, execution: Execution<'_>) -> Result<Vec<FoundPair>, Stopped> {
        let placed_parts: Vec<Cow<'_, PlacedPart>> = self.placed_parts.iter().map(Cow::Borrowed).collect();
        let quiet = execution.without_progress();
        let pairs = pairs_near(self.scene, &placed_parts, quiet.budget(), |_, _| true)?;
        let wave = if stop == Stop::First { PAIRS_PER_WAVE } else { pairs.len().max(1) };
        let mut found = Vec::new();
        for pairs in pairs.chunks(wave) {
            found.extend(self.pairs(pairs, &placed_parts, quiet)?);
            if stop == Stop::First && !found.is_empty() {
                found.truncate(1);
                break;
            }
        }
        Ok(found)
    }

    /// Returns the placements of all parts in a row.
    fn placed_parts(&self, row: usize) -> Vec<Cow<'_, PlacedPart>> {
        let of = |part: PartId| {
            if self.configurations.is_still(part) {
                Cow::Borrowed(&self.placed_parts[part.index()])
            } else {
                Cow::Owned(self.placed(part, row))
            }
        };
        self.scene.parts().map(of).collect()
    }

    /// Returns the placement of a part in a row.
    fn placed(&self, part: PartId, row: usize) -> PlacedPart {
        let clearance = if let Question::Within(clearance) = self.question { clearance } else { 0.0 };
        let pose = self.configurations.pose(part, row);
        let placed = pose.ok().and_then(|pose| self.scene.shape(part).at(*pose).ok());
        placed.map_or(PlacedPart::Anywhere, |placed| PlacedPart::new(placed, clearance))
    }

    /// Returns the pairs of a row for which the answer is yes.
    fn row(
        &self,
        row: usize,
        stop: Stop,
        caches: &mut HashMap<[PartId; 2], Cache>,
        budget: &Budget<'_>,
    ) -> Result<Vec<FoundPair>, Stopped> {
        let placed_parts = self.placed_parts(row);
        let moves = |part: PartId| !self.configurations.is_still(part);
        let pairs = pairs_near(self.scene, &placed_parts, budget, |a, b| moves(a) || moves(b))?;
        let first_still = self.still.first();
        let mut found = Vec::new();
        for pair in pairs {
            // The caller discards the result if the budget is spent.
            if budget.is_spent() {
                break;
            }
            if stop == Stop::First && first_still.is_some_and(|still| still.parts < pair) {
                break;
            }
            found.extend(self.pair(pair, &placed_parts, caches.entry(pair).or_default(), budget));
            if stop == Stop::First && !found.is_empty() {
                return Ok(found);
            }
        }
        match stop {
            Stop::First => found.extend(first_still),
            Stop::All => {
                found.extend(&self.still);
                found.sort_unstable_by_key(|pair| pair.parts);
            }
        }
        Ok(found)
    }

    /// Returns the pairs for which the answer is yes, in their order.
    fn pairs(
        &self,
        pairs: &[[PartId; 2]],
        placed_parts: &[Cow<'_, PlacedPart>],
        execution: Execution<'_>,
    ) -> Result<Vec<FoundPair>, Stopped> {
        let found = execution.rows(pairs.len(), Cache::default, |cache, at| {
            self.pair(pairs[at], placed_parts, cache, execution.budget())
        })?;
        Ok(found.into_iter().flatten().collect())
    }

    /// Returns the pair if the answer for it is yes, and `None` otherwise.
    fn pair(
        &self,
        parts: [PartId; 2],
        placed_parts: &[Cow<'_, PlacedPart>],
        cache: &mut Cache,
        budget: &Budget<'_>,
    ) -> Option<FoundPair> {
        let placed = parts.map(|part| &*placed_parts[part.index()]);
        if placed.iter().any(|part| part.is_nowhere()) {
            return None;
        }
        let [Some(a), Some(b)] = placed.map(PlacedPart::placed) else {
            return Some(FoundPair { parts, is_undecided: true });
        };
        let query = Query::new().with_cache(cache).with_budget(budget);
        let proximity = match self.question {
            Question::Intersects => query.proximity(a, b),
            Question::Within(clearance) => query.nearness(a, b, clearance),
            Question::Penetrates => match query.penetrates(a, b) {
                Penetrates::No => Proximity::Apart,
                Penetrates::Undecided => Proximity::Undecided,
                Penetrates::Yes => Proximity::Intersects,
            },
        };
        let is_undecided = proximity == Proximity::Undecided;
        (proximity != Proximity::Apart).then_some(FoundPair { parts, is_undecided })
    }

    /// Returns the status of a row, given its poses.
    fn status(&self, row: usize) -> Status {
        let fault = self.scene.parts().find_map(|part| self.configurations.pose(part, row).err());
        fault.map_or(Status::Ok, Status::of)
    }
}

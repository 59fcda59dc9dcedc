//! Conversion between snapshots and plain data, for files and other processes.

use std::fmt;

use super::body::{Body, BodyId};
use super::broad::Broad;
use super::events::PairKey;
use super::narrow::Meeting;
use super::slots::Slots;
use super::{Change, Options, Resident, Snapshot, State};
use crate::input::InputError;
use crate::query::{ContactPoint, Manifold, Proximity};

/// The contents of a [`Snapshot`] as plain data.
///
/// ```
/// use impinge::{Pose, shape::Shape, world::{Body, Snapshot, World}};
///
/// let sphere = Body::new(Shape::sphere([0.0; 3], 1.0)?);
/// let mut world = World::new();
/// let still = world.insert(sphere.clone())?;
/// let moving = world.insert(sphere.at(Pose::from_translation([1.5, 0.0, 0.0])?))?;
/// world.step(&[])?;
///
/// let record = world.save().to_record();
/// let mut other = World::new();
/// other.restore(&Snapshot::from_record(&record, other.options()).expect("the record is valid"));
/// assert_eq!(other.pair(still, moving)?, world.pair(still, moving)?);
/// # Ok::<(), impinge::world::WorldError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Bodies, sorted by handle.
    pub bodies: Vec<RecordedBody>,
    /// Number of times that each slot for a body was taken or freed. It is odd if a body is in the
    /// slot, or if the handles of the slot are used up.
    pub generations: Vec<u32>,
    /// Slots that are free; the last one is taken next.
    pub free: Vec<u32>,
    /// Pairs of bodies whose boxes overlapped at the last step, sorted.
    pub pairs: Vec<RecordedPair>,
    /// Pairs that ended because a body was removed, for the next report.
    pub departed: Vec<PairKey>,
}

/// A body in a [`Record`], with its handle and its change since the last step.
#[derive(Clone, Debug)]
pub struct RecordedBody {
    /// Handle of the body.
    pub id: BodyId,
    /// Shape, pose, traits and margin of the body.
    pub body: Body,
    /// Change of the body since the last step.
    pub change: Change,
}

/// A pair of bodies whose boxes overlapped at the last step, with its contacts if the bodies
/// intersect.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPair {
    /// Handles of the bodies. The first has the smaller tag or, if the tags are equal, the smaller
    /// handle.
    pub bodies: [BodyId; 2],
    /// Whether the intersection is proved or undecided, and the contacts in the world frame. `None`
    /// if the bodies are apart, or were not processed yet.
    pub meeting: Option<(Proximity, Vec<Manifold>)>,
}

/// The reason why a record is invalid.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RecordError {
    /// Handles, generations and free slots contradict each other.
    Places,
    /// A shape cannot be placed at its pose, or a margin is invalid.
    Input {
        /// Handle of the body.
        body: BodyId,
        /// The error of the shape, the pose or the margin.
        error: InputError,
    },
    /// A pair names a missing body or the same body twice, is in the wrong order, or is listed
    /// twice.
    Pair {
        /// Index of the pair in [`Record::pairs`].
        row: usize,
    },
    /// A result of a pair says that the pair is apart, or a contact has a coordinate that is not
    /// finite or a depth that is NaN.
    Contact {
        /// Index of the pair in [`Record::pairs`].
        row: usize,
    },
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Places => write!(f, "the handles, generations and free places of the record contradict each other"),
            Self::Input { body, error } => write!(f, "body {body}: {error}"),
            Self::Pair { row } => {
                write!(f, "pair {row} does not name two bodies of the record in their order, or is listed twice")
            }
            Self::Contact { row } => {
                write!(f, "pair {row} has a result although it is apart, or has contacts that are not finite")
            }
        }
    }
}

impl std::error::Error for RecordError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Input { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl Snapshot {
    /// Returns the snapshot as plain data. The data are the same for the same bodies, whichever
    /// broad phase is used. Shapes are shared, not copied.
    ///
    /// # Complexity
    /// O(n + p log p) for n bodies and p pairs of boxes.
    #[must_use]
    pub fn to_record(&self) -> Record {
        let state = &self.0;
        let (generations, free) = state.residents.places();
        let recorded = |(id, resident): (BodyId, &Resident)| {
            let change = state.changed.of(id.index() as u32);
            RecordedBody { id, body: resident.clone().into_body(), change }
        };
        let pairs = state.pairs.iter().filter_map(|entry| {
            let key = state.key(entry.bodies)?;
            let meeting = entry.meeting.as_ref().map(|meeting| (meeting.proximity, meeting.manifolds.clone()));
            Some((key, RecordedPair { bodies: [key.a, key.b], meeting }))
        });
        let mut pairs: Vec<(PairKey, RecordedPair)> = pairs.collect();
        pairs.sort_unstable_by_key(|(key, _)| *key);
        Record {
            bodies: state.residents.iter().map(recorded).collect(),
            generations,
            free,
            pairs: pairs.into_iter().map(|(_, pair)| pair).collect(),
            departed: state.departed.clone(),
        }
    }

    /// Returns the snapshot for a record, for worlds with these options. Worlds that restore it
    /// then return the same bytes for the same steps.
    ///
    /// Results of pairs are not computed again. If they are not those of the last step, the world
    /// reports wrong pairs until their bodies change.
    ///
    /// # Errors
    /// Returns an error if the parts of the record contradict each other.
    ///
    /// # Complexity
    /// As for inserting the bodies, and O(p log p) for p pairs.
    pub fn from_record(record: &Record, options: &Options) -> Result<Self, RecordError> {
        let (mut residents, mut places) = (Vec::with_capacity(record.bodies.len()), Vec::new());
        for RecordedBody { id, body, change } in &record.bodies {
            let mut resident = Resident::new(body.clone()).map_err(|error| RecordError::Input { body: *id, error })?;
            places.push((body.traits.kind, id.index() as u32, resident.bounds(), *change));
            residents.push((*id, resident));
        }
        let residents = Slots::of(&record.generations, &record.free, residents).ok_or(RecordError::Places)?;
        let broad = Broad::new(options.broad_phase);
        let mut state = State { residents, broad, departed: record.departed.clone(), ..State::default() };
        let surfaces = record.bodies.iter().filter(|recorded| recorded.body.traits.surface.is_some());
        state.surface_bodies = surfaces.count();
        for (kind, place, bounds, change) in places {
            state.update_bounds(kind, place, bounds);
            state.changed.mark(place, change);
        }
        state.pair_up(&record.pairs)?;
        Ok(Self(state))
    }
}

impl State {
    /// Validates recorded pairs and adds them.
    fn pair_up(&mut self, pairs: &[RecordedPair]) -> Result<(), RecordError> {
        let mut rows: Vec<(PairKey, usize)> = Vec::with_capacity(pairs.len());
        for (row, pair) in pairs.iter().enumerate() {
            let key = pair.bodies.map(|body| self.residents.get(body).map(|resident| (resident.traits.tag, body)));
            let [Some((tag_a, a)), Some((tag_b, b))] = key else { return Err(RecordError::Pair { row }) };
            if (tag_a, a) >= (tag_b, b) {
                return Err(RecordError::Pair { row });
            }
            rows.push((PairKey { tag_a, tag_b, a, b }, row));
        }
        rows.sort_unstable();
        if let Some(twice) = rows.windows(2).find(|rows| rows[0].0 == rows[1].0) {
            return Err(RecordError::Pair { row: twice[1].1 });
        }
        for (row, RecordedPair { bodies, meeting }) in pairs.iter().enumerate() {
            let number = self.pairs.add(bodies.map(|body| body.index() as u32));
            let Some((proximity, manifolds)) = meeting else { continue };
            if *proximity == Proximity::Apart || !manifolds.iter().all(is_finite) {
                return Err(RecordError::Contact { row });
            }
            if let Some(entry) = self.pairs.get_mut(number) {
                entry.meeting = Some(Meeting { proximity: *proximity, manifolds: manifolds.clone() });
            }
        }
        Ok(())
    }
}

/// Reports whether all coordinates of the contacts are finite and no depth is NaN. Depths may be
/// infinite, as those of two half-spaces are.
fn is_finite(manifold: &Manifold) -> bool {
    let is_point = |point: [f64; 3]| point.iter().all(|x| x.is_finite());
    let is_contact =
        |at: &ContactPoint| is_point(at.point_a) && is_point(at.point_b) && !at.lower.is_nan() && !at.upper.is_nan();
    is_point(manifold.normal) && manifold.points.iter().all(is_contact)
}

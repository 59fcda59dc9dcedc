//! Snapshots as plain data, for files and for other processes, and snapshots of such data.

use std::fmt;

use super::body::{Body, BodyId};
use super::broad::Broad;
use super::events::PairKey;
use super::narrow::Meeting;
use super::outline::Extremes;
use super::placed::Placed;
use super::slots::Slots;
use super::{Change, Options, Resident, Snapshot, State};
use crate::input::InputError;
use crate::query::{ContactPoint, Manifold, Proximity};

/// All that a [`Snapshot`] knows, as data that anybody may keep.
///
/// ```
/// use impinge::{Pose, shape::Shape, world::{Body, Snapshot, World}};
///
/// let ball = Body::new(Shape::sphere([0.0; 3], 1.0)?);
/// let mut world = World::new();
/// let still = world.insert(ball.clone())?;
/// let moving = world.insert(ball.at(Pose::from_translation([1.5, 0.0, 0.0])?))?;
/// world.step(&[])?;
///
/// let record = world.save().to_record();
/// let mut other = World::new();
/// other.restore(&Snapshot::from_record(&record, other.options()).expect("it was recorded"));
/// assert_eq!(other.pair(still, moving)?, world.pair(still, moving)?);
/// # Ok::<(), impinge::world::WorldError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The bodies, by handle.
    pub bodies: Vec<RecordedBody>,
    /// How often each place for a body was taken or freed; odd where a body is in it, and where its handles are spent.
    pub generations: Vec<u32>,
    /// The places that are free; the last is taken next.
    pub free: Vec<u32>,
    /// The pairs of bodies whose boxes overlapped at the last step, sorted.
    pub pairs: Vec<RecordedPair>,
    /// Pairs that ended as a body was removed, for the next report.
    pub departed: Vec<PairKey>,
}

/// A body of a [`Record`].
#[derive(Clone, Debug)]
pub struct RecordedBody {
    /// Its handle.
    pub id: BodyId,
    /// All that is to be known about it.
    pub body: Body,
    /// Since the last step.
    pub change: Change,
}

/// A pair of a [`Record`].
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPair {
    /// The bodies: the first has the lesser tag or, where tags are equal, the lesser handle.
    pub bodies: [BodyId; 2],
    /// How sure it is that they meet, and where they do; none where they do not, or were not looked at yet.
    pub meeting: Option<(Proximity, Vec<Manifold>)>,
}

/// Why a record is none that a snapshot made.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RecordFlaw {
    /// Handles, generations and free places contradict each other.
    Places,
    /// A shape does not stand its pose.
    Input {
        /// The body.
        body: BodyId,
        /// What is wrong.
        error: InputError,
    },
    /// A pair is of a body that there is not, of one body alone, in the wrong order, or there twice.
    Pair {
        /// Its row in [`Record::pairs`].
        row: usize,
    },
    /// A pair that meets is apart, or a contact is nowhere or of no depth.
    Contact {
        /// The row of its pair in [`Record::pairs`].
        row: usize,
    },
}

impl fmt::Display for RecordFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Places => write!(f, "handles and places contradict each other"),
            Self::Input { body, error } => write!(f, "body {body}: {error}"),
            Self::Pair { row } => write!(f, "pair {row} is none of two bodies in their order, or is there twice"),
            Self::Contact { row } => write!(f, "pair {row} meets nowhere, or has contacts that are not finite"),
        }
    }
}

impl std::error::Error for RecordFlaw {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Input { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl Snapshot {
    /// The snapshot as data: the same for the same bodies, whatever way pairs are found in. Shapes are shared.
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

    /// The snapshot that such data is of, for worlds with these options: from there the same steps give the same bytes.
    ///
    /// What is said of the pairs is believed: where they are not those of the last step, neither is what the world says of them until
    /// their bodies change.
    ///
    /// # Errors
    /// Where the parts of the record contradict each other.
    ///
    /// # Complexity
    /// That of inserting the bodies, and O(p log p) for p pairs.
    pub fn from_record(record: &Record, options: &Options) -> Result<Self, RecordFlaw> {
        let (mut residents, mut places) = (Vec::with_capacity(record.bodies.len()), Vec::new());
        for RecordedBody { id, body, change } in &record.bodies {
            let placed = Placed::new(&body.shape, body.world_from_body)
                .map_err(|error| RecordFlaw::Input { body: *id, error })?;
            let mut extremes = Extremes::default();
            places.push((id.index() as u32, body.outline.bounds(placed.stands(), &mut extremes), *change));
            let outline = body.outline.clone();
            residents.push((*id, Resident { placed, outline, extremes, traits: body.traits }));
        }
        let residents = Slots::of(&record.generations, &record.free, residents).ok_or(RecordFlaw::Places)?;
        let broad = Broad::new(options.broad_phase);
        let mut state = State { residents, broad, departed: record.departed.clone(), ..State::default() };
        for (place, bounds, change) in places {
            state.shift(place, bounds);
            state.changed.mark(place, change);
        }
        state.pair_up(&record.pairs)?;
        Ok(Self(state))
    }
}

impl State {
    /// Adds recorded pairs, once they are judged.
    fn pair_up(&mut self, pairs: &[RecordedPair]) -> Result<(), RecordFlaw> {
        let mut rows: Vec<(PairKey, usize)> = Vec::with_capacity(pairs.len());
        for (row, pair) in pairs.iter().enumerate() {
            let key = pair.bodies.map(|body| self.residents.get(body).map(|resident| (resident.traits.tag, body)));
            let [Some((tag_a, a)), Some((tag_b, b))] = key else { return Err(RecordFlaw::Pair { row }) };
            if (tag_a, a) >= (tag_b, b) {
                return Err(RecordFlaw::Pair { row });
            }
            rows.push((PairKey { tag_a, tag_b, a, b }, row));
        }
        rows.sort_unstable();
        if let Some(twice) = rows.windows(2).find(|rows| rows[0].0 == rows[1].0) {
            return Err(RecordFlaw::Pair { row: twice[1].1 });
        }
        for (row, RecordedPair { bodies, meeting }) in pairs.iter().enumerate() {
            let number = self.pairs.add(bodies.map(|body| body.index() as u32));
            let Some((proximity, manifolds)) = meeting else { continue };
            if *proximity == Proximity::Apart || !manifolds.iter().all(is_finite) {
                return Err(RecordFlaw::Contact { row });
            }
            if let Some(entry) = self.pairs.get_mut(number) {
                entry.meeting = Some(Meeting { proximity: *proximity, manifolds: manifolds.clone() });
            }
        }
        Ok(())
    }
}

/// Depths may be infinite: those of half-spaces in each other are.
fn is_finite(manifold: &Manifold) -> bool {
    let is_point = |point: [f64; 3]| point.iter().all(|x| x.is_finite());
    let is_contact =
        |at: &ContactPoint| is_point(at.point_a) && is_point(at.point_b) && !at.lower.is_nan() && !at.upper.is_nan();
    is_point(manifold.normal) && manifold.points.iter().all(is_contact)
}

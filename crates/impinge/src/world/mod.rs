//! Worlds of many bodies that the caller moves: which of them meet, since when, where and how deep.
//!
//! There are no dynamics. The caller inserts [bodies](Body), hands every [`step`](World::step) the new poses and reads which
//! pairs began to meet, which ended, and which [persist](World::pairs), with their contacts. A step goes through four phases:
//!
//! 1. the poses are judged, all of them before any is taken, and boxes realigned to them, in the way that each body asks for;
//! 2. the bodies and their boxes take the new places;
//! 3. the broad phase finds the pairs whose boxes overlap and that layers, owners and the user's filter admit. The filter runs
//!    inside it, so that what it refuses is never stored;
//! 4. the narrow phase decides the pairs of which a body moved, on all cores of the current rayon pool.
//!
//! A pair is a candidate exactly where the two boxes in double precision overlap, whatever structure found it. So no answer
//! depends on the [broad phase](BroadPhase), on the number of threads or on the order in which bodies came: reports are sorted by
//! the bodies' [tags](Traits::tag), then by their handles. Nothing is ever dropped: there are no capacities.
//!
//! What counts as meeting is what [`query`](crate::query) says of the two shapes in their poses: exact for meshes, boxes and
//! hulls, with touching counted.

mod body;
mod broad;
mod changed;
mod error;
mod events;
mod filter;
mod narrow;
mod outline;
mod pairs;
mod placed;
mod plane;
mod queries;
mod rays;
mod record;
mod slots;
mod state;
mod step;

pub use body::{Body, BodyId, Kind, Layers, Traits};
pub use broad::BroadPhase;
pub use changed::Change;
pub use error::WorldError;
pub use events::{Events, Pair, PairKey, Work};
pub use filter::PairFilter;
pub use narrow::NarrowPhase;
pub use outline::Realignment;
pub use queries::BodyHit;
pub use rays::BodyRayHit;
pub use record::{Record, RecordFlaw, RecordedBody, RecordedPair};
pub use step::Phase;

use std::sync::Arc;

use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::{Aging, Positions};
use crate::shape::Shape;
use broad::Broad;
use events::sorted;
use outline::{Bounds, Extremes, Outline};
use pairs::Link;
use placed::Placed;
use state::{Resident, State};

/// How a world works.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// How pairs of boxes are found.
    pub broad_phase: BroadPhase,
    /// What is found out about them.
    pub narrow_phase: NarrowPhase,
}

/// Many bodies, and which of them meet.
///
/// ```
/// use impinge::{Pose, shape::Shape, world::{Body, World}};
///
/// let ball = Body::new(Shape::sphere([0.0; 3], 1.0)?);
/// let mut world = World::new();
/// let still = world.insert(ball.clone())?;
/// let moving = world.insert(ball.at(Pose::from_translation([5.0, 0.0, 0.0])?))?;
/// assert!(world.step(&[])?.began.is_empty());
///
/// world.step(&[(moving, Pose::from_translation([1.5, 0.0, 0.0])?)])?;
/// let pair = world.pair(still, moving)?.expect("they meet");
/// assert!((pair.manifolds[0].points[0].upper - 0.5).abs() < 1e-12);
///
/// world.remove(moving)?;
/// assert_eq!(world.step(&[])?.ended.len(), 1);
/// assert!(world.traits(moving).is_err()); // the handle is stale, for good
/// # Ok::<(), impinge::world::WorldError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct World {
    options: Options,
    filter: Option<Filter>,
    state: State,
}

/// All of a world that steps change; what [`World::save`] returned.
///
/// It costs a copy of the bodies' records and of the broad phase, while the shapes are shared.
#[derive(Clone, Debug)]
pub struct Snapshot(State);

type Filter = Arc<dyn PairFilter>;

impl World {
    /// An empty world: every choice left to it, contacts found.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty world that works as stated.
    #[must_use]
    pub fn with_options(options: Options) -> Self {
        Self { options, filter: None, state: State { broad: Broad::new(options.broad_phase), ..State::default() } }
    }

    /// How the world works.
    #[must_use]
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// How many bodies there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.state.residents.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Every body, by handle.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> {
        self.state.residents.iter().map(|(id, _)| id)
    }

    /// Puts a body into the world; what it meets is told by the next step.
    ///
    /// # Errors
    /// [`Input`](WorldError::Input) where the shape does not stand the pose, [`Full`](WorldError::Full).
    pub fn insert(&mut self, body: Body) -> Result<BodyId, WorldError> {
        let placed = Placed::new(&body.shape, body.world_from_body)?;
        let mut extremes = Extremes::default();
        let bounds = body.outline.bounds(placed.stands(), &mut extremes);
        let resident = Resident { placed, outline: body.outline, extremes, traits: body.traits };
        let id = self.state.residents.insert(resident).ok_or(WorldError::Full)?;
        self.state.shift(id.index() as u32, bounds);
        self.state.changed.mark(id.index() as u32, Change::Traits);
        Ok(id)
    }

    /// Takes a body out of the world, and its handle out of use. Pairs that it was in are gone at once, and are told as ended
    /// by the next step.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn remove(&mut self, body: BodyId) -> Result<Body, WorldError> {
        let index = self.resident(body).map(|_| body.index() as u32)?;
        let links: Vec<Link> = self.state.pairs.of(index).to_vec();
        for link in links {
            self.state.part(link.pair);
        }
        let resident = self.state.residents.remove(body).ok_or(WorldError::Stale { body })?;
        self.state.shift(index, Bounds::Nowhere);
        self.state.changed.forget(index);
        Ok(resident.into_body())
    }

    /// Where a body is.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn pose(&self, body: BodyId) -> Result<&Pose, WorldError> {
        Ok(self.resident(body)?.placed.world_from_body())
    }

    /// Whom a body meets, and its tag.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn traits(&self, body: BodyId) -> Result<&Traits, WorldError> {
        Ok(&self.resident(body)?.traits)
    }

    /// A body as it is now: what [`remove`](Self::remove) would return.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn body(&self, body: BodyId) -> Result<Body, WorldError> {
        Ok(self.resident(body)?.clone().into_body())
    }

    /// The box about a body in the world; none about a half-space, or where there is nothing to bound.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn bounds(&self, body: BodyId) -> Result<Option<crate::volume::MinMax>, WorldError> {
        self.resident(body)?;
        Ok(match *self.state.bounds_of(body.index() as u32) {
            Bounds::Box(bounds) => Some(bounds),
            Bounds::Nowhere | Bounds::Behind(_) | Bounds::Anywhere => None,
        })
    }

    /// Changes what moves a body, whom it meets and who owns it, from the next step on; its tag stays, as reports are sorted
    /// by it.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn set_traits(&mut self, body: BodyId, traits: Traits) -> Result<(), WorldError> {
        let resident = self.resident_mut(body)?;
        resident.traits = Traits { tag: resident.traits.tag, ..traits };
        self.state.changed.mark(body.index() as u32, Change::Traits);
        Ok(())
    }

    /// Puts a body elsewhere at once, one that is static too; what it meets there is told by the next step.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale), and [`Input`](WorldError::Input) where the shape does not stand the pose.
    pub fn set_pose(&mut self, body: BodyId, world_from_body: Pose) -> Result<(), WorldError> {
        let resident = self.resident(body)?;
        let placed = resident.placed.moved(world_from_body).map_err(|error| refused(body, error))?;
        self.state.replace(body, placed, None);
        Ok(())
    }

    /// Gives a body another shape: a mesh that was deformed, a pose of a character. Its box follows it in the same way as
    /// before.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale), and [`Input`](WorldError::Input) where the shape does not stand the pose.
    ///
    /// # Complexity
    /// One pass over the vertices, and their convex hull for the ways of realigning that need one.
    pub fn set_shape(&mut self, body: BodyId, shape: &Shape) -> Result<(), WorldError> {
        let resident = self.resident(body)?;
        let outline = Outline::by(shape, resident.outline.realignment()).map_err(|error| refused(body, error))?;
        let placed = Placed::new(shape, *resident.placed.world_from_body()).map_err(|error| refused(body, error))?;
        self.state.replace(body, placed, Some(Arc::new(outline)));
        Ok(())
    }

    /// Moves the vertices of a body that is a mesh, by [`Mesh::refitted`](crate::Mesh::refitted); other bodies of the mesh keep
    /// it as it is. Whoever deforms one mesh for many bodies refits it and calls [`set_shape`](Self::set_shape) for each.
    ///
    /// ```
    /// use impinge::{Mesh, Positions, shape::Shape, world::{Body, World}};
    ///
    /// let flag = Mesh::new(Positions::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), vec![[0, 1, 2]])?;
    /// let pole = Shape::segment([[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]])?;
    /// let mut world = World::new();
    /// let (flag, _) = (world.insert(Body::new(Shape::mesh(&flag)))?, world.insert(Body::new(pole))?);
    /// assert_eq!(world.step(&[])?.began.len(), 0);
    /// world.refit(flag, Positions::F32(vec![[0.0, 0.0, 1.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))?;
    /// assert_eq!(world.step(&[])?.began.len(), 1);
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale), [`NotAMesh`](WorldError::NotAMesh), and [`Input`](WorldError::Input) as the refit.
    pub fn refit(&mut self, body: BodyId, positions: impl Into<Positions>) -> Result<Aging, WorldError> {
        let placed = self.resident(body)?.placed.mesh().ok_or(WorldError::NotAMesh { body })?;
        let mesh = placed.mesh.refitted(positions).map_err(|error| refused(body, error))?;
        let shape = if placed.is_solid { Shape::solid(&mesh) } else { Shape::mesh(&mesh) };
        self.set_shape(body, &shape)?;
        Ok(mesh.aging())
    }

    /// Asks this filter about every pair that layers and owners admit, from the next step on; all pairs are asked for anew.
    pub fn set_filter(&mut self, filter: impl PairFilter + 'static) {
        self.filter = Some(Arc::new(filter));
        self.refilter();
    }

    /// Admits every pair that layers and owners do, from the next step on.
    pub fn clear_filter(&mut self) {
        self.filter = None;
        self.refilter();
    }

    fn refilter(&mut self) {
        let all: Vec<BodyId> = self.bodies().collect();
        all.into_iter().for_each(|body| self.state.changed.mark(body.index() as u32, Change::Traits));
    }

    /// All that steps change, for going back to it.
    ///
    /// From a snapshot on, the same steps give the same bytes, whatever came between: worlds can be rolled back and played
    /// again. The filter is not part of it.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        Snapshot(self.state.clone())
    }

    /// Goes back to a snapshot, of this world or of another one with the same options. Handles are those of that time.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.state.clone_from(&snapshot.0);
    }

    /// The pairs that met at the last step, sorted; those of bodies that were removed since are gone.
    ///
    /// # Complexity
    /// O(p + k log k) for k of p pairs of boxes.
    pub fn pairs(&self) -> impl Iterator<Item = Pair<'_>> {
        sorted(self.state.pairs.iter().filter_map(|entry| self.state.pair(entry)).collect()).into_iter()
    }

    /// The pairs that a body was in at the last step, sorted.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn pairs_of(&self, body: BodyId) -> Result<impl Iterator<Item = Pair<'_>>, WorldError> {
        self.resident(body)?;
        let entries =
            self.state.pairs.of(body.index() as u32).iter().filter_map(|link| self.state.pairs.get(link.pair));
        Ok(sorted(entries.filter_map(|entry| self.state.pair(entry)).collect()).into_iter())
    }

    /// The pair of two bodies; none where they did not meet at the last step.
    ///
    /// # Errors
    /// [`Stale`](WorldError::Stale).
    pub fn pair(&self, one: BodyId, other: BodyId) -> Result<Option<Pair<'_>>, WorldError> {
        self.resident(one)?;
        self.resident(other)?;
        let pair = self.state.pairs.find(one.index() as u32, other.index() as u32);
        Ok(pair.and_then(|pair| self.state.pairs.get(pair)).and_then(|entry| self.state.pair(entry)))
    }

    fn resident(&self, body: BodyId) -> Result<&Resident, WorldError> {
        self.state.residents.get(body).ok_or(WorldError::Stale { body })
    }

    /// Whether two different bodies, given in the order of reports, may meet.
    fn admits(&self, a: (BodyId, &Resident), b: (BodyId, &Resident)) -> bool {
        a.1.traits.admit(&b.1.traits)
            && self.filter.as_ref().is_none_or(|filter| filter.admits((a.0, &a.1.traits), (b.0, &b.1.traits)))
    }

    fn resident_mut(&mut self, body: BodyId) -> Result<&mut Resident, WorldError> {
        self.state.residents.get_mut(body).ok_or(WorldError::Stale { body })
    }
}

fn refused(body: BodyId, error: InputError) -> WorldError {
    WorldError::Input { body: Some(body), error }
}

//! Worlds of many bodies that the caller moves: which of them intersect, since when, where and how
//! deep.
//!
//! There are no dynamics. The caller inserts [bodies](Body), passes the new poses to every
//! [`step`](World::step), and reads which pairs began, which ended, and which
//! [persist](World::pairs), with their contacts. A step has four phases:
//!
//! 1. All poses are validated before any is applied, and boxes are realigned to them in the way
//!    that each body chooses.
//! 2. The bodies and their boxes are moved.
//! 3. The broad phase finds the pairs whose boxes overlap and that layers, owners and the user's
//!    filter admit. The filter runs inside the broad phase, so that refused pairs are never stored.
//! 4. The narrow phase decides the pairs of which a body changed, on all threads of the current
//!    rayon pool.
//!
//! A pair is a candidate if and only if its two boxes overlap in double precision, whichever
//! structure found it. No result therefore depends on the [broad phase](BroadPhase), on the number
//! of threads or on the order in which bodies were inserted. Reports are sorted by the bodies'
//! [tags](Traits::tag), then by their handles. No pair is ever dropped, because there are no
//! capacity limits.
//!
//! Two bodies intersect if [`query`](crate::query) reports so for their shapes in their poses. The
//! decision is exact for meshes, boxes and hulls; touching counts. A pair that is undecided is
//! reported as if it intersected. Bodies with [margins](Body::with_margin) are a pair if
//! [`within`](crate::query::within()) reports that their distance is at most the sum of the margins.
//! Boxes are grown by margins.
//!
//! Guarded by `tests/it/worlds`, measured by the benchmark `worlds`.

mod body;
mod broad;
mod casts;
mod changed;
mod error;
mod events;
mod filter;
mod filtering;
mod margins;
mod narrow;
mod nearest;
mod other;
mod outline;
mod pairs;
mod placed;
mod plane;
mod queries;
mod ray_hits;
mod rays;
mod record;
mod search;
mod slots;
mod state;
mod step;
mod surfaces;

pub use body::{Body, BodyId, Kind, Layers, Traits};
pub use broad::BroadPhase;
pub use casts::BodyImpact;
pub use changed::Change;
pub use error::WorldError;
pub use events::{Events, Pair, PairKey, Work};
pub use filter::PairFilter;
pub use narrow::NarrowPhase;
pub use nearest::BodyDistance;
pub use outline::Realignment;
pub use queries::BodyHit;
pub use ray_hits::RayOptions;
pub use rays::BodyRayHit;
pub use record::{Record, RecordError, RecordedBody, RecordedPair};
pub use step::Phase;

use std::sync::Arc;

use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::{Aging, Positions};
use crate::shape::Shape;
use broad::Broad;
use events::sorted;
use other::Spare;
use outline::{Bounds, Outline};
use pairs::Link;
use placed::Placed;
use state::{Resident, State};

/// Options of a world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Method by which pairs of overlapping boxes are found.
    pub broad_phase: BroadPhase,
    /// Results that a step computes for each pair of bodies whose boxes overlap.
    pub narrow_phase: NarrowPhase,
}

/// A set of bodies, with the pairs of bodies that intersect or may intersect. Each
/// [`step`](Self::step) moves bodies and updates the pairs.
///
/// ```
/// use impinge::{Pose, shape::Shape, world::{Body, World}};
///
/// let sphere = Body::new(Shape::sphere([0.0; 3], 1.0)?);
/// let mut world = World::new();
/// let still = world.insert(sphere.clone())?;
/// let moving = world.insert(sphere.at(Pose::from_translation([5.0, 0.0, 0.0])?))?;
/// assert!(world.step(&[])?.began.is_empty());
///
/// world.step(&[(moving, Pose::from_translation([1.5, 0.0, 0.0])?)])?;
/// let pair = world.pair(still, moving)?.expect("they intersect");
/// assert!((pair.manifolds[0].points[0].upper - 0.5).abs() < 1e-12);
///
/// world.remove(moving)?;
/// assert_eq!(world.step(&[])?.ended.len(), 1);
/// assert!(world.traits(moving).is_err()); // the handle is stale forever
/// # Ok::<(), impinge::world::WorldError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct World {
    options: Options,
    filter: Option<Filter>,
    state: State,
    /// Memory that a step uses and the next one uses again.
    spare: Spare,
}

/// Everything in a world that steps change, as returned by [`World::save`].
///
/// Saving copies the data of the bodies and of the broad phase. Shapes are shared, not copied.
#[derive(Clone, Debug)]
pub struct Snapshot(State);

type Filter = Arc<dyn PairFilter>;

impl World {
    /// Returns an empty world with default options: it chooses the broad phase itself and computes
    /// contacts.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns an empty world with these options.
    #[must_use]
    pub fn with_options(options: Options) -> Self {
        let state = State { broad: Broad::new(options.broad_phase), ..State::default() };
        Self { options, state, ..Self::default() }
    }

    /// Returns the options of the world.
    #[must_use]
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Returns the number of bodies.
    #[must_use]
    pub fn len(&self) -> usize {
        self.state.residents.len()
    }

    /// Returns `true` if the world has no bodies.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the handles of all bodies, sorted.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> {
        self.state.residents.iter().map(|(id, _)| id)
    }

    /// Inserts a body. The next step reports the pairs that it is in.
    ///
    /// # Errors
    /// Returns [`Input`](WorldError::Input) if the shape cannot be placed at the pose or the margin is
    /// invalid, and [`Full`](WorldError::Full) if there are no more handles.
    pub fn insert(&mut self, body: Body) -> Result<BodyId, WorldError> {
        let mut resident = Resident::new(body)?;
        let (kind, bounds) = (resident.traits.kind, resident.bounds());
        let is_of_surface = resident.traits.surface.is_some();
        let id = self.state.residents.insert(resident).ok_or(WorldError::Full)?;
        self.state.update_bounds(kind, id.index() as u32, bounds);
        self.state.surface_bodies += usize::from(is_of_surface);
        self.state.changed.mark(id.index() as u32, Change::Traits);
        Ok(id)
    }

    /// Removes a body and returns it. Its handle becomes stale. Its pairs disappear at once, and
    /// the next step reports them as ended.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn remove(&mut self, body: BodyId) -> Result<Body, WorldError> {
        let index = self.resident(body).map(|_| body.index() as u32)?;
        self.state.mark_neighbors(index);
        let links: Vec<Link> = self.state.pairs.of(index).to_vec();
        for link in links {
            self.state.remove_pair(link.pair);
        }
        let resident = self.state.residents.remove(body).ok_or(WorldError::Stale { body })?;
        self.state.surface_bodies -= usize::from(resident.traits.surface.is_some());
        self.state.update_bounds(resident.traits.kind, index, Bounds::Nowhere);
        self.state.changed.forget(index);
        Ok(resident.into_body())
    }

    /// Returns the pose of a body: the map from the body's frame to the world frame.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn pose(&self, body: BodyId) -> Result<&Pose, WorldError> {
        Ok(self.resident(body)?.placed.world_from_body())
    }

    /// Returns the kind, layers, owner, surface and tag of a body.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn traits(&self, body: BodyId) -> Result<&Traits, WorldError> {
        Ok(&self.resident(body)?.traits)
    }

    /// Returns a copy of a body in its current state, as [`remove`](Self::remove) would return it.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn body(&self, body: BodyId) -> Result<Body, WorldError> {
        Ok(self.resident(body)?.clone().into_body())
    }

    /// Returns an axis-aligned box in the world frame that contains a body and its margin. Returns
    /// `None` for a body that is empty, or that is or contains a half-space.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn bounds(&self, body: BodyId) -> Result<Option<crate::volume::MinMax>, WorldError> {
        self.resident(body)?;
        Ok(match *self.state.bounds_of(body.index() as u32) {
            Bounds::Box(bounds) => Some(bounds),
            Bounds::Nowhere | Bounds::Behind(_) | Bounds::Anywhere => None,
        })
    }

    /// Changes the kind, layers, owner and surface of a body, from the next step on. The tag stays
    /// as it is, because reports are sorted by it.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn set_traits(&mut self, body: BodyId, traits: Traits) -> Result<(), WorldError> {
        let (before, place) = (self.resident(body)?.traits, body.index() as u32);
        self.state.mark_neighbors(place);
        self.state.surface_bodies += usize::from(traits.surface.is_some());
        self.state.surface_bodies -= usize::from(before.surface.is_some());
        if (before.kind == Kind::Moving) != (traits.kind == Kind::Moving) {
            let bounds = *self.state.bounds_of(place);
            self.state.update_bounds(before.kind, place, Bounds::Nowhere);
            self.state.update_bounds(traits.kind, place, bounds);
        }
        self.resident_mut(body)?.traits = Traits { tag: before.tag, ..traits };
        self.state.changed.mark(place, Change::Traits);
        Ok(())
    }

    /// Sets the pose of a body at once, also of a static body. The pose maps the body's frame to
    /// the world frame. The next step reports the pairs that this changes.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world, and
    /// [`Input`](WorldError::Input) if the shape cannot be placed at the pose.
    pub fn set_pose(&mut self, body: BodyId, world_from_body: Pose) -> Result<(), WorldError> {
        let resident = self.resident(body)?;
        let placed = resident.placed.moved(world_from_body).map_err(|error| refused(body, error))?;
        self.state.replace(body, placed, None);
        Ok(())
    }

    /// Gives a body another shape, for example a deformed mesh or another pose of a character. Its
    /// box is realigned in the same way as before.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world, and
    /// [`Input`](WorldError::Input) if the shape cannot be placed at the body's pose.
    ///
    /// # Complexity
    /// One pass over the vertices, and their convex hull if the way of realigning needs one.
    pub fn set_shape(&mut self, body: BodyId, shape: &Shape) -> Result<(), WorldError> {
        let resident = self.resident(body)?;
        let outline = Outline::by(shape, resident.outline.realignment()).map_err(|error| refused(body, error))?;
        let placed = Placed::new(shape, *resident.placed.world_from_body()).map_err(|error| refused(body, error))?;
        self.state.replace(body, placed, Some(Arc::new(outline)));
        Ok(())
    }

    /// Moves the vertices of a body that is a mesh to positions in the mesh's frame, by
    /// [`Mesh::refitted`](crate::Mesh::refitted). Returns how the hierarchy of the mesh has aged.
    /// Other bodies with the same mesh do not change. To deform one mesh for many bodies, refit it
    /// once and call [`set_shape`](Self::set_shape) for each body.
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
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world,
    /// [`NotAMesh`](WorldError::NotAMesh) if it is not a mesh, and [`Input`](WorldError::Input) if
    /// the refit fails.
    pub fn refit(&mut self, body: BodyId, positions: impl Into<Positions>) -> Result<Aging, WorldError> {
        let placed = self.resident(body)?.placed.mesh().ok_or(WorldError::NotAMesh { body })?;
        let mesh = placed.mesh.refitted(positions).map_err(|error| refused(body, error))?;
        let shape = if placed.is_solid { Shape::solid(&mesh) } else { Shape::mesh(&mesh) };
        self.set_shape(body, &shape)?;
        Ok(mesh.aging())
    }

    /// Returns a snapshot of everything that steps change.
    ///
    /// After [`restore`](Self::restore), the same steps return the same bytes, whatever happened in
    /// between, so worlds can be rolled back and replayed. The filter is not part of the snapshot.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        Snapshot(self.state.clone())
    }

    /// Goes back to a snapshot of this world, or of another world with the same options. Handles
    /// are those of the snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.state.clone_from(&snapshot.0);
    }

    /// Returns the pairs that intersected at the last step, sorted. Undecided pairs are included.
    /// Pairs of bodies that were removed since then are not among them.
    ///
    /// # Complexity
    /// O(p + k log k) for k intersecting pairs out of p pairs of overlapping boxes.
    pub fn pairs(&self) -> impl Iterator<Item = Pair<'_>> {
        sorted(self.state.pairs.iter().filter_map(|entry| self.state.pair(entry)).collect()).into_iter()
    }

    /// Returns the pairs of a body that intersected at the last step, sorted. Undecided pairs are
    /// included.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn pairs_of(&self, body: BodyId) -> Result<impl Iterator<Item = Pair<'_>>, WorldError> {
        self.resident(body)?;
        let entries =
            self.state.pairs.of(body.index() as u32).iter().filter_map(|link| self.state.pairs.get(link.pair));
        Ok(sorted(entries.filter_map(|entry| self.state.pair(entry)).collect()).into_iter())
    }

    /// Returns the pair of two bodies, given in any order, if they intersected at the last step or
    /// this was undecided. Returns `None` otherwise.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if one of the bodies is not in the world.
    pub fn pair(&self, one: BodyId, other: BodyId) -> Result<Option<Pair<'_>>, WorldError> {
        self.resident(one)?;
        self.resident(other)?;
        let pair = self.state.pairs.find(one.index() as u32, other.index() as u32);
        Ok(pair.and_then(|pair| self.state.pairs.get(pair)).and_then(|entry| self.state.pair(entry)))
    }

    fn resident(&self, body: BodyId) -> Result<&Resident, WorldError> {
        self.state.residents.get(body).ok_or(WorldError::Stale { body })
    }

    /// Reports whether kinds, layers, owners and the filter admit a pair of two different bodies,
    /// given in the order of reports.
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

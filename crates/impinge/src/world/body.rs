//! The bodies of a world: shape, pose, and traits that decide about pairs.

use std::fmt;
use std::sync::Arc;

use super::outline::{Outline, Realignment};
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::shape::Shape;

/// Handle of a body in its world. It never refers to another body: after the body is removed, every
/// method that takes the handle returns an error that it is stale.
///
/// Handles of two worlds look alike. Use a handle only with its own world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId {
    index: u32,
    generation: u32,
}

impl BodyId {
    pub(super) fn new(index: u32, generation: u32) -> Self {
        Self { index, generation }
    }

    /// Returns the body's slot in the world's arrays.
    pub(super) fn index(self) -> usize {
        self.index as usize
    }

    pub(super) fn generation(self) -> u32 {
        self.generation
    }

    /// Returns the handle as one number, for languages and files without handles. Numbers have the
    /// same order as handles and are never zero.
    #[must_use]
    pub fn to_bits(self) -> u64 {
        u64::from(self.index) << 32 | u64::from(self.generation)
    }

    /// Returns the handle for a number that [`to_bits`](Self::to_bits) returned. Any other number
    /// gives a stale handle or the handle of some body.
    #[must_use]
    pub fn from_bits(bits: u64) -> Self {
        Self { index: (bits >> 32) as u32, generation: bits as u32 }
    }
}

impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}#{}", self.index, self.generation)
    }
}

/// How a body is moved. Pairs are reported only if at least one of their bodies is
/// [`Moving`](Self::Moving).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Does not move: walls, terrain. Steps refuse to move it.
    Static,
    /// Moves on a given path, whatever it collides with: doors, lifts, conveyor belts.
    Kinematic,
    /// Reacts to the bodies that it collides with.
    #[default]
    Moving,
}

/// The layers, out of 32, that a body is on, and the layers whose bodies it collides with. A pair
/// is admitted only if each body collides with a layer of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layers {
    /// Layers that the body is on, one bit each.
    pub on: u32,
    /// Layers whose bodies this body collides with, one bit each.
    pub meets: u32,
}

impl Layers {
    /// The body is on every layer and collides with every layer.
    pub const ALL: Self = Self { on: u32::MAX, meets: u32::MAX };

    /// Reports whether each of two bodies collides with a layer of the other.
    #[must_use]
    pub fn admit(self, other: Self) -> bool {
        self.meets & other.on != 0 && other.meets & self.on != 0
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self::ALL
    }
}

/// The properties of a body that decide about its pairs. Filters receive them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Traits {
    /// How the body is moved.
    pub kind: Kind,
    /// Layers of the body, and the layers that it collides with.
    pub layers: Layers,
    /// Owner of the body. Bodies with the same owner never form a pair, for example the limbs of
    /// one character, or a weapon and its bearer.
    pub owner: Option<u64>,
    /// Surface that the body is a piece of while it is [`Static`](Kind::Static), such as a floor of
    /// tiles. Contacts with bodies of one surface are those of one compound
    /// ([`contacts`](crate::query::contacts())): nothing that slides or rolls over the tiles meets
    /// the sides or edges between them.
    pub surface: Option<u64>,
    /// A number chosen by the user. Reports are sorted by it, so bodies with different tags are
    /// reported in the same order, whatever the order in which they were inserted.
    pub tag: u64,
}

/// All properties of a body that is not in a world yet. Cloning is fast, because clones share the
/// shape.
///
/// ```
/// use impinge::{Pose, shape::Shape, world::{Body, Kind, World}};
///
/// let crate_ = Body::new(Shape::cuboid([0.5; 3])?).tag(7);
/// let floor = Body::new(Shape::half_space([0.0, 0.0, 1.0], 0.0)?).kind(Kind::Static);
/// let mut world = World::new();
/// world.insert(floor)?;
/// for height in [0.5, 2.0] {
///     world.insert(crate_.clone().at(Pose::from_translation([0.0, 0.0, height])?))?;
/// }
/// assert_eq!(world.step(&[])?.began.len(), 1); // the lower crate stands on the floor
/// # Ok::<(), impinge::world::WorldError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Body {
    pub(super) shape: Shape,
    pub(super) outline: Arc<Outline>,
    pub(super) world_from_body: Pose,
    pub(super) traits: Traits,
    pub(super) margin: f64,
}

impl Body {
    /// Returns a [`Moving`](Kind::Moving) body with this shape at the identity pose: its frame is
    /// the world frame.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        let (outline, traits) = (Arc::new(Outline::new()), Traits::default());
        Self { shape, outline, world_from_body: Pose::IDENTITY, traits, margin: 0.0 }
    }

    /// Returns the shape of the body, in the body's frame.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Returns the pose of the body: the map from its frame to the world frame.
    #[must_use]
    pub fn world_from_body(&self) -> &Pose {
        &self.world_from_body
    }

    /// Returns the kind, layers, owner, surface and tag of the body.
    #[must_use]
    pub fn traits(&self) -> &Traits {
        &self.traits
    }

    /// Returns the margin of the body, in world units.
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// Returns how the body's box follows the body when it rotates.
    #[must_use]
    pub fn realignment(&self) -> Realignment {
        self.outline.realignment()
    }

    /// Returns the same body at another pose, which maps the body's frame to the world frame. The
    /// pose is validated when the body is inserted.
    #[must_use]
    pub fn at(mut self, world_from_body: Pose) -> Self {
        self.world_from_body = world_from_body;
        self
    }

    /// Returns the same body with another kind.
    #[must_use]
    pub fn kind(mut self, kind: Kind) -> Self {
        self.traits.kind = kind;
        self
    }

    /// Returns the same body with other layers.
    #[must_use]
    pub fn layers(mut self, layers: Layers) -> Self {
        self.traits.layers = layers;
        self
    }

    /// Returns the same body with an owner. Bodies of the same owner do not form pairs.
    #[must_use]
    pub fn owner(mut self, owner: u64) -> Self {
        self.traits.owner = Some(owner);
        self
    }

    /// Returns the same body as a piece of a surface, which matters while the body is
    /// [`Static`](Kind::Static). A pair of the body has no manifold if its contacts are those of a
    /// seam, and bodies beside it hold the other body.
    ///
    /// ```
    /// use impinge::{Pose, shape::Shape, world::{Body, Kind, World}};
    ///
    /// let mut world = World::new();
    /// let tile = Body::new(Shape::cuboid([5.0, 5.0, 0.5])?).kind(Kind::Static).surface(1);
    /// for x in [-5.0, 5.0] {
    ///     world.insert(tile.clone().at(Pose::from_translation([x, 0.0, -0.5])?))?;
    /// }
    /// // A crate 0.01 deep in the floor, 0.001 over the seam.
    /// let crate_ = Body::new(Shape::cuboid([0.5; 3])?);
    /// world.insert(crate_.at(Pose::from_translation([-0.499, 0.0, 0.49])?))?;
    /// world.step(&[])?;
    /// let mut manifolds = world.pairs().flat_map(|pair| pair.manifolds);
    /// assert!(manifolds.all(|manifold| manifold.normal[2] > 0.999));
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    ///
    /// # Complexity
    /// If a body of a surface changes, pairs of the bodies beside it are processed again.
    #[must_use]
    pub fn surface(mut self, surface: u64) -> Self {
        self.traits.surface = Some(surface);
        self
    }

    /// Returns the same body with another tag.
    #[must_use]
    pub fn tag(mut self, tag: u64) -> Self {
        self.traits.tag = tag;
        self
    }

    /// Returns the same body with another margin in world units; it is zero otherwise. Two bodies
    /// are a pair if their distance is at most the sum of their margins, so that contacts are
    /// known before the bodies touch. The margin is validated when the body is inserted: it must
    /// be from 0 to 2^128.
    ///
    /// ```
    /// use impinge::{Pose, shape::Shape, world::{Body, World}};
    ///
    /// let sphere = Body::new(Shape::sphere([0.0; 3], 1.0)?).with_margin(0.25);
    /// let mut world = World::new();
    /// let a = world.insert(sphere.clone())?;
    /// let b = world.insert(sphere.at(Pose::from_translation([2.25, 0.0, 0.0])?))?;
    /// world.step(&[])?;
    /// let pair = world.pair(a, b)?.expect("they are 0.25 apart, and the margins sum to 0.5");
    /// assert!((pair.manifolds[0].points[0].upper + 0.25).abs() < 1e-12);
    /// # Ok::<(), impinge::world::WorldError>(())
    /// ```
    #[must_use]
    pub fn with_margin(mut self, margin: f64) -> Self {
        self.margin = margin;
        self
    }

    /// Returns the same body, whose box follows it in another way. No result depends on it.
    ///
    /// # Errors
    /// Returns the error of [`Hull::new`](crate::hull::Hull::new) if the way needs a convex hull
    /// that cannot be built.
    ///
    /// # Complexity
    /// One pass over the vertices, and their convex hull if the way needs one. Clones of the
    /// returned body share the result.
    pub fn realigned_by(mut self, way: Realignment) -> Result<Self, InputError> {
        self.outline = Arc::new(Outline::by(&self.shape, way)?);
        Ok(self)
    }
}

/// Maximum margin: 2^128, as for coordinates.
const MAX_MARGIN: f64 = (1_u128 << 127) as f64 * 2.0;

/// Validates a margin.
///
/// # Errors
/// Returns an error if the margin is not finite, negative or above 2^128.
pub(super) fn validate_margin(margin: f64) -> Result<(), InputError> {
    let kind = match margin {
        _ if !margin.is_finite() => InputErrorKind::NonFinite { what: "margin", index: 0 },
        _ if margin < 0.0 => InputErrorKind::Negative { what: "margin", index: 0 },
        _ if margin > MAX_MARGIN => InputErrorKind::OutOfRange { what: "margin", index: 0, limit: "2^128" },
        _ => return Ok(()),
    };
    Err(InputError::new(kind))
}

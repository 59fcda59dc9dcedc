//! What is put into a world: a shape, where it stands, and what it has to do with others.

use std::fmt;
use std::sync::Arc;

use super::outline::{Outline, Realignment};
use crate::input::InputError;
use crate::math::Pose;
use crate::shape::Shape;

/// The name of a body in its world. It never comes to mean another body: once that is removed, whatever takes the handle says
/// that it is stale.
///
/// Handles of two worlds look alike; a world knows its own only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId {
    index: u32,
    generation: u32,
}

impl BodyId {
    pub(super) fn new(index: u32, generation: u32) -> Self {
        Self { index, generation }
    }

    /// The place in the world's arrays.
    pub(super) fn index(self) -> usize {
        self.index as usize
    }

    pub(super) fn generation(self) -> u32 {
        self.generation
    }

    /// The handle as one number, for languages and files that know no handles: in the same order, and never zero.
    #[must_use]
    pub fn to_bits(self) -> u64 {
        u64::from(self.index) << 32 | u64::from(self.generation)
    }

    /// The handle of a number that [`to_bits`](Self::to_bits) made; any other number is a stale handle at worst.
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

/// What moves a body, and so which pairs are looked for: those of which one body at least is [`Moving`](Self::Moving).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Stands where it was put: walls, terrain. A step that moves one is refused.
    Static,
    /// Moves as it is told, whatever it runs into: doors, lifts, conveyor belts.
    Kinematic,
    /// Reacts to what it meets.
    #[default]
    Moving,
}

/// On which of 32 layers a body is, and those on which it meets others. Both bodies of a pair have to want it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layers {
    /// The layers that the body is on, as bits.
    pub on: u32,
    /// The layers whose bodies it meets, as bits.
    pub meets: u32,
}

impl Layers {
    /// On every layer, meeting all.
    pub const ALL: Self = Self { on: u32::MAX, meets: u32::MAX };

    /// Whether each of two bodies meets a layer of the other.
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

/// All that a filter sees of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Traits {
    /// What moves it.
    pub kind: Kind,
    /// Whom it meets.
    pub layers: Layers,
    /// Bodies with one owner never meet: the limbs of one character, a weapon and who holds it.
    pub owner: Option<u64>,
    /// The user's own number. Reports are sorted by it, so bodies with tags of their own are reported in the same order in
    /// whatever order they came.
    pub tag: u64,
}

/// Everything about a body that is not in a world yet; cheap to clone, as many bodies share one shape.
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
}

impl Body {
    /// A moving body of this shape, where its own frame is the world.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        let (outline, traits) = (Arc::new(Outline::new()), Traits::default());
        Self { shape, outline, world_from_body: Pose::IDENTITY, traits }
    }

    /// Its shape.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Where it is.
    #[must_use]
    pub fn world_from_body(&self) -> &Pose {
        &self.world_from_body
    }

    /// Whom it meets, and its tag.
    #[must_use]
    pub fn traits(&self) -> &Traits {
        &self.traits
    }

    /// How its box is found.
    #[must_use]
    pub fn realignment(&self) -> Realignment {
        self.outline.realignment()
    }

    /// The same body elsewhere; whether its shape stands the pose is judged where it is inserted.
    #[must_use]
    pub fn at(mut self, world_from_body: Pose) -> Self {
        self.world_from_body = world_from_body;
        self
    }

    /// The same body, moved by something else.
    #[must_use]
    pub fn kind(mut self, kind: Kind) -> Self {
        self.traits.kind = kind;
        self
    }

    /// The same body on other layers.
    #[must_use]
    pub fn layers(mut self, layers: Layers) -> Self {
        self.traits.layers = layers;
        self
    }

    /// The same body as one of a group whose bodies do not meet each other.
    #[must_use]
    pub fn owner(mut self, owner: u64) -> Self {
        self.traits.owner = Some(owner);
        self
    }

    /// The same body with a number of the user's.
    #[must_use]
    pub fn tag(mut self, tag: u64) -> Self {
        self.traits.tag = tag;
        self
    }

    /// The same body, its box in the world found in another way. No answer depends on it.
    ///
    /// # Errors
    /// As [`Hull::new`](crate::hull::Hull::new), for the ways that need a hull.
    ///
    /// # Complexity
    /// One pass over the vertices, and their convex hull for those ways; clone the body to share it.
    pub fn realigned_by(mut self, way: Realignment) -> Result<Self, InputError> {
        self.outline = Arc::new(Outline::by(&self.shape, way)?);
        Ok(self)
    }
}

//! The parts of a scene, and which pairs of them are asked about.

use std::collections::{HashMap, HashSet};
use std::error::Error;
use std::fmt;

use crate::input::InputError;
use crate::math::Pose;
use crate::shape::Shape;

/// A part of a scene, by its place in the order in which parts were added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PartId(u32);

/// Named parts that are checked against each other.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    parts: Vec<Part>,
    by_name: HashMap<String, PartId>,
    /// Pairs that are not asked about, the lesser part first.
    ignored: HashSet<[PartId; 2]>,
}

#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) name: String,
    pub(super) shape: Shape,
    pub(super) world_from_part: Pose,
    group: Option<u32>,
}

/// Why a part was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneError {
    /// Another part has this name.
    NameTaken {
        /// The name.
        name: String,
    },
    /// The part cannot stand at its pose.
    Pose {
        /// The name of the part.
        name: String,
        /// Why not.
        error: InputError,
    },
    /// There are 2^32 - 1 parts, the most that there may be.
    Full,
}

impl PartId {
    /// Returns the place of the part in the order in which parts were added.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Scene {
    /// Returns a scene without parts.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a part: a mesh, a solid (`mesh.solid()`), a shape or a compound, at a pose.
    ///
    /// # Errors
    /// If another part has the name, or the part cannot stand at the pose, as a round shape at one that is not rigid.
    pub fn add(
        &mut self,
        name: impl Into<String>,
        shape: impl Into<Shape>,
        world_from_part: Pose,
    ) -> Result<PartId, SceneError> {
        let (name, shape) = (name.into(), shape.into());
        if self.by_name.contains_key(&name) {
            return Err(SceneError::NameTaken { name });
        }
        if let Err(error) = shape.judge(&world_from_part) {
            return Err(SceneError::Pose { name, error });
        }
        let Some(number) = u32::try_from(self.parts.len()).ok().filter(|&number| number < u32::MAX) else {
            return Err(SceneError::Full);
        };
        let part = PartId(number);
        self.by_name.insert(name.clone(), part);
        self.parts.push(Part { name, shape, world_from_part, group: None });
        Ok(part)
    }

    /// Returns the part with a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<PartId> {
        self.by_name.get(name).copied()
    }

    /// Returns all parts, in the order in which they were added.
    pub fn parts(&self) -> impl ExactSizeIterator<Item = PartId> + use<> {
        (0..self.parts.len() as u32).map(PartId)
    }

    /// Returns the name of a part.
    ///
    /// # Panics
    /// As all methods that take a part: if it is of another scene, which has more parts.
    #[must_use]
    pub fn name(&self, part: PartId) -> &str {
        &self.part(part).name
    }

    /// Returns what a part is made of.
    ///
    /// # Panics
    /// As [`name`](Self::name).
    #[must_use]
    pub fn shape(&self, part: PartId) -> &Shape {
        &self.part(part).shape
    }

    /// Leaves a pair of parts out of all later questions.
    ///
    /// # Panics
    /// As [`name`](Self::name).
    pub fn ignore(&mut self, a: PartId, b: PartId) {
        assert!(a.max(b).index() < self.parts.len(), "there is no such part");
        self.ignored.insert([a.min(b), a.max(b)]);
    }

    /// Puts a part into a group. Parts of one group are not asked about among themselves; a part without a group is asked about with
    /// all others.
    ///
    /// # Panics
    /// As [`name`](Self::name).
    pub fn set_group(&mut self, part: PartId, group: Option<u32>) {
        self.parts[part.index()].group = group;
    }

    /// Reports whether a pair of parts is asked about.
    ///
    /// # Panics
    /// As [`name`](Self::name).
    #[must_use]
    pub fn admits(&self, a: PartId, b: PartId) -> bool {
        let [group_a, group_b] = [a, b].map(|part| self.part(part).group);
        let is_one_group = group_a.is_some() && group_a == group_b;
        a != b && !is_one_group && !self.ignored.contains(&[a.min(b), a.max(b)])
    }

    pub(super) fn part(&self, part: PartId) -> &Part {
        &self.parts[part.index()]
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NameTaken { name } => write!(f, "there is a part {name:?} already"),
            Self::Pose { name, error } => write!(f, "part {name:?}: {error}"),
            Self::Full => f.write_str("a scene has at most 2^32 - 1 parts"),
        }
    }
}

impl Error for SceneError {}

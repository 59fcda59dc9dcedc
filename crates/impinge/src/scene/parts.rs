//! The parts of a scene, and the pairs of them that are checked.

use std::collections::{HashMap, HashSet};
use std::error::Error;
use std::fmt;

use super::details::Details;
use crate::input::InputError;
use crate::math::Pose;
use crate::shape::Shape;

/// Handle of a part of a scene: its index in the order in which parts were added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PartId(u32);

/// Named parts at poses in the world, which are checked against each other.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    parts: Vec<Part>,
    by_name: HashMap<String, PartId>,
    /// Pairs that are not checked, the smaller part first.
    ignored: HashSet<[PartId; 2]>,
}

#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) name: String,
    pub(super) shape: Shape,
    pub(super) world_from_part: Pose,
    group: Option<u32>,
    details: Details,
}

/// The reason why a part was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneError {
    /// Another part already has this name.
    NameTaken {
        /// The name.
        name: String,
    },
    /// The part cannot be placed at its pose.
    Pose {
        /// Name of the part.
        name: String,
        /// The error of the pose.
        error: InputError,
    },
    /// The scene already has 2^32 - 1 parts, the maximum.
    Full,
}

impl PartId {
    /// Returns the index of the part in the order in which parts were added.
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

    /// Adds a part: a mesh, a solid (`mesh.solid()`), a shape or a compound, at a pose. The pose
    /// maps the part's frame to the world frame.
    ///
    /// # Errors
    /// Returns an error if another part has the name, or if the part cannot be placed at the pose,
    /// for example a round shape at a pose that is not rigid.
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
        if let Err(error) = shape.check_pose(&world_from_part) {
            return Err(SceneError::Pose { name, error });
        }
        let Some(number) = u32::try_from(self.parts.len()).ok().filter(|&number| number < u32::MAX) else {
            return Err(SceneError::Full);
        };
        let part = PartId(number);
        self.by_name.insert(name.clone(), part);
        self.parts.push(Part { name, shape, world_from_part, group: None, details: Details::default() });
        Ok(part)
    }

    /// Returns the part with this name, or `None` if there is none.
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
    /// Panics if the part belongs to another scene with more parts, as do all methods that take a
    /// part.
    #[must_use]
    pub fn name(&self, part: PartId) -> &str {
        &self.part(part).name
    }

    /// Returns the shape of a part, in its own frame.
    ///
    /// # Panics
    /// As for [`name`](Self::name).
    #[must_use]
    pub fn shape(&self, part: PartId) -> &Shape {
        &self.part(part).shape
    }

    /// Returns the pose of a part, which maps its frame to the world frame.
    ///
    /// # Panics
    /// As for [`name`](Self::name).
    #[must_use]
    pub fn pose(&self, part: PartId) -> &Pose {
        &self.part(part).world_from_part
    }

    /// Returns the details of a part, which are empty until they are set.
    ///
    /// # Panics
    /// As for [`name`](Self::name).
    #[must_use]
    pub fn details(&self, part: PartId) -> &Details {
        &self.part(part).details
    }

    /// Sets the details of a part: key, type, path and further properties. They change no check.
    ///
    /// # Panics
    /// As for [`name`](Self::name).
    pub fn set_details(&mut self, part: PartId, details: Details) {
        self.parts[part.index()].details = details;
    }

    /// Excludes a pair of parts from all later checks.
    ///
    /// # Panics
    /// As for [`name`](Self::name).
    pub fn ignore(&mut self, a: PartId, b: PartId) {
        assert!(a.max(b).index() < self.parts.len(), "the scene has no such part: the handle belongs to another scene");
        self.ignored.insert([a.min(b), a.max(b)]);
    }

    /// Puts a part into a group. Parts of the same group are not checked against each other. `None`
    /// takes the part out of its group: it is then checked against all other parts, except in
    /// ignored pairs.
    ///
    /// # Panics
    /// As for [`name`](Self::name).
    pub fn set_group(&mut self, part: PartId, group: Option<u32>) {
        self.parts[part.index()].group = group;
    }

    /// Reports whether a pair of parts is checked: two different parts that are not in one group
    /// and not ignored.
    ///
    /// # Panics
    /// As for [`name`](Self::name).
    #[must_use]
    pub fn admits(&self, a: PartId, b: PartId) -> bool {
        let [group_a, group_b] = [a, b].map(|part| self.part(part).group);
        let is_one_group = group_a.is_some() && group_a == group_b;
        a != b && !is_one_group && !self.ignored.contains(&[a.min(b), a.max(b)])
    }

    /// Returns the shape of each part.
    pub(super) fn shapes_mut(&mut self) -> impl Iterator<Item = (PartId, &mut Shape)> {
        (0..).map(PartId).zip(self.parts.iter_mut().map(|part| &mut part.shape))
    }

    pub(super) fn part(&self, part: PartId) -> &Part {
        &self.parts[part.index()]
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NameTaken { name } => write!(f, "there is a part {name:?} already: choose another name"),
            Self::Pose { name, error } => write!(f, "part {name:?}: {error}"),
            Self::Full => f.write_str("a scene has at most 2^32 - 1 parts"),
        }
    }
}

impl Error for SceneError {}

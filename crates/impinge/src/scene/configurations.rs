//! Rows of poses for the parts of a scene that move.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt;

use super::parts::{PartId, Scene};
use crate::input::InputError;
use crate::math::Pose;
use crate::query::batch::{Broadcast, BroadcastError, Poses};
use crate::shape::Acceptance;

/// Configurations of a scene: a pose in each row for each part that moves. Leading axes broadcast
/// as in NumPy. A part without poses keeps the pose that it has in the scene.
#[derive(Clone, Debug)]
pub struct Configurations<'s> {
    scene: &'s Scene,
    /// Common leading axes of all poses.
    shape: Vec<usize>,
    rows: usize,
    moves: BTreeMap<PartId, Moves>,
}

/// The poses of a part, and the map from rows to them (the second operand of the broadcast).
#[derive(Clone, Debug)]
struct Moves {
    poses: Poses,
    broadcast: Broadcast,
}

/// Error if the leading axes of a part's poses do not broadcast with those of the earlier parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigurationsError {
    /// Part whose leading axes do not broadcast.
    pub part: PartId,
    /// The lengths of the common leading axes so far, and of the axes of the part.
    pub error: BroadcastError,
}

impl Scene {
    /// Returns a single configuration in which all parts have the poses of the scene. Set poses for
    /// the parts that move with [`Configurations::set`].
    #[must_use]
    pub fn configurations(&self) -> Configurations<'_> {
        Configurations { scene: self, shape: Vec::new(), rows: 1, moves: BTreeMap::new() }
    }
}

impl<'s> Configurations<'s> {
    /// Sets the poses of a part, which map its frame to the world frame. A pose at which the part
    /// cannot be placed becomes a faulty row.
    ///
    /// # Errors
    /// Returns an error if the leading axes do not broadcast with those of the earlier parts.
    ///
    /// # Panics
    /// Panics if the part belongs to another scene with more parts.
    pub fn set(&mut self, part: PartId, poses: impl Into<Poses>) -> Result<(), ConfigurationsError> {
        let mut poses = poses.into();
        let refused = |error| ConfigurationsError { part, error };
        let broadcast = Broadcast::new(&self.shape, poses.shape()).map_err(refused)?;
        if broadcast.shape() != self.shape {
            for (&part, moves) in &mut self.moves {
                let stretched = Broadcast::new(broadcast.shape(), moves.poses.shape());
                moves.broadcast = stretched.map_err(|error| ConfigurationsError { part, error })?;
            }
        }
        self.shape = broadcast.shape().to_vec();
        self.rows = broadcast.rows();
        let broadcast = Broadcast::new(&self.shape, poses.shape()).map_err(refused)?;
        let acceptance = Acceptance::of(&self.scene.part(part).shape);
        poses.reject_if(|pose| acceptance.check(pose));
        self.moves.insert(part, Moves { poses, broadcast });
        Ok(())
    }

    /// Returns the lengths of the common leading axes. The slice is empty for a single
    /// configuration.
    #[must_use]
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Returns the first faulty pose: its part, its row among the poses of that part, and its
    /// error. Returns `None` if all poses are valid.
    #[must_use]
    pub fn first_fault(&self) -> Option<(PartId, usize, &InputError)> {
        self.moves.iter().find_map(|(&part, moves)| moves.poses.first_fault().map(|(row, error)| (part, row, error)))
    }

    pub(super) fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// Returns the number of configurations.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Reports whether a part has the same pose in all configurations.
    pub(super) fn is_still(&self, part: PartId) -> bool {
        self.moves.get(&part).is_none_or(|moves| moves.poses.len() == 1)
    }

    /// Returns the pose of a part in a row, or the error if the pose is faulty.
    pub(super) fn pose(&self, part: PartId, row: usize) -> Result<&Pose, &InputError> {
        match self.moves.get(&part) {
            None => Ok(&self.scene.part(part).world_from_part),
            Some(Moves { poses, broadcast }) => poses.get(broadcast.sources(row)[1]),
        }
    }
}

impl fmt::Display for ConfigurationsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "poses of part {}: {}", self.part.index(), self.error)
    }
}

impl Error for ConfigurationsError {}

//! The objects of a scene, after the operations of the file.

use std::collections::HashMap;

use impinge::Pose;

use super::place;
use crate::pieces::{Notes, Piece};

/// An object of a planning scene.
pub(super) struct Object {
    pub(super) name: String,
    /// Name of the frame of the pose; empty for the frame of the scene.
    pub(super) frame: String,
    pub(super) pose: Pose,
    /// The shapes, in the frame of the object.
    pub(super) pieces: Vec<Piece>,
    /// Line of the file.
    pub(super) line: usize,
}

/// Operation of a message on an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Add,
    Remove,
    Append,
    Move,
}

/// The objects, in the order of the file.
#[derive(Default)]
pub(super) struct Objects {
    list: Vec<Option<Object>>,
    /// Place of each name in the list.
    places: HashMap<String, usize>,
}

impl Objects {
    /// Applies an operation, with warnings about names that are not known or known already.
    pub(super) fn apply(&mut self, operation: Operation, object: Object, notes: &mut Notes<'_>) {
        let mut warn = |line, what: &str| notes.add(|| place(line), format!("object {:?} {what}", object.name));
        let known = self.places.get(&object.name).and_then(|&at| self.list[at].as_mut());
        match (operation, known) {
            (Operation::Append, Some(known)) => known.pieces.extend(object.pieces),
            (Operation::Move, Some(known)) => (known.pose, known.frame) = (object.pose, object.frame),
            (Operation::Add, Some(known)) => {
                warn(object.line, "is defined again, and replaces the one before it");
                *known = object;
            }
            (Operation::Add | Operation::Append, None) => self.push(object),
            (Operation::Move, None) => warn(object.line, "is moved, but not defined"),
            (Operation::Remove, None) => warn(object.line, "is removed, but not defined"),
            (Operation::Remove, Some(_)) => {
                if let Some(at) = self.places.remove(&object.name) {
                    self.list[at] = None;
                }
            }
        }
    }

    fn push(&mut self, object: Object) {
        self.places.insert(object.name.clone(), self.list.len());
        self.list.push(Some(object));
    }

    pub(super) fn into_vec(self) -> Vec<Object> {
        self.list.into_iter().flatten().collect()
    }
}

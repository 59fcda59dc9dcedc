//! Pieces: the shapes that descriptions of robots and of scenes are made of, with their places.
//!
//! A link of a robot or an object of a scene is the union of its pieces. `packages` finds the
//! meshes that a description names, `shapes` makes the shapes, and `problem` has what can be wrong
//! with one. `warning` collects what was skipped or guessed.

mod packages;
mod problem;
mod shapes;
mod warning;

use impinge::{Pose, Positions};

pub use problem::PieceProblem;
pub use warning::DescriptionWarning;

pub(crate) use packages::Packages;
pub(crate) use shapes::{Context, Shapes};
pub(crate) use warning::Notes;

/// A shape of a link or of an object.
pub(crate) struct Piece {
    pub(crate) form: Form,
    /// The place of the piece in the frame of the link or the object.
    pub(crate) pose: Pose,
    /// The element of the description, from which [`Context::place`] finds the line.
    pub(crate) element: usize,
}

/// A shape as it is written in the description.
pub(crate) enum Form {
    /// Full lengths of the edges.
    Box([f64; 3]),
    /// A cylinder about z: its radius and its full length.
    Cylinder(f64, f64),
    /// A cone about z, with its tip up: its radius and its full length.
    Cone(f64, f64),
    Sphere(f64),
    /// A capsule about z: its radius, and the length of the cylinder between its ends.
    Capsule(f64, f64),
    /// A mesh in a file: its reference and its scale.
    File(String, [f64; 3]),
    /// A mesh in the description itself.
    Mesh(Positions, Vec<[u32; 3]>),
}

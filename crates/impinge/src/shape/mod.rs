//! Shapes in their own frames and placed in the world: convex ones, half-spaces, meshes, and compounds of these.
//!
//! There are three representations, so that any two shapes can be asked anything without a routine for each pair: a *core*
//! with a support function, swept by a ball; a half-space; a mesh. A sphere is a point and a radius, a capsule a segment and
//! one; all other convex shapes have no radius. A compound is asked part by part.
//!
//! `kind` has a shape and what it is made of, of `corners` or of the sets in `round`, and `constructors` makes shapes. `placed` puts
//! them into the world, `part_tree` finds the parts of a placed compound, and `form` has the three representations.

mod constructors;
mod corners;
mod form;
mod kind;
mod part_tree;
mod placed;
mod round;

pub(crate) use form::Form;
pub use kind::Shape;
pub use placed::PlacedShape;
pub(crate) use placed::Stand;

//! Shapes in their own frames, and shapes placed in the world: convex shapes, half-spaces, meshes,
//! height fields, and compounds of these.
//!
//! Every shape has one of four representations, so that any two shapes can be compared without a
//! kernel for each pair of kinds. The representations are a *core* with a support function, swept
//! by a sphere; a half-space; a mesh; and a height field. A sphere is a point and a radius, a
//! capsule a segment and a radius. All other convex shapes have the radius that they are rounded
//! with, or none. A compound is compared part by part.
//!
//! `kind` has a shape and its contents, which are `corners` or the sets in `round`. `constructors`
//! makes and validates shapes, and `rounded` rounds them. `acceptance` says at which poses a shape
//! can be placed, and `placed` places it in the world, at a `stand`. `part_finder` finds the parts
//! of a placed compound, and `form` has the representations. `triangles` shows shapes in pictures.
//!
//! Tests: `tests/it/shapes`. Benchmark: `shapes`.

mod acceptance;
mod constructors;
mod corners;
mod form;
mod kind;
mod part_finder;
mod placed;
mod round;
mod rounded;
mod stand;
mod triangles;

pub(crate) use acceptance::Acceptance;
pub(crate) use form::Form;
pub use kind::Shape;
pub use placed::PlacedShape;
pub(crate) use stand::Stand;

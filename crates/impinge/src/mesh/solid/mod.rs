//! Meshes as solids.
//!
//! - `crossings` counts the faces that a ray crosses.
//! - `solid_angle` sums solid angles with error bounds, and `far_field` sums the solid angles of
//!   many faces by their moments.
//! - `winding` computes winding numbers from all three.
//! - `sheets` connects faces along edges, and `walls` finds on which sides of a face the solid is.
//! - `facets` finds the flat parts of a surface.
//! - `border` finds the parts of space that are far from the border of an open mesh.
//! - `convexity` recognizes solids that are convex.
//! - `bsp` is a tree of planes for many points against one solid.

pub(super) mod border;
pub(super) mod bsp;
pub(super) mod convexity;
pub(super) mod crossings;
pub(super) mod facets;
pub(super) mod far_field;
pub(super) mod sheets;
pub(super) mod solid_angle;
pub(super) mod walls;
pub(super) mod winding;

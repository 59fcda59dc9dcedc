//! A solid-leaf BSP tree over the faces of a mesh: space cut by planes until no face is left in a cell, so that one answer tells
//! for all points of it.
//!
//! Source: Thibault, Naylor, *Set operations on polyhedra using binary space partitioning trees*, SIGGRAPH 1987 (Ericson, 8.2 to
//! 8.4). Ours departs in three ways. Faces that a plane passes through go to both sides whole, as pieces of them would be rounded.
//! Planes across an axis come first and those of faces last, so that round solids, of which no face's plane halves the others, get
//! trees of small depth too. And what a cell is is asked, exactly, when a point first falls into it.
//!
//! `plane` has the planes and `tree` the tree with its point queries. `across` finds planes across an axis for `build`, and `cast`
//! follows rays.

mod across;
mod build;
mod cast;
mod plane;
mod tree;

pub use tree::SolidBsp;

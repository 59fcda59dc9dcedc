//! A solid-leaf BSP tree over the faces of a mesh. Planes cut space until no face is left in a
//! cell, so that one answer holds for all points of the cell.
//!
//! Source: Thibault, Naylor, *Set operations on polyhedra using binary space partitioning trees*,
//! SIGGRAPH 1987 (Ericson, 8.2 to 8.4). Ours departs in three ways. Faces that a plane cuts go to
//! both sides whole, because pieces of them would be rounded. Axis-aligned planes come first and
//! planes of faces last, so that round solids get trees of small depth too: no plane of their faces
//! halves the others. And whether a cell is inside is computed, exactly, when a point first falls
//! into it.
//!
//! `plane` has the planes and `tree` the tree with its point queries. `across` finds axis-aligned
//! planes for `build`, and `cast` follows rays.
//!
//! Proof: docs/notes/proof.md, L32. Guarded by `tests/it/solids/bsp.rs` and by the benchmark
//! `solid_bsp` of `impinge-bench`.

mod across;
mod build;
mod cast;
mod plane;
mod tree;

pub use tree::SolidBsp;

//! Height fields: terrain as a grid of heights, with triangles that are never stored.
//!
//! A cell of the grid is two triangles, whose corners are computed when they are needed (`field`).
//! `blocks` is the tree over the cells, `crop` makes a mesh of some faces, for queries that need
//! one, and `rays` casts rays.
//!
//! Guarded by `tests/it/shapes/height_fields.rs`, which compares every query with the mesh of the
//! same triangles. The proof is docs/notes/proof.md, L37.

mod blocks;
mod crop;
mod field;
mod rays;

pub(crate) use crop::Crop;
pub use field::HeightField;

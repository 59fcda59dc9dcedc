//! Parts that the fuzz targets share: bounds on memory, checks of files, and shapes on a lattice.

pub mod files;
pub mod lattice;
pub mod memory;

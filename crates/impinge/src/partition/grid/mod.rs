//! Grids: space in equal cells, each of which knows the boxes that reach into it (Ericson, 7.1 and 7.2).

mod hierarchical;
mod level;
mod single;

pub use hierarchical::HierarchicalGrid;
pub use single::{HashedGrid, UniformGrid};

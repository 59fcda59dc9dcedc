//! Grids: space in equal cells, each of which knows the boxes that reach into it (Ericson, 7.1 and 7.2).

mod follow;
mod frame;
mod hierarchical;
mod layout;
mod level;
mod lines;
mod single;
mod together;
mod word;

pub use hierarchical::HierarchicalGrid;
pub use single::{HashedGrid, UniformGrid};

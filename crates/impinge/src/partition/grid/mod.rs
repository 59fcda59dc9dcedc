//! Grids: space in equal cells, each of which knows the boxes that reach into it (Ericson, 7.1 and 7.2).
//!
//! `quantization` divides a cell into steps. `quantized_box` has a box in such steps, `lines` stores the quantized boxes of each
//! cell, `frame` finds the cells of a box, `layout` finds the memory of a cell, and `level` is all cells of one size. Moves are
//! processed in batches: `move_batch` collects them, `quantized_move` compares a moving box with those of a line, `cell_visits`
//! goes through the cells about the moves, and `batched_step` ties these together. `single` and `hierarchical` are the public grids.

mod batched_step;
mod cell_visits;
mod frame;
mod hierarchical;
mod layout;
mod level;
mod lines;
mod move_batch;
mod quantization;
mod quantized_box;
mod quantized_move;
mod single;

pub use hierarchical::HierarchicalGrid;
pub use single::{HashedGrid, UniformGrid};

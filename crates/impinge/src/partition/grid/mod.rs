//! Grids: space divided into equal cells, each of which stores the boxes that reach into it
//! (Ericson, 7.1 and 7.2).
//!
//! `quantization` divides a cell into steps. `quantized_box` is a box in such steps, `lines` stores
//! the quantized boxes of each cell, `frame` finds the cells of a box, `layout` finds the memory of
//! a cell, and `level` holds all cells of one size.
//!
//! Moves are processed in batches: `move_batch` collects them, `quantized_move` compares a moving
//! box with the boxes of a line, `cell_visits` visits the cells around the moves, and
//! `batched_step` ties these together. `single` and `hierarchical` are the public grids.
//!
//! Guarded by `tests/it/partition/cells.rs` and `tests/it/partition/churn.rs`, measured by the
//! benchmark `partitions`.

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

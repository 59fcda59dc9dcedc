//! A small simulation of rigid bodies on contacts of impinge.
//!
//! It is an example and a test, not a product. Stacks that stand as meshes just as they stand as
//! boxes show that contacts of meshes are good enough for a solver.

pub mod block;
pub mod scenes;
pub mod solver;

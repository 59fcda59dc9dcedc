//! Queries at many poses: one answer for each row of poses, computed on all threads.
//!
//! A [`Batch`] has two things and the poses of each. Leading axes of poses broadcast as in NumPy.
//! Each row gets the answer of the query of the same name in [`query`](crate::query) at its poses,
//! and a [`Status`]. A row with an invalid pose gets the safe answer. Consecutive rows share a
//! [`Cache`](super::Cache), so that the poses of a motion take less time than the same poses
//! shuffled.
//!
//! ```
//! use impinge::query::batch::{Batch, Poses};
//! use impinge::{Mesh, Pose, Positions};
//!
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
//! let moved = (0..8).map(|step| Pose::from_translation([0.25 * f64::from(step), 0.0, 0.0]));
//! let moved = Poses::from(moved.collect::<Result<Vec<_>, _>>()?);
//! let batch = Batch::new(&mesh, &mesh, Poses::default(), moved)?;
//! assert_eq!(batch.intersects()?.values, [true, true, true, true, true, false, false, false]);
//! assert_eq!(batch.within(0.5)?.values, [true, true, true, true, true, true, true, false]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `broadcast` pairs the rows of two operands, `poses` has poses and their errors, and `side` one
//! thing at its poses. `execution` gives rows to threads, `answers` has the answers, and `verbs`
//! the queries.

mod answers;
mod broadcast;
mod execution;
mod poses;
mod side;
mod verbs;

pub use answers::{Answers, Status};
pub use broadcast::{Broadcast, BroadcastError};
pub use execution::Execution;
pub use poses::Poses;
pub use verbs::Batch;

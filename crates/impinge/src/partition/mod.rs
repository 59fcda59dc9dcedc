//! Space partitioning: which of many boxes are where (*Notes on Real Time Collision Detection*, introduction; Ericson,
//! chapters 6 and 7). Nothing here knows what is in a box.
//!
//! A partition holds closed boxes, [`MinMax`](crate::volume::MinMax), under keys that the caller chooses: dense numbers, as memory grows with the
//! greatest. Every kind answers the same questions with the same answers, to the bit; they differ in what they cost, and
//! in what they do to space, which [`Cells`] tells:
//!
//! | kind | space | boxes come and go | made for |
//! |---|---|---|---|
//! | [`BoxTree`] | volumes that may overlap | yes | anything; the fewest surprises |
//! | [`ColumnSweep`] | columns, made anew each time | no: all pairs and nothing else | scenes in which most boxes move |
//! | [`UniformGrid`] | disjoint cells in a block | yes | boxes of like size that fill a known space |
//! | [`HashedGrid`] | disjoint cells without an end | yes | boxes of like size anywhere |
//! | [`HierarchicalGrid`] | disjoint cells of many sizes | yes | boxes of unlike sizes, of which few move |
//! | [`Octree`] | disjoint cubes in cubes | yes | scenes that are dense here and empty there, boxes of unlike sizes |
//! | [`LooseOctree`] | loose cubes in cubes | yes | the same, where boxes lie across the middles of cells |
//! | [`KdTree`] | disjoint cells | no | points and small boxes that stand, and what is nearest |
//! | [`BspTree`] | disjoint cells, planes of the boxes' own | no | rooms and walls that stand |
//! | [`SweepOneAxis`], [`SweepThreeAxes`] | an order along axes | yes | few boxes, or such as move little in long scenes |
//!
//! Touching counts everywhere. Boxes are judged when they are made ([`MinMax::new`](crate::volume::MinMax::new)), so that no question has errors; no
//! box is too large, too small or too far away, and any number of them may be equal. Pairs come sorted, each once, with
//! the lesser key first. The same calls give the same bytes on any machine.
//!
//! ```
//! use std::ops::ControlFlow;
//! use impinge::partition::{BoxTree, Changes, Dynamic, Move, Partition};
//! use impinge::volume::MinMax;
//!
//! let mut tree = BoxTree::new();
//! for key in 0..4 {
//!     let x = 2.0 * f64::from(key);
//!     tree.insert(key, MinMax::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0])?);
//! }
//! assert!(tree.pairs().is_empty());
//! // Box 3 moves beside box 0, and box 2 leaves.
//! let beside = MinMax::new([1.0, 0.0, 0.0], [1.5, 1.0, 1.0])?;
//! let mut changes = Changes::default();
//! tree.step(&[Move { key: 3, to: Some(beside) }, Move { key: 2, to: None }], &mut changes);
//! assert_eq!((changes.began(), changes.ended()), (&[[0, 3]][..], &[][..]));
//! let mut met = Vec::new();
//! let _ = tree.at([1.0, 0.5, 0.5], &mut |key| {
//!     met.push(key);
//!     ControlFlow::Continue(())
//! });
//! met.sort();
//! assert_eq!(met, [0, 3]);
//! # Ok::<(), impinge::InputError>(())
//! ```

mod best;
mod box_tree;
mod bsp_tree;
mod changes;
mod column_sweep;
mod forwarding;
mod grid;
mod interface;
mod items;
mod kd_tree;
mod neighbour;
mod octree;
mod plane_tree;
mod ray;
mod sort_and_sweep;

pub use box_tree::BoxTree;
pub use bsp_tree::BspTree;
pub use changes::{Changes, Move};
pub use column_sweep::ColumnSweep;
use forwarding::forward_to_inner;
pub use grid::{HashedGrid, HierarchicalGrid, UniformGrid};
use interface::record;
pub use interface::{Cells, Dynamic, Partition, RayVisit, Visitor, Work};
use items::{Held, Holds, Items};
pub use kd_tree::KdTree;
pub use neighbour::Neighbour;
pub use octree::{LooseOctree, Octree};
pub use ray::Ray;
pub use sort_and_sweep::{Axis, SweepOneAxis, SweepThreeAxes};

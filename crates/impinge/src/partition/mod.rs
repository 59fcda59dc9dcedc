//! Space partitioning: finding which of many boxes overlap, and where (*Notes on Real Time
//! Collision Detection*, introduction; Ericson, chapters 6 and 7). Nothing in this module knows
//! what a box contains.
//!
//! A partition stores closed boxes, [`MinMax`](crate::volume::MinMax), under keys that the caller
//! chooses. Use small consecutive numbers as keys, because memory grows with the largest key. All
//! kinds return the same answers to the same queries, bit for bit. They differ in speed and in how
//! they divide space, which [`Cells`] describes:
//!
//! | kind | space | boxes come and go | made for |
//! |---|---|---|---|
//! | [`BoxTree`] | volumes that may overlap | yes | general use; the most predictable kind |
//! | [`ColumnSweep`] | columns, rebuilt on every call | no: returns all pairs, has no other query | scenes in which most boxes move |
//! | [`UniformGrid`] | disjoint cells in a block | yes | boxes of similar size that fill a known region |
//! | [`HashedGrid`] | disjoint cells without bounds | yes | boxes of similar size anywhere |
//! | [`HierarchicalGrid`] | disjoint cells of many sizes | yes | boxes of different sizes, few of which move |
//! | [`Octree`] | nested disjoint cubes | yes | scenes with dense and empty regions, boxes of different sizes |
//! | [`LooseOctree`] | nested loose cubes | yes | the same, if boxes lie across the middles of cells |
//! | [`KdTree`] | disjoint cells | no | points and small boxes that do not move, nearest-neighbor queries |
//! | [`BspTree`] | disjoint cells, split at faces of the boxes | no | rooms and walls that do not move |
//! | [`SweepOneAxis`], [`SweepThreeAxes`] | an order along axes | yes | few boxes, or long scenes in which boxes move little |
//!
//! Boxes that touch overlap. Boxes are validated when they are made
//! ([`MinMax::new`](crate::volume::MinMax::new)), so queries return no errors. No valid box is too
//! large, too small or too far away, and any number of boxes may be equal. Lists of pairs are
//! sorted, without duplicates, with the smaller key of each pair first. The same calls return the
//! same bytes on every machine.
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
//! let mut found = Vec::new();
//! let _ = tree.at([1.0, 0.5, 0.5], &mut |key| {
//!     found.push(key);
//!     ControlFlow::Continue(())
//! });
//! found.sort();
//! assert_eq!(found, [0, 3]);
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
mod neighbor;
mod octree;
mod pair_list;
mod plane_tree;
mod ray;
mod sort_and_sweep;

pub use box_tree::{BoxTree, GapVisitor};
pub use bsp_tree::BspTree;
pub use changes::{Changes, Move};
pub use column_sweep::ColumnSweep;
use forwarding::forward_to_inner;
pub use grid::{HashedGrid, HierarchicalGrid, UniformGrid};
use interface::record;
pub use interface::{Cells, Dynamic, PairVisitor, Partition, RayVisit, Visitor, Work};
use items::{Held, Holds, Items};
pub use kd_tree::KdTree;
pub use neighbor::Neighbor;
pub use octree::{LooseOctree, Octree};
pub use ray::Ray;
pub use sort_and_sweep::{Axis, SweepOneAxis, SweepThreeAxes};

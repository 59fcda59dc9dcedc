//! Finds the nearest points of two meshes by branch and bound over both trees.
//!
//! Source: Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*,
//! ICRA 2000, for distance by the descent of two trees. Ours departs in two ways: it compares eight
//! children with eight, nearest first, and its bounds are proved (docs/notes/proof.md, L14).
//!
//! Whether the meshes intersect is decided first, exactly. If they do not intersect, every pair of
//! faces has a *value*: the distance of its metric corners (see `metric`), computed by the closed
//! form. It depends only on the pair and on the query. The answer is the least (value, face of a,
//! face of b) of all pairs. A pair is skipped only if it is proved to be worse. So the answer
//! depends neither on the order of the descent nor on the vector unit.
//!
//! - `nearest` has the verbs, and `search` has the search.
//! - `metric` maps both meshes to one frame, in which distances are measured.
//! - `bounds` has lower bounds of the distances of boxes. `line_bound` and `direction_bounds` have
//!   bounds along single directions.
//! - `scene` has the values that do not change during a search. `answer` has the best pair so far.
//! - `leaf_pair` compares the triangles of two leaves.
//! - `frontier` and `warm_start` keep the end of a search for the next search.
//!
//! Guarded by `tests/it/distance`, above all `meshes.rs`, and by the benchmark `distance` of
//! `impinge-bench`.

mod answer;
mod bounds;
mod cache;
mod carried_boxes;
mod direction_bounds;
mod far_apart;
mod frontier;
mod leaf;
mod leaf_pair;
mod line_bound;
mod metric;
mod nearest;
mod pair_batch;
mod relative_frame;
mod scene;
mod search;
mod slices;
mod slot;
mod support_bound;
mod task;
mod warm_start;

pub(crate) use nearest::{nearest, within};
pub(crate) use warm_start::WarmStart;

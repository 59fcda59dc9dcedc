//! The nearest points of two meshes, by branch and bound over both trees.
//!
//! Source: Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*, ICRA 2000, for distance by
//! the descent of two trees; ours opens eight children against eight, nearest first, on bounds that are proved.
//!
//! Whether the meshes intersect is asked first, and decided exactly. Where they do not, every pair of faces has a *value*,
//! the distance of their metric corners by the closed form, which depends on nothing but the pair and the query. The answer
//! is the least (value, face of a, face of b) of all pairs. A pair is left out only where it is proved to be worse. So
//! neither the order of the descent nor the vector unit can be seen in the answer.
//!
//! `nearest` has the verbs, and `search` the search itself. `metric` maps both meshes to one frame, `bounds` has lower bounds of
//! the distances of boxes, `line_bound` and `direction_bounds` bounds along single directions. `scene` has the values that stay as
//! they are, `answer` the best pair so far. `leaf_pair` compares the triangles of two leaves. `frontier` and `warm_start` keep the
//! end of a search for the next one.

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

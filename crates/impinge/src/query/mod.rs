//! Queries about two things in the world: do they intersect, in which points, how far apart are
//! they, how deep in each other?
//!
//! Each query is a function of two things, `a` and `b`. Each of them is a mesh as its surface, a
//! mesh as a solid, a shape or a compound ([`Placed`]). Queries about faces, such as
//! [`intersecting_pairs`], take two meshes.
//!
//! | question | function | answer |
//! |---|---|---|
//! | do they have a common point? | [`intersects()`], [`proximity()`] | `bool`, [`Proximity`] |
//! | are they at most `clearance` apart? | [`within()`], [`nearness()`] | `bool`, [`Proximity`] |
//! | how far apart are they? | [`distance()`] | [`Distance`], a proved interval |
//! | how deep are they in each other? | [`penetration()`] | [`Penetration`], a proved interval |
//! | how much material do they share? | [`depth()`], [`deeper()`] | [`Depth`], a proved interval, [`Deeper`] |
//! | do their interiors intersect? | [`penetrates()`] | [`Penetrates`] |
//! | where do they touch, for a solver? | [`contacts()`] | [`Manifold`]s |
//! | which faces of two meshes intersect? | [`intersecting_pairs()`], [`any_intersecting_pair()`] | pairs of face indices |
//! | in which points? | [`common_points()`] | one point of each pair |
//! | along which curves? | [`intersection_curves()`] | [`Curves`] |
//! | in which regions? | [`contact_patches()`] | [`ContactPatch`]es |
//! | is a part of one mesh inside the other? | [`solid_intersection()`] | [`SolidIntersection`] |
//! | which faces of one mesh intersect? | [`self_intersecting_pairs()`] | pairs of face indices |
//!
//! These rules hold for every query:
//!
//! - Frames and units: a pose maps the frame of its thing to the world frame. Points, normals and
//!   distances in an answer are in the world frame and in world units.
//! - Touching counts as intersecting.
//! - Queries never fail. A mesh, a shape and a pose are validated when they are made. The functions
//!   that take pairs of faces from the caller panic if an index is out of range.
//! - An empty mesh intersects nothing, and its distance from anything is infinite.
//! - If rounding prevents a proof, a query that returns `bool` returns `true`, the safe answer.
//!   [`proximity()`] and [`nearness()`] return [`Undecided`](Proximity::Undecided) instead.
//! - No answer depends on the vector unit, on the number of threads or on the order of the work.
//!
//! [`Query`] adds a cache or a budget to a query, and [`batch`] asks a query at many poses.
//!
//! ```
//! use impinge::{Mesh, Pose, Positions, Shape, query};
//!
//! let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
//! let part = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//! let sphere = Shape::sphere([0.0; 3], 0.5)?.at(Pose::from_translation([1.0; 3])?)?;
//! assert!(!query::intersects(&part, &sphere)); // the surface
//! assert!(query::intersects(part.solid(), &sphere));
//! assert!((query::distance(&part, &sphere).upper - 0.5).abs() < 1e-12);
//! # Ok::<(), impinge::InputError>(())
//! ```
//!
//! # The files
//! `placed` has the arguments of a query; `ask`, `cache` and `contact_options` have its options,
//! and `answer` the answer about a distance. `intersects`, `distance`, `penetration` and
//! `shapes/contacts` have the queries on any two things. They call `of_meshes` for two meshes, and
//! `shapes` otherwise. `depth` measures common material.
//! `pairs`, `common_points`, `curves`, `patches`, `nesting`, `penetrates` and
//! `self_intersection` are about meshes. `batch` asks the queries at many poses.

mod answer;
mod ask;
pub mod batch;
mod cache;
mod common_points;
mod contact_options;
mod curves;
mod depth;
mod distance;
mod intersects;
mod last_hit;
mod nesting;
mod of_meshes;
mod pair_order;
mod pairs;
mod patches;
mod penetrates;
mod penetration;
mod placed;
mod self_intersection;
mod shapes;

pub use crate::mesh::Share;
pub use crate::volume::Proximity;
pub use answer::{Distance, Witness};
pub use ask::Query;
pub use cache::Cache;
pub use common_points::common_points;
pub use contact_options::ContactOptions;
pub use curves::{Curves, curves_of_pairs, intersection_curves};
pub use depth::{CommonVolume, Deeper, Depth, common_volume, deeper, depth};
pub(crate) use depth::{Effort, nearest_face};
pub use distance::{distance, nearness, within};
pub use intersects::{intersects, proximity};
pub use nesting::{Contained, SolidIntersection, contained_point, solid_intersection, solid_intersection_of_pairs};
pub use pairs::{LimitedPairs, any_intersecting_pair, intersecting_pairs, intersecting_pairs_up_to};
pub(crate) use patches::contacts_of_patches;
pub(crate) use patches::normals_of_regions;
pub use patches::{ContactPatch, contact_patches};
pub use penetrates::{Penetrates, penetrates_of_pairs};
pub use penetration::{Penetration, penetrates, penetration};
pub use placed::Placed;
pub use self_intersection::self_intersecting_pairs;
pub use shapes::contacts::{ContactId, ContactPoint, Feature, Manifold, contacts};
pub(crate) use shapes::contacts::{SurfacePair, contacts_of_surface};
pub(crate) use shapes::seams::{Member, Surroundings};

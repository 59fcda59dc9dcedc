//! The verbs: what one asks of two things that stand somewhere in the world.
//!
//! Each verb takes any two of meshes, as surfaces or as solids, shapes and compounds ([`Placed`]). What they take was judged before,
//! so they cannot fail. Verbs about faces, such as [`intersecting_pairs`], take meshes.
//!
//! ```
//! use impinge::{Mesh, Pose, Positions, Shape, query};
//!
//! let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
//! let part = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//! let ball = Shape::sphere([0.0; 3], 0.5)?.at(Pose::from_translation([1.0; 3])?)?;
//! assert!(!query::intersects(&part, &ball)); // the surface
//! assert!(query::intersects(part.solid(), &ball));
//! assert!((query::distance(&part, &ball).upper - 0.5).abs() < 1e-12);
//! # Ok::<(), impinge::InputError>(())
//! ```
//!
//! # The files
//! `placed` has what a verb takes, `ask`, `cache` and `contact_options` how it is asked, `answer` what is said of a distance. `intersects`, `distance`,
//! `penetration` and `shapes/contacts` have the verbs on any two things: they go to `of_meshes` or to `shapes`. `pairs`, `curves`,
//! `patches`, `nesting`, `penetrates` and `self_intersection` are about meshes. `batch` has the verbs over many poses.

mod answer;
mod ask;
pub mod batch;
mod cache;
mod contact_options;
mod curves;
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

pub use crate::volume::Proximity;
pub use answer::{Distance, Witness};
pub use ask::Query;
pub use cache::Cache;
pub use contact_options::ContactOptions;
pub use curves::{Curves, curves_of_pairs, intersection_curves};
pub use distance::{distance, nearness, within};
pub use intersects::{intersects, proximity};
pub use nesting::{Contained, SolidIntersection, solid_intersection, solid_intersection_of_pairs};
pub use pairs::{SomePairs, intersecting_pairs, intersecting_pairs_up_to};
pub(crate) use patches::contacts_of_patches;
pub(crate) use patches::normals_of_regions;
pub use patches::{ContactPatch, contact_patches};
pub use penetrates::{Penetrates, penetrates_of_pairs};
pub use penetration::{Penetration, penetrates, penetration};
pub use placed::Placed;
pub use self_intersection::self_intersecting_pairs;
pub use shapes::contacts::{ContactId, ContactPoint, Feature, Manifold, contacts};

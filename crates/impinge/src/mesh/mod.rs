//! Triangle meshes: validated once, packed for SIMD, with a bounding volume hierarchy, and the
//! simultaneous descent of two meshes.
//!
//! Each folder uses only the folders before it in this list:
//!
//! - `storage` holds the arrays: positions, faces, the packed frame, leaves and packets.
//! - `derived` holds the values that are computed when a query first needs them: connectivity, the
//!   distance up to which the border matters, the moments of the faces below each node.
//! - `triangle_mesh` defines [`Mesh`], which owns all of these, and `placed` a mesh with its pose.
//! - `report` describes a mesh: its health, its hierarchy, and simpler volumes that can replace it.
//! - `lifecycle` makes and changes meshes: it validates, builds, refits, rebuilds, repairs and
//!   stores.
//! - `points` answers queries of points and rays.
//! - `pairs` finds pairs of intersecting faces, of two meshes and within one mesh.
//! - `solid` treats meshes as solids: winding numbers, and the sides of faces.
//! - `distance` finds the nearest points of two meshes.
//! - `decomposition` divides solids into convex parts.
//!
//! - `height_field` is terrain on a grid, whose triangles are never stored; `faces` is what meshes
//!   and height fields have in common.
//!
//! `options` sets how a query runs.

mod decomposition;
mod derived;
mod distance;
mod faces;
mod height_field;
mod lifecycle;
mod options;
mod pairs;
mod placed;
mod points;
mod report;
mod solid;
mod storage;
mod triangle_mesh;

pub use decomposition::{ConvexPart, ConvexParts, DecompositionOptions};
pub(crate) use derived::facets::{FacetPlane, Facets};
pub(crate) use derived::topology::{Across, Components, DisjointSets, FaceAcross};
pub(crate) use distance::{WarmStart, nearest, within};
pub(crate) use faces::Faces;
pub(crate) use height_field::Crop;
pub use height_field::HeightField;
pub use lifecycle::aging::Aging;
pub use lifecycle::parts::{Flaw, Parts};
pub use lifecycle::repair::{Repair, RepairOptions};
#[doc(hidden)]
pub use options::{HostChoice, Options};
pub(crate) use pairs::descent::{any_hit, collect_intersecting, collect_share, faces_intersect, first_hit};
pub(crate) use pairs::self_descent::{WantedFaces, collect_self_intersecting};
pub use pairs::share::Share;
pub use placed::{PlacedMesh, SolidMesh};
pub(crate) use points::face_search::FaceSearch;
pub use points::nearest::ClosestPoint;
pub use points::rays::{Ray, RayHit};
pub use report::health::Health;
pub use solid::bsp::SolidBsp;
pub(crate) use solid::walls::{Wall, Walls};
pub(crate) use solid::winding::PointClassifier;
pub use solid::winding::{Containment, WindingNumber};
pub use storage::positions::Positions;
pub use triangle_mesh::Mesh;

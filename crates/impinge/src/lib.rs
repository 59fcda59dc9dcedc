//! Exact, fast collision detection for triangle meshes and for shapes: spheres, boxes, hulls,
//! half-spaces and others. Yes-or-no answers about surfaces, closed solids and polytopes are exact.
//! Every distance or depth is an interval that is proved to hold the true value.
//!
//! Two meshes (touching counts as intersecting):
//!
//! ```
//! use impinge::{Mesh, Pose, query};
//!
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let mesh = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//! let moved = mesh.at(Pose::from_translation([0.25, 0.25, 0.25])?);
//! assert!(query::intersects(&mesh, moved));
//! assert_eq!(query::intersecting_pairs(&mesh, moved).len(), 3); // [face of a, face of b]
//! # Ok::<(), impinge::InputError>(())
//! ```
//!
//! Many poses in one call, on all cores:
//!
//! ```
//! use impinge::query::batch::{Batch, Poses};
//! use impinge::{Mesh, Pose};
//!
//! let mesh = Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
//! let poses = vec![Pose::from_translation([0.5, 0.0, 0.0])?, Pose::from_translation([2.0, 0.0, 0.0])?];
//! let batch = Batch::new(&mesh, &mesh, Pose::IDENTITY, poses)?;
//! assert_eq!(batch.intersects()?.values, [true, false]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! How far apart, and whether a clearance is kept:
//!
//! ```
//! use impinge::{Mesh, Pose, query};
//!
//! let mesh = Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
//! let above = mesh.at(Pose::from_translation([0.0, 0.0, 2.0])?);
//! let distance = query::distance(&mesh, above);
//! assert!(distance.lower <= 2.0 && 2.0 <= distance.upper);
//! assert!(query::within(&mesh, above, 2.0) && !query::within(&mesh, above, 1.999));
//! # Ok::<(), impinge::InputError>(())
//! ```
//!
//! Shapes and their contacts:
//!
//! ```
//! use impinge::{Pose, Shape, query};
//!
//! let floor = Shape::half_space([0.0, 0.0, 1.0], 0.0)?.at(Pose::IDENTITY)?;
//! let sunk = Shape::cuboid([0.5; 3])?.at(Pose::from_translation([0.0, 0.0, 0.25])?)?;
//! let manifolds = query::contacts(&floor, &sunk);
//! assert_eq!((manifolds.len(), manifolds[0].points.len()), (1, 4));
//! assert!(manifolds[0].points.iter().all(|point| point.lower <= 0.25 && 0.25 <= point.upper));
//! # Ok::<(), impinge::InputError>(())
//! ```
//!
//! Many named parts ([`world`] has many moving bodies instead):
//!
//! ```
//! use impinge::scene::{Question, Scene};
//! use impinge::{Pose, Shape};
//!
//! let link = Shape::cuboid([0.5; 3])?;
//! let mut scene = Scene::new();
//! let base = scene.add("base", &link, Pose::IDENTITY)?;
//! let arm = scene.add("arm", &link, Pose::from_translation([0.75, 0.0, 0.0])?)?;
//! scene.add("hand", &link, Pose::from_translation([9.0, 0.0, 0.0])?)?;
//! assert_eq!(scene.pairs(Question::Intersects)?, [[base, arm]]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which module
//!
//! | module | contents |
//! |---|---|
//! | [`query`] | queries about two things: intersection, distance, depth, contacts; [`query::batch`] at many poses |
//! | [`mesh`] | [`Mesh`]: building, refitting, repair, and its own queries of points and rays |
//! | [`shape`] | [`Shape`]: spheres, capsules, boxes, hulls, half-spaces, meshes and compounds |
//! | [`sweep`] | the time when moving or deforming things first touch |
//! | [`scene`] | named parts, checked against each other in one configuration or in many |
//! | [`robot`] | kinematic trees of links: which configurations collide |
//! | [`world`] | moving bodies: which pairs begin or cease to touch at each step, with contacts |
//! | [`character`] | rigged bodies with hit volumes |
//! | [`clash`] | parts of scenes that run into each other: kinds, depth, rules, reports |
//! | [`math`] | [`Pose`], vectors and exact numbers |
//! | [`budget`] | [`Budget`]: limits on time, work and memory of queries |
//! | [`input`] | [`InputError`]: which input is invalid, and why |
//! | [`hull`] | convex hulls of points |
//! | [`volume`] | bounding volumes: boxes, spheres, capsules and others fitted to points |
//! | [`partition`] | many boxes: trees, grids and sweeps that find overlaps and neighbors |
//! | [`hierarchy`] | bounding volume hierarchies: builders, memory layout, descent |
//! | [`convex`] | distance and depth of convex sets, and the [`Support`](convex::Support) trait |
//! | [`exact`] | exact decisions about two placed triangles |
//! | [`primitive`] | distances between points, segments, triangles and rays |
//!
//! # Features
//!
//! | feature | default | effect |
//! |---|---|---|
//! | `all-levels` | yes | compiles kernels for SSE4.2 and AVX-512 too, beside SSE2 and AVX2 |
//! | `mmap` | yes | keeps large arrays in separate pages, which the system is asked to make large; building a large mesh is then faster |
//! | `glam`, `nalgebra` | no | `TryFrom` and `From` conversions of [`Pose`] and [`Positions`] from the types of that crate, and of [`Pose`] to them |
//! | `serde` | no | stores a [`Pose`] as the four rows of its matrix, and validates it when it is read |
//! | `scalar` | no | compiles every kernel without vector instructions too, for tests |

#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod budget;
pub mod character;
pub mod clash;
pub mod convex;
pub mod exact;
pub mod hierarchy;
pub mod hull;
pub mod input;
mod interop;
pub mod math;
pub mod mesh;
pub mod partition;
pub mod primitive;
pub mod query;
pub mod robot;
pub mod scene;
pub mod shape;
#[doc(hidden)]
pub mod simd;
#[doc(hidden)]
pub mod storage;
pub mod sweep;
pub mod volume;
pub mod world;

pub use budget::Budget;
pub use input::{InputError, InputErrorKind};
pub use math::Pose;
pub use mesh::{HeightField, Mesh, Positions};
pub use shape::Shape;

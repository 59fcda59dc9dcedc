//! Shared code of the benchmarks: meshes and poses, timed queries with compared answers, and
//! printing.
//!
//! - `headline`: impinge on two knots of two million triangles, or on any file.
//! - `peers`: impinge and parry3d in one run.
//! - `trees`: impinge and obvhs in one run: builds, and first hits of rays.
//! - `realign`: methods by which a box follows a turn.
//! - `hulls`: the time of a convex hull, for `bench/hulls.py`.
//! - `box_forms`: the cost of n rotations and m translations for the three forms of a box.
//! - `characters`: crowds of animated characters, all against all, and rays against each kind of
//!   hit volume.
//! - `ccd`: recorded queries of continuous collision, with answers and times; and a cloth with
//!   itself.
//! - `distance`: distances of two knots, with and without a cache.
//! - `rays`: the first hits of rays from a file, for `bench/rivals_rays.py`.
//! - `hierarchies`: builders, degrees and volumes of trees, wrapped and layered.
//! - `partitions`: space partitions and their peers in one run.
//! - `real`: large CAD parts, and a mesh against itself, in which every face intersects its
//!   neighbors.
//! - `refit`: refitting and rebuilding, and the aging of trees under animations.
//! - `baked`: baked files: writing, opening, validating and trusting.
//! - `worlds`: many moving bodies, their meshes and their broad phases.
//! - `shapes`: every pair of kinds of shapes, also in parry3d, and meshes in contact.
//! - `solids`: queries about solids; `solid_bsp`: a BSP tree over the faces of a solid.
//! - `volumes`: bounding volumes of meshes, and the minimal sphere in passes over memory.
//!
//! Every benchmark checks its answers. If an answer disagrees with another or with a known count,
//! the benchmark exits with an error and prints no times.

#![forbid(unsafe_code)]

pub mod questions;
pub mod real_points;
pub mod record;
pub mod samples;
pub mod scene;
pub mod table;

//! What the benchmarks share: meshes and poses, timed answers that are compared, and how they are printed.
//!
//! - `headline`: impinge on two knots of two million triangles, or on any file.
//! - `peers`: impinge beside parry3d, in one run.
//! - `realign`: the ways in which a box follows a turn; `hulls`: the time of a convex hull, for `bench/hulls.py`.
//! - `box_forms`: what n rotations and m translations cost the three forms of a box.
//! - `characters`: crowds of animated characters, all against all, and rays against each kind of hit volume.
//! - `ccd`: recorded queries of continuous collision, their answers and their times; a cloth with itself.
//! - `rays`: the first hits of rays from a file, for `bench/rivals_rays.py`.
//! - `hierarchies`: builders, degrees and volumes of trees; wrapped and layered.
//! - `real`: large CAD parts, and a mesh against itself, where every face meets its neighbours.
//! - `worlds`: many moving bodies, their meshes and their broad phases.
//! - `shapes`: every pair of kinds of shapes beside parry3d, and meshes in contact.
//! - `volumes`: bounding volumes of real meshes, and the minimal sphere beside the speed of memory.
//!
//! A benchmark checks its answer: one that disagrees with itself or with a known count fails and prints no times.

#![forbid(unsafe_code)]

pub mod questions;
pub mod real_points;
pub mod record;
pub mod samples;
pub mod scene;
pub mod table;

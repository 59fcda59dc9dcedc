//! Builds, changes and stores meshes.
//!
//! `validate` checks input arrays. `face_boxes` gives a builder the boxes of the faces, `fit`
//! computes the boxes and slabs of nodes, and `moved` fits a whole tree to vertices. `build` makes
//! a mesh from arrays with these. `aging` compares the cost of a hierarchy with its cost when built
//! and rebuilds it, and `refit` moves the vertices. `parts` lends the arrays for storing and
//! borrows stored ones. `repair` makes a new mesh without defects.

pub(super) mod aging;
pub(super) mod build;
pub(super) mod face_boxes;
pub(super) mod fit;
pub(super) mod moved;
pub(super) mod parts;
pub(super) mod refit;
pub(super) mod repair;
pub(super) mod validate;

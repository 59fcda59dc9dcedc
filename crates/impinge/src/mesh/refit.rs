//! Refitting: the same faces where their vertices are now, without building anew.
//!
//! Of a hierarchy only the *layout* is chosen: which node is whose child, and which face is in which lane. All its numbers, the
//! boxes, slabs and anchors, follow from the layout and the vertices, by the same operations in a build and here, so that
//! a refit to the vertices that a mesh was built from changes not one bit (docs/proof.md, L26).

use std::sync::Arc;

use rayon::prelude::*;

use super::fit::{Fitting, NO_CORNERS};
use super::frame::PackedFrame;
use super::leaf::Leaf;
use super::positions::{Positions, VertexSlice, Vertices};
use super::stamp::Stamp;
use super::stored_corners::Corners;
use super::triangles::CornerLanes;
use super::{Aging, Data, Mesh, judge, world_box};
use crate::hierarchy::{Node, Patch, Patches, WideTree, Work};
use crate::input::InputError;
use crate::simd::{Level, best_level, dispatch};

impl Mesh {
    /// Moves the vertices, of which there are as many as before; faces keep their numbers. Whoever holds a clone keeps
    /// the mesh as it was. Returns how the hierarchy has aged, which costs time and never an answer.
    ///
    /// ```
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mut mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
    /// let before = mesh.clone();
    /// let aging = mesh.refit(Positions::F32(vec![[0.0, 0.0, 9.0], [1.0, 0.0, 9.0], [0.0, 1.0, 9.0]]))?;
    /// assert_eq!((mesh.corners(0)[1], before.corners(0)[1]), ([1.0, 0.0, 9.0], [1.0, 0.0, 0.0]));
    /// assert!(!aging.is_worth_rebuilding());
    /// assert!(mesh.refit(Positions::F32(vec![[f32::NAN; 3]; 3])).is_err() && mesh.corners(0)[1] == [1.0, 0.0, 9.0]);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Errors
    /// Another number of vertices, a coordinate that is not finite or not below 2^128 in magnitude. The mesh is then what
    /// it was.
    ///
    /// # Complexity
    /// Linear, on all cores of the current rayon pool; nothing is allocated in proportion to the mesh unless there are
    /// clones, who keep the old hierarchy.
    pub fn refit(&mut self, positions: Positions) -> Result<Aging, InputError> {
        let (positions, frame) = self.judged(positions)?;
        match Arc::get_mut(&mut self.0) {
            Some(data) => data.refit(positions, frame),
            None => self.0 = Arc::new(self.0.refitted(positions, frame)),
        }
        Ok(self.aging())
    }

    /// A mesh of the same faces with its vertices moved; this one stays where it is.
    ///
    /// # Errors
    /// As [`refit`](Self::refit).
    ///
    /// # Complexity
    /// As [`refit`](Self::refit), and the memory of another hierarchy; the faces are shared.
    pub fn refitted(&self, positions: Positions) -> Result<Self, InputError> {
        let (positions, frame) = self.judged(positions)?;
        Ok(Self(Arc::new(self.0.refitted(positions, frame))))
    }

    fn judged(&self, positions: Positions) -> Result<(Positions, PackedFrame), InputError> {
        let extremes = judge::judge_moved(positions.slice(), self.0.vertices.slice().len())?;
        // Before the tree is no longer as it was built.
        self.0.costs_as_built();
        Ok((positions.narrowed(), PackedFrame::over(&extremes)))
    }
}

impl Data {
    fn refit(&mut self, positions: Positions, frame: PackedFrame) {
        self.fit(positions, frame);
    }

    fn refitted(&self, positions: Positions, frame: PackedFrame) -> Self {
        let tree = WideTree::from_nodes(self.tree.nodes().to_vec().into());
        let nowhere = Vertices::Given(Positions::F32(Vec::new()));
        let mut data = Self::new(nowhere, self.faces.clone(), self.frame, tree, self.leaves.clone());
        data.costs_as_built = self.costs_as_built.clone();
        data.fit(positions, frame);
        data
    }

    fn fit(&mut self, positions: Positions, frame: PackedFrame) {
        self.stamp = Stamp::new();
        self.vertices = Vertices::Given(positions);
        self.topology.take();
        self.far_field.take();
        self.made.clear();
        self.frame = frame;
        let moved = Moved { vertices: self.vertices.slice(), faces: &self.faces, frame: &self.frame };
        self.cost = moved.fit(&mut self.tree, &self.leaves).into();
        self.half_extents = world_box::half_extents(&self.tree, &self.frame);
    }
}

/// Where everything is now.
#[derive(Clone, Copy)]
pub(super) struct Moved<'a> {
    pub(super) vertices: VertexSlice<'a>,
    pub(super) faces: &'a [[u32; 3]],
    pub(super) frame: &'a PackedFrame,
}

impl Moved<'_> {
    /// Gives the nodes of a sound tree over these leaves all their numbers, and returns what it [costs](WideTree::cost).
    pub(super) fn fit(&self, tree: &mut WideTree, leaves: &[Leaf]) -> f64 {
        let patches = Patches::of(tree, leaves.len());
        let nodes = tree.nodes_mut();
        let work = patches.split(nodes);
        let fit = |corners: &mut _, Work { patch, nodes }: Work<'_>| {
            self.fit_patch(best_level(), &patch, nodes, &leaves[patch.leaves.clone()], corners)
        };
        let areas: Vec<f64> = work.into_par_iter().map_init(Vec::new, fit).collect();
        patches.refit_above(nodes);
        patches.cost(nodes, &areas)
    }

    /// Likewise of one patch of it; returns what the areas below its nodes add up to. `corners` is room that is used again.
    pub(super) fn fit_patch(
        &self,
        level: Level,
        patch: &Patch,
        nodes: &mut [Node],
        leaves: &[Leaf],
        corners: &mut Vec<CornerLanes>,
    ) -> f64 {
        corners.resize(leaves.len().max(corners.len()), NO_CORNERS);
        match Corners::of(self.vertices, self.faces, *self.frame) {
            Corners::Single(stored) => {
                dispatch!(level, simd => patch.refit(simd, nodes, &mut Fitting::new(simd, stored, leaves, corners)))
            }
            Corners::SingleWidened(stored) => {
                dispatch!(level, simd => patch.refit(simd, nodes, &mut Fitting::new(simd, stored, leaves, corners)))
            }
            Corners::Double(stored) => {
                dispatch!(level, simd => patch.refit(simd, nodes, &mut Fitting::new(simd, stored, leaves, corners)))
            }
        }
    }
}

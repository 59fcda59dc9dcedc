//! Computes the boxes and slabs of all nodes of a tree from the vertices. A build, a refit and the
//! validation of stored arrays share this code.

use rayon::prelude::*;

use super::fit::{Fitting, NO_CORNERS};
use crate::hierarchy::{Node, Patch, Patches, WideTree, Work};
use crate::mesh::storage::frame::PackedFrame;
use crate::mesh::storage::leaf::Leaf;
use crate::mesh::storage::positions::VertexSlice;
use crate::mesh::storage::stored_corners::Corners;
use crate::mesh::storage::triangles::CornerLanes;
use crate::simd::{Level, best_level, dispatch};

/// The vertices, faces and frame to which a tree is fitted.
#[derive(Clone, Copy)]
pub(super) struct Moved<'a> {
    pub(in crate::mesh) vertices: VertexSlice<'a>,
    pub(in crate::mesh) faces: &'a [[u32; 3]],
    pub(in crate::mesh) frame: &'a PackedFrame,
}

impl Moved<'_> {
    /// Computes the boxes and slabs of all nodes of a sound tree over these leaves, and returns its
    /// [cost](WideTree::cost).
    pub(in crate::mesh) fn fit(&self, tree: &mut WideTree, leaves: &[Leaf]) -> f64 {
        let patches = Patches::of(tree, leaves.len());
        let nodes = tree.nodes_mut();
        let work = patches.split(nodes);
        let fit = |corners: &mut _, Work { patch, nodes }: Work<'_>| {
            self.fit_subtree(best_level(), &patch, nodes, &leaves[patch.leaves.clone()], corners)
        };
        let areas: Vec<f64> = work.into_par_iter().map_init(Vec::new, fit).collect();
        patches.refit_above(nodes);
        patches.cost(nodes, &areas)
    }

    /// Computes the boxes and slabs of one patch, and returns the sum of the areas below its nodes.
    /// `corners` is a buffer that calls reuse.
    pub(super) fn fit_subtree(
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

//! Refitting: the same faces where their vertices are now, without building anew.
//!
//! Of a hierarchy only the *layout* is chosen: which node is whose child, and which face is in which lane. All its numbers, the
//! boxes, slabs and anchors, follow from the layout and the vertices, by the same operations in a build and here, so that
//! a refit to the vertices that a mesh was built from changes not one bit (docs/proof.md, L26).

use std::ops::Range;
use std::sync::Arc;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::fitted::{self, Fitted};
use super::frame::PackedFrame;
use super::leaf::Leaf;
use super::positions::{Positions, VertexSlice, Vertices};
use super::stored_corners::{Corners, StoredCorners};
use super::{Aging, Data, Mesh, judge};
use crate::hierarchy::{Leaves, Node, Patch, Patches, Slab, WideTree, Work};
use crate::input::InputError;
use crate::simd::{Level, best_level};
use crate::storage::Pages;
use crate::volume::Aabb;

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
        self.fit(positions, frame, |_| ());
    }

    fn refitted(&self, positions: Positions, frame: PackedFrame) -> Self {
        let tree = WideTree::from_nodes(self.tree.nodes().to_vec().into());
        let leaves = Pages::zeroed(self.leaves.len());
        let nowhere = Vertices::Given(Positions::F32(Vec::new()));
        let mut data = Self::new(nowhere, self.faces.clone(), self.frame, tree, leaves);
        data.costs_as_built = self.costs_as_built.clone();
        data.fit(positions, frame, |work| {
            work.leaves.copy_from_slice(&self.leaves[work.patch.leaves.clone()]);
        });
        data
    }

    fn fit(&mut self, positions: Positions, frame: PackedFrame, lay: impl Fn(&mut Work<'_, Leaf>) + Sync) {
        self.vertices = Vertices::Given(positions);
        self.topology.take();
        self.far_field.take();
        self.made.clear();
        self.frame = frame;
        let moved = Moved { vertices: self.vertices.slice(), faces: &self.faces, frame: &self.frame };
        moved.fit(&mut self.tree, self.leaves.to_mut(), lay);
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
    /// Gives the nodes of a sound tree and its leaves all their numbers, once `lay` has laid out the leaves of a patch.
    pub(super) fn fit(&self, tree: &mut WideTree, leaves: &mut [Leaf], lay: impl Fn(&mut Work<'_, Leaf>) + Sync) {
        let patches = Patches::of(tree, leaves.len());
        let nodes = tree.nodes_mut();
        let work = patches.split(nodes, leaves);
        work.into_par_iter().for_each_init(Vec::new, |fitted, mut work| {
            lay(&mut work);
            self.fit_patch(best_level(), &work.patch, work.nodes, work.leaves, fitted);
        });
        patches.refit_above(nodes);
    }

    /// Likewise of one patch of it. `fitted` is room that is used again.
    pub(super) fn fit_patch(
        &self,
        level: Level,
        patch: &Patch,
        nodes: &mut [Node],
        leaves: &mut [Leaf],
        fitted: &mut Vec<Fitted>,
    ) {
        fitted.resize(leaves.len().max(fitted.len()), Fitted::NONE);
        match Corners::of(self.vertices, self.faces, self.frame) {
            Corners::Single(stored) => {
                dispatch!(level, simd => patch.refit(nodes, &mut Fitting { simd, stored, leaves, fitted }))
            }
            Corners::SingleWidened(stored) => {
                dispatch!(level, simd => patch.refit(nodes, &mut Fitting { simd, stored, leaves, fitted }))
            }
            Corners::Double(stored) => {
                dispatch!(level, simd => patch.refit(nodes, &mut Fitting { simd, stored, leaves, fitted }))
            }
        }
    }
}

/// Leaves ahead whose vertices are asked for, and half of those whose faces are.
const AHEAD: usize = 3;

/// The leaves of a patch, and of those that are fitted what nodes want to know.
struct Fitting<'a, S, C> {
    simd: S,
    stored: C,
    leaves: &'a mut [Leaf],
    fitted: &'a mut [Fitted],
}

impl<S: Simd, C: StoredCorners> Leaves for Fitting<'_, S, C> {
    #[inline(always)]
    fn refit(&mut self, at: usize) -> Aabb {
        let ahead = |by: usize| at.checked_sub(by).map_or(&[][..], |at| self.leaves[at].held());
        // The faces of a leaf lie anywhere, and their vertices too.
        for &face in ahead(2 * AHEAD) {
            self.stored.prefetch_face(face);
        }
        for &face in ahead(AHEAD) {
            self.stored.prefetch_corners(face);
        }
        let leaf = &mut self.leaves[at];
        let (bounds, corners, anchor) = leaf.fit(self.simd, &self.stored);
        self.fitted[at].keep(leaf, &corners, anchor);
        bounds
    }

    #[inline(always)]
    fn slab(&self, leaves: Range<usize>) -> Slab {
        fitted::slab(self.simd, &self.fitted[leaves])
    }
}

//! Refitting: the same faces where their vertices are now, without building anew.
//!
//! Of a hierarchy only the *layout* is chosen: which node is whose child, and which face is in which lane. All its numbers, the
//! boxes, packets and slabs, follow from the layout and the vertices, by the same operations in a build and here, so that
//! a refit to the vertices that a mesh was built from changes not one bit (docs/proof.md, L26).

use std::ops::Range;
use std::sync::Arc;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::frame::PackedFrame;
use super::packet::{self, Packet};
use super::positions::{Positions, Vertex, VertexSlice, Vertices};
use super::{Aging, Data, Mesh, judge};
use crate::hierarchy::{Leaves, Node, Patch, Patches, Slab, WideTree, Work};
use crate::input::InputError;
use crate::simd::{Level, best_level, prefetch};
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
        let packets = Pages::zeroed(self.packets.len());
        let nowhere = Vertices::Given(Positions::F32(Vec::new()));
        let mut data = Self::new(nowhere, self.faces.clone(), self.frame, tree, packets);
        data.costs_as_built = self.costs_as_built.clone();
        data.fit(positions, frame, |work| {
            for (packet, old) in work.leaves.iter_mut().zip(&self.packets[work.patch.leaves.clone()]) {
                packet.lay(old.held());
            }
        });
        data
    }

    fn fit(&mut self, positions: Positions, frame: PackedFrame, lay: impl Fn(&mut Work<'_, Packet>) + Sync) {
        self.vertices = Vertices::Given(positions);
        self.topology.take();
        self.far_field.take();
        self.frame = frame;
        let moved = Moved { vertices: self.vertices.slice(), faces: &self.faces, frame: &self.frame };
        moved.fit(&mut self.tree, self.packets.to_mut(), lay);
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
    /// Gives the nodes of a sound tree and the packets of its leaves all their numbers, once `lay` has laid out the packets
    /// of a patch.
    pub(super) fn fit(&self, tree: &mut WideTree, packets: &mut [Packet], lay: impl Fn(&mut Work<'_, Packet>) + Sync) {
        let patches = Patches::of(tree, packets.len());
        let nodes = tree.nodes_mut();
        let work = patches.split(nodes, packets);
        work.into_par_iter().for_each(|mut work| {
            lay(&mut work);
            self.fit_patch(best_level(), &work.patch, work.nodes, work.leaves);
        });
        patches.refit_above(nodes);
    }

    /// Likewise of one patch of it.
    pub(super) fn fit_patch(&self, level: Level, patch: &Patch, nodes: &mut [Node], packets: &mut [Packet]) {
        match self.vertices {
            VertexSlice::F32(vertices) => {
                dispatch!(level, simd => patch.refit(nodes, &mut Packets { simd, vertices, moved: self, packets }))
            }
            VertexSlice::F64(vertices) => {
                dispatch!(level, simd => patch.refit(nodes, &mut Packets { simd, vertices, moved: self, packets }))
            }
        }
    }
}

/// The packets of a patch.
struct Packets<'a, S, V> {
    simd: S,
    vertices: &'a [V],
    moved: &'a Moved<'a>,
    packets: &'a mut [Packet],
}

impl<S: Simd, V: Vertex> Leaves for Packets<'_, S, V> {
    #[inline(always)]
    fn refit(&mut self, leaf: usize) -> Aabb {
        let Moved { faces, frame, .. } = self.moved;
        let ahead = |by: usize| leaf.checked_sub(by).map_or(&[][..], |leaf| self.packets[leaf].held());
        // The faces of a leaf lie anywhere, and their vertices too: they are asked for three leaves and one leaf ahead.
        for &face in ahead(3) {
            prefetch(&faces[face as usize]);
        }
        for &face in ahead(1) {
            for vertex in faces[face as usize] {
                prefetch(&self.vertices[vertex as usize]);
            }
        }
        self.packets[leaf].fit(self.simd, frame, self.vertices, faces)
    }

    #[inline(always)]
    fn slab(&self, leaves: Range<usize>) -> Slab {
        packet::slab(self.simd, &self.packets[leaves])
    }
}

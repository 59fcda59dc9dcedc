//! Refitting: the same faces where their vertices are now, without building anew.
//!
//! Of a hierarchy only the *layout* is chosen: which node is whose child, and which face is in which lane. All its numbers, the
//! boxes, slabs and anchors, follow from the layout and the vertices, by the same operations in a build and here, so that
//! a refit to the vertices that a mesh was built from changes not one bit (docs/proof.md, L26).

use std::sync::Arc;

use super::aging::Aging;
use super::moved::Moved;
use super::validate::validate_moved;
use crate::hierarchy::WideTree;
use crate::input::InputError;
use crate::mesh::storage::frame::PackedFrame;
use crate::mesh::storage::positions::{Positions, Vertices};
use crate::mesh::storage::stamp::Stamp;
use crate::mesh::triangle_mesh::{Data, Mesh};

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
    pub fn refit(&mut self, positions: impl Into<Positions>) -> Result<Aging, InputError> {
        let (positions, frame) = self.validated(positions.into())?;
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
    pub fn refitted(&self, positions: impl Into<Positions>) -> Result<Self, InputError> {
        let (positions, frame) = self.validated(positions.into())?;
        Ok(Self(Arc::new(self.0.refitted(positions, frame))))
    }

    fn validated(&self, positions: Positions) -> Result<(Positions, PackedFrame), InputError> {
        let extremes = validate_moved(positions.slice(), self.0.vertices.slice().len())?;
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
        self.packet_cache.clear();
        self.frame = frame;
        let moved = Moved { vertices: self.vertices.slice(), faces: &self.faces, frame: &self.frame };
        self.cost = moved.fit(&mut self.tree, &self.leaves).into();
        self.half_extents = self.frame.half_extents(&self.tree);
    }
}

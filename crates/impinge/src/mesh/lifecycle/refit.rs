//! Refits a mesh: keeps its faces and the layout of its hierarchy, and moves the vertices.
//!
//! A builder only chooses the *layout* of a hierarchy: the children of each node, and the lane of
//! each face. All numbers, such as boxes, slabs and local origins, follow from the layout and the
//! vertices. A build and a refit compute them by the same operations. So a refit to the vertices
//! that a mesh was built from changes no bit (docs/notes/proof.md, L26).
//!
//! Guarded by the tests in `engine/moving.rs` and by the benchmark `refit`.

use std::sync::Arc;

use super::aging::Aging;
use super::moved::Moved;
use super::validate::validate_moved;
use crate::hierarchy::WideTree;
use crate::input::InputError;
use crate::mesh::storage::frame::PackedFrame;
use crate::mesh::storage::positions::{Positions, Vertices};
use crate::mesh::storage::stamp::Stamp;
use crate::mesh::triangle_mesh::{Data, Derived, Mesh};

impl Mesh {
    /// Moves the vertices to `positions`, in the mesh frame, one per vertex. The faces and their
    /// indices are kept. Clones of the mesh keep the old vertices. Returns how the hierarchy has
    /// aged, which affects the time of queries but no answer.
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
    /// If the number of vertices differs, or if a coordinate is not finite or not below 2^128 in
    /// magnitude. The mesh is then unchanged.
    ///
    /// # Complexity
    /// Linear, on all cores of the current rayon pool. Nothing is allocated in proportion to the
    /// mesh, unless clones exist, which keep the old hierarchy.
    pub fn refit(&mut self, positions: impl Into<Positions>) -> Result<Aging, InputError> {
        let (positions, frame) = self.validated(positions.into())?;
        match Arc::get_mut(&mut self.0) {
            Some(data) => data.refit(positions, frame),
            None => self.0 = Arc::new(self.0.refitted(positions, frame)),
        }
        Ok(self.aging())
    }

    /// Returns a mesh with the same faces and with the vertices at `positions`, in the mesh frame.
    /// This mesh is unchanged.
    ///
    /// # Errors
    /// As [`refit`](Self::refit).
    ///
    /// # Complexity
    /// As [`refit`](Self::refit), and the memory of another hierarchy. The faces are shared.
    pub fn refitted(&self, positions: impl Into<Positions>) -> Result<Self, InputError> {
        let (positions, frame) = self.validated(positions.into())?;
        Ok(Self(Arc::new(self.0.refitted(positions, frame))))
    }

    /// Validates new vertices. Returns them as they are stored, with their packed frame.
    fn validated(&self, positions: Positions) -> Result<(Positions, PackedFrame), InputError> {
        let extremes = validate_moved(positions.slice(), self.0.vertices.slice().len())?;
        // Stored before the tree changes.
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

    /// Moves the vertices, fits the tree to them, and removes cached values that depend on them.
    fn fit(&mut self, positions: Positions, frame: PackedFrame) {
        self.stamp = Stamp::new();
        self.vertices = Vertices::Given(positions);
        self.derived = Derived::default();
        self.packet_cache.clear();
        self.frame = frame;
        let moved = Moved { vertices: self.vertices.slice(), faces: &self.faces, frame: &self.frame };
        self.cost = moved.fit(&mut self.tree, &self.leaves).into();
        self.half_extents = self.frame.half_extents(&self.tree);
    }
}

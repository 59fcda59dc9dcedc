//! The triangle mesh: its arrays, its hierarchy, and the values that queries derive and keep.

use std::sync::{Arc, OnceLock};

use super::derived::cap::Cap;
use super::derived::moments::FarField;
use super::derived::topology::{Components, Topology};
use super::storage::frame::PackedFrame;
use super::storage::leaf::Leaf;
use super::storage::packet::{Made, Packets};
use super::storage::positions::{Positions, Vertices};
use super::storage::stamp::Stamp;
use super::storage::stored_corners;
use crate::exact::Corners;
use crate::hierarchy::WideTree;
use crate::math::vec3::Vector;
use crate::storage::Buffer;

/// A triangle mesh, judged and packed, with its hierarchy; cheap to clone, and never changing under a query.
///
/// A mesh is its surface: the union of its closed triangles. A triangle without area is the segment or the point that
/// it spans, and counts like any other. Face `i` is row `i` of what was given.
///
/// ```
/// use impinge::{Mesh, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// assert!(query::intersects(&mesh, &mesh));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Mesh(pub(super) Arc<Data>);

#[derive(Debug)]
pub(super) struct Data {
    pub(super) stamp: Stamp,
    pub(super) vertices: Vertices,
    /// Shared by all meshes that were refitted from one.
    pub(super) faces: Arc<Buffer<[u32; 3]>>,
    pub(super) frame: PackedFrame,
    /// About the frame's origin.
    pub(super) half_extents: Vector,
    pub(super) tree: WideTree,
    /// Likewise.
    pub(super) leaves: Arc<Buffer<Leaf>>,
    /// The packets of leaves that were met.
    pub(super) made: Made,
    /// What the tree costs, noted when it is refitted or first asked for.
    pub(super) cost: OnceLock<f64>,
    /// What each subtree cost when it was built, noted when it is first refitted.
    pub(super) costs_as_built: OnceLock<Arc<[f64]>>,
    /// Made when a question about solids first needs it.
    pub(super) topology: OnceLock<Topology>,
    /// Made when a winding number first needs it.
    pub(super) far_field: OnceLock<FarField>,
    /// Made when a question first depends on how faces are connected along edges.
    pub(super) sheets: OnceLock<Components>,
    /// Made when a question first asks where the mesh is far enough from its border.
    pub(super) cap: OnceLock<Cap>,
}

impl Mesh {
    /// The positions, in the mesh's own frame.
    #[inline]
    #[must_use]
    pub fn positions(&self) -> &Positions {
        self.0.vertices.positions()
    }

    /// The faces as given.
    #[inline]
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.0.faces
    }

    /// The corners of a face, in the mesh's own frame.
    ///
    /// # Panics
    /// Where there is no such face.
    #[inline]
    #[must_use]
    pub fn corners(&self, face: u32) -> Corners {
        self.0.faces[face as usize].map(|vertex| self.0.vertices.get(vertex as usize))
    }

    /// How the faces hang together.
    pub(crate) fn topology(&self) -> &Topology {
        let slot = &self.0.topology;
        // Not while the slot is locked: a thread that waits for its sorting may take up a task that needs the slot too.
        if slot.get().is_none() {
            let _ = slot.set(Topology::of(self.positions(), &self.0.faces));
        }
        slot.get_or_init(|| Topology::of(self.positions(), &self.0.faces))
    }

    /// The faces at a vertex, which is the first at its position, ascending; one that has it twice comes twice.
    ///
    /// # Complexity
    /// O(n) the first time, then constant.
    pub(crate) fn faces_at(&self, vertex: u32) -> &[u32] {
        self.topology().faces_at(self.faces(), vertex)
    }

    /// The packets of its leaves.
    pub(crate) fn packets(&self) -> Packets<'_> {
        let data = &*self.0;
        let corners = stored_corners::Corners::of(data.vertices.slice(), &data.faces, data.frame);
        Packets::new(&data.leaves, &data.made, corners)
    }

    /// What one leaf holds.
    #[inline(always)]
    pub(crate) fn leaf(&self, leaf: u32) -> &Leaf {
        &self.0.leaves[leaf as usize]
    }

    /// The moments of the faces below each node.
    pub(crate) fn far_field(&self) -> &FarField {
        let data = &*self.0;
        data.far_field.get_or_init(|| FarField::of(&data.tree, &data.leaves, &data.frame, |face| self.corners(face)))
    }

    /// Bytes that the mesh and its hierarchy hold, with what questions have added to be asked again: 40 bytes a triangle where they
    /// met every leaf.
    #[must_use]
    pub fn memory(&self) -> usize {
        let data = &*self.0;
        data.vertices.slice().into_bytes().len()
            + size_of_val(&data.faces[..])
            + size_of_val(data.tree.nodes())
            + size_of_val(&data.leaves[..])
            + data.made.memory()
    }
}

impl Data {
    pub(super) fn new(
        vertices: Vertices,
        faces: Arc<Buffer<[u32; 3]>>,
        frame: PackedFrame,
        tree: WideTree,
        leaves: Arc<Buffer<Leaf>>,
    ) -> Self {
        let (cost, costs_as_built, topology, far_field) = Default::default();
        let (sheets, cap) = Default::default();
        let (stamp, made) = (Stamp::new(), Made::none(leaves.len()));
        let half_extents = frame.half_extents(&tree);
        Self {
            stamp,
            vertices,
            faces,
            frame,
            half_extents,
            tree,
            leaves,
            made,
            cost,
            costs_as_built,
            topology,
            far_field,
            sheets,
            cap,
        }
    }
}

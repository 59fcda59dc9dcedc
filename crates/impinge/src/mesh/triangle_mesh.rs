//! The triangle mesh: its arrays, its hierarchy, and the values that queries derive and cache.

use std::sync::{Arc, OnceLock};

use super::derived::cap::Cap;
use super::derived::copies::Copies;
use super::derived::facets::Facets;
use super::derived::moments::FarField;
use super::derived::topology::{Across, Components, Topology};
use super::storage::frame::PackedFrame;
use super::storage::leaf::Leaf;
use super::storage::packet::{PacketCache, Packets};
use super::storage::positions::{Positions, Vertices};
use super::storage::stamp::Stamp;
use super::storage::stored_corners;
use crate::exact::Corners;
use crate::hierarchy::WideTree;
use crate::math::vec3::Vector;
use crate::primitive::unit_normal;
use crate::storage::Buffer;

/// A validated triangle mesh with its hierarchy. It is cheap to clone, as clones share all data,
/// and it never changes during a query.
///
/// A mesh is its surface: the union of its closed triangles. A triangle without area is the segment
/// or the point that its corners span, and counts like any other. Face `i` is row `i` of the input.
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

/// The data of a mesh, which its clones share.
#[derive(Debug)]
pub(super) struct Data {
    /// Changes when the vertices move, so that caches can detect it.
    pub(super) stamp: Stamp,
    pub(super) vertices: Vertices,
    /// The faces, shared by all meshes that were refitted from one mesh.
    pub(super) faces: Arc<Buffer<[u32; 3]>>,
    /// Maps the mesh frame to the packed frame.
    pub(super) frame: PackedFrame,
    /// Bounds of the distance of the mesh from the origin of `frame` on each axis, in the mesh
    /// frame and its unit, rounded up.
    pub(super) half_extents: Vector,
    pub(super) tree: WideTree,
    /// The leaves, shared by all meshes that were refitted from one mesh.
    pub(super) leaves: Arc<Buffer<Leaf>>,
    /// The packets that queries have made so far.
    pub(super) packet_cache: PacketCache,
    /// Expected cost of a query of the tree; stored by a refit or computed when first needed.
    pub(super) cost: OnceLock<f64>,
    /// Cost of each subtree when it was built; computed before the first refit.
    pub(super) costs_as_built: OnceLock<Arc<[f64]>>,
    pub(super) derived: Derived,
}

/// Values that follow from the positions of the vertices, each computed when first needed. A refit
/// replaces them all.
#[derive(Debug, Default)]
pub(super) struct Derived {
    /// How the faces are connected.
    pub(super) topology: OnceLock<Topology>,
    /// Moments of the faces below each node; winding numbers need them.
    pub(super) far_field: OnceLock<FarField>,
    /// Components of the faces that are connected along edges.
    pub(super) sheets: OnceLock<Components>,
    /// The flat parts of the surface.
    pub(super) facets: OnceLock<Facets>,
    /// Boxes about the border, and the distance beyond which it does not matter.
    pub(super) cap: OnceLock<Cap>,
    /// Faces that are copies of another face.
    pub(super) copies: OnceLock<Copies>,
}

impl Mesh {
    /// Returns the vertex positions, in the mesh frame. A [borrowed](Self::borrow) mesh copies them
    /// at the first call.
    #[inline]
    #[must_use]
    pub fn positions(&self) -> &Positions {
        self.0.vertices.positions()
    }

    /// Returns the faces as given: three vertex indices each.
    #[inline]
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.0.faces
    }

    /// Returns the corners of a face, in the mesh frame and exact.
    ///
    /// # Panics
    /// If `face` is not below the number of faces.
    #[inline]
    #[must_use]
    pub fn corners(&self, face: u32) -> Corners {
        let ([a, b, c], vertices) = (self.0.faces[face as usize], &self.0.vertices);
        [vertices.get(a as usize), vertices.get(b as usize), vertices.get(c as usize)]
    }

    /// Returns the unit normal of a face in the mesh frame, or `None` if the face has no area. It
    /// is on the side from which the corners are in counterclockwise order.
    ///
    /// ```
    /// use impinge::mesh::Ray;
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    /// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2], [0, 1, 1]])?;
    /// let hit = mesh.ray_cast(&Ray::new([1.0, 1.0, 3.0], [0.0, 0.0, -1.0])?).expect("a hit");
    /// assert_eq!(mesh.face_normal(hit.face), Some([0.0, 0.0, 1.0]));
    /// assert_eq!(mesh.face_normal(1), None);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// The direction is within 2^-38 of the exact one, however thin the face is.
    ///
    /// # Panics
    /// If `face` is not below the number of faces.
    #[must_use]
    pub fn face_normal(&self, face: u32) -> Option<[f64; 3]> {
        unit_normal(&self.corners(face))
    }

    /// Returns how the faces are connected, computed at the first call.
    pub(crate) fn topology(&self) -> &Topology {
        let slot = &self.0.derived.topology;
        // No lock is held during the computation. A thread that waits in the parallel sort may
        // start another task that needs this slot, and would deadlock.
        if slot.get().is_none() {
            let _ = slot.set(Topology::of(self.positions(), &self.0.faces));
        }
        slot.get_or_init(|| Topology::of(self.positions(), &self.0.faces))
    }

    /// Returns the faces at a vertex, ascending. The vertex must be the first one at its position.
    /// A face that has it twice is listed twice.
    ///
    /// # Complexity
    /// O(n) at the first call, then constant.
    pub(crate) fn faces_at(&self, vertex: u32) -> &[u32] {
        self.topology().faces_at(self.faces(), vertex)
    }

    /// Returns what lies across the edges of a face. Edge k runs from corner k to the next.
    ///
    /// # Complexity
    /// O(n log n) at the first call, then constant.
    pub(crate) fn across(&self, face: u32) -> [Across; 3] {
        self.all_across()[face as usize]
    }

    /// Returns what lies across the edges of each face, as [`across`](Self::across) does.
    pub(crate) fn all_across(&self) -> &[[Across; 3]] {
        self.topology().across(self.faces())
    }

    /// Returns access to the packets of the leaves.
    pub(crate) fn packets(&self) -> Packets<'_> {
        let data = &*self.0;
        let corners = stored_corners::Corners::of(data.vertices.slice(), &data.faces, data.frame);
        Packets::new(&data.leaves, &data.packet_cache, corners)
    }

    /// Returns a leaf, which names its faces.
    #[inline(always)]
    pub(crate) fn leaf(&self, leaf: u32) -> &Leaf {
        &self.0.leaves[leaf as usize]
    }

    /// Returns the moments of the faces below each node, computed at the first call.
    pub(crate) fn far_field(&self) -> &FarField {
        let data = &*self.0;
        data.derived
            .far_field
            .get_or_init(|| FarField::of(&data.tree, &data.leaves, &data.frame, |face| self.corners(face)))
    }

    /// Returns which faces are copies of another face, computed at the first call.
    pub(crate) fn copies(&self) -> &Copies {
        let data = &*self.0;
        let first_at = &self.topology().first_at;
        data.derived.copies.get_or_init(|| Copies::of(first_at, &data.faces, data.tree.nodes(), &data.leaves))
    }

    /// Returns the number of bytes of the mesh, its hierarchy and its packets. A packet is made
    /// when a query first reaches its leaf. All packets together take 40 bytes per triangle.
    #[must_use]
    pub fn memory(&self) -> usize {
        let data = &*self.0;
        data.vertices.slice().into_bytes().len()
            + size_of_val(&data.faces[..])
            + size_of_val(data.tree.nodes())
            + size_of_val(&data.leaves[..])
            + data.packet_cache.memory()
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
        let (cost, costs_as_built, derived) = Default::default();
        let (stamp, packet_cache) = (Stamp::new(), PacketCache::new(leaves.len()));
        let half_extents = frame.half_extents(&tree);
        Self { stamp, vertices, faces, frame, half_extents, tree, leaves, packet_cache, cost, costs_as_built, derived }
    }
}

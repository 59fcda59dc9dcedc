//! Triangle meshes: judged once, packed, with their hierarchy, and the one descent of two meshes.

mod aging;
mod bsp;
mod build;
mod cap;
mod crossings;
mod descent;
mod distance;
mod eight_triangles;
mod face_boxes;
mod face_search;
mod faces;
mod far_field;
mod filter;
mod fit;
mod frame;
mod health;
mod hubs;
mod inspection;
mod judge;
mod large_leaf;
mod leaf;
mod leaf_pairs;
mod metric;
mod nearest;
mod packet;
mod parts;
mod positions;
mod proxies;
mod ray_packet;
mod rays;
mod refit;
mod relation;
mod repair;
mod self_descent;
mod sheets;
mod solid_angle;
mod stamp;
mod stored_corners;
mod taken_up;
mod topology;
mod triangles;
mod walls;
mod winding;
mod world_box;

use std::sync::{Arc, OnceLock};

pub use aging::Aging;
pub use bsp::SolidBsp;
pub use descent::Options;
pub(crate) use descent::{any_hit, collect_intersecting, faces_meet, first_hit};
pub(crate) use distance::{Trail, nearest, within};
pub(crate) use face_search::FaceSearch;
pub use health::Health;
pub use nearest::ClosestPoint;
pub use parts::{Flaw, Parts};
pub use positions::Positions;
use positions::Vertices;
pub use rays::{Ray, RayHit};
pub use relation::HostChoice;
pub use repair::{Repair, RepairOptions};
pub(crate) use self_descent::{WantedFaces, collect_self_intersecting};
pub(crate) use walls::{Wall, Walls};
pub(crate) use winding::Judge;
pub use winding::{Containment, WindingNumber};

use crate::exact::Corners;
use crate::hierarchy::{Builder, WideTree};
use crate::input::InputError;
use crate::math::Pose;
use crate::primitive::Vector;
use crate::storage::Buffer;
use build::built;
use cap::Cap;
use far_field::FarField;
use frame::PackedFrame;
use leaf::Leaf;
use packet::Made;
use stamp::Stamp;
use topology::Topology;
pub(crate) use topology::{Components, DisjointSets};

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
pub struct Mesh(Arc<Data>);

#[derive(Debug)]
struct Data {
    stamp: Stamp,
    vertices: Vertices,
    /// Shared by all meshes that were refitted from one.
    faces: Arc<Buffer<[u32; 3]>>,
    frame: PackedFrame,
    /// About the frame's origin.
    half_extents: Vector,
    tree: WideTree,
    /// Likewise.
    leaves: Arc<Buffer<Leaf>>,
    /// The packets of leaves that were met.
    made: Made,
    /// What the tree costs, noted when it is refitted or first asked for.
    cost: OnceLock<f64>,
    /// What each subtree cost when it was built, noted when it is first refitted.
    costs_as_built: OnceLock<Arc<[f64]>>,
    /// Made when a question about solids first needs it.
    topology: OnceLock<Topology>,
    /// Made when a winding number first needs it.
    far_field: OnceLock<FarField>,
    /// Made when a question first depends on how faces are connected along edges.
    sheets: OnceLock<Components>,
    /// Made when a question first asks where the mesh is far enough from its border.
    cap: OnceLock<Cap>,
}

impl Mesh {
    /// Judges, packs and builds; takes the arrays without copying them.
    ///
    /// Double precision positions that are all representable in single precision are stored so, which changes no
    /// answer.
    ///
    /// # Errors
    /// A coordinate that is not finite or not below 2^128 in magnitude; an index without a vertex; more vertices or
    /// faces than can be numbered. Nothing is repaired and nothing is dropped.
    ///
    /// # Complexity
    /// O(n log n), on all cores of the current rayon pool.
    pub fn new(positions: Positions, faces: Vec<[u32; 3]>) -> Result<Self, InputError> {
        Self::with_builder(positions, faces, Builder::default())
    }

    /// As [`new`](Self::new), with the hierarchy built by another strategy, which changes no answer.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// # Complexity
    /// As [`Builder::build`].
    pub fn with_builder(positions: Positions, faces: Vec<[u32; 3]>, builder: Builder) -> Result<Self, InputError> {
        let frame = PackedFrame::over(&judge::judge(positions.slice(), &faces)?);
        let vertices = Vertices::Given(positions.narrowed());
        let (tree, leaves) = built(vertices.slice(), &faces, &frame, builder);
        Ok(Self(Arc::new(Data::new(vertices, Arc::new(faces.into()), frame, tree, Arc::new(leaves)))))
    }

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

    /// The mesh placed in the world, for a query.
    #[must_use]
    pub fn at(&self, world_from_mesh: Pose) -> Placed<'_> {
        Placed { mesh: self, world_from_mesh }
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

    /// The moments of the faces below each node.
    pub(crate) fn far_field(&self) -> &FarField {
        self.0.far_field.get_or_init(|| FarField::of(self))
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
    fn new(
        vertices: Vertices,
        faces: Arc<Buffer<[u32; 3]>>,
        frame: PackedFrame,
        tree: WideTree,
        leaves: Arc<Buffer<Leaf>>,
    ) -> Self {
        let (cost, costs_as_built, topology, far_field) = Default::default();
        let (sheets, cap) = Default::default();
        let (stamp, made) = (Stamp::new(), Made::none(leaves.len()));
        let half_extents = world_box::half_extents(&tree, &frame);
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

/// A mesh and where it stands in the world.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Maps the mesh's own frame to the world.
    pub world_from_mesh: Pose,
}

impl<'a> From<&'a Mesh> for Placed<'a> {
    /// The mesh where its own frame is the world.
    fn from(mesh: &'a Mesh) -> Self {
        mesh.at(Pose::IDENTITY)
    }
}

/// Leaves, or faces, that are one task.
const CHUNK: usize = 512;

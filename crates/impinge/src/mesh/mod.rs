//! Triangle meshes: judged once, packed, with their hierarchy, and the one descent of two meshes.

mod descent;
mod distance;
mod filter;
mod frame;
mod judge;
mod metric;
mod nearest;
mod packet;
mod positions;
mod rays;
mod relation;

use std::sync::Arc;

use rayon::prelude::*;

pub(crate) use descent::collect_intersecting;
pub use descent::{HostChoice, Options};
pub(crate) use distance::{nearest, within};
pub use nearest::ClosestPoint;
pub use positions::Positions;
pub use rays::{Ray, RayHit};

use crate::exact::Corners;
use crate::hierarchy::{BinaryTree, LEAF_CAPACITY, WideTree, build_morton};
use crate::input::InputError;
use crate::math::Pose;
use crate::storage::Buffer;
use crate::volume::Aabb;
use frame::PackedFrame;
use packet::Packet;

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
    positions: Positions,
    faces: Vec<[u32; 3]>,
    frame: PackedFrame,
    tree: WideTree,
    packets: Buffer<Packet>,
    /// The faces that fill the lanes of each packet.
    packet_faces: Buffer<[u32; LEAF_CAPACITY]>,
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
        judge::judge(&positions, &faces)?;
        let positions = positions.narrowed();
        let frame = PackedFrame::of(&positions);
        let boxes = face_boxes(&positions, &faces, &frame);
        let binary = build_morton(&boxes);
        let (tree, leaves) = WideTree::collapse(&binary);
        drop(boxes);
        let packets = match &positions {
            Positions::F32(vertices) => pack(&binary, &leaves, |face: u32| {
                faces[face as usize].map(|vertex| frame.pack(vertices[vertex as usize].map(f64::from)))
            }),
            Positions::F64(vertices) => pack(&binary, &leaves, |face: u32| {
                faces[face as usize].map(|vertex| frame.pack(vertices[vertex as usize]))
            }),
        };
        let packet_faces: Vec<[u32; LEAF_CAPACITY]> = leaves
            .par_iter()
            .map(|&leaf| {
                let held = binary.held(leaf);
                std::array::from_fn(|lane| held[if lane < held.len() { lane } else { 0 }])
            })
            .collect();
        let (packets, packet_faces) = (packets.into(), packet_faces.into());
        Ok(Self(Arc::new(Data { positions, faces, frame, tree, packets, packet_faces })))
    }

    /// The positions, in the mesh's own frame.
    #[must_use]
    pub fn positions(&self) -> &Positions {
        &self.0.positions
    }

    /// The faces as given.
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
        self.0.faces[face as usize].map(|vertex| self.0.positions.get(vertex as usize))
    }

    /// The mesh placed in the world, for a query.
    #[must_use]
    pub fn at(&self, world_from_mesh: Pose) -> Placed<'_> {
        Placed { mesh: self, world_from_mesh }
    }

    /// Bytes that the mesh and its hierarchy hold.
    #[must_use]
    pub fn memory(&self) -> usize {
        let data = &*self.0;
        let positions = match &data.positions {
            Positions::F32(vertices) => size_of_val(&vertices[..]),
            Positions::F64(vertices) => size_of_val(&vertices[..]),
        };
        positions
            + size_of_val(&data.faces[..])
            + size_of_val(data.tree.nodes())
            + size_of_val(&data.packets[..])
            + size_of_val(&data.packet_faces[..])
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

/// The packets of the leaves.
fn pack(binary: &BinaryTree, leaves: &[u32], packed: impl Fn(u32) -> [[f64; 3]; 3] + Sync) -> Vec<Packet> {
    leaves
        .par_iter()
        .map(|&leaf| Packet::new(binary.held(leaf), &binary.nodes[leaf as usize].bounds, &packed))
        .collect()
}

/// Boxes of the faces in the packed frame, rounded outward (docs/proof.md, L1).
fn face_boxes(positions: &Positions, faces: &[[u32; 3]], frame: &PackedFrame) -> Vec<Aabb> {
    let round = |vertex: [f64; 3]| frame.pack(vertex).map(|x| x as f32);
    let packed: Vec<[f32; 3]> = match positions {
        Positions::F32(vertices) => vertices.par_iter().map(|v| round(v.map(f64::from))).collect(),
        Positions::F64(vertices) => vertices.par_iter().map(|v| round(*v)).collect(),
    };
    // A step to the next float outward is a whole unit in the last place: more than half of one for the rounding to
    // single precision and the double precision errors before it.
    faces.par_iter().map(|face| Aabb::of_points(face.map(|vertex| packed[vertex as usize])).next_outward()).collect()
}

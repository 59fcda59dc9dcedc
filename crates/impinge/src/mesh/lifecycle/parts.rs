//! Lends the arrays of a mesh, so that they can be stored, and makes a mesh that borrows such
//! arrays.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::moved::Moved;
use super::validate::validate;
use crate::hierarchy::{Node, Patch, Patches, WideTree};
use crate::input::InputError;
use crate::mesh::storage::frame::PackedFrame;
use crate::mesh::storage::leaf::{CHUNK, Leaf};
use crate::mesh::storage::positions::{VertexSlice, Vertices};
use crate::mesh::storage::triangles::CornerLanes;
use crate::mesh::triangle_mesh::{Data, Mesh};
use crate::simd::best_level;
use crate::storage::{Buffer, SharedBytes};

/// One value for each stored array of a mesh: its bytes, or their range in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts<T> {
    /// The map from the mesh frame to the packed frame.
    pub frame: T,
    /// Positions: three numbers per vertex, in single or double precision. The precision is not
    /// stored in the array.
    pub positions: T,
    /// Faces: three 32-bit vertex indices per face.
    pub faces: T,
    /// Nodes of the hierarchy.
    pub nodes: T,
    /// Leaves of the hierarchy.
    pub leaves: T,
}

/// Reason why arrays are not a valid mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Flaw {
    /// An array lies outside the bytes, is not a whole number of elements, or is not aligned for
    /// them.
    Shape {
        /// The array, by the name of its field in [`Parts`].
        part: &'static str,
    },
    /// The vertices or the faces are invalid: [`Mesh::new`] would return this error.
    Input(InputError),
    /// The stored map to the packed frame is not the map that follows from the vertices.
    Frame,
    /// The nodes do not form a tree over the leaves, or the tree is too deep.
    Tree,
    /// A leaf holds a face that does not exist, or a face is held by no leaf or by two.
    Faces,
    /// A box or slab of the hierarchy differs from the one computed from the vertices.
    Bounds {
        /// The first node of the subtree in which the difference was found, or 0 for the nodes
        /// above all such subtrees.
        node: usize,
    },
}

impl Mesh {
    /// Version of the layout of [`parts`](Self::parts). It is the same on all little-endian
    /// machines. It changes whenever a build makes other bits from the same arrays.
    pub const PARTS_VERSION: u32 = 4;

    /// Maximum alignment that an array needs, in bytes.
    pub const PARTS_ALIGNMENT: usize = align_of::<Node>();

    /// Returns the arrays of the mesh as bytes, as they are in memory.
    #[must_use]
    pub fn parts(&self) -> Parts<&[u8]> {
        let data = &*self.0;
        Parts {
            frame: bytemuck::bytes_of(&data.frame),
            positions: data.vertices.slice().into_bytes(),
            faces: bytemuck::cast_slice(&data.faces[..]),
            nodes: bytemuck::cast_slice(data.tree.nodes()),
            leaves: bytemuck::cast_slice(&data.leaves[..]),
        }
    }

    /// Reports whether the vertices are stored in single precision, in four bytes per coordinate
    /// instead of eight.
    #[must_use]
    pub fn is_single_precision(&self) -> bool {
        matches!(self.0.vertices.slice(), VertexSlice::F32(_))
    }

    /// Returns a mesh that borrows its arrays from shared bytes. They are not copied, and only the
    /// array of the frame is read. `parts` has the range of each array in `bytes`, and
    /// `is_single_precision` tells the precision of the positions.
    ///
    /// The content of the bytes is trusted. If it is not what [`parts`](Self::parts) returned,
    /// answers may be wrong, and queries may panic or never end. Nothing outside the bytes is ever
    /// read or written. Call [`validate`](Self::validate) for bytes that you do not trust.
    ///
    /// # Errors
    /// If an array does not fit, as described at [`Flaw::Shape`].
    ///
    /// # Complexity
    /// Constant time but for a list of empty slots for packets: 8 bytes for 64 triangles.
    pub fn borrow(bytes: &SharedBytes, is_single_precision: bool, parts: &Parts<Range<usize>>) -> Result<Self, Flaw> {
        let vertices = if is_single_precision {
            Vertices::BorrowedF32(part(bytes, &parts.positions, "positions")?, OnceLock::new())
        } else {
            Vertices::BorrowedF64(part(bytes, &parts.positions, "positions")?, OnceLock::new())
        };
        let frame: Buffer<PackedFrame> = part(bytes, &parts.frame, "frame")?;
        let &[frame] = &frame[..] else { return Err(Flaw::Shape { part: "frame" }) };
        let faces = Arc::new(part(bytes, &parts.faces, "faces")?);
        let tree = WideTree::from_nodes(part(bytes, &parts.nodes, "nodes")?);
        let leaves = Arc::new(part(bytes, &parts.leaves, "leaves")?);
        Ok(Self(Arc::new(Data::new(vertices, faces, frame, tree, leaves))))
    }

    /// Checks that the mesh is valid: [`new`](Self::new) would accept its vertices and faces, its
    /// nodes are a tree of bounded depth, and each face is in exactly one leaf. All boxes and slabs
    /// must be equal, bit by bit, to those that a [`refit`](Self::refit) to the same vertices would
    /// compute. A mesh that was not [borrowed](Self::borrow) is always valid.
    ///
    /// # Errors
    /// The first flaw that is found.
    ///
    /// # Complexity
    /// Linear for any content of the arrays, on all cores of the current rayon pool; little more
    /// than a refit.
    pub fn validate(&self) -> Result<(), Flaw> {
        let data = &*self.0;
        let extremes = validate(data.vertices.slice(), &data.faces).map_err(Flaw::Input)?;
        // Bits are compared, as zeros of either sign are equal.
        let frame = PackedFrame::over(&extremes);
        if bytemuck::bytes_of(&frame) != bytemuck::bytes_of(&data.frame) {
            return Err(Flaw::Frame);
        }
        if !data.tree.is_sound(data.leaves.len()) {
            return Err(Flaw::Tree);
        }
        each_face_once(&data.leaves, data.faces.len())?;
        let patches = Patches::of(&data.tree, data.leaves.len());
        let moved = Moved { vertices: data.vertices.slice(), faces: &data.faces, frame: &frame };
        let is_fitted = |(nodes, corners): &mut (_, _), patch| data.is_fitted(&moved, patch, nodes, corners);
        let are_fitted = patches.patches.par_iter().map_init(Default::default, is_fitted);
        match are_fitted.position_first(|is_fitted| !is_fitted) {
            Some(unfit) => Err(Flaw::Bounds { node: patches.patches[unfit].nodes.start }),
            None if !patches.are_fitted_above(data.tree.nodes()) => Err(Flaw::Bounds { node: 0 }),
            None => Ok(()),
        }
    }
}

impl Data {
    /// Reports whether a refit would change no bit of a patch. `refitted` and `corners` are buffers
    /// that calls reuse.
    fn is_fitted(
        &self,
        moved: &Moved<'_>,
        patch: &Patch,
        refitted: &mut Vec<Node>,
        corners: &mut Vec<CornerLanes>,
    ) -> bool {
        let (nodes, leaves) = (&self.tree.nodes()[patch.nodes.clone()], &self.leaves[patch.leaves.clone()]);
        refitted.clear();
        refitted.extend_from_slice(nodes);
        moved.fit_subtree(best_level(), patch, refitted, leaves, corners);
        bytemuck::cast_slice::<_, u8>(refitted) == bytemuck::cast_slice::<_, u8>(nodes)
    }
}

/// Returns a part of the bytes as an array, or the flaw that it does not fit.
fn part<T: bytemuck::Pod>(bytes: &SharedBytes, range: &Range<usize>, part: &'static str) -> Result<Buffer<T>, Flaw> {
    Buffer::borrow(bytes.clone(), range.clone()).ok_or(Flaw::Shape { part })
}

/// Checks that each of `faces` faces is in exactly one leaf, and that the leaf has it once.
fn each_face_once(leaves: &[Leaf], faces: usize) -> Result<(), Flaw> {
    // One byte per face, which is only written. Bits would make threads wait for each other, and a
    // thread for its own writes.
    let mut seen: Vec<AtomicBool> = (0..faces).map(|_| AtomicBool::new(false)).collect();
    let see = |&face: &u32| seen.get(face as usize).map(|seen| seen.store(true, Ordering::Relaxed)).is_some();
    // All lanes, as unused lanes repeat the first face.
    let count = |leaf: &Leaf| (leaf.is_sound() && leaf.faces.iter().all(see)).then(|| leaf.count());
    let held: Option<usize> = leaves.par_iter().with_min_len(CHUNK).map(count).sum();
    // If the leaves hold as many faces as there are, and each face is seen, then none is held
    // twice.
    let are_seen = |seen: &mut [AtomicBool]| seen.iter_mut().fold(true, |all, seen| all & *seen.get_mut());
    let is_each = held == Some(faces) && seen.par_chunks_mut(CHUNK).all(are_seen);
    if is_each { Ok(()) } else { Err(Flaw::Faces) }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape { part } => write!(
                f,
                "the array of {part} lies outside the bytes, is misaligned, or is not a whole number of elements"
            ),
            Self::Input(error) => error.fmt(f),
            Self::Frame => write!(f, "the packed frame is not that of the vertices"),
            Self::Tree => write!(f, "the nodes are not a tree of bounded depth over the leaves"),
            Self::Faces => write!(f, "the leaves do not hold each face exactly once"),
            Self::Bounds { node } => {
                write!(f, "boxes or slabs of node {node} or below it are not those of the vertices")
            }
        }
    }
}

impl std::error::Error for Flaw {}

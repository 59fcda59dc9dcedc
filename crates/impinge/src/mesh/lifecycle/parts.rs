//! The arrays that a mesh consists of, to be stored somewhere, and a mesh over such arrays that somebody else keeps.

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

/// One of something for each array that a mesh consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts<T> {
    /// How the packed frame lies in the mesh's own.
    pub frame: T,
    /// Three numbers a vertex, of the precision that goes with them.
    pub positions: T,
    /// Three vertices a face, 32 bits each.
    pub faces: T,
    /// The nodes of the hierarchy.
    pub nodes: T,
    /// Its leaves.
    pub leaves: T,
}

/// Why arrays are not a mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Flaw {
    /// An array lies outside the bytes, is not a whole number of elements, or is not aligned for them.
    Shape {
        /// Which array, by the name of its field in [`Parts`].
        part: &'static str,
    },
    /// The vertices or the faces would be refused by [`Mesh::new`].
    Input(InputError),
    /// The frame is not that of the vertices.
    Frame,
    /// The nodes are no tree over the leaves, or too deep.
    Tree,
    /// A leaf holds a face that there is not, or that another one holds.
    Faces,
    /// A box, slab or leaf is not what it is for these vertices.
    Bounds {
        /// The node from which on it was found.
        node: usize,
    },
}

impl Mesh {
    /// The version of the form that [`parts`](Self::parts) have, which is one on all machines whose numbers are
    /// little-endian: it changes whenever a build makes other bits of the same arrays.
    pub const PARTS_VERSION: u32 = 4;

    /// No array needs a larger alignment, in bytes.
    pub const PARTS_ALIGNMENT: usize = align_of::<Node>();

    /// The arrays that the mesh consists of, as they are in memory.
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

    /// Whether the vertices are kept in single precision: four bytes a coordinate, else eight.
    #[must_use]
    pub fn is_single_precision(&self) -> bool {
        matches!(self.0.vertices.slice(), VertexSlice::F32(_))
    }

    /// A mesh over arrays in somebody's bytes, which are not copied, nor looked at except for the frame's.
    ///
    /// The bytes are believed: where they are not what [`parts`](Self::parts) gave, answers may be wrong, and questions may panic
    /// or go on without end. Nothing is ever read or written outside them. [`validate`](Self::validate) removes all doubt.
    ///
    /// # Errors
    /// An array that does not fit.
    ///
    /// # Complexity
    /// Nothing is read; a list of empty places for packets is made, 8 bytes for 64 triangles.
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

    /// Whether the mesh is one: its vertices and faces are such as [`new`](Self::new) takes, its nodes are a tree of bounded depth,
    /// each face is in one leaf, and all boxes and slabs are to the bit those that a [`refit`](Self::refit) to the same
    /// vertices would make. A mesh that was not [borrowed](Self::borrow) always is.
    ///
    /// # Errors
    /// What is wrong first.
    ///
    /// # Complexity
    /// Linear whatever the arrays hold, on all cores of the current rayon pool; hardly more than a refit.
    pub fn validate(&self) -> Result<(), Flaw> {
        let data = &*self.0;
        let extremes = validate(data.vertices.slice(), &data.faces).map_err(Flaw::Input)?;
        // Bits, as zeros compare equal whatever their sign.
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
    /// Whether a refit would not change a bit of a patch. `refitted` and `corners` are room that is used again.
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
        moved.fit_patch(best_level(), patch, refitted, leaves, corners);
        bytemuck::cast_slice::<_, u8>(refitted) == bytemuck::cast_slice::<_, u8>(nodes)
    }
}

fn part<T: bytemuck::Pod>(bytes: &SharedBytes, range: &Range<usize>, part: &'static str) -> Result<Buffer<T>, Flaw> {
    Buffer::borrow(bytes.clone(), range.clone()).ok_or(Flaw::Shape { part })
}

/// Each of this many faces is in one leaf, which has no other.
fn each_face_once(leaves: &[Leaf], faces: usize) -> Result<(), Flaw> {
    // A byte each, which is only ever written: threads that set bits of one number wait for each other, and one for itself.
    let mut seen: Vec<AtomicBool> = (0..faces).map(|_| AtomicBool::new(false)).collect();
    let see = |&face: &u32| seen.get(face as usize).map(|seen| seen.store(true, Ordering::Relaxed)).is_some();
    // All lanes, as those that are not in use repeat the first.
    let count = |leaf: &Leaf| (leaf.is_sound() && leaf.faces.iter().all(see)).then(|| leaf.count());
    let held: Option<usize> = leaves.par_iter().with_min_len(CHUNK).map(count).sum();
    // As many as there are, and each of them, is none twice.
    let are_seen = |seen: &mut [AtomicBool]| seen.iter_mut().fold(true, |all, seen| all & *seen.get_mut());
    let is_each = held == Some(faces) && seen.par_chunks_mut(CHUNK).all(are_seen);
    if is_each { Ok(()) } else { Err(Flaw::Faces) }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape { part } => write!(f, "the array of {part} does not fit"),
            Self::Input(error) => error.fmt(f),
            Self::Frame => write!(f, "the packed frame is not that of the vertices"),
            Self::Tree => write!(f, "the nodes are not a tree over the leaves"),
            Self::Faces => write!(f, "the leaves do not hold each face once"),
            Self::Bounds { node } => {
                write!(f, "boxes or slabs below node {node} are not those of the vertices")
            }
        }
    }
}

impl std::error::Error for Flaw {}

//! Builds a mesh: a builder lays out the faces, and the code of a refit fits the boxes and slabs to
//! the vertices.
//!
//! Guarded by `a_refit_to_the_same_positions_changes_no_bit` in `engine/moving.rs` and by the
//! benchmark `headline`.

use std::sync::Arc;

use rayon::prelude::*;

use super::face_boxes::FaceBoxes;
use super::moved::Moved;
use super::validate::validate;
use crate::hierarchy::{BinaryTree, Bounds, Builder, WideTree, tree_along_curve};
use crate::input::{InputError, InputErrorKind};
use crate::mesh::storage::frame::PackedFrame;
use crate::mesh::storage::leaf::{CHUNK, Leaf};
use crate::mesh::storage::positions::{Positions, VertexSlice, Vertices};
use crate::mesh::storage::stored_corners::{Corners, StoredCorners};
use crate::mesh::triangle_mesh::{Data, Mesh};
use crate::storage::{Buffer, Pages};

impl Mesh {
    /// Validates the arrays and builds the hierarchy. Vectors are moved into the mesh without a
    /// copy; slices and arrays are copied.
    ///
    /// ```
    /// use impinge::{Mesh, query};
    ///
    /// let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(corners, [[0, 1, 2]])?;
    /// assert!(query::intersects(&mesh, &mesh));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// Double precision positions that single precision represents exactly are stored in single
    /// precision, which changes no answer.
    ///
    /// # Errors
    /// If a coordinate is not finite or not below 2^128 in magnitude, if a face names a vertex that
    /// does not exist, if there are 2^32 vertices or 2^29 faces or more, or if there is not enough
    /// memory for the hierarchy. Nothing is repaired and nothing is dropped.
    ///
    /// # Complexity
    /// O(n log n), on all cores of the current rayon pool.
    pub fn new(positions: impl Into<Positions>, faces: impl Into<Vec<[u32; 3]>>) -> Result<Self, InputError> {
        Self::with_builder(positions, faces, Builder::default())
    }

    /// Builds a mesh as [`new`](Self::new) does, with the hierarchy from another builder, which
    /// changes no answer.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// # Complexity
    /// As [`Builder::build`].
    pub fn with_builder(
        positions: impl Into<Positions>,
        faces: impl Into<Vec<[u32; 3]>>,
        builder: Builder,
    ) -> Result<Self, InputError> {
        let (positions, faces) = (positions.into(), faces.into());
        let frame = PackedFrame::over(&validate(positions.slice(), &faces)?);
        check_memory(faces.len())?;
        let vertices = Vertices::Given(positions.narrowed());
        let (tree, leaves) = built(vertices.slice(), &faces, &frame, builder);
        Ok(Self(Arc::new(Data::new(vertices, Arc::new(faces.into()), frame, tree, Arc::new(leaves)))))
    }
}

/// Number of bytes per face that must be available for a build. The default builder of large meshes
/// keeps a center and a scratch center of 16 bytes each, a place in the order of 4 bytes, and at
/// most 28 bytes of nodes and leaves. If the number is too small, a build may end the process for
/// want of memory; if it is too large, a build that would succeed is refused.
const BUILD_BYTES_PER_FACE: usize = 64;

/// Checks that the arrays that a build allocates can be allocated, before it begins.
///
/// # Errors
/// [`OutOfMemory`](InputErrorKind::OutOfMemory) if not.
fn check_memory(faces: usize) -> Result<(), InputError> {
    let mut room: Vec<u8> = Vec::new();
    let refused = InputErrorKind::OutOfMemory { what: "faces", count: faces };
    room.try_reserve_exact(faces.saturating_mul(BUILD_BYTES_PER_FACE)).map_err(|_| InputError::new(refused))
}

/// Builds the tree of the faces. Returns it with its leaves.
pub(in crate::mesh) fn built(
    vertices: VertexSlice<'_>,
    faces: &[[u32; 3]],
    frame: &PackedFrame,
    builder: Builder,
) -> (WideTree, Buffer<Leaf>) {
    let moved = Moved { vertices, faces, frame };
    match Corners::of(vertices, faces, *frame) {
        Corners::Single(stored) => built_from(&moved, stored, builder),
        Corners::SingleWidened(stored) => built_from(&moved, stored, builder),
        Corners::Double(stored) => built_from(&moved, stored, builder),
    }
}

/// Builds the tree for one kind of stored vertices.
fn built_from(moved: &Moved<'_>, stored: impl StoredCorners, builder: Builder) -> (WideTree, Buffer<Leaf>) {
    let boxes = FaceBoxes(stored);
    match builder.strategy(moved.faces.len()) {
        // The only builder that uses nothing but the centers of boxes.
        Builder::Morton => fitted(moved, &tree_along_curve(&boxes, no_bounds)),
        strategy => fitted(moved, &strategy.build(&boxes.listed())),
    }
}

/// Stores nothing about the boxes of a group. It is a function rather than a closure, so that all
/// kinds of vertices share one builder, which is compiled once.
fn no_bounds(_: &[u32]) {}

/// Returns the wide tree and its leaves in the layout of the binary tree, fitted to the vertices.
fn fitted<B: Bounds>(moved: &Moved<'_>, binary: &BinaryTree<B>) -> (WideTree, Buffer<Leaf>) {
    let (mut tree, places) = WideTree::collapse(binary);
    let mut leaves = Pages::zeroed(places.len());
    let placed = leaves.to_mut().par_iter_mut().zip(&places).with_min_len(CHUNK);
    placed.for_each(|(leaf, &place)| *leaf = Leaf::holding(binary.held(place)));
    moved.fit(&mut tree, &leaves);
    (tree, leaves)
}

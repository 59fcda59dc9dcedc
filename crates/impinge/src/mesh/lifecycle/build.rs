//! Building: a builder lays the faces out, and what a refit does fits all to the vertices.

use std::sync::Arc;

use rayon::prelude::*;

use super::face_boxes::FaceBoxes;
use super::moved::Moved;
use super::validate::validate;
use crate::hierarchy::{BinaryTree, Bounds, Builder, WideTree, tree_along_curve};
use crate::input::InputError;
use crate::mesh::storage::frame::PackedFrame;
use crate::mesh::storage::leaf::{CHUNK, Leaf};
use crate::mesh::storage::positions::{Positions, VertexSlice, Vertices};
use crate::mesh::storage::stored_corners::{Corners, StoredCorners};
use crate::mesh::triangle_mesh::{Data, Mesh};
use crate::storage::{Buffer, Pages};

impl Mesh {
    /// Judges, packs and builds. Vectors are taken without copying them; slices and arrays are copied.
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
    /// Double precision positions that are all representable in single precision are stored so, which changes no
    /// answer.
    ///
    /// # Errors
    /// A coordinate that is not finite or not below 2^128 in magnitude; an index without a vertex; more vertices or
    /// faces than can be numbered. Nothing is repaired and nothing is dropped.
    ///
    /// # Complexity
    /// O(n log n), on all cores of the current rayon pool.
    pub fn new(positions: impl Into<Positions>, faces: impl Into<Vec<[u32; 3]>>) -> Result<Self, InputError> {
        Self::with_builder(positions, faces, Builder::default())
    }

    /// As [`new`](Self::new), with the hierarchy built by another strategy, which changes no answer.
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
        let vertices = Vertices::Given(positions.narrowed());
        let (tree, leaves) = built(vertices.slice(), &faces, &frame, builder);
        Ok(Self(Arc::new(Data::new(vertices, Arc::new(faces.into()), frame, tree, Arc::new(leaves)))))
    }
}

/// The tree of the faces and its leaves.
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

fn built_from(moved: &Moved<'_>, stored: impl StoredCorners, builder: Builder) -> (WideTree, Buffer<Leaf>) {
    let boxes = FaceBoxes(stored);
    match builder.strategy(moved.faces.len()) {
        // The one that looks at centres alone.
        Builder::Morton => fitted(moved, &tree_along_curve(&boxes, no_bounds)),
        strategy => fitted(moved, &strategy.build(&boxes.listed())),
    }
}

/// Keeps nothing of the boxes of a group. It is a function rather than a closure, so that all kinds
/// of vertices share one builder, which is compiled once.
fn no_bounds(_: &[u32]) {}

/// The wide tree and its leaves, laid out as the binary tree says.
fn fitted<B: Bounds>(moved: &Moved<'_>, binary: &BinaryTree<B>) -> (WideTree, Buffer<Leaf>) {
    let (mut tree, places) = WideTree::collapse(binary);
    let mut leaves = Pages::zeroed(places.len());
    let placed = leaves.to_mut().par_iter_mut().zip(&places).with_min_len(CHUNK);
    placed.for_each(|(leaf, &place)| *leaf = Leaf::holding(binary.held(place)));
    moved.fit(&mut tree, &leaves);
    (tree, leaves)
}

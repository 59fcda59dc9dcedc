//! Building: a builder lays the faces out, and what a refit does fits all to the vertices.

use rayon::prelude::*;

use super::face_boxes::FaceBoxes;
use super::frame::PackedFrame;
use super::leaf::Leaf;
use super::positions::VertexSlice;
use super::refit::Moved;
use super::stored_corners::{Corners, StoredCorners};
use crate::hierarchy::{BinaryTree, Bounds, Builder, WideTree, tree_along_curve};
use crate::storage::{Buffer, Pages};

/// The tree of the faces and its leaves.
pub(super) fn built(
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
    let placed = leaves.to_mut().par_iter_mut().zip(&places).with_min_len(super::CHUNK);
    placed.for_each(|(leaf, &place)| *leaf = Leaf::holding(binary.held(place)));
    moved.fit(&mut tree, &leaves);
    (tree, leaves)
}

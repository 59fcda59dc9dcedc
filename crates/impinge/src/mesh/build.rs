//! Building: a builder lays the faces out, and what a refit does fits all to the vertices.

use rayon::prelude::*;

use super::face_boxes::FaceBoxes;
use super::frame::PackedFrame;
use super::leaf::Leaf;
use super::positions::VertexSlice;
use super::refit::Moved;
use crate::hierarchy::{BinaryTree, Bounds, Builder, Keyed, WideTree};
use crate::simd::LANES;
use crate::storage::{Buffer, Room, Space};

/// The tree of the faces and its leaves.
pub(super) fn built(
    vertices: VertexSlice<'_>,
    faces: &[[u32; 3]],
    frame: &PackedFrame,
    builder: Builder,
) -> (WideTree, Buffer<Leaf>) {
    let moved = Moved { vertices, faces, frame };
    let of_vertices = Space::of::<[f32; 4]>(vertices.len());
    // Nearly all leaves are full; an eighth more is more than there ever are.
    let lasting = size_of::<Leaf>() * (faces.len() / LANES + faces.len() / (8 * LANES) + 1);
    match builder.strategy(faces.len()) {
        // The one that looks at centres alone, and sorts where the vertices were.
        Builder::Morton => {
            let mut room_of_keys = Room::new(Keyed::space(faces.len()), 0);
            let mut room = Room::new(of_vertices.max(Keyed::space_to_sort(faces.len())), lasting);
            let mut space = room.space();
            let boxes = FaceBoxes::of(vertices, faces, frame, space.rest().take(vertices.len()));
            let layout: BinaryTree<()> = Keyed::of(&boxes, &mut room_of_keys.space()).tree(|_| (), &mut space);
            drop(room_of_keys);
            fitted(&moved, &layout, room)
        }
        strategy => {
            let mut room = Room::new(of_vertices, lasting);
            let boxes = FaceBoxes::of(vertices, faces, frame, room.space().take(vertices.len())).listed();
            fitted(&moved, &strategy.build(&boxes), room)
        }
    }
}

/// The wide tree and its leaves, laid out as the binary tree says.
fn fitted<B: Bounds>(moved: &Moved<'_>, binary: &BinaryTree<B>, room: Room) -> (WideTree, Buffer<Leaf>) {
    let (mut tree, places) = WideTree::collapse(binary);
    let mut leaves = room.into_buffer(places.len());
    let placed = leaves.to_mut().par_iter_mut().zip(&places).with_min_len(super::CHUNK);
    placed.for_each(|(leaf, &place)| *leaf = Leaf::holding(binary.held(place)));
    moved.fit(&mut tree, &leaves);
    (tree, leaves)
}

//! Building: a builder lays the faces out, and what a refit does fits all to the vertices.

use super::face_boxes::FaceBoxes;
use super::frame::PackedFrame;
use super::packet::Packet;
use super::positions::VertexSlice;
use super::refit::Moved;
use crate::hierarchy::{BinaryTree, Bounds, Builder, Keyed, WideTree};
use crate::simd::LANES;
use crate::storage::{Buffer, Room, Space};

/// The tree of the faces and the packets of its leaves.
pub(super) fn built(
    vertices: VertexSlice<'_>,
    faces: &[[u32; 3]],
    frame: &PackedFrame,
    builder: Builder,
) -> (WideTree, Buffer<Packet>) {
    let moved = Moved { vertices, faces, frame };
    let of_vertices = Space::of::<[f32; 4]>(vertices.len());
    // Nearly all leaves are full; an eighth more is more than there ever are.
    let lasting = size_of::<Packet>() * (faces.len() / LANES + faces.len() / (8 * LANES) + 1);
    match builder.strategy(faces.len()) {
        // The one that looks at centres alone, and sorts where the vertices were.
        Builder::Morton => {
            let of_keys = Keyed::space(faces.len());
            let mut room = Room::new(of_keys + of_vertices.max(Keyed::space_to_sort(faces.len())), lasting);
            let mut space = room.space();
            let mut space_of_keys = space.part(of_keys);
            let boxes = FaceBoxes::of(vertices, faces, frame, space.rest().take(vertices.len()));
            let layout: BinaryTree<()> = Keyed::of(&boxes, &mut space_of_keys).tree(|_| (), &mut space);
            fitted(&moved, &layout, room)
        }
        strategy => {
            let mut room = Room::new(of_vertices, lasting);
            let boxes = FaceBoxes::of(vertices, faces, frame, room.space().take(vertices.len())).listed();
            fitted(&moved, &strategy.build(&boxes), room)
        }
    }
}

/// The wide tree and its packets, laid out as the binary tree says.
fn fitted<B: Bounds>(moved: &Moved<'_>, binary: &BinaryTree<B>, room: Room) -> (WideTree, Buffer<Packet>) {
    let (mut tree, leaves) = WideTree::collapse(binary);
    let mut packets = room.into_buffer(leaves.len());
    moved.fit(&mut tree, packets.to_mut(), |work| {
        for (packet, &leaf) in work.leaves.iter_mut().zip(&leaves[work.patch.leaves.clone()]) {
            packet.lay(binary.held(leaf));
        }
    });
    (tree, packets)
}

//! The block of geometry: meshes, the look of each part, and curves.

use super::curves::Curves;
use super::integers::{push_integer, push_numbers};
use super::parts::{Drawn, Look};

/// Code of a part that is not drawn. Meshes have the codes from [`FIRST_MESH`].
const NOTHING: u64 = 0;
/// Code of a part that is drawn as a box.
const BOX: u64 = 1;
/// Code of a part that is drawn as the first mesh.
const FIRST_MESH: u64 = 2;

/// Returns the bytes that `viewer/src/data/geometry.ts` reads.
pub(super) fn bytes(drawn: &Drawn, curves: &Curves) -> Vec<u8> {
    let mut bytes = Vec::new();
    push_integer(&mut bytes, drawn.meshes.len() as u64);
    drawn.meshes.iter().for_each(|mesh| mesh.push(&mut bytes));
    push_integer(&mut bytes, drawn.looks.len() as u64);
    for look in &drawn.looks {
        match look {
            Look::Nothing => push_integer(&mut bytes, NOTHING),
            Look::Box(corners) => {
                push_integer(&mut bytes, BOX);
                push_numbers(&mut bytes, corners.iter().flatten());
            }
            Look::Mesh(number, pose) => {
                push_integer(&mut bytes, FIRST_MESH + *number as u64);
                push_numbers(&mut bytes, pose.linear().iter().flatten().chain(pose.translation()));
            }
        }
    }
    curves.push(&mut bytes);
    bytes
}

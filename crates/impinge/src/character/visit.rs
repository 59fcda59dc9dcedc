//! Positions of vertices in the frames of their parts.

use super::rig::Rig;
use super::rig_pose::RigPose;
use super::samples::PartVertices;
use super::skin::blended;
use super::transform::{Matrix, apply_transposed, matrix, times};
use crate::math::vec3::{Vector, sub};

/// Calls `show` with the part, the vertex and its position in the frame of its part, for all
/// vertices of the parts.
pub(super) fn visit_positions(
    rig: &Rig,
    pose: &RigPose,
    held: &[PartVertices],
    mut show: impl FnMut(usize, u32, Vector),
) {
    let palette = rig.skin().palette(pose.bones());
    let mut morphed = Vec::new();
    rig.skin().morphed(pose.morph_weights(), &mut morphed);
    // The palette in the frame of the current part. Only the entries that its vertices use are
    // computed, because there may be many parts and many joints.
    let mut local = palette.clone();
    let mut part_of_entry = vec![usize::MAX; palette.len()];
    for (at, part) in held.iter().enumerate() {
        let bone = &pose.bones()[part.anchor as usize];
        let (rotation, origin) = (matrix(bone.rotation_wxyz), bone.origin());
        let transposed = [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[j][i]));
        for &vertex in &part.vertices {
            let influences = rig.skin().influences(vertex);
            for joint in influences.iter().map(|influence| influence.joint as usize) {
                if part_of_entry[joint] != at {
                    part_of_entry[joint] = at;
                    let (linear, offset): &(Matrix, Vector) = &palette[joint];
                    local[joint] = (times(&transposed, linear), apply_transposed(&rotation, sub(offset, &origin)));
                }
            }
            show(at, vertex, blended(&local, influences, morphed[vertex as usize]));
        }
    }
}

//! Rigid frames of bones.

use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;

use super::transform::{apply, matrix, normalized};
use crate::math::vec3::{Vector, add, sub};

/// The rigid frame of a bone: a rotation and an origin in the world. Scales of the bone are left
/// out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub(super) rotation_wxyz: [f64; 4],
    pub(super) rotation: [[f64; 3]; 3],
    pub(super) origin: [f64; 3],
}

impl Frame {
    /// Builds the frame with a rotation (w, x, y, z) of length 1.
    pub(super) fn new(rotation_wxyz: [f64; 4], origin: Vector) -> Self {
        Self { rotation_wxyz, rotation: matrix(rotation_wxyz), origin }
    }

    /// Maps a point from this frame to the world, rounded.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        add(&apply(&self.rotation, point), &self.origin)
    }

    /// Maps a point from the world to this frame, rounded.
    #[must_use]
    pub fn local(&self, point: [f64; 3]) -> [f64; 3] {
        super::transform::apply_transposed(&self.rotation, sub(&point, &self.origin))
    }

    /// Returns the frame as a pose, which maps this frame to the world.
    ///
    /// # Errors
    /// Returns an error if the origin is out of range, which it never is for poses of a rig.
    pub fn pose(&self) -> Result<Pose, InputError> {
        Pose::new(self.rotation, self.origin)
    }
}

/// Returns the frame of a pose, and its error: a bound on the distance between the images of a
/// point under the frame and the pose. The bound holds for points within one unit of the origin.
///
/// # Errors
/// Returns an error if the pose is not a rotation within 1e-4, or if it mirrors.
pub(super) fn frame_of(pose: &Pose) -> Result<(Frame, f64), InputError> {
    const MAX_DEVIATION: f64 = 1e-4;
    let m = pose.linear();
    let [a, b, c] = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    let [d, e, f] = [m[0][1] + m[1][0], m[1][2] + m[2][1], m[2][0] + m[0][2]];
    let (p, q, r) = (m[0][0], m[1][1], m[2][2]);
    // Four expressions for the same quaternion with different lengths. The longest is the most
    // accurate.
    let candidates = [
        [1.0 + p + q + r, a, b, c],
        [a, 1.0 + p - q - r, d, f],
        [b, d, 1.0 - p + q - r, e],
        [c, f, e, 1.0 - p - q + r],
    ];
    let longest = (0..4).max_by(|&i, &j| candidates[i][i].total_cmp(&candidates[j][j])).unwrap_or(0);
    let rotation = normalized(candidates[longest]).unwrap_or([1.0, 0.0, 0.0, 0.0]);
    let frame = Frame::new(rotation, *pose.translation());
    let difference = (0..9).map(|k| (frame.rotation[k / 3][k % 3] - m[k / 3][k % 3]).powi(2)).sum::<f64>().sqrt();
    if difference > MAX_DEVIATION {
        return Err(InputError::new(InputErrorKind::NotRigid { deviation: 2.0 * difference }));
    }
    Ok((frame, difference))
}

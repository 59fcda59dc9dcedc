//! What every exact arithmetic answers about the six corners of a pair of triangles.

use crate::math::Sign;

/// The corners of a triangle in the frame of its mesh; single precision is widened, which loses nothing.
pub type Corners = [[f64; 3]; 3];

/// Six corners with exact coordinates in some frame.
pub(super) trait ExactPoints {
    /// The sign of `det(q - p, r - p, s - p)` of corners `[p, q, r, s]`.
    fn orient3d(&self, corners: [usize; 4]) -> Sign;

    /// The sign of `det(q - p, r - p)` of corners `[p, q, r]`, projected along an axis.
    fn orient2d(&self, axis: usize, corners: [usize; 3]) -> Sign;

    /// How corner `p` compares to `q` along an axis, of `[p, q]`.
    fn compare(&self, axis: usize, corners: [usize; 2]) -> Sign;
}

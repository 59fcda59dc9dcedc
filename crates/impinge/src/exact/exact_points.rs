//! The trait that every exact arithmetic implements: signs of determinants and comparisons of the
//! six corners of a pair of triangles.

use crate::math::Sign;

/// The corners of a triangle in the frame of its mesh. Coordinates in single precision are widened,
/// which is exact.
pub type Corners = [[f64; 3]; 3];

/// Six corners with exact coordinates in some frame.
pub(super) trait ExactPoints {
    /// Returns the sign of `det(q - p, r - p, s - p)` for corners `[p, q, r, s]`.
    fn orient3d(&self, corners: [usize; 4]) -> Sign;

    /// Returns the sign of `det(q - p, r - p)` for corners `[p, q, r]`, projected along an axis.
    fn orient2d(&self, axis: usize, corners: [usize; 3]) -> Sign;

    /// Compares corner `p` with corner `q` along an axis, for corners `[p, q]`.
    fn compare(&self, axis: usize, corners: [usize; 2]) -> Sign;
}

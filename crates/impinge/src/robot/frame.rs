//! Rigid maps of links while they are composed: plain matrices, which become poses at the end.

use crate::math::Pose;

/// The first three rows of an affine matrix. The last column is the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame(pub(super) [[f64; 4]; 3]);

impl Frame {
    pub(super) const IDENTITY: Self = Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    pub(super) fn new(linear: [[f64; 3]; 3], translation: [f64; 3]) -> Self {
        Self(std::array::from_fn(|i| [linear[i][0], linear[i][1], linear[i][2], translation[i]]))
    }

    pub(super) fn of(pose: &Pose) -> Self {
        Self::new(*pose.linear(), *pose.translation())
    }

    /// Returns the map that applies `inner` first and then this map. Each entry is rounded as that
    /// of [`Pose::compose`].
    pub(super) fn after(&self, inner: &Self) -> Self {
        let [a, b, c] = &inner.0;
        Self(self.0.map(|[x, y, z, t]| {
            let mut row: [f64; 4] = std::array::from_fn(|k| x * a[k] + y * b[k] + z * c[k]);
            row[3] += t;
            row
        }))
    }

    /// Returns this map after a translation of its inner frame.
    pub(super) fn translated(&self, by: [f64; 3]) -> Self {
        Self(self.0.map(|[x, y, z, t]| [x, y, z, x * by[0] + y * by[1] + z * by[2] + t]))
    }

    /// Returns the image of a point, rounded as that of [`Pose::apply`].
    #[inline]
    pub(super) fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.0.map(|[a, b, c, t]| a * x + b * y + c * z + t)
    }

    /// Returns the image of an offset.
    #[inline]
    pub(super) fn turn(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.0.map(|[a, b, c, _]| a * x + b * y + c * z)
    }

    /// Returns the gradient, in the inner frame, of the height of images along a direction.
    #[inline]
    pub(super) fn along(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [p, q, r] = &self.0;
        std::array::from_fn(|k| x * p[k] + y * q[k] + z * r[k])
    }

    /// Returns the pose of this map, or `None` if an entry is out of range.
    pub(super) fn pose(&self) -> Option<Pose> {
        Pose::new(self.0.map(|[x, y, z, _]| [x, y, z]), self.0.map(|row| row[3])).ok()
    }
}

/// Returns the rotation about an axis of length 1 by an angle, right-handed. If the axis is a
/// coordinate axis, the entries are exactly 0, 1, and the sine and cosine with a sign.
///
/// # Source
/// The formula of Rodrigues, with the diagonal written so that it is 1 along a coordinate axis.
pub(super) fn rotation(axis: [f64; 3], [sine, cosine]: [f64; 2]) -> [[f64; 3]; 3] {
    let squares = axis.map(|x| x * x);
    let mut rows = [[0.0; 3]; 3];
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        rows[i][i] = squares[i] + cosine * (squares[j] + squares[k]);
        let (both, turned) = (axis[i] * axis[j] * (1.0 - cosine), axis[k] * sine);
        rows[i][j] = both - turned;
        rows[j][i] = both + turned;
    }
    rows
}

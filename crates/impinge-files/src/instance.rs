//! Affine maps in f64, and limits for files that instantiate the same mesh many times.

use crate::error::{LoadError, LoadErrorKind};

/// An affine map. `rows[i]` holds the linear part of coordinate i and, last, its translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affine {
    pub(crate) rows: [[f64; 4]; 3],
}

impl Affine {
    pub(crate) const IDENTITY: Self = Self { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// Returns the map that applies `first` and then this map.
    pub(crate) fn after(&self, first: &Self) -> Self {
        let rows = self.rows.map(|[x, y, z, t]| {
            let [a, b, c] = first.rows;
            let mut row = [0, 1, 2, 3].map(|k| x * a[k] + y * b[k] + z * c[k]);
            row[3] += t;
            row
        });
        Self { rows }
    }

    /// Returns the image of a point.
    pub(crate) fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.rows.map(|[a, b, c, t]| a * x + b * y + c * z + t)
    }

    /// Reports whether the map mirrors: its determinant is negative.
    pub(crate) fn mirrors(&self) -> bool {
        let [[a, b, c, _], [d, e, f, _], [g, h, i, _]] = self.rows;
        a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0
    }
}

/// Maximum number of items that the instances of a file may add up to. For vertices and triangles
/// it is 2^24, or four per byte of the file if that is more. Without a limit, a file of a few
/// hundred bytes could take any amount of memory. Real assemblies stay far below.
#[derive(Clone, Copy)]
pub(crate) struct Budget(u64);

impl Budget {
    /// Returns the budget for vertices, triangles and similar items: 2^24, or 4 per byte of the
    /// file if that is more.
    pub(crate) fn for_bytes(bytes: u64) -> Self {
        Self(bytes.saturating_mul(4).clamp(1 << 24, u64::from(u32::MAX)))
    }

    /// Returns the budget for the bytes of all part names: 2^24, or 32 per byte of the file if that
    /// is more. A name has at most [`MAX_NAME`](crate::text::MAX_NAME) bytes, and a node that is
    /// used once takes at least 10 bytes.
    pub(crate) fn for_names(bytes: u64) -> Self {
        Self(bytes.saturating_mul(32).clamp(1 << 24, u64::from(u32::MAX)))
    }

    /// Returns the budget for visited nodes, counted once for each path that reaches them: 2^20, or
    /// one per byte of the file if that is more. A node that is reached once takes more than one
    /// byte.
    pub(crate) fn for_nodes(bytes: u64) -> Self {
        Self(bytes.clamp(1 << 20, u64::from(u32::MAX)))
    }

    /// Returns an error if `count` exceeds the budget; `what` names the items.
    pub(crate) fn check(self, what: &'static str, count: u64) -> Result<(), LoadError> {
        if count <= self.0 {
            return Ok(());
        }
        let error = LoadError::new(LoadErrorKind::TooMany { what, count, limit: self.0 });
        Err(error.with_hint("counted over all instances; load a file with fewer instances"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_compose_right_to_left() {
        let rotate = Affine { rows: [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };
        let move_x = Affine { rows: [[1.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };
        let p = [1.0, 2.0, 3.0];
        assert_eq!(rotate.after(&move_x).apply(p), rotate.apply(move_x.apply(p)));
        assert_eq!(rotate.after(&move_x).apply(p), [-2.0, 6.0, 3.0]);
        assert_eq!(rotate.after(&Affine::IDENTITY), rotate);
        assert!(!rotate.mirrors());
        let mirror = Affine { rows: [[0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };
        assert!(mirror.mirrors() && !mirror.after(&mirror).mirrors());
    }
}

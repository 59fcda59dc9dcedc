//! Affine maps in f64, which place the instances of a mesh.

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

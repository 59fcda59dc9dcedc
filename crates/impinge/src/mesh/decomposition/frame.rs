//! The frame in which a mesh is cut: planes across three axes, and the boxes that they bound.
//!
//! Proof: docs/notes/proof.md, L38. Guarded by `tests/it/solids/decomposition.rs`.

use super::cut_point::{CutPoint, Side};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{Vector, dot};

/// Three directions, nearly perpendicular and of nearly unit length. Every plane of a decomposition
/// is across one of them.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    axes: [Vector; 3],
    /// Whether the axes are those of the mesh frame. Cuts are then exact along their axis.
    pub(super) is_standard: bool,
    /// Upper bound on the deviation of the axes from perpendicular unit vectors: the sum of the
    /// entries of |NNᵀ - I|, where the rows of N are the axes.
    deviation: f64,
}

/// The plane of all points x with `axis · x = offset`. The axis is a row of a [`Frame`].
#[derive(Clone, Copy, Debug)]
pub(super) struct CutPlane {
    pub(super) axis: usize,
    pub(super) offset: f64,
}

/// The points between two offsets along each axis of a frame, ends included. An offset may be
/// infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    low: Vector,
    high: Vector,
}

impl Frame {
    /// The axes of the mesh frame.
    pub(super) const STANDARD: Self =
        Self { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], is_standard: true, deviation: 0.0 };

    /// Returns the frame with these axes, or `None` if they are far from perpendicular unit
    /// vectors.
    pub(super) fn new(axes: [Vector; 3]) -> Option<Self> {
        let mut deviation = 0.0;
        for (row, a) in axes.iter().enumerate() {
            for (column, b) in axes.iter().enumerate() {
                deviation += (dot(a, b) - if row == column { 1.0 } else { 0.0 }).abs() + 8.0 * UNIT_ROUNDOFF;
            }
        }
        (deviation < 1e-9).then_some(Self { axes, is_standard: false, deviation })
    }

    /// Returns the offset of a point along an axis, rounded.
    pub(super) fn along(&self, axis: usize, point: &Vector) -> f64 {
        if self.is_standard { point[axis] } else { dot(&self.axes[axis], point) }
    }

    /// Returns the side of a plane on which a point is.
    ///
    /// # Accuracy
    /// In the standard frame one subtraction is rounded, which keeps its sign. Otherwise the
    /// product of n terms has an error of 3.1 u of the sum of their magnitudes, and the subtraction
    /// one of u, where u is 2^-53.
    pub(super) fn side(&self, plane: CutPlane, point: &CutPoint) -> Side {
        let CutPlane { axis, offset } = plane;
        if self.is_standard {
            let error = point.error[axis] * (1.0 + 8.0 * UNIT_ROUNDOFF);
            return Side { value: point.at[axis] - offset, error };
        }
        let normal = &self.axes[axis];
        let size: f64 = (0..3).map(|k| (normal[k] * point.at[k]).abs()).sum();
        let moved: f64 = (0..3).map(|k| normal[k].abs() * point.error[k]).sum();
        let error =
            moved * (1.0 + 8.0 * UNIT_ROUNDOFF) + 8.0 * UNIT_ROUNDOFF * (size + offset.abs()) + f64::MIN_POSITIVE;
        Side { value: dot(normal, &point.at) - offset, error }
    }

    /// Returns the point with three offsets along the axes.
    ///
    /// # Accuracy
    /// Exact in the standard frame. Otherwise the point is N⁻¹c for the offsets c, and Nᵀc is
    /// returned. The difference is N⁻¹(I - NNᵀ)c, which is at most twice the deviation times the
    /// length of c, as the norm of N⁻¹ is below 2.
    fn point(&self, offsets: Vector) -> CutPoint {
        if self.is_standard {
            return CutPoint { at: offsets, error: [0.0; 3] };
        }
        let size: f64 = offsets.iter().map(|offset| offset.abs()).sum();
        let at = std::array::from_fn(|k| (0..3).map(|axis| self.axes[axis][k] * offsets[axis]).sum());
        CutPoint { at, error: [(2.0 * self.deviation + 16.0 * UNIT_ROUNDOFF) * size + f64::MIN_POSITIVE; 3] }
    }

    /// Returns the point at which the edge between two points crosses a plane. If the exact points
    /// are on the same side of the plane, which inexact sides permit, it returns a bound for one of
    /// them.
    ///
    /// # Accuracy
    /// Let s and s' be the exact sides and t = s / (s - s') the exact parameter. With an error of
    /// at most e in both sides and with rounding, the computed t differs by at most e / (|s - s'| -
    /// 2e) + 4 u. The point (1 - t) a + t b then differs by at most the larger error of a and b,
    /// the error of t times |b - a|, and 8 u of the larger magnitude.
    pub(super) fn crossing(
        &self,
        plane: CutPlane,
        (a, side_a): (&CutPoint, Side),
        (b, side_b): (&CutPoint, Side),
    ) -> CutPoint {
        let span = side_a.value - side_b.value;
        let error = side_a.error.max(side_b.error) + 2.0 * UNIT_ROUNDOFF * span.abs();
        let (t, spread) = if span.abs() > 4.0 * error {
            ((side_a.value / span).clamp(0.0, 1.0), error / (span.abs() - 2.0 * error) + 4.0 * UNIT_ROUNDOFF)
        } else {
            (0.5, 0.5)
        };
        let is_crossed = (side_a.is_above() && side_b.is_below()) || (side_a.is_below() && side_b.is_above());
        let mut point = CutPoint::exact(a.at);
        for k in 0..3 {
            let (from, to) = (a.at[k], b.at[k]);
            let inherited = a.error[k].max(b.error[k]);
            if self.is_standard && k == plane.axis && is_crossed {
                point.at[k] = plane.offset;
            } else if from != to || inherited > 0.0 {
                point.at[k] = from + t * (to - from);
                let rounding = 8.0 * UNIT_ROUNDOFF * from.abs().max(to.abs()) + f64::MIN_POSITIVE;
                point.error[k] = (inherited + spread * (to - from).abs()) * (1.0 + 8.0 * UNIT_ROUNDOFF) + rounding;
            }
        }
        point
    }
}

impl Cell {
    /// All of space.
    pub(super) const EVERYWHERE: Self = Self { low: [f64::NEG_INFINITY; 3], high: [f64::INFINITY; 3] };

    /// Returns the two parts of the cell below and above a plane.
    pub(super) fn halves(self, plane: CutPlane) -> [Self; 2] {
        let (mut below, mut above) = (self, self);
        below.high[plane.axis] = plane.offset;
        above.low[plane.axis] = plane.offset;
        [below, above]
    }

    /// Returns the middle of the cell, or `None` if the cell is unbounded.
    pub(super) fn middle(self, frame: &Frame) -> Option<CutPoint> {
        let offsets: Vector = std::array::from_fn(|k| 0.5 * self.low[k] + 0.5 * self.high[k]);
        offsets.iter().all(|offset| offset.is_finite()).then(|| frame.point(offsets))
    }

    /// Iterates over the corners of the cell that are at a finite distance.
    pub(super) fn corners(self, frame: &Frame) -> impl Iterator<Item = CutPoint> {
        (0..8)
            .map(move |corner| std::array::from_fn(|k| if corner >> k & 1 == 0 { self.low[k] } else { self.high[k] }))
            .filter(|offsets: &Vector| offsets.iter().all(|offset| offset.is_finite()))
            .map(|offsets| frame.point(offsets))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_along_an_axis_are_cut_exactly() {
        let (a, b) = (CutPoint::exact([0.0, 1.0, 2.0]), CutPoint::exact([7.0, 1.0, 2.0]));
        let plane = CutPlane { axis: 0, offset: 1.0 / 3.0 };
        let sides = [&a, &b].map(|point| Frame::STANDARD.side(plane, point));
        let found = Frame::STANDARD.crossing(plane, (&a, sides[0]), (&b, sides[1]));
        assert_eq!((found.at, found.is_exact()), ([1.0 / 3.0, 1.0, 2.0], true));
    }
}

//! Boxes whose edges are parallel to the axes, as their lower and upper corners.

use super::vector::{Vector, add, length, minus, times};

pub(crate) type Bounds = [Vector; 2];

/// Returns the eight corners of a box. Bit k of a corner's index is set if the corner has the
/// maximum k-th coordinate.
pub(crate) fn corners([min, max]: &Bounds) -> [Vector; 8] {
    std::array::from_fn(|corner| {
        std::array::from_fn(|axis| if corner >> axis & 1 == 1 { max[axis] } else { min[axis] })
    })
}

/// Returns the box around some points, or `None` without points.
pub(crate) fn around(points: impl IntoIterator<Item = Vector>) -> Option<Bounds> {
    points.into_iter().fold(None, |found: Option<Bounds>, point| {
        let [min, max] = found.unwrap_or([point, point]);
        Some([[0, 1, 2].map(|k| min[k].min(point[k])), [0, 1, 2].map(|k| max[k].max(point[k]))])
    })
}

pub(crate) fn center([min, max]: Bounds) -> Vector {
    add(times(min, 0.5), times(max, 0.5))
}

/// Returns half the length of the diagonal: the radius of the sphere through all corners.
pub(crate) fn radius([min, max]: Bounds) -> f64 {
    0.5 * length(minus(max, min))
}

/// Reports whether two closed boxes have a common point.
pub(crate) fn overlap(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k])
}

/// Returns a box that reaches farther by a length on each side.
pub(crate) fn grown([min, max]: Bounds, by: f64) -> Bounds {
    [min.map(|x| x - by), max.map(|x| x + by)]
}

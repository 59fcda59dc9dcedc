//! Hulls of points that lie in a plane, in a line or in one place.

use super::build::{line, off_line};
use crate::exact::orient2d;
use crate::math::Sign::{Positive, Zero};

/// The hull of points that do not span space, by numbers of points. Of equal points, the first is
/// named.
#[derive(Clone, Debug)]
pub(super) enum Flat {
    /// All points are equal to this one.
    Point(u32),
    /// All points are on the segment between these two.
    Segment([u32; 2]),
    /// All points are in the convex polygon with these corners.
    Polygon(Vec<u32>),
}

impl Flat {
    /// Returns the hull of points in a plane. There must be at least one point.
    ///
    /// # Source
    /// Andrew, *Another efficient algorithm for convex hulls in two dimensions*, 1979, decided
    /// exactly in the projection along an axis in which the points are not in a line.
    ///
    /// # Complexity
    /// O(n log n).
    pub(super) fn of(points: &[[f64; 3]]) -> Self {
        let Some([a, b]) = line(points) else { return Self::Point(0) };
        let Some(c) = off_line(points, a, b) else { return Self::Segment([a as u32, b as u32]) };
        let axis = (0..3).find(|&axis| orient2d(axis, &points[a], &points[b], &points[c]) != Zero).unwrap_or(0);
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order.sort_unstable_by(|&x, &y| {
            let (p, q) = (&points[x as usize], &points[y as usize]);
            p[i].total_cmp(&q[i]).then(p[j].total_cmp(&q[j])).then(x.cmp(&y))
        });
        order.dedup_by(|x, y| points[*x as usize] == points[*y as usize]);
        let mut polygon = Vec::new();
        chain(points, axis, order.iter().copied(), &mut polygon);
        chain(points, axis, order.iter().rev().copied(), &mut polygon);
        Self::Polygon(polygon)
    }
}

/// Appends the corners on the right of the path from the first point to the last. The last point is
/// left out.
fn chain(points: &[[f64; 3]], axis: usize, order: impl Iterator<Item = u32>, polygon: &mut Vec<u32>) {
    let start = polygon.len();
    for point in order {
        while let [.., before, last] = polygon[start..] {
            let [p, q, r] = [before, last, point].map(|index| &points[index as usize]);
            if orient2d(axis, p, q, r) == Positive {
                break;
            }
            polygon.pop();
        }
        polygon.push(point);
    }
    polygon.pop();
}

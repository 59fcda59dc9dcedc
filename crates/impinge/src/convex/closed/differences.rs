//! The set of differences of two cores, with a bound on the errors of all computations in it.

use crate::convex::posed::{Core, Swept};
use crate::math::relative::{Offset, UNIT_ROUNDOFF};
use crate::math::vec3::{Vector, add, dot, length, sub};

/// Range of sizes within which no square, and no product of six coordinates, overflows or loses
/// digits that count: 2^-100 to 2^100.
const SIZES: [f64; 2] = [f64::from_bits((1023 - 100) << 52), f64::from_bits((1023 + 100) << 52)];

/// Reports whether the sizes are not extreme. Zero is not: then every number is zero.
pub(super) fn is_in_range(extent: f64) -> bool {
    SIZES[0] < extent && extent < SIZES[1] || extent == 0.0
}

/// A core as the sum of a center and up to three half edges, relative to the translation of its
/// pose.
struct Zonotope {
    center: Vector,
    edges: [Vector; 3],
    count: usize,
    /// Sum, over the axes, of the magnitudes of all terms of a coordinate.
    extent: f64,
}

/// The differences of the points of B and those of A: a center plus multiples within ±1 of half
/// edges.
pub(super) struct Differences {
    /// Vector from the center of A to that of B.
    pub(super) between: Vector,
    /// The negative half edges of A, then the half edges of B.
    edges: [Vector; 6],
    count_a: usize,
    count: usize,
    /// Center of A, relative to the translation of A.
    center_a: Vector,
    /// Bound on the sum, over the axes, of the magnitudes of all terms of a coordinate. All errors
    /// are relative to it.
    pub(super) extent: f64,
}

/// Proved bounds on the distance of two cores, in world units.
pub(super) struct Gap {
    /// Lower bound on the distance, at least zero. The cores are this far apart along the vector
    /// that the gap was computed from.
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// Length of that vector, rounded.
    pub(super) length: f64,
}

impl Zonotope {
    /// Returns a core in the world, or `None` if it is not a point, a segment or a box.
    ///
    /// A half edge of a box is off by u of itself in each coordinate. A center, and a half edge of
    /// a segment, is off by at most 4.1 u of the magnitudes of the terms: one rounding in the local
    /// frame, and three products and two sums. (u = 2^-53.)
    #[inline]
    fn of(swept: &Swept<'_>) -> Option<Self> {
        let linear = swept.pose.linear();
        let image = |local: &Vector| linear.map(|row| dot(&row, local));
        let extent = |reach: &Vector| {
            linear.iter().map(|row| row[0].abs() * reach[0] + row[1].abs() * reach[1] + row[2].abs() * reach[2]).sum()
        };
        let mut edges = [[0.0; 3]; 3];
        match swept.core {
            Core::Points([center]) if *center == [0.0; 3] => {
                Some(Self { center: [0.0; 3], edges, count: 0, extent: 0.0 })
            }
            Core::Points([center]) => {
                Some(Self { center: image(center), edges, count: 0, extent: extent(&center.map(f64::abs)) })
            }
            Core::Points([start, end]) => {
                let middle = std::array::from_fn(|k| 0.5 * (start[k] + end[k]));
                edges[0] = image(&std::array::from_fn(|k| 0.5 * (end[k] - start[k])));
                let reach = std::array::from_fn(|k| start[k].abs().max(end[k].abs()));
                Some(Self { center: image(&middle), edges, count: 1, extent: extent(&reach) })
            }
            Core::Cuboid(corners) => {
                let half = corners.last()?;
                for (axis, edge) in edges.iter_mut().enumerate() {
                    *edge = linear.map(|row| row[axis] * half[axis]);
                }
                Some(Self { center: [0.0; 3], edges, count: 3, extent: extent(half) })
            }
            Core::Points(_) | Core::Hull(_) | Core::Turned(_) | Core::Curved(_) => None,
        }
    }
}

impl Differences {
    /// Returns the differences of two cores. Returns `None` if a core is not a point, a segment or
    /// a box, or the sizes are extreme.
    #[inline]
    pub(super) fn between(a: &Swept<'_>, b: &Swept<'_>) -> Option<Self> {
        let (from, to) = (Zonotope::of(a)?, Zonotope::of(b)?);
        let offset = Offset::between(a.pose, b.pose).rounded;
        let extent = from.extent + to.extent + (offset[0].abs() + offset[1].abs() + offset[2].abs());
        let mut edges = [[0.0; 3]; 6];
        for (at, edge) in from.edges[..from.count].iter().enumerate() {
            edges[at] = edge.map(|x| -x);
        }
        edges[from.count..from.count + to.count].copy_from_slice(&to.edges[..to.count]);
        is_in_range(extent).then(|| Self {
            between: sub(&add(&offset, &to.center), &from.center),
            edges,
            count_a: from.count,
            count: from.count + to.count,
            center_a: from.center,
            extent,
        })
    }

    /// Returns all half edges.
    #[inline]
    pub(super) fn edges(&self) -> &[Vector] {
        &self.edges[..self.count]
    }

    /// Returns the half edges of A, negative, and those of B.
    #[inline]
    pub(super) fn edges_of_each(&self) -> [&[Vector]; 2] {
        let (a, b) = self.edges().split_at(self.count_a);
        [a, b]
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn are_boxes(&self) -> bool {
        self.count == 6
    }

    /// Returns the difference with the given multiples of the half edges.
    ///
    /// Its coordinates are off by at most 24 u of the extent: the center by 6.2 u, the half edges
    /// by 4.1 u, and twelve roundings of numbers of at most that size.
    #[inline]
    pub(super) fn at(&self, shares: &[f64; 6]) -> Vector {
        let mut sum = self.between;
        for (edge, share) in self.edges().iter().zip(shares) {
            sum = std::array::from_fn(|k| sum[k] + share * edge[k]);
        }
        sum
    }

    /// Returns the points of A and of B with the given multiples of the half edges, relative to
    /// the translation of A.
    pub(super) fn points(&self, shares: &[f64; 6]) -> [Vector; 2] {
        let mut points = [self.center_a, add(&self.center_a, &self.between)];
        for (at, (edge, share)) in self.edges().iter().zip(shares).enumerate() {
            // A's half edges are stored with the opposite sign, and a multiple moves the point the
            // other way.
            let (point, share) = if at < self.count_a { (&mut points[0], -share) } else { (&mut points[1], *share) };
            *point = std::array::from_fn(|k| point[k] + share * edge[k]);
        }
        points
    }

    /// Returns bounds on the distance of the cores, given the difference that is proposed as the
    /// shortest one (docs/notes/proof.md, L35).
    #[inline]
    pub(super) fn gap(&self, proposed: &Vector) -> Gap {
        let length = length(proposed);
        let upper = length * (1.0 + 4.0 * UNIT_ROUNDOFF) + 32.0 * UNIT_ROUNDOFF * self.extent;
        let along = if self.count == 0 {
            length
        } else if length > 0.0 {
            let reach: f64 = self.edges().iter().map(|edge| dot(proposed, edge).abs()).sum();
            (dot(proposed, &self.between) - reach) / length
        } else {
            0.0
        };
        let lower = along - 4.0 * UNIT_ROUNDOFF * along.abs() - 64.0 * UNIT_ROUNDOFF * self.extent;
        Gap { lower: lower.max(0.0), upper, length }
    }
}

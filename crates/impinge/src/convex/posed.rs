//! Two convex sets in one frame of floats, with bounds on the errors of computations in it.
//!
//! The frame has the world's axes and the origin of the first pose. Its unit makes all sizes about
//! one. So products of six coordinates neither overflow nor underflow, whatever the poses are.

use std::cell::Cell;
use std::cmp::Ordering;

use super::support::Support;
use super::turned::Turned;
use crate::hull::Hull;
use crate::math::Pose;
use crate::math::relative::{Offset, UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::{dot, length};
use crate::simd::by_axis;

/// A convex shape without its radius.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Core<'a> {
    /// The convex hull of a few points.
    Points(&'a [[f64; 3]]),
    /// A box about the origin of its frame, by its eight corners. Bit k of a corner's index is set
    /// on the positive side of axis k, so the last corner has the half-extents.
    Cuboid(&'a [[f64; 3]]),
    /// A polytope with the adjacency of its vertices.
    Hull(&'a Hull),
    /// A cylinder or a cone.
    Turned(&'a Turned),
    /// Any other convex set.
    Curved(&'a dyn Support),
}

/// A core in the world, swept by the image of a sphere under the pose. That image holds a sphere
/// with the first radius and lies in a sphere with the second, in world units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept<'a> {
    pub(crate) core: Core<'a>,
    pub(crate) pose: &'a Pose,
    pub(crate) radius: [f64; 2],
}

/// A point of a set, in the set's own frame and rounded in the common frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) local: [f64; 3],
    pub(super) point: [f64; 3],
}

/// A point of each set and their difference, which belongs to the set of all differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Difference {
    pub(super) a: Spot,
    pub(super) b: Spot,
    pub(super) vector: [f64; 3],
}

/// A core in the common frame.
#[derive(Debug)]
pub(super) struct Posed<'a> {
    core: Core<'a>,
    pose: &'a Pose,
    offset: [f64; 3],
    scale: f64,
    /// Vertex at which the next climb over a hull starts.
    vertex: Cell<u32>,
}

/// Two cores in the common frame.
#[derive(Debug)]
pub(super) struct Pair<'a> {
    pub(super) a: Posed<'a>,
    pub(super) b: Posed<'a>,
    /// Size of the common unit in world units, a power of two.
    pub(super) unit: f64,
    /// Bound on the sum of the magnitudes of the terms of a coordinate, for both sets together, in
    /// the common unit.
    pub(super) extent: [f64; 3],
    /// Bound on the loss in products that underflow in world units.
    pub(super) underflow: f64,
}

impl Core<'_> {
    /// Returns an upper bound on the magnitude of the core's coordinates on each axis, in its own
    /// frame.
    pub(crate) fn reach(&self) -> [f64; 3] {
        match self {
            Self::Cuboid(corners) => corners.last().copied().unwrap_or([0.0; 3]),
            Self::Points(points) => points
                .iter()
                .fold([0.0; 3], |reach: [f64; 3], point| std::array::from_fn(|k| reach[k].max(point[k].abs()))),
            Self::Hull(hull) => hull.reach(),
            Self::Turned(set) => set.reach(),
            Self::Curved(set) => set.reach(),
        }
    }

    /// Returns numbers that differ for most cores that are not equal.
    fn numbers(&self) -> [[f64; 3]; 3] {
        match self {
            Self::Points(_) | Self::Cuboid(_) | Self::Hull(_) => [self.reach(), [0.0; 3], [0.0; 3]],
            Self::Turned(_) | Self::Curved(_) => {
                [self.reach(), self.farthest([1.0, 0.5, 0.75], 0).0, self.farthest([0.75, 0.5, -1.0], 0).0]
            }
        }
    }

    /// Returns a point of the core in its own frame.
    pub(super) fn point(&self) -> [f64; 3] {
        match self {
            Self::Turned(_) | Self::Curved(_) => self.farthest([1.0, 0.0, 0.0], 0).0,
            _ => self.corners().and_then(|corners| corners.first().copied()).unwrap_or([0.0; 3]),
        }
    }

    /// Returns a point near the middle of the core, in its own frame: the mean of at most eight
    /// corners, or the center of the frame of any other core.
    pub(super) fn middle(&self) -> [f64; 3] {
        match self {
            Self::Points(points) => mean(points),
            Self::Hull(hull) => mean(hull.positions()),
            Self::Cuboid(_) | Self::Turned(_) | Self::Curved(_) => [0.0; 3],
        }
    }

    /// Returns a farthest point along a direction whose greatest entry is ±1, both in the core's
    /// own frame, and its vertex if the core is a hull. The climb over a hull starts at `vertex`.
    #[inline]
    pub(crate) fn farthest(&self, along: [f64; 3], vertex: u32) -> ([f64; 3], u32) {
        match self {
            Self::Points(points) | Self::Cuboid(points) => (farthest_of(points, along).1, 0),
            Self::Hull(hull) => {
                let vertex = farthest_vertex(hull, along, vertex);
                (hull.positions()[vertex as usize], vertex)
            }
            Self::Turned(set) => (set.support(along), 0),
            Self::Curved(set) => {
                let (found, reach) = (set.support(along), set.reach());
                (std::array::from_fn(|k| if found[k].is_nan() { 0.0 } else { found[k].clamp(-reach[k], reach[k]) }), 0)
            }
        }
    }

    /// Returns the corners of a polytope, or `None` for any other core.
    pub(crate) fn corners(&self) -> Option<&[[f64; 3]]> {
        match self {
            Self::Points(points) | Self::Cuboid(points) => Some(points),
            Self::Hull(hull) => Some(hull.positions()),
            Self::Turned(_) | Self::Curved(_) => None,
        }
    }
}

/// Returns the first of the points that are farthest along a direction, up to rounding, and its
/// number. Without points, or with a direction that is not finite, it is a point at the origin.
fn farthest_of(points: &[[f64; 3]], along: [f64; 3]) -> (u32, [f64; 3]) {
    let mut best = (f64::NEG_INFINITY, 0, [0.0; 3]);
    for (number, point) in (0..).zip(points) {
        let found = dot(&along, point);
        if found > best.0 {
            best = (found, number, *point);
        }
    }
    (best.1, best.2)
}

/// Returns a vertex of a hull that is farthest along a direction, up to rounding. It does not
/// depend on `start`, where the climb over a large hull starts.
fn farthest_vertex(hull: &Hull, along: [f64; 3], start: u32) -> u32 {
    /// Maximum number of vertices that are all compared, which takes less time than a climb.
    const MAX_SCANNED: usize = 48;
    let positions = hull.positions();
    if positions.len() <= MAX_SCANNED { farthest_of(positions, along).0 } else { hull.support_from(along, start) }
}

/// Returns the mean of the first eight points, or zero if there are no points.
fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    let points = &points[..points.len().min(8)];
    let share = 1.0 / points.len().max(1) as f64;
    points.iter().fold([0.0; 3], |sum, point| std::array::from_fn(|k| sum[k] + share * point[k]))
}

impl Swept<'_> {
    /// Reports whether this shape comes before `other` in the arithmetic: the shape with the lesser
    /// numbers comes first. So swapping the arguments of a query changes no digit. Shapes with
    /// equal numbers keep their given order.
    pub(super) fn is_before(&self, other: &Self) -> bool {
        let (here, there) = (self.pose.translation(), other.pose.translation());
        if let Some(order) = here.iter().zip(there).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne()) {
            return order.is_le();
        }
        let numbers = |shape: &Self| {
            let linear = *shape.pose.linear();
            linear.into_iter().flatten().chain(shape.radius).chain(shape.core.numbers().into_iter().flatten())
        };
        let order = numbers(self).zip(numbers(other)).map(|(x, y)| x.total_cmp(&y)).find(|order| order.is_ne());
        let order = order.or_else(|| {
            let (corners, others) = (self.core.corners()?.as_flattened(), other.core.corners()?.as_flattened());
            Some(corners.len().cmp(&others.len()).then_with(|| {
                let differs = corners.iter().zip(others).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne());
                differs.unwrap_or(Ordering::Equal)
            }))
        });
        order.is_none_or(Ordering::is_le)
    }
}

impl<'a> Pair<'a> {
    pub(super) fn new(a: &Swept<'a>, b: &Swept<'a>) -> Self {
        let offset = Offset::between(a.pose, b.pose).rounded;
        let [extent_a, extent_b] = [a, b].map(|swept| {
            let reach = swept.core.reach();
            swept.pose.linear().map(|row| (0..3).map(|j| row[j].abs() * reach[j]).sum::<f64>())
        });
        let world: [f64; 3] = std::array::from_fn(|k| extent_a[k] + extent_b[k] + offset[k].abs());
        let unit = power_of_two_near(world.into_iter().fold(0.0, f64::max));
        let posed = |swept: &Swept<'a>, offset| Posed {
            core: swept.core,
            pose: swept.pose,
            offset,
            scale: 1.0 / unit,
            vertex: Cell::new(0),
        };
        let underflow = UNDERFLOW * (1.0 + 1.0 / unit);
        Self { a: posed(a, [0.0; 3]), b: posed(b, offset), unit, extent: world.map(|extent| extent / unit), underflow }
    }

    /// Sets the vertices at which climbs over hulls start. No answer depends on them.
    pub(super) fn start_at(&self, vertices: [u32; 2]) {
        for (set, vertex) in [&self.a, &self.b].into_iter().zip(vertices) {
            if let Core::Hull(hull) = set.core
                && (vertex as usize) < hull.positions().len()
            {
                set.vertex.set(vertex);
            }
        }
    }

    /// Returns the vertices at which the last climbs ended.
    pub(super) fn vertices(&self) -> [u32; 2] {
        [self.a.vertex.get(), self.b.vertex.get()]
    }

    /// Returns the farthest difference along a direction from A to B.
    pub(super) fn support(&self, direction: [f64; 3]) -> Difference {
        Difference::between(self.a.support(direction), self.b.support(direction.map(|x| -x)))
    }

    /// Returns a bound on how much farther along `direction` the set of differences may reach than
    /// the product of the direction with its [`support`](Self::support), in the common unit times
    /// the direction (docs/notes/proof.md, L20).
    pub(super) fn height_error(&self, direction: [f64; 3]) -> f64 {
        let magnitudes = direction.map(f64::abs);
        let size = dot(&magnitudes, &self.extent);
        let slope = magnitudes[0] + magnitudes[1] + magnitudes[2];
        64.0 * UNIT_ROUNDOFF * size + slope * self.underflow
    }

    /// Returns a bound on the distance of a computed difference, or of a mean of differences, from
    /// a point of the exact set, in the common unit.
    pub(super) fn point_error(&self) -> f64 {
        32.0 * UNIT_ROUNDOFF * self.extent.iter().sum::<f64>() + self.underflow
    }

    /// Converts a point of the common frame to the world.
    pub(super) fn world(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| point[k] * self.unit + self.a.pose.translation()[k])
    }
}

impl Difference {
    pub(super) fn between(a: Spot, b: Spot) -> Self {
        Self { a, b, vector: std::array::from_fn(|k| a.point[k] - b.point[k]) }
    }
}

impl Posed<'_> {
    pub(super) fn pose(&self) -> &Pose {
        self.pose
    }

    #[inline]
    pub(super) fn spot(&self, local: [f64; 3]) -> Spot {
        let linear = self.pose.linear();
        Spot { local, point: by_axis!(k => (dot(&linear[k], &local) + self.offset[k]) * self.scale) }
    }

    /// Returns a farthest point along a direction of the common frame.
    pub(super) fn support(&self, direction: [f64; 3]) -> Spot {
        self.spot(self.farthest_local(self.turned(direction)))
    }

    /// Converts a direction of the common frame to the set's own frame. Its greatest entry becomes
    /// ±1.
    pub(super) fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        let linear = self.pose.linear();
        let [x, y, z] = direction;
        to_unit_entries(by_axis!(j => linear[0][j] * x + linear[1][j] * y + linear[2][j] * z))
    }

    /// Returns a farthest point along a direction, both in the set's own frame.
    pub(super) fn farthest_local(&self, along: [f64; 3]) -> [f64; 3] {
        let (point, vertex) = self.core.farthest(along, self.vertex.get());
        self.vertex.set(vertex);
        point
    }

    /// Returns the vertex of a hull that is farthest along a direction of the common frame, or zero
    /// for any other core.
    pub(super) fn farthest_vertex(&self, direction: [f64; 3]) -> u32 {
        match self.core {
            Core::Hull(hull) => farthest_vertex(hull, self.turned(direction), self.vertex.get()),
            _ => 0,
        }
    }

    pub(super) fn core(&self) -> Core<'_> {
        self.core
    }

    /// Returns the half edges of a box in the common frame, one for each axis of the box. Returns
    /// `None` for a box without volume, and for any other core.
    pub(super) fn half_edges_of_box(&self) -> Option<[[f64; 3]; 3]> {
        let Core::Cuboid([.., half_extents]) = self.core else { return None };
        let linear = self.pose.linear();
        let edge = |axis: usize| by_axis!(k => linear[k][axis] * half_extents[axis] * self.scale);
        half_extents.iter().all(|half| *half > 0.0).then(|| [edge(0), edge(1), edge(2)])
    }

    /// Returns a bound on the magnitude of the set's coordinates in its own frame, in the common
    /// unit if the pose is rigid.
    pub(super) fn reach(&self) -> f64 {
        self.core.reach().into_iter().fold(0.0, f64::max) * self.scale
    }

    /// Returns the corners of a polytope, or `None` for any other core.
    pub(super) fn corners(&self) -> Option<&[[f64; 3]]> {
        self.core.corners()
    }
}

/// Returns the vector scaled so that its greatest entry is ±1, or zero if it is too short or not
/// finite.
pub(crate) fn to_unit_entries(vector: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = vector.map(f64::abs);
    let largest = x.max(y).max(z);
    if largest >= f64::MIN_POSITIVE && largest.is_finite() { vector.map(|x| x / largest) } else { [0.0; 3] }
}

/// Returns a vector of length 1 in the direction of another, without negative zeros. Returns the
/// first axis if the vector has no direction.
pub(crate) fn to_unit_length(vector: [f64; 3]) -> [f64; 3] {
    let scaled = to_unit_entries(vector);
    let length = length(&scaled);
    if length > 0.0 { scaled.map(|x| x / length + 0.0) } else { [1.0, 0.0, 0.0] }
}

/// Returns the power of two that is at most `size` and more than half of it, or 1 for zero. The
/// result is never so small that its inverse overflows.
fn power_of_two_near(size: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    const MIN_SIZE: f64 = f64::from_bits((1023 - 1000) << 52);
    if size == 0.0 { 1.0 } else { f64::from_bits(size.max(MIN_SIZE).to_bits() & EXPONENT) }
}

//! Two convex sets in one frame of floats, and how far what is computed there may be off.
//!
//! The frame has the world's axes, its origin where the first pose puts its own, and a unit in which all that is asked about
//! is about as large as one. So products of six coordinates neither overflow nor vanish, whatever the poses are.

use std::cell::Cell;
use std::cmp::Ordering;
use std::fmt;

use crate::hull::Hull;
use crate::math::Pose;
use crate::math::relative::{Offset, UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::{dot, length};

/// A convex set that is known by its support function, in its own frame.
///
/// What is neither finite nor within [`reach`](Self::reach) is brought within it, so a wrong function gives wrong answers but
/// never a NaN, a panic or a loop.
pub trait Support: fmt::Debug + Send + Sync {
    /// A point of the set that is farthest along a direction, which is finite and has its greatest entry at ±1, or is zero.
    ///
    /// # Accuracy
    /// Answers are proved for functions whose point is off by at most 2^-50 of [`reach`](Self::reach), axis by axis, and has
    /// a product with the direction that is as close to the greatest one.
    fn support(&self, direction: [f64; 3]) -> [f64; 3];

    /// The greatest magnitude of a coordinate of the set on each axis, or more.
    fn reach(&self) -> [f64; 3];
}

/// What a convex shape is but for its radius.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Core<'a> {
    /// The convex hull of a few points.
    Points(&'a [[f64; 3]]),
    /// A polytope with the adjacency of its vertices.
    Hull(&'a Hull),
    /// Anything else.
    Curved(&'a dyn Support),
}

/// A core in the world, swept by a ball: what the pose makes of a ball holds one of the lesser radius and lies in one of the
/// greater.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept<'a> {
    pub(crate) core: Core<'a>,
    pub(crate) pose: &'a Pose,
    pub(crate) radius: [f64; 2],
}

/// A point of a set: where it is in its own frame, and rounded in the common one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) local: [f64; 3],
    pub(super) point: [f64; 3],
}

/// A point of each set and their difference, which is a point of the set of all differences.
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
    /// Where the next climb over a hull starts.
    vertex: Cell<u32>,
}

/// Two cores in the common frame.
#[derive(Debug)]
pub(super) struct Pair<'a> {
    pub(super) a: Posed<'a>,
    pub(super) b: Posed<'a>,
    /// The common unit is this many world units: a power of two.
    pub(super) unit: f64,
    /// A bound of the magnitudes that sum up to a coordinate of either set, added up.
    pub(super) extent: [f64; 3],
    /// More than what products that vanish in world units take away.
    pub(super) underflow: f64,
}

impl Core<'_> {
    fn reach(&self) -> [f64; 3] {
        match self {
            Self::Points(points) => points
                .iter()
                .fold([0.0; 3], |reach: [f64; 3], point| std::array::from_fn(|k| reach[k].max(point[k].abs()))),
            Self::Hull(hull) => hull.reach(),
            Self::Curved(set) => set.reach(),
        }
    }

    /// A point of the core, in its own frame.
    pub(super) fn point(&self) -> [f64; 3] {
        match self {
            Self::Curved(set) => {
                let (found, reach) = (set.support([1.0, 0.0, 0.0]), set.reach());
                std::array::from_fn(|k| if found[k].is_nan() { 0.0 } else { found[k].clamp(-reach[k], reach[k]) })
            }
            _ => self.corners().and_then(|corners| corners.first().copied()).unwrap_or([0.0; 3]),
        }
    }

    /// The corners, where the core is a polytope.
    pub(super) fn corners(&self) -> Option<&[[f64; 3]]> {
        match self {
            Self::Points(points) => Some(points),
            Self::Hull(hull) => Some(hull.positions()),
            Self::Curved(_) => None,
        }
    }
}

impl Swept<'_> {
    /// Which of two shapes comes first in the arithmetic, whichever was named first, so that swapping them changes no digit:
    /// the one with the lesser numbers. Shapes in one place that no number here tells apart are taken as they come.
    pub(super) fn is_before(&self, other: &Self) -> bool {
        let (here, there) = (self.pose.translation(), other.pose.translation());
        if let Some(order) = here.iter().zip(there).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne()) {
            return order.is_le();
        }
        let order =
            self.numbers().iter().zip(other.numbers()).map(|(x, y)| x.total_cmp(&y)).find(|order| order.is_ne());
        let order = order.or_else(|| {
            let (corners, others) = (self.core.corners()?.as_flattened(), other.core.corners()?.as_flattened());
            Some(corners.len().cmp(&others.len()).then_with(|| {
                let differs = corners.iter().zip(others).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne());
                differs.unwrap_or(Ordering::Equal)
            }))
        });
        order.is_none_or(Ordering::is_le)
    }

    fn numbers(&self) -> Vec<f64> {
        let linear = self.pose.linear().as_flattened();
        let mut numbers = [&self.pose.translation()[..], linear, &self.radius[..], &self.core.reach()[..]].concat();
        if let Core::Curved(set) = self.core {
            numbers.extend(set.support([1.0, 0.5, 0.75]));
            numbers.extend(set.support([0.75, 0.5, -1.0]));
        }
        numbers
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

    /// Lets climbs over hulls start here; no answer depends on it.
    pub(super) fn start_at(&self, vertices: [u32; 2]) {
        for (set, vertex) in [&self.a, &self.b].into_iter().zip(vertices) {
            if let Core::Hull(hull) = set.core
                && (vertex as usize) < hull.positions().len()
            {
                set.vertex.set(vertex);
            }
        }
    }

    /// Where the last climbs ended.
    pub(super) fn vertices(&self) -> [u32; 2] {
        [self.a.vertex.get(), self.b.vertex.get()]
    }

    /// The difference that is farthest along a direction from A to B.
    pub(super) fn support(&self, direction: [f64; 3]) -> Difference {
        Difference::between(self.a.support(direction), self.b.support(direction.map(|x| -x)))
    }

    /// How much farther along a direction than its [`support`](Self::support), multiplied out, the set of differences may
    /// reach (docs/proof.md, L20).
    pub(super) fn height_error(&self, direction: [f64; 3]) -> f64 {
        let size: f64 = (0..3).map(|k| direction[k].abs() * self.extent[k]).sum();
        let slope: f64 = direction.into_iter().map(f64::abs).sum();
        64.0 * UNIT_ROUNDOFF * size + slope * self.underflow
    }

    /// How far a difference, or a mean of some, may be from one of the set.
    pub(super) fn point_error(&self) -> f64 {
        32.0 * UNIT_ROUNDOFF * self.extent.iter().sum::<f64>() + self.underflow
    }

    /// A point of the common frame in the world.
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

    pub(super) fn spot(&self, local: [f64; 3]) -> Spot {
        let point = std::array::from_fn(|k| {
            let row = self.pose.linear()[k];
            (dot(&row, &local) + self.offset[k]) * self.scale
        });
        Spot { local, point }
    }

    /// A point that is farthest along a direction of the common frame.
    pub(super) fn support(&self, direction: [f64; 3]) -> Spot {
        self.spot(self.farthest_local(self.turned(direction)))
    }

    /// A direction of the common frame in the set's own, its greatest entry at ±1.
    pub(super) fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        let linear = self.pose.linear();
        to_unit_entries(std::array::from_fn(|j| (0..3).map(|k| linear[k][j] * direction[k]).sum::<f64>()))
    }

    /// A point that is farthest along a direction, both in the set's own frame.
    pub(super) fn farthest_local(&self, along: [f64; 3]) -> [f64; 3] {
        match self.core {
            Core::Points(points) => {
                let mut best = (f64::NEG_INFINITY, [0.0; 3]);
                for point in points {
                    let found = dot(&along, point);
                    if found > best.0 {
                        best = (found, *point);
                    }
                }
                best.1
            }
            Core::Hull(hull) => {
                let vertex = hull.support_from(along, self.vertex.get());
                self.vertex.set(vertex);
                hull.positions()[vertex as usize]
            }
            Core::Curved(set) => {
                let (found, reach) = (set.support(along), set.reach());
                std::array::from_fn(|k| if found[k].is_nan() { 0.0 } else { found[k].clamp(-reach[k], reach[k]) })
            }
        }
    }

    /// The vertex of a hull that is farthest along a direction of the common frame; of anything else the first.
    pub(super) fn farthest_vertex(&self, direction: [f64; 3]) -> u32 {
        match self.core {
            Core::Hull(hull) => hull.support_from(self.turned(direction), self.vertex.get()),
            _ => 0,
        }
    }

    pub(super) fn core(&self) -> Core<'_> {
        self.core
    }

    /// A bound of the greatest magnitude of a coordinate of the set in its own frame, in the common unit as far as the pose is
    /// rigid.
    pub(super) fn reach(&self) -> f64 {
        self.core.reach().into_iter().fold(0.0, f64::max) * self.scale
    }

    /// The corners, where the core is a polytope.
    pub(super) fn corners(&self) -> Option<&[[f64; 3]]> {
        self.core.corners()
    }
}

/// The vector with its greatest entry at ±1; zero where it is too short for that.
pub(super) fn to_unit_entries(vector: [f64; 3]) -> [f64; 3] {
    let largest = vector.into_iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest >= f64::MIN_POSITIVE && largest.is_finite() { vector.map(|x| x / largest) } else { [0.0; 3] }
}

/// A vector of length 1 along another, no zero of it negative; along an axis where that has no direction.
pub(crate) fn to_unit_length(vector: [f64; 3]) -> [f64; 3] {
    let scaled = to_unit_entries(vector);
    let length = length(&scaled);
    if length > 0.0 { scaled.map(|x| x / length + 0.0) } else { [1.0, 0.0, 0.0] }
}

/// The power of two that a size is at most twice of; 1 for zero. None is so small that its inverse overflows.
fn power_of_two_near(size: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    const LEAST: f64 = f64::from_bits((1023 - 1000) << 52);
    if size == 0.0 { 1.0 } else { f64::from_bits(size.max(LEAST).to_bits() & EXPONENT) }
}

//! Convex pieces of a moving body, and how far their points are from the axis of the motion.
//!
//! The proof is docs/notes/proof.md, L34. The tests are in `tests/it/sweep`.

use super::motion::{Motion, Turn};
use crate::hierarchy::Child;
use crate::math::vec3::{Vector, add, cross, dot, scale, scaled_length, sub};

/// Bound on the relative error of lengths and sums of a few numbers.
pub(super) const ABOVE: f64 = 1.0 + 1e-12;

/// A convex set that holds a part of a body.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Index of the part of the shape; the first part of a group.
    pub(super) part: u32,
    pub(super) content: Content,
    pub(super) volume: Volume,
    /// Upper bound on the radius of the sphere that sweeps the volume, in world units.
    pub(super) radius: f64,
    /// Bounds about the axis of the motion at time 0.
    pub(super) reach: AxisReach,
    /// Upper bound on the distance of two points of a box, in world units. It is zero for a piece
    /// that is never divided.
    pub(super) diameter: f64,
    /// Pieces that this piece is divided into, once they are made.
    pub(super) children: Vec<u32>,
}

/// The part of a body that a piece holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Some parts of a compound.
    Group,
    /// A node or a leaf of a mesh.
    Below(Child),
    /// A face of a mesh.
    Face(u32),
    /// A convex part or a half-space.
    Whole,
}

/// The points of a piece, in the body's frame unless stated otherwise.
#[derive(Clone, Debug)]
pub(super) enum Volume {
    Box(SlabbedBox),
    Triangle([Vector; 3]),
    /// The core of the part, with a point of it.
    Core(Vector),
    /// The half-space on the inner side of a plane. It never turns. The unit normal, rounded, is in
    /// the world frame. The plane moves with `base`, a point of the world at time 0, and is `level`
    /// above it along the normal.
    HalfSpace {
        normal: Vector,
        base: Vector,
        level: f64,
    },
}

/// A parallelepiped, and a slab that holds its content too.
#[derive(Clone, Debug)]
pub(super) struct SlabbedBox {
    pub(super) center: Vector,
    pub(super) half_axes: [Vector; 3],
    /// A unit normal, rounded, and bounds on its product with any point of the content.
    pub(super) slab: Option<(Vector, [f64; 2])>,
}

impl SlabbedBox {
    /// Returns an upper bound on the product of `along` with any point of the content, up to
    /// rounding.
    pub(super) fn height(&self, along: &Vector) -> f64 {
        let of_box = |along: &Vector| {
            dot(along, &self.center) + self.half_axes.iter().map(|axis| dot(along, axis).abs()).sum::<f64>()
        };
        let height = of_box(along);
        let Some((normal, [min, max])) = &self.slab else { return height };
        // The direction is a multiple of the normal and a rest. The slab bounds the first, and the
        // box the second.
        let times = dot(along, normal);
        let level = if times > 0.0 { times * max } else { times * min };
        height.min(level + of_box(&sub(along, &scale(normal, times))))
    }
}

/// How far a piece reaches from the axis of its motion and along it, in world units.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AxisReach {
    /// Upper bound on the distance of a point of the piece, without its radius, from the axis.
    pub(super) across: f64,
    /// Upper bound on the distance of such a point from the pivot.
    pub(super) from_pivot: f64,
    /// Bounds on the product of the axis with the arm of such a point, up to rounding.
    pub(super) along: [f64; 2],
}

impl AxisReach {
    /// Returns the reach of the hull of some points of the body.
    pub(super) fn of_points(motion: &Motion, points: impl Iterator<Item = Vector>) -> Self {
        let axis = motion.turn().axis;
        let (mut across, mut from_pivot, mut along) = (0.0_f64, 0.0_f64, [f64::INFINITY, f64::NEG_INFINITY]);
        for point in points {
            let arm = motion.arm(point);
            across = across.max(scaled_length(&cross(&axis, &arm)));
            from_pivot = from_pivot.max(scaled_length(&arm));
            let height = dot(&axis, &arm);
            along = [along[0].min(height), along[1].max(height)];
        }
        Self { across: across * ABOVE, from_pivot: from_pivot * ABOVE, along }
    }

    /// Returns the reach of two sets together.
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            across: self.across.max(other.across),
            from_pivot: self.from_pivot.max(other.from_pivot),
            along: [self.along[0].min(other.along[0]), self.along[1].max(other.along[1])],
        }
    }

    /// Returns the reach of the set swept by a sphere.
    pub(super) fn swept(self, radius: f64) -> Self {
        let along = [self.along[0] - radius, self.along[1] + radius];
        Self { across: (self.across + radius) * ABOVE, from_pivot: (self.from_pivot + radius) * ABOVE, along }
    }

    /// Returns the reach of a set, given two of its bounds.
    pub(super) fn intersection(self, other: Self) -> Self {
        Self {
            across: self.across.min(other.across),
            from_pivot: self.from_pivot.min(other.from_pivot),
            along: [self.along[0].max(other.along[0]), self.along[1].min(other.along[1])],
        }
    }

    /// Returns the reach of a parallelepiped of the body.
    pub(super) fn of_box(motion: &Motion, SlabbedBox { center, half_axes, .. }: &SlabbedBox) -> Self {
        let axis = motion.turn().axis;
        let middle = motion.arm(*center);
        let arms = half_axes.map(|half_axis| image(motion, &half_axis));
        let across = arms.iter().map(|arm| scaled_length(&cross(&axis, arm))).sum::<f64>();
        let half = arms.iter().map(|arm| dot(&axis, arm).abs()).sum::<f64>();
        let height = dot(&axis, &middle);
        let across = scaled_length(&cross(&axis, &middle)) + across;
        let from_pivot = scaled_length(&middle) + arms.iter().map(scaled_length).sum::<f64>();
        Self { across: across * ABOVE, from_pivot: from_pivot * ABOVE, along: [height - half, height + half] }
    }

    /// Returns the reach of a convex set by its support function: `farthest` returns its farthest
    /// point of the body along a direction of the world at time 0.
    ///
    /// Directions across the axis that are an angle of 2π / n apart circumscribe a polygon about
    /// the set. A point at distance ρ is at least ρ cos(π / n) high along one of them.
    pub(super) fn of_support(motion: &Motion, farthest: impl Fn(&Vector) -> Vector) -> Self {
        /// Number of directions. The bound on the distance is at most 0.03 % too large.
        const DIRECTIONS: usize = 128;
        const COSINE: f64 = 0.999_698;
        let Turn { axis, .. } = motion.turn();
        let height = |direction: &Vector| dot(direction, &motion.arm(farthest(direction)));
        let along = [-height(&axis.map(|x| -x)), height(&axis)];
        let least = (0..3).fold(0, |least, k| if axis[k].abs() < axis[least].abs() { k } else { least });
        let mut side = [0.0; 3];
        side[least] = 1.0;
        let mut direction = sub(&side, &scale(&axis, axis[least]));
        direction = scale(&direction, 1.0 / scaled_length(&direction));
        let other = cross(&axis, &direction);
        // The rotation by 2π / 128, applied again and again.
        const SINE: f64 = 0.049_067_674_327_418_015;
        const ROTATION: f64 = 0.998_795_456_205_172_4;
        let (mut cosine, mut sine, mut across) = (1.0, 0.0, 0.0_f64);
        for _ in 0..DIRECTIONS {
            across = across.max(height(&add(&scale(&direction, cosine), &scale(&other, sine))));
            [cosine, sine] = [ROTATION * cosine - SINE * sine, ROTATION * sine + SINE * cosine];
        }
        let across = across / COSINE * ABOVE;
        let from_pivot = across.hypot(along[0].abs().max(along[1].abs())) * ABOVE;
        Self { across, from_pivot, along }
    }
}

/// Returns the image of a vector of the body at time 0.
pub(super) fn image(motion: &Motion, vector: &Vector) -> Vector {
    motion.at(0.0).linear().map(|row| dot(&row, vector))
}

//! Lower bounds of distances between nodes of two trees: which frame they are compared in, and how.
//!
//! Boxes are compared in the host's packed frame where the host's pose keeps the shape of things (a rotation with a scale,
//! within [`SHAPE_KEPT`]), as its boxes are then used as they are; else both are carried to the metric frame. In either,
//! a unit is at least `per_unit` units of the metric frame.
//!
//! Two kinds of bounds, of which the meshes' gap decides:
//! - *near*: the distance of the boxes, squared;
//! - *far*, where single precision would not tell nodes apart next to the gap: what is left of the gap along its own direction
//!   once the nodes' boxes have reached into it. The gap itself is left out of the numbers that are compared.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::metric::Metric;
use super::relative_frame::RelativeFrame;
use crate::hierarchy::{BoxLanes, BoxMap, HALF_ULP, Node};
use crate::math::RelativeMap;
use crate::math::vec3::{Vector, dot, length, sub};
use crate::mesh::pairs::relation::Relation;
use crate::mesh::pairs::sides::Sides;
use crate::mesh::storage::frame::REACH;
use crate::mesh::{HostChoice, PlacedMesh};
use crate::simd::{LANES, Lanes3, by_axis, dot as dot3, load3, outlined};
use crate::volume::Aabb;

/// The largest relative deviation of a host's squared lengths from a common scale with which its packed frame is used:
/// 2^-10. Bounds are looser by that much; beyond it, carrying both trees costs less than the looseness.
const SHAPE_KEPT: f64 = 1.0 / 1024.0;

/// Gaps of more than this many times the meshes' size are *far*: 2^10, as squares in single precision tell apart 2^-22.
const FAR: f64 = 1024.0;

/// More than the relative rounding of a lower bound's evaluation, seven operations, and of its comparison: 2^-20.
const ROUNDING: f64 = 1.0 / (1_u64 << 20) as f64;

/// Bounds of eight boxes from one.
pub(super) struct LaneBounds {
    pub(super) bounds: [f32; LANES],
    /// What is least is worth looking at first.
    pub(super) order: [f32; LANES],
    /// The lanes, in use or not, whose bound is not above the limit; one that is not a number proves nothing.
    pub(super) near: u32,
}

/// How much the square of twice the distance of centres counts beside that of the gap: boxes of surfaces that are near each other
/// overlap, and then only centres say where to look first. Of 0, 1/100, 1/16, 1/4, 1 and 4 this one opened fewest nodes: for two
/// knots almost in touch 265, where the gap alone opened 667.
const CENTRES: f32 = 1.0 / 16.0;

/// How nodes of the two trees are compared.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    /// Which mesh is the host.
    pub(super) sides: Sides,
    /// What carries boxes of the host and of the guest there; none for a host's that are used as they are.
    maps: [Option<BoxMap>; 2],
    /// Metric units, at least, for one unit of the frame of the boxes.
    per_unit: f64,
    far: Option<Far>,
    /// How the guest lies in the host's packed frame, where boxes are compared there.
    pub(super) relative: Option<RelativeFrame>,
}

/// The gap between the centres, as a direction of about unit length, and how much of it there is along it.
#[derive(Clone, Copy, Debug)]
struct Far {
    direction: [f32; 3],
    length: f64,
    along: f64,
    /// More than what sums of products of boxes and direction are off by.
    slack: f64,
}

impl Bounds {
    pub(super) fn new(a: PlacedMesh<'_>, b: PlacedMesh<'_>, metric: &Metric, choice: HostChoice) -> Self {
        match choice {
            HostChoice::First => Self::hosted(a, b, metric, Sides::FIRST_HOSTS).0,
            HostChoice::Second => Self::hosted(b, a, metric, Sides::SECOND_HOSTS).0,
            HostChoice::SmallerError => {
                let (by_a, blur_a) = Self::hosted(a, b, metric, Sides::FIRST_HOSTS);
                let (by_b, blur_b) = Self::hosted(b, a, metric, Sides::SECOND_HOSTS);
                if blur_b < blur_a { by_b } else { by_a }
            }
        }
    }

    /// The bounds with this host, and how much of the metric frame rounding blurs.
    fn hosted(host: PlacedMesh<'_>, guest: PlacedMesh<'_>, metric: &Metric, sides: Sides) -> (Self, f64) {
        let [host_side, guest_side] = sides.host_guest([0, 1]);
        let gap = sub(&metric.maps[guest_side].offset, &metric.maps[host_side].offset);
        let is_far = length(&gap) > FAR * metric.extent;
        let carried = |placed: PlacedMesh<'_>, side: usize| {
            let map = &metric.maps[side];
            let linear = map.linear.map(|row| row.map(|x| x / placed.mesh.0.frame.scale));
            let offset = if is_far { [0.0; 3] } else { map.offset };
            BoxMap::new(&linear, &offset, &[metric.error; 3], REACH)
        };
        let kept = if is_far { None } else { stretch(host.world_from_mesh.linear()) };
        let bounds = match kept {
            Some([least, most]) => {
                let local = RelativeMap::a_from_b(&host.world_from_mesh, &guest.world_from_mesh);
                let (host_frame, guest_frame) = (&host.mesh.0.frame, &guest.mesh.0.frame);
                let per_unit = |stretch: f64| stretch / host_frame.scale * metric.scale;
                let stretch = [per_unit(least) * (1.0 - 1e-12), per_unit(most) * (1.0 + 1e-12)];
                let Relation { linear, translation, error, boxes, .. } = Relation::new(&local, host_frame, guest_frame);
                let relative = Some(RelativeFrame { linear, translation, error, stretch });
                Self { sides, maps: [None, Some(boxes)], per_unit: stretch[0], far: None, relative }
            }
            None => Self {
                sides,
                maps: [Some(carried(host, host_side)), Some(carried(guest, guest_side))],
                per_unit: 1.0,
                far: is_far.then(|| Far::new(&gap, metric)),
                relative: None,
            },
        };
        let slack: f64 = bounds.maps.iter().flatten().map(|map| f64::from(map.slack())).sum();
        let blur = slack * bounds.per_unit;
        (bounds, blur)
    }

    /// Boxes of a node of the host, or of the guest, in the frame of comparison.
    #[inline(always)]
    pub(super) fn carry<S: Simd>(&self, simd: S, side: usize, node: &Node) -> BoxLanes {
        match &self.maps[side] {
            Some(map) => carried(simd, map, node),
            None => BoxLanes { min: node.min, max: node.max },
        }
    }

    /// The number that bounds of nodes are compared to, so that all that is above it is farther away than `metric`.
    pub(super) fn limit(&self, metric: f64) -> f32 {
        let reached = metric / self.per_unit;
        let limit = match &self.far {
            None => (reached * (1.0 + ROUNDING)).powi(2),
            Some(far) => (reached * (1.0 + 1e-12)) * far.length - far.along + far.slack,
        };
        (limit as f32).next_up()
    }

    /// Bounds of the distances of eight boxes from one, in the numbers that [`limit`](Self::limit) gives, as one of which
    /// `limit` says what matters; `guest_is_many` says on which side the eight are.
    #[inline(always)]
    pub(super) fn of<S: Simd>(
        &self,
        simd: S,
        many: &BoxLanes,
        one: &Aabb,
        guest_is_many: bool,
        limit: f32,
    ) -> LaneBounds {
        let (min, max) = (load3(simd, &many.min), load3(simd, &many.max));
        let (lower, order) = match &self.far {
            None => {
                let squared = squared_gaps(simd, (&min, &max), one);
                (squared, by_centres(simd, squared, (&min, &max), one))
            }
            Some(far) => {
                // What the guest's boxes reach towards the host, less what the host's reach towards the guest.
                let mut sum = f32x8::splat(simd, 0.0);
                for axis in 0..3 {
                    let n = f32x8::splat(simd, far.direction[axis]);
                    let (least_many, most_many) =
                        ((min[axis] * n).min(max[axis] * n), (min[axis] * n).max(max[axis] * n));
                    let (low, high) = (one.min[axis] * far.direction[axis], one.max[axis] * far.direction[axis]);
                    let (least_one, most_one) = (low.min(high), low.max(high));
                    sum += if guest_is_many {
                        least_many - f32x8::splat(simd, most_one)
                    } else {
                        f32x8::splat(simd, least_one) - most_many
                    };
                }
                (sum, sum)
            }
        };
        let near = !(lower.simd_gt(f32x8::splat(simd, limit)).to_bitmask() as u32);
        LaneBounds { bounds: lower.into(), order: order.into(), near }
    }
}

impl Far {
    fn new(gap: &Vector, metric: &Metric) -> Self {
        let size = length(gap);
        let direction = gap.map(|x| (x / size) as f32);
        let wide = direction.map(f64::from);
        // Three products and two sums for each of two boxes; and the gap itself.
        let slack = 32.0 * HALF_ULP * metric.extent + metric.error;
        Self { direction, length: length(&wide) * (1.0 + 1e-12), along: dot(&wide, gap), slack }
    }
}

#[inline(always)]
fn carried<S: Simd>(simd: S, map: &BoxMap, node: &Node) -> BoxLanes {
    outlined(
        simd,
        #[inline(always)]
        || map.apply(simd, node),
    )
}

/// The squares of the distances of eight boxes from one.
#[inline(always)]
pub(super) fn squared_gaps<S: Simd>(simd: S, many: (&[f32x8<S>; 3], &[f32x8<S>; 3]), one: &Aabb) -> f32x8<S> {
    let (min, max) = many;
    let zero = f32x8::splat(simd, 0.0);
    let gaps: [f32x8<S>; 3] = by_axis!(axis => {
        let (before, after) = (min[axis] - f32x8::splat(simd, one.max[axis]), f32x8::splat(simd, one.min[axis]) - max[axis]);
        before.max(after).max(zero)
    });
    gaps[0] * gaps[0] + gaps[1] * gaps[1] + gaps[2] * gaps[2]
}

/// What is least for the box to look at first, of eight at these squared distances from one.
#[inline(always)]
pub(super) fn by_centres<S: Simd>(
    simd: S,
    squared: f32x8<S>,
    (min, max): (&[f32x8<S>; 3], &[f32x8<S>; 3]),
    one: &Aabb,
) -> f32x8<S> {
    let doubled: Lanes3<S> =
        by_axis!(axis => (min[axis] + max[axis]) - f32x8::splat(simd, one.min[axis] + one.max[axis]));
    squared + dot3(&doubled, &doubled) * CENTRES
}

/// Bounds of the stretch of a matrix that keeps the shape of things, the lower and the upper; none for others.
fn stretch(linear: &[Vector; 3]) -> Option<[f64; 2]> {
    let column = |j: usize| [linear[0][j], linear[1][j], linear[2][j]];
    let gram = [0, 1, 2].map(|i| [0, 1, 2].map(|j| dot(&column(i), &column(j))));
    let squared = (gram[0][0] + gram[1][1] + gram[2][2]) / 3.0;
    let deviation =
        |i: usize| (0..3).map(|j| (gram[i][j] - if i == j { squared } else { 0.0 }).abs()).sum::<f64>() / squared;
    // The largest sum of magnitudes in a row bounds what a symmetric matrix stretches by.
    let worst = deviation(0).max(deviation(1)).max(deviation(2)) + 1e-14;
    // Squares that vanish or overflow make this NaN or infinite, and so no shape.
    let keeps_shape = worst <= SHAPE_KEPT && squared > f64::MIN_POSITIVE * 1e20;
    keeps_shape.then(|| [1.0 - worst, 1.0 + worst].map(|share| (squared * share).sqrt()))
}

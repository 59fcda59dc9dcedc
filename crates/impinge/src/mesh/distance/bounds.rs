//! Lower bounds of the distances between nodes of two trees, and the frame in which their boxes are
//! compared.
//!
//! Boxes are compared in the host's packed frame if the host's pose is nearly a rotation with a
//! uniform scale (within [`MAX_SHAPE_DEVIATION`]). The host's boxes are then used as they are
//! stored. Otherwise the boxes of both meshes are carried to the metric frame. One unit of the
//! frame of comparison is at least `per_unit` metric units.
//!
//! There are two kinds of bounds. The gap between the meshes decides which one is used:
//! - *near*: the squared distance of the boxes;
//! - *far*: the part of the gap, along its own direction, that the boxes of the nodes do not cover.
//!   It is used if single precision could not distinguish the nodes next to the gap. The gap itself
//!   is left out of the compared numbers.

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

/// Maximum relative deviation of the host's squared lengths from a common scale for which boxes are
/// compared in the host's packed frame: 2^-10. The bounds are looser by the same ratio. Beyond it,
/// carrying both trees to the metric frame costs less than loose bounds.
const MAX_SHAPE_DEVIATION: f64 = 1.0 / 1024.0;

/// Ratio of the gap between two meshes to their size above which bounds are *far*: 2^10, because
/// squares in single precision distinguish 2^-22.
const FAR: f64 = 1024.0;

/// Bound for the relative rounding error of a near bound, which takes seven operations, and of its
/// comparison: 2^-20.
const ROUNDING: f64 = 1.0 / (1_u64 << 20) as f64;

/// Lower bounds of the distances of eight boxes from one box.
pub(super) struct LaneBounds {
    /// Bound of each lane, comparable with [`Bounds::limit`].
    pub(super) bounds: [f32; LANES],
    /// Sort key of each lane: the box with the least key is processed first.
    pub(super) order: [f32; LANES],
    /// Lanes whose bound is not above the limit, as bits. The bits of unused lanes may be set, so
    /// callers mask them out. A bound that is NaN proves nothing, so its bit is set.
    pub(super) near: u32,
}

/// Weight of the squared doubled distance of the centers of two boxes in their order, beside the
/// squared gap. Boxes of surfaces that are near each other overlap, and then only the centers show
/// which pair to process first. Of the weights 0, 1/100, 1/16, 1/4, 1 and 4 this one opened the
/// fewest nodes: 265 for two knots that almost touch, compared with 667 for the gap alone.
const CENTER_WEIGHT: f32 = 1.0 / 16.0;

/// The frame in which the nodes of two trees are compared, and the kind of their bounds.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    /// Which mesh is the host.
    pub(super) sides: Sides,
    /// Maps of the boxes of host and guest into the frame of comparison. `None` for the host if its
    /// boxes are used as they are.
    maps: [Option<BoxMap>; 2],
    /// Minimum number of metric units for one unit of the frame of comparison.
    per_unit: f64,
    /// The gap between the meshes, if the bounds are *far*.
    far: Option<Far>,
    /// Map from the guest's packed frame to the host's, if boxes are compared in the host's.
    pub(super) relative: Option<RelativeFrame>,
}

/// The gap between the centers of two meshes that are far apart.
#[derive(Clone, Copy, Debug)]
struct Far {
    /// Direction from the host to the guest in the metric frame, of about unit length.
    direction: [f32; 3],
    /// Upper bound of the length of `direction`.
    length: f64,
    /// Length of the gap along `direction`, in metric units.
    along: f64,
    /// Bound for the rounding error of the sums of products of boxes and direction, in metric
    /// units.
    slack: f64,
}

impl Bounds {
    /// Chooses the host, the frame of comparison and the kind of bounds for two meshes.
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

    /// Returns the bounds for this host, and the size of their rounding error in metric units.
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

    /// Returns the boxes of a node's children in the frame of comparison. `side` is 0 for a node of
    /// the host and 1 for the guest.
    #[inline(always)]
    pub(super) fn carry<S: Simd>(&self, simd: S, side: usize, node: &Node) -> BoxLanes {
        match &self.maps[side] {
            Some(map) => carried(simd, map, node),
            None => BoxLanes { min: node.min, max: node.max },
        }
    }

    /// Returns the limit for the bounds of nodes: nodes whose bound is above it are farther apart
    /// than `metric`, in metric units.
    pub(super) fn limit(&self, metric: f64) -> f32 {
        let reached = metric / self.per_unit;
        let limit = match &self.far {
            None => (reached * (1.0 + ROUNDING)).powi(2),
            Some(far) => (reached * (1.0 + 1e-12)) * far.length - far.along + far.slack,
        };
        (limit as f32).next_up()
    }

    /// Computes lower bounds of the distances of eight boxes from one box. They are comparable with
    /// [`limit`](Self::limit), and `limit` is such a number. `guest_is_many` tells whether the
    /// eight boxes are the guest's.
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
                (squared, by_centers(simd, squared, (&min, &max), one))
            }
            Some(far) => {
                // How far the guest's boxes reach towards the host, less how far the host's boxes
                // reach towards the guest.
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
        // Three products and two sums are rounded for each of two boxes. The gap adds its own
        // error.
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

/// Returns the squared distances of eight boxes from one box.
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

/// Returns numbers by which eight boxes are ordered against one box, least first. `squared` has
/// their squared distances from it.
#[inline(always)]
pub(super) fn by_centers<S: Simd>(
    simd: S,
    squared: f32x8<S>,
    (min, max): (&[f32x8<S>; 3], &[f32x8<S>; 3]),
    one: &Aabb,
) -> f32x8<S> {
    let doubled: Lanes3<S> =
        by_axis!(axis => (min[axis] + max[axis]) - f32x8::splat(simd, one.min[axis] + one.max[axis]));
    squared + dot3(&doubled, &doubled) * CENTER_WEIGHT
}

/// Returns a lower and an upper bound of the factor by which a matrix stretches lengths. Returns
/// `None` unless the matrix is nearly a rotation with a uniform scale.
fn stretch(linear: &[Vector; 3]) -> Option<[f64; 2]> {
    let column = |j: usize| [linear[0][j], linear[1][j], linear[2][j]];
    let gram = [0, 1, 2].map(|i| [0, 1, 2].map(|j| dot(&column(i), &column(j))));
    let squared = (gram[0][0] + gram[1][1] + gram[2][2]) / 3.0;
    let deviation =
        |i: usize| (0..3).map(|j| (gram[i][j] - if i == j { squared } else { 0.0 }).abs()).sum::<f64>() / squared;
    // The largest sum of magnitudes in a row bounds the stretch by a symmetric matrix.
    let worst = deviation(0).max(deviation(1)).max(deviation(2)) + 1e-14;
    // If the squares vanish or overflow, `worst` is NaN or infinite, and the result is `None`.
    let keeps_shape = worst <= MAX_SHAPE_DEVIATION && squared > f64::MIN_POSITIVE * 1e20;
    keeps_shape.then(|| [1.0 - worst, 1.0 + worst].map(|share| (squared * share).sqrt()))
}

//! Fits oriented boxes to points: by principal components, or nearly of minimal volume with a
//! proved bound.

use super::super::obb::{orthonormal, projection_up};
use super::super::rounding::HALF_ULP;
use super::super::{BoundingVolume, Kdop26, Obb};
use super::enclosing::{scaled_offset, unit_scale};
use super::moments::principal_axes;
use crate::input::InputError;
use crate::math::vec3::{cross, dot, sub};
use crate::volume::points::{Coordinate, validated_bounds, widen};

/// An oriented box that encloses the points, and a lower bound of the minimal volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedObb {
    /// The box. It encloses every point.
    pub obb: Obb,
    /// Lower bound of the volume of any convex set that encloses the points. The volume of the box
    /// is at most 6√6 times this bound, up to rounding.
    pub volume_lower: f64,
}

/// The points relative to an origin, with the scale in which their size is about 1.
struct Set<'a, T> {
    points: &'a [[T; 3]],
    origin: [f64; 3],
    scale: f64,
}

/// Returns an oriented box that encloses all points, along their principal axes.
///
/// # Errors
/// Same as [`BoundingVolume::of_points`].
///
/// # Complexity
/// Six passes over memory.
///
/// # Source
/// *Notes*, 2.3; Gottschalk, Lin and Manocha 1996. The distribution of interior points moves the
/// axes, so this box can be larger than the axis-aligned one by any factor.
pub fn principal_obb<T: Coordinate>(points: &[[T; 3]]) -> Result<Obb, InputError> {
    let set = Set::new(points)?;
    Ok(set.box_along(principal_axes(points, set.origin, set.scale)))
}

/// Returns an oriented box of nearly minimal volume that encloses all points.
///
/// Candidates are the axis-aligned box, the box along the principal axes, one along approximate
/// diameters, and boxes along fixed directions. Each candidate is then improved, as long as that
/// helps: the box is rotated about one axis after the other into the smallest rectangle around the
/// points as seen along that axis. One side of that rectangle is flush with an edge of their
/// outline.
///
/// ```
/// use impinge::volume::{BoundingVolume, fit};
/// // The corners of a unit cube, turned.
/// let axes = [[2.0, 2.0, 1.0], [-2.0, 1.0, 2.0], [1.0, -2.0, 2.0]].map(|row| row.map(|x| x / 3.0));
/// let corner = |i: usize| std::array::from_fn(|k| (0..3).map(|j| (i >> j & 1) as f64 * axes[j][k]).sum());
/// let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
/// let fitted = fit::obb(&corners)?;
/// assert!((fitted.obb.volume() - 1.0).abs() < 1e-12);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Errors
/// Same as [`BoundingVolume::of_points`].
///
/// # Accuracy
/// The volume is at most 6√6 ≈ 14.7 times the minimal one. Proof: let p, q be the points at the
/// ends of the longest side of the axis-aligned box. They are at least 1/√3 of the diameter apart.
/// Project along pq. Two points r, s at the ends of the longer side of a rectangle are at least
/// 1/√2 of the projection's diameter apart. Let w be the extent perpendicular to both. The box
/// along these three directions has at most the volume √3 |pq| · √2 |rs| · w. The projection has an
/// area of at least |rs| w / 2. The hull is convex and has a chord of length |pq| over it, so its
/// volume is at least a third of their product: `volume_lower` is |pq| |rs| w / 6, less rounding.
/// `docs/tasks/volumes.md` lists the ratio to the hull for real meshes.
///
/// # Complexity
/// About 30 passes over memory.
///
/// # Source
/// Barequet and Har-Peled, *Efficiently approximating the minimum-volume bounding box of a point
/// set in three dimensions*, 2001 (the approximation from diameters; the constant above is ours);
/// Toussaint 1983 (rotating calipers), applied to one axis after the other; Larsson and Källberg,
/// *Fast computation of tight-fitting oriented bounding boxes*, 2011 (working on points that are
/// extreme in fixed directions).
pub fn obb<T: Coordinate>(points: &[[T; 3]]) -> Result<FittedObb, InputError> {
    let set = Set::new(points)?;
    let (diameters, volume_lower) = set.diameters();
    let principal = principal_axes(points, set.origin, set.scale);
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut starts = vec![identity, principal, diameters];
    starts.extend(Kdop26::DIRECTIONS[3..].iter().map(|&direction| orthonormal([direction, identity[0], identity[1]])));
    let extreme = set.extreme();
    let mut improved: Vec<([[f64; 3]; 3], f64)> = starts.iter().map(|&axes| improve(&extreme, axes)).collect();
    improved.sort_by(|a, b| a.1.total_cmp(&b.1));
    // The extreme points only approximate the whole set, so the best few boxes are measured on all
    // points. The three starts on which the proof and the comparison rest are measured, too.
    let finalists = improved.iter().map(|&(axes, _)| axes).take(3).chain([identity, principal, diameters]);
    let smallest = finalists.map(|axes| (axes, set.volume_along(axes))).min_by(|a, b| a.1.total_cmp(&b.1));
    let obb = set.box_along(smallest.map_or(identity, |(axes, _)| axes));
    Ok(FittedObb { obb, volume_lower: volume_lower.min(obb.volume()) })
}

impl<'a, T: Coordinate> Set<'a, T> {
    fn new(points: &'a [[T; 3]]) -> Result<Self, InputError> {
        let bounds = validated_bounds(points)?;
        let (min, max) = (bounds.min(), bounds.max());
        let origin = std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
        Ok(Self { points, origin, scale: unit_scale(&bounds) })
    }

    fn local(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.points.iter().map(|&point| scaled_offset(widen(point), self.origin, self.scale))
    }

    /// Returns the extent along each axis of a frame, and the points at its ends.
    fn extents<const N: usize>(&self, axes: [[f64; 3]; N]) -> [([f64; 2], [[f64; 3]; 2]); N] {
        let mut extents = [([f64::INFINITY, f64::NEG_INFINITY], [[0.0; 3]; 2]); N];
        for point in self.local() {
            for ((range, ends), axis) in extents.iter_mut().zip(axes) {
                let t = dot(&axis, &point);
                if t < range[0] {
                    (range[0], ends[0]) = (t, point);
                }
                if t > range[1] {
                    (range[1], ends[1]) = (t, point);
                }
            }
        }
        extents
    }

    fn volume_along(&self, axes: [[f64; 3]; 3]) -> f64 {
        self.extents(axes).iter().map(|([low, high], _)| high - low).product()
    }

    /// Returns axes along approximate diameters, and a proved lower bound of the volume of the
    /// hull.
    fn diameters(&self) -> ([[f64; 3]; 3], f64) {
        /// Bound on the rounding error of any length here, all below 8: 2^-45.
        const ROUNDING: f64 = 1.0 / (1_u64 << 45) as f64;
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let chord = |extents: &[([f64; 2], [[f64; 3]; 2])]| {
            let longest = extents.iter().max_by(|(a, _), (b, _)| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
            longest.map_or([0.0; 3], |(_, [p, q])| sub(q, p))
        };
        let first = chord(&self.extents(identity));
        let [first_axis, u, v] = orthonormal([first, identity[0], identity[1]]);
        let second = chord(&self.extents([u, v]));
        let axes = orthonormal([first_axis, second, u]);
        let [([low, high], _)] = self.extents([axes[2]]);
        // The length of the second chord as seen along the first.
        let seen = dot(&second, &axes[1]);
        let lengths =
            [dot(&first, &first).sqrt(), seen, high - low].map(|length| (length - ROUNDING).max(0.0) / self.scale);
        (axes, lengths.into_iter().product::<f64>() / 6.0 * (1.0 - ROUNDING))
    }

    /// Returns the points that are extreme in at least one of 61 directions spread over the sphere.
    /// If there are at most 200 points, returns all of them.
    fn extreme(&self) -> Vec<[f64; 3]> {
        const MAX_UNREDUCED: usize = 200;
        if self.points.len() <= MAX_UNREDUCED {
            return self.local().collect();
        }
        let between = |i: usize, j: usize| {
            let (a, b) = (Kdop26::DIRECTIONS[i], Kdop26::DIRECTIONS[j]);
            std::array::from_fn(|axis| a[axis] + 2.0 * b[axis])
        };
        let fixed = Kdop26::DIRECTIONS;
        let more: [[f64; 3]; 48] = std::array::from_fn(|k| between(k % 13, (k % 13 + 1 + k / 13) % 13));
        let ends =
            |extents: &[([f64; 2], [[f64; 3]; 2])]| extents.iter().flat_map(|&(_, ends)| ends).collect::<Vec<_>>();
        let mut extreme = ends(&self.extents(fixed));
        extreme.extend(ends(&self.extents(more)));
        extreme.sort_by(|p, q| p.partial_cmp(q).unwrap_or(std::cmp::Ordering::Equal));
        extreme.dedup();
        extreme
    }

    /// Returns the box with the given axes around the middle of the points along them. The
    /// half-extents are rounded up.
    fn box_along(&self, axes: [[f64; 3]; 3]) -> Obb {
        let extents = self.extents(axes);
        let mut center = self.origin;
        for (axis, ([low, high], _)) in axes.into_iter().zip(extents) {
            center = std::array::from_fn(|k| center[k] + axis[k] * (0.5 * (low + high) / self.scale));
        }
        let projections = |&point: &[T; 3]| {
            let offset = scaled_offset(widen(point), center, self.scale);
            axes.map(|axis| dot(&axis, &offset).abs())
        };
        let mut reach = [0.0_f64; 3];
        for point in self.points {
            let projected = projections(point);
            reach = std::array::from_fn(|k| reach[k].max(projected[k]));
        }
        // Six roundings of terms whose magnitudes sum to less than 4: only points this close to the
        // largest value can exceed it exactly.
        let near = reach.map(|x| x - 64.0 * HALF_ULP);
        let mut exact = [0.0_f64; 3];
        for point in self.points {
            let projected = projections(point);
            for k in 0..3 {
                if projected[k] >= near[k] {
                    exact[k] = exact[k].max(projection_up(axes[k], widen(*point), center));
                }
            }
        }
        Obb::of_reach(center, axes, exact)
    }
}

/// Rotates a box about one axis after the other, each time into the smallest rectangle, as long as
/// the volume shrinks. Returns the axes and the volume.
fn improve(points: &[[f64; 3]], mut axes: [[f64; 3]; 3]) -> ([[f64; 3]; 3], f64) {
    /// Maximum number of rotations, far more than enough while every three rotations gain 0.1 % or
    /// more. About ten are typical.
    const MAX_TURNS: usize = 30;
    let volume = |axes: &[[f64; 3]; 3]| -> f64 {
        let extent = |axis: &[f64; 3]| {
            let range = points
                .iter()
                .map(|&point| dot(axis, &point))
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| [a.min(t), b.max(t)]);
            range[1] - range[0]
        };
        axes.iter().map(extent).product()
    };
    let mut least = volume(&axes);
    let mut idle = 0;
    for turn in 0..MAX_TURNS {
        let about = turn % 3;
        let (u, v) = (axes[(about + 1) % 3], axes[(about + 2) % 3]);
        let turned = orthonormal(match smallest_rectangle(points, u, v) {
            Some(side) => [axes[about], side, cross(&axes[about], &side)],
            None => axes,
        });
        let next = volume(&turned);
        if next < least * (1.0 - 1e-9) {
            (axes, least, idle) = (turned, next, 0);
            // The axis of rotation is first now. Put it back, so that the next turn uses the next
            // axis.
            axes.rotate_right(about);
        } else {
            idle += 1;
            if idle == 3 {
                break;
            }
        }
    }
    (axes, least)
}

/// Returns the direction of a side of the smallest rectangle around the points as seen in the plane
/// of u and v. Returns `None` if they all appear as one point.
fn smallest_rectangle(points: &[[f64; 3]], u: [f64; 3], v: [f64; 3]) -> Option<[f64; 3]> {
    let hull = hull_2d(points.iter().map(|&point| [dot(&u, &point), dot(&v, &point)]).collect());
    let mut best = (f64::INFINITY, None);
    for (at, p) in hull.iter().enumerate() {
        let q = hull[(at + 1) % hull.len()];
        let edge = [q[0] - p[0], q[1] - p[1]];
        let length = (edge[0] * edge[0] + edge[1] * edge[1]).sqrt();
        if length == 0.0 {
            continue;
        }
        let side = edge.map(|x| x / length);
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for r in &hull {
            let seen = [side[0] * r[0] + side[1] * r[1], side[0] * r[1] - side[1] * r[0]];
            for (range, t) in ranges.iter_mut().zip(seen) {
                *range = [range[0].min(t), range[1].max(t)];
            }
        }
        let area = (ranges[0][1] - ranges[0][0]) * (ranges[1][1] - ranges[1][0]);
        if area < best.0 {
            best = (area, Some(std::array::from_fn(|k| side[0] * u[k] + side[1] * v[k])));
        }
    }
    best.1
}

/// Returns the convex hull in the plane, counter-clockwise (Andrew 1979), up to rounding. Only a
/// direction depends on it, so rounding is harmless.
fn hull_2d(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|p, q| p.partial_cmp(q).unwrap_or(std::cmp::Ordering::Equal));
    points.dedup();
    let turn = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let mut hull: Vec<[f64; 2]> = Vec::with_capacity(points.len() + 1);
    let mut chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let from = hull.len();
        for point in points {
            while hull.len() >= from + 2 && turn(hull[hull.len() - 2], hull[hull.len() - 1], point) <= 0.0 {
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop(); // the other chain begins with it
    };
    chain(&mut points.iter().copied());
    chain(&mut points.iter().rev().copied());
    if hull.is_empty() { points } else { hull }
}

//! Lower bounds on the distance of a convex set from the boxes and the faces of a mesh.
//!
//! A bound is the gap along the axes, or along a direction: the one from the nearest face that was
//! found, and, for a capsule, that to the nearest point of its axis.
//!
//! The proof is docs/notes/proof.md, L31, and the tests are in `tests/it/shapes/surfaces.rs`.

use std::cell::Cell;

use super::interval::{above, below};
use super::posed::{Core, Pair, to_unit_length};
use crate::math::vec3::{dot, length, sub};

/// A convex set in the common frame of it and a mesh, prepared for bounds on the mesh's boxes.
pub(super) struct Beside<'p> {
    pair: &'p Pair<'p>,
    /// Least and greatest coordinate of the set's core on each axis, in the common frame.
    bounds: [[f64; 2]; 3],
    /// The ends of the core, if it is a segment or a point.
    axis: Option<[[f64; 3]; 2]>,
    radius: f64,
    error: f64,
    /// A direction of length 1 from the mesh to the set, with the set's least height along it.
    plane: Cell<Option<([f64; 3], f64)>>,
}

impl<'p> Beside<'p> {
    pub(super) fn new(pair: &'p Pair<'p>, radius: f64) -> Self {
        let radius = above(radius / pair.unit);
        let error = pair.point_error();
        let bounds = std::array::from_fn(|k| {
            let end = |sign: f64| {
                let direction = std::array::from_fn(|j| if j == k { sign } else { 0.0 });
                sign * (pair.b.support(direction).point[k] * sign + pair.height_error(direction))
            };
            [end(-1.0), end(1.0)]
        });
        let spot = |local: [f64; 3]| pair.b.spot(local).point;
        let axis = match pair.b.core() {
            Core::Points(&[center]) => Some([spot(center); 2]),
            Core::Points(&[start, end]) => Some([spot(start), spot(end)]),
            _ => None,
        };
        Self { pair, bounds, axis, radius, error, plane: Cell::new(None) }
    }

    /// Adds the gap along a direction of the world, from the mesh to the set, to all later bounds.
    pub(super) fn look_along(&self, direction: [f64; 3]) {
        let direction = to_unit_length(direction);
        let against = direction.map(|x| -x);
        let lowest = dot(&direction, &self.pair.b.support(against).point);
        self.plane.set(Some((direction, lowest - self.pair.height_error(against) - self.radius)));
    }

    /// Returns a lower bound on the distance, in world units, between the set and a box of the
    /// mesh's frame. It is negative if the two boxes overlap, and the more so the deeper they do: a
    /// face in the middle of the set is found before those at its border. Bounds above `cut` are
    /// not made larger.
    pub(super) fn bound(&self, center: &[f64; 3], half_extents: &[f64; 3], cut: f64) -> f64 {
        let at = self.pair.a.spot(*center).point;
        let linear = self.pair.a.pose().linear();
        let scale = 1.0 / self.pair.unit;
        let gaps: [f64; 3] = std::array::from_fn(|k| {
            let reach = (0..3).map(|j| linear[k][j].abs() * half_extents[j]).sum::<f64>() * scale;
            f64::max(self.bounds[k][0] - (at[k] + reach), at[k] - reach - self.bounds[k][1])
        });
        let height = |direction: &[f64; 3]| {
            let reach: f64 = (0..3)
                .map(|j| (0..3).map(|k| linear[k][j] * direction[k]).sum::<f64>().abs() * half_extents[j])
                .sum::<f64>()
                * scale;
            dot(direction, &at) + reach
        };
        self.gap(self.gap_of_boxes(&gaps), height, || at, cut)
    }

    /// Returns a lower bound on the distance, in world units, between the set and something that
    /// has this gap to it along the axes, and a greatest height along each direction from the mesh
    /// to the set. A point of it is `inside`.
    fn gap(
        &self,
        of_boxes: f64,
        height: impl Fn(&[f64; 3]) -> f64,
        inside: impl FnOnce() -> [f64; 3],
        cut: f64,
    ) -> f64 {
        let in_world = |gap: f64| (below(gap) - 8.0 * self.error) * self.pair.unit;
        let mut gap = of_boxes;
        if let Some((direction, lowest)) = self.plane.get() {
            gap = gap.max(lowest - height(&direction));
        }
        let found = in_world(gap);
        match &self.axis {
            Some(axis) if found <= cut => {
                let direction = to_unit_length(towards_axis(&inside(), axis));
                let lowest = dot(&direction, &axis[0]).min(dot(&direction, &axis[1]));
                found.max(in_world(lowest - self.radius - height(&direction)))
            }
            _ => found,
        }
    }

    /// Returns the distance of the set from a box that has these gaps to the core's box along the
    /// axes. It is negative if the boxes overlap.
    fn gap_of_boxes(&self, gaps: &[f64; 3]) -> f64 {
        let largest = gaps[0].max(gaps[1]).max(gaps[2]);
        let apart = if largest > 0.0 { length(&gaps.map(|gap| gap.max(0.0))) } else { largest };
        below(apart) - self.radius
    }

    /// Returns the center of the set's box, in the common frame.
    pub(super) fn center(&self) -> [f64; 3] {
        self.bounds.map(|[least, greatest]| 0.5 * least + 0.5 * greatest)
    }

    /// Returns the two sets in their common frame.
    pub(super) fn pair(&self) -> &'p Pair<'p> {
        self.pair
    }

    /// Returns the radius of the set, in the common unit.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns a lower bound on the distance, in world units, between the set and the hull of three
    /// points of the common frame. `ends` are their least and greatest coordinates on each axis.
    /// Bounds above `cut` are not made larger.
    pub(super) fn gap_of_points(&self, points: &[[f64; 3]; 3], ends: &[[f64; 2]; 3], cut: f64) -> f64 {
        let gap = |k: usize| f64::max(self.bounds[k][0] - ends[k][1], ends[k][0] - self.bounds[k][1]);
        let height = |direction: &[f64; 3]| {
            points.iter().fold(f64::NEG_INFINITY, |height, point| height.max(dot(direction, point)))
        };
        let middle = || std::array::from_fn(|k| (points[0][k] + points[1][k] + points[2][k]) / 3.0);
        self.gap(self.gap_of_boxes(&[gap(0), gap(1), gap(2)]), height, middle, cut)
    }
}

/// Returns a vector from a point towards the nearest point of a segment, rounded.
fn towards_axis(point: &[f64; 3], [start, end]: &[[f64; 3]; 2]) -> [f64; 3] {
    let (along, from_start) = (sub(end, start), sub(point, start));
    let share = dot(&along, &from_start) / dot(&along, &along);
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    std::array::from_fn(|k| share * along[k] - from_start[k])
}

/// Returns the least and the greatest coordinate of three points on each axis.
#[inline]
pub(super) fn ends_of([p, q, r]: &[[f64; 3]; 3]) -> [[f64; 2]; 3] {
    let ends = |k: usize| [p[k].min(q[k]).min(r[k]), p[k].max(q[k]).max(r[k])];
    [ends(0), ends(1), ends(2)]
}

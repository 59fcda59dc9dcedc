//! A cell of the search for a depth: a convex polytope by its corners and its planes.
//!
//! Each corner knows the planes that it lies on. Two corners may be the ends of an edge only if
//! they share two planes, so a cut needs no list of edges or faces. All points of the parent lie in
//! a child, except for points within the slack of the cutting plane.
//!
//! Source: the double description method of Motzkin and others, *The double description method*,
//! 1953. Ours departs in keeping pairs of corners that only may be edges: each adds a point that
//! lies in the cell anyway.
//!
//! Guarded by `tests/it/clash/cases.rs`, and by unit tests below.

use smallvec::SmallVec;

use crate::math::vec3::{Vector, add, cross, dot, scale, squared_distance, sub};

/// A half-space: the points whose product with the normal is at most the height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Normal of length 1.
    pub(super) normal: Vector,
    pub(super) height: f64,
}

/// A corner of a cell.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: Vector,
    /// The planes that the corner lies on: bit i is plane i.
    on: u128,
}

/// A convex polytope.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    corners: Vec<Corner>,
    /// The planes. Those without corners are out of use.
    planes: Vec<Plane>,
}

/// A part of a triangle. Most have few corners, which need no allocation.
pub(super) type Polygon = SmallVec<[Vector; 9]>;

/// How a triangle lies across the planes of a cell.
struct Across {
    /// The planes that divide the triangle: bit i is plane i.
    planes: u128,
    /// Whether a corner of the triangle is inside all planes.
    has_corner_inside: bool,
}

impl Plane {
    /// Returns the distance of a point beyond the plane, negative inside the half-space.
    pub(super) fn beyond(&self, point: &Vector) -> f64 {
        dot(&self.normal, point) - self.height
    }

    fn reversed(&self) -> Self {
        Self { normal: scale(&self.normal, -1.0), height: -self.height }
    }
}

impl Cell {
    /// Maximum number of planes, one for each bit of a corner.
    const MAX_PLANES: usize = 128;

    /// Maximum number of corners of a cell that is cut. Rounding adds corners to cells of many
    /// planes.
    const MAX_CORNERS: usize = 64;

    /// Returns the cell of a box.
    pub(super) fn cuboid(bounds: &[Vector; 2]) -> Self {
        let plane = |axis: usize, end: usize| {
            let mut normal = [0.0; 3];
            normal[axis] = if end == 0 { -1.0 } else { 1.0 };
            Plane { normal, height: bounds[end][axis] * normal[axis] }
        };
        let planes = (0..6).map(|at| plane(at / 2, at % 2)).collect();
        let corner = |at: usize| {
            let ends = [at & 1, at >> 1 & 1, at >> 2 & 1];
            let on = (0..3).map(|axis| 1_u128 << (2 * axis + ends[axis])).sum();
            Corner { at: std::array::from_fn(|axis| bounds[ends[axis]][axis]), on }
        };
        Self { corners: (0..8).map(corner).collect(), planes }
    }

    pub(super) fn corners(&self) -> impl ExactSizeIterator<Item = &Vector> {
        self.corners.iter().map(|corner| &corner.at)
    }

    /// Returns the cell, moved.
    pub(super) fn translated(&self, by: &Vector) -> Self {
        let corners = self.corners.iter().map(|corner| Corner { at: add(&corner.at, by), ..*corner }).collect();
        let moved = |plane: &Plane| Plane { height: plane.height + dot(&plane.normal, by), ..*plane };
        Self { corners, planes: self.planes.iter().map(moved).collect() }
    }

    /// Returns the planes that the cell has corners on: bit i is plane i.
    fn used(&self) -> u128 {
        self.corners.iter().fold(0, |used, corner| used | corner.on)
    }

    /// Returns the planes that the cell has corners on.
    pub(super) fn planes(&self) -> impl Iterator<Item = &Plane> {
        let used = self.used();
        self.planes.iter().enumerate().filter(move |(at, _)| used >> at & 1 == 1).map(|(_, plane)| plane)
    }

    /// Returns the mean of the corners, which lies in the cell.
    pub(super) fn center(&self) -> Vector {
        let sum = self.corners().fold([0.0; 3], |sum, at| add(&sum, at));
        scale(&sum, 1.0 / self.corners.len() as f64)
    }

    /// Returns the box about the cell.
    pub(super) fn bounds(&self) -> [Vector; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for at in self.corners() {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(at[axis]);
                bounds[1][axis] = bounds[1][axis].max(at[axis]);
            }
        }
        bounds
    }

    /// Returns the box about the cell, grown by a margin.
    pub(super) fn bounds_grown(&self, margin: f64) -> [Vector; 2] {
        let [low, high] = self.bounds();
        [low.map(|x| x - margin), high.map(|x| x + margin)]
    }

    /// Returns the volume of the cell.
    pub(super) fn volume(&self) -> f64 {
        let center = self.center();
        self.sides().map(|(plane, area)| area * -plane.beyond(&center)).sum::<f64>() / 3.0
    }

    /// Returns the area of all sides of the cell.
    pub(super) fn surface(&self) -> f64 {
        self.sides().map(|(_, area)| area).sum()
    }

    /// Returns the plane and the area of each side.
    fn sides(&self) -> impl Iterator<Item = (&Plane, f64)> {
        self.planes.iter().enumerate().map(|(at, plane)| {
            let on: Vec<Vector> =
                self.corners.iter().filter(|corner| corner.on >> at & 1 == 1).map(|corner| corner.at).collect();
            (plane, area_of(&plane.normal, &on))
        })
    }

    /// Cuts the cell by a plane: returns the cell inside its half-space and the cell beyond. A cell
    /// without corners off the plane by more than the slack is `None`. Returns `None` alone if the
    /// cell has too many planes or corners to be cut.
    pub(super) fn cut(&self, plane: &Plane, slack: f64) -> Option<[Option<Self>; 2]> {
        let used = self.used();
        let bit = (!used).trailing_zeros() as usize;
        if bit >= Self::MAX_PLANES || self.corners.len() > Self::MAX_CORNERS {
            return None;
        }
        let beyond: Vec<f64> = self.corners().map(|at| plane.beyond(at)).collect();
        let half = |sign: f64, plane: Plane| {
            if beyond.iter().all(|x| sign * x >= -slack) {
                return None;
            }
            let mut corners = Vec::with_capacity(self.corners.len() + 4);
            for (corner, x) in self.corners.iter().zip(&beyond) {
                if x.abs() <= slack {
                    corners.push(Corner { on: corner.on | 1 << bit, ..*corner });
                } else if sign * x < 0.0 {
                    corners.push(*corner);
                }
            }
            self.push_crossings(&mut corners, &beyond, (bit, slack));
            let mut planes = self.planes.clone();
            if bit == planes.len() {
                planes.push(plane);
            } else {
                planes[bit] = plane;
            }
            Some(Self { corners, planes })
        };
        Some([half(1.0, *plane), half(-1.0, plane.reversed())])
    }

    /// Adds the points in which edges cross a plane, given the distances of all corners beyond it.
    /// Points in one place become one corner, so that their number stays that of the polytope.
    fn push_crossings(&self, corners: &mut Vec<Corner>, beyond: &[f64], (bit, slack): (usize, f64)) {
        for (from, x) in self.corners.iter().zip(beyond).filter(|(_, x)| **x < -slack) {
            for (to, y) in self.corners.iter().zip(beyond).filter(|(_, y)| **y > slack) {
                let common = from.on & to.on;
                if common.count_ones() < 2 {
                    continue;
                }
                let step = scale(&sub(&to.at, &from.at), x / (x - y));
                let (at, on) = (add(&from.at, &step), common | 1 << bit);
                let is_near = |old: &&mut Corner| squared_distance(&old.at, &at) <= slack * slack;
                match corners.iter_mut().find(is_near) {
                    Some(old) => old.on |= on,
                    None => corners.push(Corner { at, on }),
                }
            }
        }
    }

    /// Returns the part of a triangle inside the cell, grown by a margin. It is empty if the
    /// triangle does not reach the grown cell.
    pub(super) fn clip(&self, triangle: &[Vector; 3], margin: f64) -> Polygon {
        self.across(triangle, margin).map_or_else(Polygon::new, |across| self.clip_by(across.planes, triangle, margin))
    }

    /// Reports whether a triangle reaches the cell, grown by a margin.
    pub(super) fn meets(&self, triangle: &[Vector; 3], margin: f64) -> bool {
        self.across(triangle, margin)
            .is_some_and(|across| across.has_corner_inside || !self.clip_by(across.planes, triangle, margin).is_empty())
    }

    /// Returns the planes, moved outward by a margin, that divide a triangle, or `None` if the
    /// triangle is beyond one of them.
    fn across(&self, triangle: &[Vector; 3], margin: f64) -> Option<Across> {
        let used = self.used();
        let (mut planes, mut outside) = (0, [false; 3]);
        for (at, plane) in self.planes.iter().enumerate().filter(|(at, _)| used >> at & 1 == 1) {
            let beyond = triangle.each_ref().map(|corner| plane.beyond(corner) > margin);
            if beyond == [true; 3] {
                return None;
            }
            if beyond != [false; 3] {
                planes |= 1 << at;
                outside = std::array::from_fn(|corner| outside[corner] || beyond[corner]);
            }
        }
        Some(Across { planes, has_corner_inside: outside != [true; 3] })
    }

    /// Returns the part of a triangle inside some of the planes, moved outward by a margin.
    fn clip_by(&self, planes: u128, triangle: &[Vector; 3], margin: f64) -> Polygon {
        let mut polygon = Polygon::from_slice(triangle);
        let (mut clipped, mut beyond) = (Polygon::new(), SmallVec::<[f64; 9]>::new());
        for (_, plane) in self.planes.iter().enumerate().filter(|(at, _)| planes >> at & 1 == 1) {
            beyond.clear();
            beyond.extend(polygon.iter().map(|point| plane.beyond(point) - margin));
            if beyond.iter().all(|&x| x <= 0.0) {
                continue;
            }
            if beyond.iter().all(|&x| x > 0.0) {
                return Polygon::new();
            }
            clipped.clear();
            for at in 0..polygon.len() {
                let next = (at + 1) % polygon.len();
                let (x, y) = (beyond[at], beyond[next]);
                if x <= 0.0 {
                    clipped.push(polygon[at]);
                }
                if x < 0.0 && y > 0.0 || x > 0.0 && y < 0.0 {
                    clipped.push(add(&polygon[at], &scale(&sub(&polygon[next], &polygon[at]), x / (x - y))));
                }
            }
            std::mem::swap(&mut polygon, &mut clipped);
        }
        polygon
    }
}

/// Returns the area of the convex polygon of some corners in a plane.
fn area_of(normal: &Vector, corners: &[Vector]) -> f64 {
    if corners.len() < 3 {
        return 0.0;
    }
    let center = scale(&corners.iter().fold([0.0; 3], |sum, at| add(&sum, at)), 1.0 / corners.len() as f64);
    let arms: Vec<Vector> = corners.iter().map(|at| sub(at, &center)).collect();
    let [x, y] = [arms[0], cross(normal, &arms[0])];
    let mut turned: Vec<(f64, &Vector)> = arms.iter().map(|arm| (dot(arm, &y).atan2(dot(arm, &x)), arm)).collect();
    turned.sort_by(|a, b| a.0.total_cmp(&b.0));
    let next = turned.iter().cycle().skip(1);
    0.5 * turned.iter().zip(next).map(|((_, a), (_, b))| dot(normal, &cross(a, b))).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(cell: &Cell) -> f64 {
        // The cells of these tests are boxes, or prisms along z.
        let [low, high] = cell.bounds();
        (0..3).map(|axis| high[axis] - low[axis]).product()
    }

    #[test]
    fn both_halves_of_a_box_fill_it() {
        let cell = Cell::cuboid(&[[0.0; 3], [4.0, 2.0, 1.0]]);
        let [below, above] = cell.cut(&Plane { normal: [1.0, 0.0, 0.0], height: 1.0 }, 1e-12).unwrap();
        let (below, above) = (below.unwrap(), above.unwrap());
        assert_eq!((below.corners().len(), above.corners().len()), (8, 8));
        assert_eq!((volume(&below), volume(&above)), (2.0, 6.0));
    }

    #[test]
    fn a_cut_through_corners_keeps_them_in_both_halves() {
        let cell = Cell::cuboid(&[[0.0; 3], [1.0; 3]]);
        let diagonal = Plane { normal: [0.5_f64.sqrt(), -(0.5_f64.sqrt()), 0.0], height: 0.0 };
        let [below, above] = cell.cut(&diagonal, 1e-12).unwrap();
        assert_eq!([below.unwrap().corners().len(), above.unwrap().corners().len()], [6, 6]);
        let outside = Plane { normal: [1.0, 0.0, 0.0], height: 1.0 };
        let [all, nothing] = cell.cut(&outside, 1e-12).unwrap();
        assert!(all.is_some() && nothing.is_none());
    }

    #[test]
    fn triangles_are_clipped_to_the_cell() {
        let cell = Cell::cuboid(&[[0.0; 3], [1.0; 3]]);
        let wide = [[-9.0, -9.0, 0.5], [9.0, -9.0, 0.5], [0.0, 9.0, 0.5]];
        assert_eq!(cell.clip(&wide, 0.0).len(), 4);
        let touching = wide.map(|[x, y, _]| [x, y, 1.0]);
        assert!(!cell.clip(&touching, 0.0).is_empty());
        let apart = wide.map(|[x, y, _]| [x, y, 1.25]);
        assert!(cell.clip(&apart, 0.125).is_empty() && !cell.clip(&apart, 0.25).is_empty());
    }
}

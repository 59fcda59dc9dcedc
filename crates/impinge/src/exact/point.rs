//! The position of a point relative to the corners of a mesh: along an axis, beside an edge viewed
//! along an axis, and relative to the plane of a face. These signs alone decide whether the point
//! is on a triangle, and where a ray along an axis of the mesh's frame crosses a triangle.
//!
//! The point may belong to another mesh with another pose. Its coordinates in the mesh's frame are
//! then rational, and are computed only as floats with an error bound. Signs that the bound leaves
//! undecided are computed exactly in the world frame, where the columns of the mesh's linear part
//! stand for the axes (Cramer's rule). The proof is docs/notes/proof.md, L16.

use std::cell::OnceCell;
use std::cmp::Ordering;

use super::Corners;
use super::filter::{self, Errors};
use super::placement::{Placement, world_point};
use crate::math::Sign::{self, Negative, Positive, Zero};
use crate::math::dyadic::{self, Dyadic};
use crate::math::relative::{INFLATE, UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::sub;

/// A point in the frame of the mesh that it belongs to.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Spot {
    /// The point with these coordinates.
    At([f64; 3]),
    /// A point within a triangle: exactly half of its first corner plus a quarter of each other
    /// corner.
    Within(Corners),
}

/// A point relative to a mesh, the host. Corners belong to the host and are in its frame.
pub(crate) struct PosedPoint<'p> {
    /// Point in the host's frame. Each coordinate is wrong by at most `error`.
    pub(crate) approximate: [f64; 3],
    pub(crate) error: [f64; 3],
    spot: Spot,
    /// Placement of the host, as A, and of the point's mesh, as B. `None` if both have one frame.
    placement: Option<&'p Placement>,
    exact: OnceCell<Box<ExactPoint>>,
}

/// Direction of a ray along an axis of the host's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AxisRay {
    pub(crate) axis: usize,
    /// Whether the ray points towards larger coordinates.
    pub(crate) ascending: bool,
}

struct ExactPoint {
    /// Exact point, in the common frame or in the world.
    point: [Dyadic; 3],
    /// The host's axes in the world, or `None` in the common frame.
    columns: Option<[[Dyadic; 3]; 3]>,
}

impl AxisRay {
    /// Returns the other two axes, in the order that makes all three a right-handed frame.
    pub(crate) fn across(self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }
}

impl Spot {
    /// Returns the coordinates in floats, and bounds on their errors.
    fn rounded(&self) -> ([f64; 3], [f64; 3]) {
        match self {
            Self::At(point) => (*point, [0.0; 3]),
            Self::Within([a, b, c]) => {
                let mean = |x: f64, y: f64, z: f64| 0.5 * x + (0.25 * y + 0.25 * z);
                let point = std::array::from_fn(|k| mean(a[k], b[k], c[k]));
                // Two sums are rounded. The products are exact except for subnormal numbers.
                let bound = |x: f64| 2.0 * UNIT_ROUNDOFF * INFLATE * x + UNDERFLOW;
                (point, std::array::from_fn(|k| bound(mean(a[k].abs(), b[k].abs(), c[k].abs()))))
            }
        }
    }

    fn exact(&self) -> [Dyadic; 3] {
        match self {
            Self::At(point) => point.map(Dyadic::from_f64),
            Self::Within([a, b, c]) => std::array::from_fn(|k| {
                let part = |x: f64, weight: f64| Dyadic::product(x, weight);
                &part(a[k], 0.5) + &(&part(b[k], 0.25) + &part(c[k], 0.25))
            }),
        }
    }
}

impl<'p> PosedPoint<'p> {
    /// Builds a point of the host's own frame.
    pub(crate) fn local(spot: Spot) -> Self {
        let (approximate, error) = spot.rounded();
        Self { approximate, error, spot, placement: None, exact: OnceCell::new() }
    }

    /// Builds a point of B's frame relative to A, the host.
    pub(crate) fn new(placement: &'p Placement, spot: Spot) -> Self {
        if placement.is_shared() {
            return Self::local(spot);
        }
        let (point, own_error) = spot.rounded();
        let map = placement.relative();
        let image_error = map.image_error(std::array::from_fn(|k| point[k].abs()));
        let error = std::array::from_fn(|i| {
            let carried: f64 =
                (0..3).map(|k| (map.linear[i][k].abs() + map.linear_error[i][k]) * own_error[k]).sum::<f64>();
            image_error[i] + carried * INFLATE + UNDERFLOW
        });
        Self { approximate: map.apply(point), error, spot, placement: Some(placement), exact: OnceCell::new() }
    }

    /// Compares the point with a corner along an axis of the host's frame.
    pub(crate) fn compare(&self, axis: usize, corner: &[f64; 3]) -> Sign {
        let (difference, error) = (self.approximate[axis] - corner[axis], self.error[axis] * INFLATE);
        // The difference of two floats may be rounded, but its sign is right.
        if difference > error {
            Positive
        } else if difference < -error {
            Negative
        } else if error == 0.0 {
            Zero
        } else {
            self.exact_compare(axis, corner)
        }
    }

    /// Returns the side of the edge from `a` to `b` on which the point lies, looking against an
    /// axis. Left is positive.
    pub(crate) fn beside(&self, axis: usize, a: &[f64; 3], b: &[f64; 3]) -> Sign {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let p = &self.approximate;
        let (u_i, u_j, v_i, v_j) = (a[i] - p[i], a[j] - p[j], b[i] - p[i], b[j] - p[j]);
        let (forward, backward) = (u_i * v_j, u_j * v_i);
        let determinant = forward - backward;
        let (e_i, e_j) = (self.error[i], self.error[j]);
        let input = (u_i.abs() + v_i.abs() + e_i) * e_j + (u_j.abs() + v_j.abs() + e_j) * e_i;
        // Two differences, a product and the last difference make four roundings. Five units also
        // cover the rounding of the bound.
        let rounding = 5.0 * UNIT_ROUNDOFF * (forward.abs() + backward.abs());
        let error = input * INFLATE + rounding + UNDERFLOW;
        if determinant > error {
            Positive
        } else if determinant < -error {
            Negative
        } else {
            self.exact_beside(axis, a, b)
        }
    }

    /// Returns the sign of `det(b - a, c - a, point - a)`. It is positive on the side of the normal
    /// of the corners.
    pub(crate) fn above(&self, [a, b, c]: &Corners) -> Sign {
        const NONE: [f64; 3] = [0.0; 3];
        let (u, v) = (sub(b, a), sub(c, a));
        let w = sub(&self.approximate, a);
        let [certain] = filter::signs(&u, &v, &[w], &Errors { u: &NONE, v: &NONE, w: &self.error });
        certain.unwrap_or_else(|| {
            let exact = self.exact();
            let [a, b, c] = [a, b, c].map(|corner| self.exact_corner(corner));
            let normal = dyadic::cross(&minus(&b, &a), &minus(&c, &a));
            self.in_host(dyadic::dot(&normal, &minus(&exact.point, &a)).sign())
        })
    }

    /// Reports whether the point is on the closed triangle, which may be a segment or a point.
    pub(crate) fn is_on(&self, corners: &Corners) -> bool {
        let within = |axis: usize| {
            let sides = corners.each_ref().map(|corner| self.compare(axis, corner));
            !sides.iter().all(|&side| side == Positive) && !sides.iter().all(|&side| side == Negative)
        };
        (0..3).all(within) && self.above(corners) == Zero && self.is_on_in_plane(corners)
    }

    /// Reports whether the point is on the triangle. It must be in the box of the corners and in
    /// their plane; if they have no plane, anywhere in their box.
    fn is_on_in_plane(&self, corners: &Corners) -> bool {
        let [a, b, c] = corners;
        for axis in 0..3 {
            let sides = [self.beside(axis, a, b), self.beside(axis, b, c), self.beside(axis, c, a)];
            if sides.contains(&Negative) && sides.contains(&Positive) {
                return false;
            }
            // All sides have one sign or are zero: the point is within the projection, or in line
            // with a projection that is a segment.
            let turning = PosedPoint::local(Spot::At(*c)).beside(axis, a, b);
            if turning != Zero {
                return true;
            }
            if sides != [Zero; 3] {
                return false;
            }
        }
        // By all projections, the point is in line with a segment, or at a point.
        true
    }

    /// Returns how often a ray crosses the triangle from its back to its front: 1, 0, or -1 for the
    /// other direction. The ray starts beside the point, as [`turns_about`](Self::turns_about)
    /// defines. Returns 0 for a triangle whose plane holds the point.
    pub(crate) fn crossing(&self, ray: AxisRay, corners: &Corners) -> i32 {
        let turns = self.turns_about(ray, corners);
        if turns == 0 {
            return 0;
        }
        // If the corners turn to the left, the normal points along the axis. So `behind` is
        // negative if the point is on the side of smaller coordinates, which puts the triangle
        // ahead of an ascending ray.
        let behind = self.above(corners).negated_if(turns < 0);
        match (behind, ray.ascending) {
            (Negative, true) => turns,
            (Positive, false) => -turns,
            _ => 0,
        }
    }

    /// Returns how the corners turn about the line of a ray, looking against its axis: 1 to the
    /// left, -1 to the right, 0 if the line misses the triangle. The line is beside the point,
    /// moved by `δ` along the first axis [across](AxisRay::across) and by `ε` along the second.
    /// `0 < ε ≪ δ` are as small as is needed to pass edges and corners on one side (Edelsbrunner
    /// and Mücke, *Simulation of Simplicity*, ACM Transactions on Graphics 9(1), 1990, here for one
    /// point only).
    pub(crate) fn turns_about(&self, ray: AxisRay, corners: &Corners) -> i32 {
        let [_, j] = ray.across();
        let below = corners.each_ref().map(|corner| self.compare(j, corner) != Negative);
        if below[0] == below[1] && below[1] == below[2] {
            return 0;
        }
        let mut turns = 0;
        for k in 0..3 {
            let next = (k + 1) % 3;
            if below[k] != below[next] {
                match (below[k], self.beside(ray.axis, &corners[k], &corners[next])) {
                    (true, Positive) => turns += 1,
                    (false, Negative) => turns -= 1,
                    _ => {}
                }
            }
        }
        turns
    }

    /// Returns the same as [`beside`](Self::beside), but for the line of a ray that
    /// [`turns_about`](Self::turns_about) defines. The sign is zero only for an edge that is a
    /// point in this view.
    pub(crate) fn ray_beside(&self, ray: AxisRay, a: &[f64; 3], b: &[f64; 3]) -> Sign {
        let [i, j] = ray.across();
        let rises = |axis: usize| Sign::from(b[axis].partial_cmp(&a[axis]).unwrap_or(Ordering::Equal));
        match (self.beside(ray.axis, a, b), rises(j)) {
            (Zero, Zero) => rises(i),
            (Zero, rise) => -rise,
            (side, _) => side,
        }
    }

    fn exact_compare(&self, axis: usize, corner: &[f64; 3]) -> Sign {
        let exact = self.exact();
        let difference = minus(&exact.point, &self.exact_corner(corner));
        match &exact.columns {
            None => difference[axis].sign(),
            Some(columns) => {
                let others = dyadic::cross(&columns[(axis + 1) % 3], &columns[(axis + 2) % 3]);
                self.in_host(dyadic::dot(&others, &difference).sign())
            }
        }
    }

    fn exact_beside(&self, axis: usize, a: &[f64; 3], b: &[f64; 3]) -> Sign {
        let exact = self.exact();
        let [u, v] = [a, b].map(|corner| minus(&self.exact_corner(corner), &exact.point));
        match &exact.columns {
            None => {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                (&(&u[i] * &v[j]) - &(&u[j] * &v[i])).sign()
            }
            Some(columns) => self.in_host(dyadic::dot(&dyadic::cross(&u, &v), &columns[axis]).sign()),
        }
    }

    fn exact(&self) -> &ExactPoint {
        self.exact.get_or_init(|| {
            let point = self.spot.exact();
            let Some(placement) = self.placement else {
                return Box::new(ExactPoint { point, columns: None });
            };
            let pose = placement.world_from_b();
            let coordinate = |i: usize| {
                let row = pose.linear()[i].map(Dyadic::from_f64);
                &dyadic::dot(&row, &point) + &Dyadic::from_f64(pose.translation()[i])
            };
            let linear = placement.world_from_a().linear();
            let columns = std::array::from_fn(|k| linear.each_ref().map(|row| Dyadic::from_f64(row[k])));
            Box::new(ExactPoint { point: [coordinate(0), coordinate(1), coordinate(2)], columns: Some(columns) })
        })
    }

    fn exact_corner(&self, corner: &[f64; 3]) -> [Dyadic; 3] {
        match self.placement {
            None => corner.map(Dyadic::from_f64),
            Some(placement) => world_point(placement.world_from_a(), corner),
        }
    }

    /// Converts the sign of a determinant in the exact frame to its sign in the host's frame.
    fn in_host(&self, sign: Sign) -> Sign {
        sign.negated_if(self.placement.is_some_and(|placement| placement.world_from_a().mirrors()))
    }
}

fn minus(p: &[Dyadic; 3], q: &[Dyadic; 3]) -> [Dyadic; 3] {
    [&p[0] - &q[0], &p[1] - &q[1], &p[2] - &q[2]]
}

//! Discrete-orientation polytopes: intersections of slabs in fixed directions (Klosowski, Held,
//! Mitchell, Sowizral and Zikan, *Efficient collision detection using bounding volume hierarchies
//! of k-DOPs*, 1998; Ericson 4.6).
//!
//! Tests: `tests/it/volumes/fitted.rs`, `tests/it/volumes/laws.rs`. Benchmark: `volumes`.

use super::BoundingVolume;
use super::points::{Coordinate, validated_bounds, widen};
use super::rounding::{LIMIT, add_down, add_up, mul_up};
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::math::vec3::{add, cross, dot, scale, sub};

/// Directions to the faces, edges and corners of a cube, in the order in which the polytopes use
/// them.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const EDGES: [[f64; 3]; 6] =
    [[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 1.0, 1.0], [0.0, 1.0, -1.0]];
const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0]];

/// The points x with low ≤ n · x ≤ high for each of `D` fixed directions n, whose entries are -1, 0
/// and 1. The set is exactly the one that the numbers define.
///
/// ```
/// use impinge::volume::{BoundingVolume, Kdop14};
/// let corner = Kdop14::of_points(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])?;
/// let other = Kdop14::of_points(&[[1.0; 3], [0.5; 3]])?;
/// // Their boxes overlap, but x + y + z is at most 1 in one and at least 1.5 in the other.
/// assert!(!corner.overlaps(&other));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kdop<const D: usize> {
    low: [f64; D],
    high: [f64; D],
}

/// Polytope with the 6 face directions and the 8 corner directions of a cube.
pub type Kdop14 = Kdop<7>;

/// Polytope with the 6 face directions and the 12 edge directions of a cube.
pub type Kdop18 = Kdop<9>;

/// Polytope with the 6 face, 12 edge and 8 corner directions of a cube.
pub type Kdop26 = Kdop<13>;

const _: () = assert!(size_of::<Kdop14>() == 112 && size_of::<Kdop18>() == 144 && size_of::<Kdop26>() == 208);

impl<const D: usize> Kdop<D> {
    /// The slab directions, coordinate axes first. They are not of unit length.
    pub const DIRECTIONS: [[f64; 3]; D] = {
        assert!(D == 7 || D == 9 || D == 13, "14, 18 or 26 faces");
        let mut directions = [[0.0; 3]; D];
        let mut at = 0;
        while at < D {
            directions[at] = if at < 3 {
                AXES[at]
            } else if D == 7 {
                CORNERS[at - 3]
            } else if at < 9 {
                EDGES[at - 3]
            } else {
                CORNERS[at - 9]
            };
            at += 1;
        }
        directions
    };

    /// Builds the polytope from the lower and upper bounds of n · x for each n of
    /// [`DIRECTIONS`](Self::DIRECTIONS).
    ///
    /// # Errors
    /// Returns [`NonFinite`](InputErrorKind::NonFinite) or
    /// [`OutOfRange`](InputErrorKind::OutOfRange) (beyond 3 · 2^320) with the index of the slab,
    /// and [`Negative`](InputErrorKind::Negative) if a lower bound exceeds its upper bound.
    pub fn new(low: [f64; D], high: [f64; D]) -> Result<Self, InputError> {
        for (index, (low, high)) in low.into_iter().zip(high).enumerate() {
            if !(low.is_finite() && high.is_finite()) {
                return Err(InputError::new(InputErrorKind::NonFinite { what: "slab", index }));
            }
            if low.abs().max(high.abs()) > 3.0 * LIMIT {
                return Err(InputError::new(InputErrorKind::OutOfRange { what: "slab", index, limit: "3 * 2^320" }));
            }
            if low > high {
                return Err(InputError::new(InputErrorKind::Negative { what: "slab", index }));
            }
        }
        Ok(Self { low, high })
    }

    /// Returns the smallest polytope that holds the points. Every bound is the exact one, rounded
    /// outward.
    ///
    /// # Errors
    /// Same as [`BoundingVolume::of_points`].
    ///
    /// # Complexity
    /// Two passes over memory; D dot products per point.
    pub fn of<T: Coordinate>(points: &[[T; 3]]) -> Result<Self, InputError> {
        validated_bounds(points)?;
        let mut kdop = Self { low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D] };
        for &point in points {
            let point = widen(point);
            for (k, direction) in Self::DIRECTIONS.iter().enumerate() {
                let [low, high] = project(direction, point);
                kdop.low[k] = kdop.low[k].min(low);
                kdop.high[k] = kdop.high[k].max(high);
            }
        }
        Ok(kdop)
    }

    /// Returns the lower bound of n · x for each n of [`DIRECTIONS`](Self::DIRECTIONS), as stored.
    /// The minimum over the polytope may be larger, if other faces cut it off.
    #[must_use]
    pub fn low(&self) -> [f64; D] {
        self.low
    }

    /// Returns the upper bound of n · x for each n of [`DIRECTIONS`](Self::DIRECTIONS), as stored.
    /// The maximum over the polytope may be smaller, if other faces cut it off.
    #[must_use]
    pub fn high(&self) -> [f64; D] {
        self.high
    }

    /// Reports whether the point is proved to be inside.
    pub(super) fn certainly_contains(&self, point: [f64; 3]) -> bool {
        (0..D).all(|k| {
            let [low, high] = project(&Self::DIRECTIONS[k], point);
            self.low[k] <= low && high <= self.high[k]
        })
    }

    /// Returns an upper bound of d · x over the polytope, for a d known within `off` in each
    /// component.
    ///
    /// Weak duality of linear programming: if d = Σ λᵢ nᵢ with λᵢ ≥ 0 and nᵢ normals of faces, then
    /// d · x ≤ Σ λᵢ hᵢ. The three normals are those around d in the division of the sphere of
    /// directions by the symmetries of the cube. They give the tightest bound if every direction
    /// has a face. The part of d that rounding leaves over is bounded by the axis-aligned box.
    fn support_up(&self, d: [f64; 3], off: [f64; 3]) -> f64 {
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| d[j].abs().total_cmp(&d[i].abs()));
        let sign: [f64; 3] = d.map(|x| if x < 0.0 { -1.0 } else { 1.0 });
        let [a, b, c] = order.map(|axis| d[axis].abs());
        // Each cone normal lists its entries for the largest, middle and smallest component of d.
        let cone: [(f64, [f64; 3]); 3] = match D {
            7 => [(a - b, [1.0, 0.0, 0.0]), (0.5 * (b + c), [1.0, 1.0, 1.0]), (0.5 * (b - c), [1.0, 1.0, -1.0])],
            9 if a >= b + c => [(a - b - c, [1.0, 0.0, 0.0]), (b, [1.0, 1.0, 0.0]), (c, [1.0, 0.0, 1.0])],
            9 => [
                (0.5 * (a + b - c), [1.0, 1.0, 0.0]),
                (0.5 * (a + c - b), [1.0, 0.0, 1.0]),
                (0.5 * (b + c - a), [0.0, 1.0, 1.0]),
            ],
            _ => [(a - b, [1.0, 0.0, 0.0]), (b - c, [1.0, 1.0, 0.0]), (c, [1.0, 1.0, 1.0])],
        };
        let mut bound = 0.0;
        let mut rest = [[0.0; 2]; 3].map(|_| [0.0, 0.0]);
        for axis in 0..3 {
            rest[axis] = [add_down(d[axis], -off[axis]), add_up(d[axis], off[axis])];
        }
        for (weight, ranks) in cone {
            let weight = weight.max(0.0);
            let mut normal = [0.0; 3];
            for (rank, &axis) in order.iter().enumerate() {
                normal[axis] = sign[axis] * ranks[rank];
                let part = weight * normal[axis]; // exact: the entry is -1, 0 or 1
                rest[axis] = [add_down(rest[axis][0], -part), add_up(rest[axis][1], -part)];
            }
            bound = add_up(bound, mul_up(weight, self.height(normal)));
        }
        for axis in 0..3 {
            let widest = self.high[axis].abs().max(self.low[axis].abs());
            bound = add_up(bound, mul_up(rest[axis][1].max(-rest[axis][0]), widest));
        }
        bound
    }

    /// Returns the maximum of n · x for a direction of the list or its opposite.
    fn height(&self, normal: [f64; 3]) -> f64 {
        let opposite = normal.map(|x| -x);
        for (k, &direction) in Self::DIRECTIONS.iter().enumerate() {
            if direction == normal {
                return self.high[k];
            }
            if direction == opposite {
                return -self.low[k];
            }
        }
        f64::INFINITY
    }

    /// Returns the distance from `origin` and the area of each face, both rounded. A face that does
    /// not exist has area zero.
    fn faces(&self, origin: [f64; 3]) -> Vec<(f64, f64)> {
        let half_spaces: Vec<([f64; 3], f64)> = (0..D)
            .flat_map(|k| {
                let n = Self::DIRECTIONS[k];
                let length = dot(&n, &n).sqrt();
                let at = dot(&n, &origin);
                [
                    (scale(&n, 1.0 / length), (self.high[k] - at) / length),
                    (scale(&n, -1.0 / length), (at - self.low[k]) / length),
                ]
            })
            .collect();
        let size = (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f64::max);
        let faces = half_spaces.iter().enumerate().map(|(own, &(normal, height))| {
            let mut polygon = square(normal, height, 4.0 * size);
            for (other, &(n, h)) in half_spaces.iter().enumerate() {
                if other != own {
                    polygon = clip(&polygon, n, h);
                }
            }
            (height, area(&polygon, normal))
        });
        faces.collect()
    }
}

impl<const D: usize> BoundingVolume for Kdop<D> {
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        Self::of(points)
    }

    /// Compares slabs exactly: the polytopes are apart if they are apart in some slab direction.
    /// Two polytopes that no slab separates may still be apart.
    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        (0..D).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        (0..D).all(|k| {
            let [low, high] = project(&Self::DIRECTIONS[k], point);
            !(low > self.high[k] || high < self.low[k])
        })
    }

    /// Computes the union exactly. The result is the smallest polytope of these directions that
    /// holds both, if both are the smallest ones that hold their contents.
    fn merged(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Accepts any affine map. The faces of the image have other directions, so the result is
    /// larger, as with a rotated box. Always move the original polytope, never a moved one.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let (linear, translation) = (world_from_local.linear(), world_from_local.translation());
        let mut moved = *self;
        for (k, n) in Self::DIRECTIONS.iter().enumerate() {
            let column = |axis: usize| project(n, [linear[0][axis], linear[1][axis], linear[2][axis]]);
            let [x, y, z] = [column(0), column(1), column(2)];
            let d = [x, y, z].map(|[low, high]| 0.5 * low + 0.5 * high);
            let off = std::array::from_fn(|axis| {
                let [low, high] = [x, y, z][axis];
                add_up(high, -d[axis]).max(add_up(d[axis], -low))
            });
            let shift = project(n, *translation);
            moved.high[k] = add_up(self.support_up(d, off), shift[1]);
            moved.low[k] = add_down(-self.support_up(d.map(|x| -x), off), shift[0]);
        }
        if let Some(index) = moved.low.iter().chain(&moved.high).position(|x| x.is_nan() || x.abs() > 3.0 * LIMIT) {
            let error = InputErrorKind::OutOfRange { what: "slab", index: index % D, limit: "3 * 2^320" };
            return Err(InputError::new(error));
        }
        Ok(moved)
    }

    fn volume(&self) -> f64 {
        let middle = std::array::from_fn(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis]);
        self.faces(middle).iter().map(|(height, area)| height * area / 3.0).sum::<f64>().max(0.0)
    }

    fn surface_area(&self) -> f64 {
        let middle = std::array::from_fn(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis]);
        self.faces(middle).iter().map(|(_, area)| area).sum()
    }
}

/// Returns lower and upper bounds of n · x for a direction with entries -1, 0 and 1: the sum,
/// rounded down and up.
fn project(direction: &[f64; 3], point: [f64; 3]) -> [f64; 2] {
    let [x, y, z] = std::array::from_fn(|axis| direction[axis] * point[axis]);
    [add_down(add_down(x, y), z), add_up(add_up(x, y), z)]
}

/// Returns a square with the given half edge length in the plane n · x = height, with n of unit
/// length.
fn square(normal: [f64; 3], height: f64, half: f64) -> Vec<[f64; 3]> {
    let [u, v, _] = {
        let [n, u, v] = super::obb::orthonormal([normal, AXES[0], AXES[1]]);
        [u, v, n]
    };
    let middle = scale(&normal, height);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(s, t)| add(&middle, &add(&scale(&u, s * half), &scale(&v, t * half))))
        .to_vec()
}

/// Returns the part of a convex polygon in the half-space n · x ≤ height (Sutherland and Hodgman).
fn clip(polygon: &[[f64; 3]], n: [f64; 3], height: f64) -> Vec<[f64; 3]> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (at, &p) in polygon.iter().enumerate() {
        let q = polygon[(at + 1) % polygon.len()];
        let (over_p, over_q) = (dot(&n, &p) - height, dot(&n, &q) - height);
        if over_p <= 0.0 {
            kept.push(p);
        }
        if (over_p <= 0.0) != (over_q <= 0.0) {
            kept.push(add(&p, &scale(&sub(&q, &p), over_p / (over_p - over_q))));
        }
    }
    kept
}

/// Returns the area of a convex polygon with the given unit normal.
fn area(polygon: &[[f64; 3]], normal: [f64; 3]) -> f64 {
    let fan = polygon.windows(2).skip(1).map(|pair| cross(&sub(&pair[0], &polygon[0]), &sub(&pair[1], &polygon[0])));
    0.5 * fan.map(|product| dot(&product, &normal)).sum::<f64>().abs()
}

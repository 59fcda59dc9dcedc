//! The cores of the round volumes (a point, a segment or a parallelogram) and the closest points of
//! two cores.
//!
//! The results are rounded and prove nothing by themselves. [`round`](super::round) turns them into
//! bounds, which hold however wrong the points are. So the plain closed forms suffice: every edge
//! against every edge, every corner against the other face, and every edge through the other face.
//!
//! Source: Ericson 5.1.2 (point and segment), 5.1.9 (two segments), 5.1.4 (point and rectangle).
//!
//! Tests: `tests/it/volumes/round.rs`.

use crate::math::vec3::{add, cross, dot, squared_distance, sub};

/// The convex hull of a corner and the two edges from there: a point if both edges are zero, a
/// segment if the second edge is zero, otherwise a parallelogram.
#[derive(Clone, Copy, Debug)]
pub(super) struct Core {
    pub(super) corner: [f64; 3],
    pub(super) edges: [[f64; 3]; 2],
    /// Number of edges used: 0 for a point, 1 for a segment, 2 for a parallelogram.
    pub(super) dimension: usize,
}

impl Core {
    pub(super) fn point(corner: [f64; 3]) -> Self {
        Self { corner, edges: [[0.0; 3]; 2], dimension: 0 }
    }

    /// Returns the corners, rounded. Only the first [`count`](Self::count) are distinct.
    #[inline(always)]
    pub(super) fn corners(&self) -> [[f64; 3]; 4] {
        let [u, v] = self.edges;
        let c = self.corner;
        [c, add(&c, &u), add(&c, &v), add(&add(&c, &u), &v)]
    }

    /// Number of distinct corners: 1, 2 or 4.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        1 << self.dimension
    }

    /// Returns the point of this core that is closest to `p`, rounded.
    pub(super) fn closest_to(&self, p: [f64; 3]) -> [f64; 3] {
        let [u, v] = self.edges;
        let w = sub(&p, &self.corner);
        match self.dimension {
            0 => self.corner,
            1 => along(self.corner, u, parameter(w, u)),
            _ => {
                // The unconstrained minimum if it is inside, else the best point of the four edges.
                let (uu, uv, vv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v));
                let determinant = uu * vv - uv * uv;
                let (s, t) = (vv * dot(&w, &u) - uv * dot(&w, &v), uu * dot(&w, &v) - uv * dot(&w, &u));
                let inside = |x: f64| x >= 0.0 && x <= determinant;
                if determinant > 0.0 && inside(s) && inside(t) {
                    return along(along(self.corner, u, s / determinant), v, t / determinant);
                }
                let mut best = (f64::INFINITY, self.corner);
                for (from, edge) in self.sides() {
                    let q = along(from, edge, parameter(sub(&p, &from), edge));
                    let d = squared_distance(&p, &q);
                    if d < best.0 {
                        best = (d, q);
                    }
                }
                best.1
            }
        }
    }

    /// Returns the sides, each as its start and its edge vector.
    fn sides(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        let [u, v] = self.edges;
        let c = self.corner;
        let count = [0, 1, 4][self.dimension];
        [(c, u), (c, v), (add(&c, &v), u), (add(&c, &u), v)].into_iter().take(count)
    }
}

/// Returns a point of each core so that their distance is minimal, up to rounding.
pub(super) fn closest_points(a: &Core, b: &Core) -> ([f64; 3], [f64; 3]) {
    match (a.dimension, b.dimension) {
        (0, _) => (a.corner, b.closest_to(a.corner)),
        (_, 0) => (a.closest_to(b.corner), b.corner),
        (1, 1) => closest_of_segments((a.corner, a.edges[0]), (b.corner, b.edges[0])),
        _ => closest_of_faces(a, b),
    }
}

/// Handles pairs of which at least one core is a parallelogram.
fn closest_of_faces(a: &Core, b: &Core) -> ([f64; 3], [f64; 3]) {
    let mut best = (f64::INFINITY, (a.corner, b.corner));
    let mut offer = |p: [f64; 3], q: [f64; 3]| {
        let d = squared_distance(&p, &q);
        if d < best.0 {
            best = (d, (p, q));
        }
    };
    for side_a in a.sides() {
        for side_b in b.sides() {
            let (p, q) = closest_of_segments(side_a, side_b);
            offer(p, q);
        }
        if let Some(x) = through(side_a, b) {
            offer(x, x);
        }
    }
    for side_b in b.sides() {
        if let Some(x) = through(side_b, a) {
            offer(x, x);
        }
    }
    for &p in &a.corners()[..a.count()] {
        offer(p, b.closest_to(p));
    }
    for &q in &b.corners()[..b.count()] {
        offer(a.closest_to(q), q);
    }
    best.1
}

/// Returns the point where a side passes through a parallelogram, or `None` if it does not or if
/// `face` is no parallelogram.
fn through((from, edge): ([f64; 3], [f64; 3]), face: &Core) -> Option<[f64; 3]> {
    if face.dimension < 2 {
        return None;
    }
    let [u, v] = face.edges;
    let normal = cross(&u, &v);
    let (height, fall) = (dot(&sub(&face.corner, &from), &normal), dot(&edge, &normal));
    if fall == 0.0 {
        return None;
    }
    let t = height / fall;
    if !(0.0..=1.0).contains(&t) {
        return None;
    }
    let x = along(from, edge, t);
    let w = sub(&x, &face.corner);
    let area_squared = dot(&normal, &normal);
    let (s, t) = (dot(&cross(&w, &v), &normal) / area_squared, dot(&cross(&u, &w), &normal) / area_squared);
    ((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then_some(x)
}

fn closest_of_segments((p, d): ([f64; 3], [f64; 3]), (q, e): ([f64; 3], [f64; 3])) -> ([f64; 3], [f64; 3]) {
    let r = sub(&p, &q);
    let (a, b, c, f, g) = (dot(&d, &d), dot(&d, &e), dot(&d, &r), dot(&e, &r), dot(&e, &e));
    let ratio = |x: f64, y: f64| if y > 0.0 { (x / y).clamp(0.0, 1.0) } else { 0.0 };
    let s = ratio(b * f - c * g, a * g - b * b);
    let t = ratio(b * s + f, g);
    // With t clamped, this s is the best for it. If t was not clamped, only rounding changes.
    let s = ratio(b * t - c, a);
    (along(p, d, s), along(q, e, t))
}

/// Returns the parameter in [0, 1] of the point on an edge that is closest to the offset `w` from
/// its start. The parameter is 0 for an edge of length zero.
#[inline(always)]
fn parameter(w: [f64; 3], edge: [f64; 3]) -> f64 {
    let squared = dot(&edge, &edge);
    if squared > 0.0 { (dot(&w, &edge) / squared).clamp(0.0, 1.0) } else { 0.0 }
}

#[inline(always)]
fn along(from: [f64; 3], edge: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|axis| from[axis] + t * edge[axis])
}

//! Oracle: convex hulls by definition, in integers and rationals. It shares no code with the
//! library.
//!
//! The time grows with the fifth power of the number of points. It checks `Hull::new`,
//! `Hull::contains` and `Mesh::validate_proxies`.

use dashu_ratio::RBig;
use impinge_testkit::generate::Rng;

pub(crate) type Point = [i64; 3];

/// Returns the sign of the volume of four points. It is positive if the last point is on the left
/// side of the first three.
pub(crate) fn orientation([p, q, r, s]: [Point; 4]) -> i128 {
    let [u, v, w] = [q, r, s].map(|x| difference(x, p));
    dot(cross(u, v), w).signum()
}

/// Reports whether a point is in the simplex of one to four corners. Returns `false` if the corners
/// are affinely dependent.
fn is_in_simplex(p: Point, corners: &[Point]) -> bool {
    match *corners {
        [a] => a == p,
        [a, b] => cross(difference(b, a), difference(p, a)) == [0; 3] && dot(difference(a, p), difference(b, p)) <= 0,
        [a, b, c] => {
            let normal = cross(difference(b, a), difference(c, a));
            let is_left = |from: Point, to: Point| dot(normal, cross(difference(to, from), difference(p, from))) >= 0;
            normal != [0; 3] && orientation([a, b, c, p]) == 0 && is_left(a, b) && is_left(b, c) && is_left(c, a)
        }
        [a, b, c, d] => {
            let whole = orientation([a, b, c, d]);
            let parts = [[p, b, c, d], [a, p, c, d], [a, b, p, d], [a, b, c, p]];
            whole != 0 && parts.into_iter().all(|part| orientation(part) * whole >= 0)
        }
        _ => unreachable!("simplices have up to four corners"),
    }
}

/// Returns the extreme points: those in no simplex of the others (Carathéodory). Of equal points,
/// the first is returned.
pub(crate) fn extreme(points: &[Point]) -> Vec<u32> {
    let is_first = |at: usize| !points[..at].contains(&points[at]);
    let is_extreme = |at: usize| {
        let others: Vec<Point> = points.iter().copied().filter(|&other| other != points[at]).collect();
        !simplices(&others).any(|simplex| is_in_simplex(points[at], &simplex))
    };
    (0..points.len()).filter(|&at| is_first(at) && is_extreme(at)).map(|at| at as u32).collect()
}

/// Returns the affine dimension of the points: 0 for one place, 1 for a line, 2 for a plane, else
/// 3.
pub(crate) fn dimension(points: &[Point]) -> usize {
    let a = points[0];
    let Some(&b) = points.iter().find(|&&b| b != a) else { return 0 };
    let area = |c: Point| cross(difference(b, a), difference(c, a));
    let Some(&c) = points.iter().find(|&&c| area(c) != [0; 3]) else { return 1 };
    if points.iter().any(|&d| orientation([a, b, c, d]) != 0) { 3 } else { 2 }
}

fn simplices(points: &[Point]) -> impl Iterator<Item = Vec<Point>> {
    // The corners are in ascending order. An index past the end means no corner.
    let n = points.len();
    (0..n).flat_map(move |a| {
        (a + 1..=n).flat_map(move |b| {
            (b + 1..=n + 1).flat_map(move |c| {
                (c + 1..=n + 2).filter_map(move |d| {
                    // Each smaller simplex occurs once, because missing corners are last and
                    // numbered in one way.
                    let is_canonical = (b < n || c == b + 1) && (c < n || d == c + 1);
                    is_canonical.then(|| [a, b, c, d].iter().filter(|&&i| i < n).map(|&i| points[i]).collect())
                })
            })
        })
    })
}

fn difference(p: Point, q: Point) -> [i128; 3] {
    std::array::from_fn(|k| i128::from(p[k]) - i128::from(q[k]))
}

fn cross(u: [i128; 3], v: [i128; 3]) -> [i128; 3] {
    std::array::from_fn(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3])
}

fn dot(u: [i128; 3], v: [i128; 3]) -> i128 {
    (0..3).map(|k| u[k] * v[k]).sum()
}

/// Returns the sign of the volume of four points in doubles. A generous error bound decides first,
/// and rationals if it does not.
pub(crate) fn orientation_of_doubles(points: [[f64; 3]; 4]) -> i32 {
    let [p, q, r, s] = points;
    let [u, v, w]: [[f64; 3]; 3] = [q, r, s].map(|x| std::array::from_fn(|k| x[k] - p[k]));
    let (mut volume, mut size) = (0.0, 0.0);
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        volume += (u[i] * v[j] - u[j] * v[i]) * w[k];
        size += ((u[i] * v[j]).abs() + (u[j] * v[i]).abs()) * w[k].abs();
    }
    if volume.abs() > 1e-13 * size && size > 1e-250 {
        return if volume > 0.0 { 1 } else { -1 };
    }
    let exact = |x: f64| RBig::try_from(x).expect("finite");
    let [u, v, w]: [[RBig; 3]; 3] = [q, r, s].map(|x| std::array::from_fn(|k| exact(x[k]) - exact(p[k])));
    let minor = |i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
    let volume = minor(1, 2) * &w[0] + minor(2, 0) * &w[1] + minor(0, 1) * &w[2];
    volume.cmp(&RBig::ZERO) as i32
}

/// Returns a small set of points with many ties. All coordinates are below 2^20 in absolute value.
pub(crate) fn small_set(rng: &mut Rng, family: usize) -> Vec<Point> {
    let count = rng.integer(1, 13) as usize;
    let mut grid = |side: i64| -> Point { std::array::from_fn(|_| rng.integer(-side, side)) };
    let mut points: Vec<Point> = match family {
        // In space, on grids of three sizes.
        0 => (0..count).map(|_| grid(1)).collect(),
        1 => (0..count).map(|_| grid(3)).collect(),
        2 => (0..count).map(|_| grid(1 << 18)).collect(),
        // In an oblique plane, and on an oblique line.
        3 => {
            let (u, v, base) = (grid(9), grid(9), grid(99));
            (0..count)
                .map(|_| grid(3))
                .map(|[s, t, _]| std::array::from_fn(|k| base[k] + s * u[k] + t * v[k]))
                .collect()
        }
        4 => {
            let (u, base) = (grid(9), grid(99));
            (0..count).map(|_| grid(3)).map(|[s, ..]| std::array::from_fn(|k| base[k] + s * u[k])).collect()
        }
        // On a sphere: permutations and signs of 1, 2, 3.
        5 => (0..count)
            .map(|_| {
                let signs = grid(1 << 10);
                let turn = signs[0].rem_euclid(3) as usize;
                std::array::from_fn(|k| ((k + turn) % 3 + 1) as i64 * if signs[k] >= 0 { 1 } else { -1 })
            })
            .collect(),
        // Near a plane: one coordinate is 0 except for a few points.
        _ => (0..count).map(|_| grid(4)).map(|[x, y, z]| [1000 * x, 1000 * y, i64::from(z == 4)]).collect(),
    };
    // Duplicates of any points.
    for _ in 0..rng.integer(0, 2) {
        let copied = rng.choose(&points);
        points.push(copied);
    }
    points
}

pub(crate) const FAMILIES: usize = 7;

/// Returns the points as floats, scaled by a power of two.
pub(crate) fn floats(points: &[Point], exponent: i64) -> Vec<[f64; 3]> {
    let scale = f64::from_bits(((1023 + exponent) as u64) << 52);
    points.iter().map(|point| point.map(|x| x as f64 * scale)).collect()
}

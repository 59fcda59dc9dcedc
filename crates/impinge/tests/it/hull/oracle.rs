//! What hulls are by definition, in integers and rationals. Nothing here is shared with the library.

use dashu_ratio::RBig;
use impinge_testkit::generate::Rng;

pub(crate) type Point = [i64; 3];

/// The sign of the volume of four points: positive where the last is on the left side of the first three.
pub(crate) fn orientation([p, q, r, s]: [Point; 4]) -> i128 {
    let [u, v, w] = [q, r, s].map(|x| difference(x, p));
    dot(cross(u, v), w).signum()
}

/// Whether a point is in the hull of at most four others that span what they can.
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

/// The first of each of the points that are in no simplex of the others (Carathéodory).
pub(crate) fn extreme(points: &[Point]) -> Vec<u32> {
    let is_first = |at: usize| !points[..at].contains(&points[at]);
    let is_extreme = |at: usize| {
        let others: Vec<Point> = points.iter().copied().filter(|&other| other != points[at]).collect();
        !simplices(&others).any(|simplex| is_in_simplex(points[at], &simplex))
    };
    (0..points.len()).filter(|&at| is_first(at) && is_extreme(at)).map(|at| at as u32).collect()
}

/// One less than the number of points that are affinely independent.
pub(crate) fn dimension(points: &[Point]) -> usize {
    let a = points[0];
    let Some(&b) = points.iter().find(|&&b| b != a) else { return 0 };
    let area = |c: Point| cross(difference(b, a), difference(c, a));
    let Some(&c) = points.iter().find(|&&c| area(c) != [0; 3]) else { return 1 };
    if points.iter().any(|&d| orientation([a, b, c, d]) != 0) { 3 } else { 2 }
}

fn simplices(points: &[Point]) -> impl Iterator<Item = Vec<Point>> {
    // Corners in ascending order, an index past the end being none.
    let n = points.len();
    (0..n).flat_map(move |a| {
        (a + 1..=n).flat_map(move |b| {
            (b + 1..=n + 1).flat_map(move |c| {
                (c + 1..=n + 2).filter_map(move |d| {
                    // Each smaller simplex once: a missing corner is followed by missing ones only, in one way.
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

/// The sign of the volume of four points in doubles: by a bound that is far on the safe side, else by rationals.
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

/// Sets of few points with many ties, whose greatest coordinate is below 2^20.
pub(crate) fn small_set(rng: &mut Rng, family: usize) -> Vec<Point> {
    let count = rng.integer(1, 13) as usize;
    let mut grid = |side: i64| -> Point { std::array::from_fn(|_| rng.integer(-side, side)) };
    let mut points: Vec<Point> = match family {
        // In space, on a coarse grid and on a finer one.
        0 => (0..count).map(|_| grid(1)).collect(),
        1 => (0..count).map(|_| grid(3)).collect(),
        2 => (0..count).map(|_| grid(1 << 18)).collect(),
        // In a plane and in a line, both askew.
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
        // On a sphere: signs and orders of 1, 2, 3.
        5 => (0..count)
            .map(|_| {
                let signs = grid(1 << 10);
                let turn = signs[0].rem_euclid(3) as usize;
                std::array::from_fn(|k| ((k + turn) % 3 + 1) as i64 * if signs[k] >= 0 { 1 } else { -1 })
            })
            .collect(),
        // Near a plane: one coordinate is 0 but for a few points.
        _ => (0..count).map(|_| grid(4)).map(|[x, y, z]| [1000 * x, 1000 * y, i64::from(z == 4)]).collect(),
    };
    // Duplicates, of the first and of any.
    for _ in 0..rng.integer(0, 2) {
        let copied = rng.choose(&points);
        points.push(copied);
    }
    points
}

pub(crate) const FAMILIES: usize = 7;

/// The points as floats, scaled by a power of two.
pub(crate) fn floats(points: &[Point], exponent: i64) -> Vec<[f64; 3]> {
    let scale = f64::from_bits(((1023 + exponent) as u64) << 52);
    points.iter().map(|point| point.map(|x| x as f64 * scale)).collect()
}

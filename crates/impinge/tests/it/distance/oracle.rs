//! Oracle: distances of points, segments, triangles and rays in rationals.
//!
//! The closest points of two simplices lie in the affine hulls of some of their corners, with
//! weights of zero or more. The oracle tries all pairs of sets of corners (49 for two triangles),
//! each by the normal equations. If the equations are singular, a smaller set has the same minimum.
//! The intersection of a ray with a triangle is found in the same way. It checks `query::distance`,
//! `query::within`, `Mesh::closest_point` and the ray casts.

use dashu_ratio::RBig;
use impinge_testkit::Affine;

pub(crate) type Point = [RBig; 3];

pub(crate) fn rational(x: f64) -> RBig {
    RBig::try_from(x).expect("finite")
}

pub(crate) fn point(p: [f64; 3]) -> Point {
    p.map(rational)
}

/// Returns the exact image of a point.
pub(crate) fn image(pose: &Affine, p: [f64; 3]) -> Point {
    let p = point(p);
    [0, 1, 2].map(|k| {
        let row = pose.linear[k].map(rational);
        &row[0] * &p[0] + &row[1] * &p[1] + &row[2] * &p[2] + rational(pose.translation[k])
    })
}

pub(crate) fn sub(p: &Point, q: &Point) -> Point {
    [0, 1, 2].map(|k| &p[k] - &q[k])
}

pub(crate) fn dot(p: &Point, q: &Point) -> RBig {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

/// Returns the squared distance of the convex hulls of two sets of points.
pub(crate) fn squared_distance(a: &[Point], b: &[Point]) -> RBig {
    let mut least: Option<RBig> = None;
    for set_a in subsets(a) {
        for set_b in subsets(b) {
            let Some(squared) = hulls(&set_a, &set_b) else { continue };
            if least.as_ref().is_none_or(|least| squared < *least) {
                least = Some(squared);
            }
        }
    }
    least.expect("two corners are always a pair of sets")
}

fn subsets(points: &[Point]) -> Vec<Vec<&Point>> {
    (1..1_usize << points.len())
        .map(|set| points.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1).map(|(_, p)| p).collect())
        .collect()
}

/// Returns the squared distance of two affine hulls, or `None` if the closest points are not unique
/// or have a negative weight.
fn hulls(a: &[&Point], b: &[&Point]) -> Option<RBig> {
    let mut columns: Vec<Point> = a[1..].iter().map(|p| sub(p, a[0])).collect();
    columns.extend(b[1..].iter().map(|p| sub(b[0], p)));
    let w = sub(a[0], b[0]);
    let rows = columns
        .iter()
        .map(|x| {
            let mut row: Vec<RBig> = columns.iter().map(|y| dot(x, y)).collect();
            row.push(-dot(x, &w));
            row
        })
        .collect();
    let weights = solve(rows)?;
    let (of_a, of_b) = weights.split_at(a.len() - 1);
    for weights in [of_a, of_b] {
        let sum = weights.iter().fold(RBig::ZERO, |sum, x| sum + x);
        if weights.iter().any(|x| *x < RBig::ZERO) || sum > RBig::ONE {
            return None;
        }
    }
    let mut rest = w;
    for (x, column) in weights.iter().zip(&columns) {
        rest = [0, 1, 2].map(|k| &rest[k] + x * &column[k]);
    }
    Some(dot(&rest, &rest))
}

/// Returns the unique solution of linear equations, or `None`. Each row holds the coefficients and
/// then the right-hand side. Additional rows must be consistent.
fn solve(mut rows: Vec<Vec<RBig>>) -> Option<Vec<RBig>> {
    let Some(unknowns) = rows.first().map(|row| row.len() - 1) else { return Some(Vec::new()) };
    for column in 0..unknowns {
        let pivot = (column..rows.len()).find(|&row| rows[row][column] != RBig::ZERO)?;
        rows.swap(column, pivot);
        let scale = rows[column][column].clone();
        rows[column].iter_mut().for_each(|x| *x = &*x / &scale);
        let pivot = rows[column].clone();
        for (index, row) in rows.iter_mut().enumerate() {
            if index != column && row[column] != RBig::ZERO {
                let factor = row[column].clone();
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x = &*x - &factor * p);
            }
        }
    }
    let agree = rows[unknowns.min(rows.len())..].iter().all(|row| row[unknowns] == RBig::ZERO);
    agree.then(|| rows[..unknowns].iter().map(|row| row[unknowns].clone()).collect())
}

/// Returns the smallest `t` of zero or more for which `origin + t direction` is in the hull of some
/// points.
pub(crate) fn ray(origin: &Point, direction: &Point, points: &[Point]) -> Option<RBig> {
    let mut least: Option<RBig> = None;
    for set in subsets(points) {
        for starts in [false, true] {
            // The unknowns are t, unless only the ray's start is tested, and the weights of all but
            // one point.
            let rows = (0..3)
                .map(|k| {
                    let mut row = if starts { Vec::new() } else { vec![direction[k].clone()] };
                    row.extend(set[1..].iter().map(|p| &set[0][k] - &p[k]));
                    row.push(&set[0][k] - &origin[k]);
                    row
                })
                .collect::<Vec<_>>();
            let Some(solution) = solve(rows) else { continue };
            let (t, weights) = if starts { (RBig::ZERO, &solution[..]) } else { (solution[0].clone(), &solution[1..]) };
            let sum = weights.iter().fold(RBig::ZERO, |sum, x| sum + x);
            let is_hit = t >= RBig::ZERO && sum <= RBig::ONE && weights.iter().all(|x| *x >= RBig::ZERO);
            if is_hit && least.as_ref().is_none_or(|least| t < *least) {
                least = Some(t);
            }
        }
    }
    least
}

/// Reports whether the square root of `squared` lies between two floats. The upper one may be
/// infinite.
pub(crate) fn root_is_between(squared: &RBig, lower: f64, upper: f64) -> bool {
    let square = |x: f64| rational(x) * rational(x);
    lower >= 0.0 && square(lower) <= *squared && (upper == f64::INFINITY || *squared <= square(upper))
}

#[test]
fn the_oracle_knows_simple_distances() {
    let triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(point);
    let at = |p: [f64; 3]| squared_distance(&[point(p)], &triangle);
    assert_eq!(at([1.0, 1.0, 3.0]), RBig::from(9));
    assert_eq!(at([4.0, 4.0, 0.0]), RBig::from(8));
    assert_eq!(at([-3.0, -4.0, 12.0]), RBig::from(169));
    let needle = [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0]].map(point);
    assert_eq!(squared_distance(&needle, &triangle), RBig::ZERO);
    let cast = |origin: [f64; 3], direction: [f64; 3]| ray(&point(origin), &point(direction), &triangle);
    assert_eq!(cast([1.0, 1.0, 3.0], [0.0, 0.0, -2.0]), Some(RBig::from_parts(3.into(), 2_u8.into())));
    assert_eq!(cast([-1.0, 1.0, 0.0], [1.0, 0.0, 0.0]), Some(RBig::ONE));
    assert_eq!(cast([1.0, 1.0, 0.0], [1.0, 0.0, 0.0]), Some(RBig::ZERO));
    assert_eq!(cast([1.0, 1.0, 3.0], [0.0, 0.0, 1.0]), None);
}

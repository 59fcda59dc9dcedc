//! The minimal sphere in plain doubles: fast, nearly always with the right support, and never
//! trusted.
//!
//! From a support of at most four points, step to the most distant point. The new support is the
//! subset of these five, always including the new point, whose sphere needs the smallest radius to
//! hold all five. Each step enlarges the sphere; about ten steps reach the end.

use crate::math::vec3::{add, cross, dot, scale, squared_distance, sub};

/// A center and the points that the sphere passes through.
#[derive(Clone, Debug)]
pub(super) struct Approximation {
    pub(super) center: [f64; 3],
    /// At most four indices of points.
    pub(super) support: Vec<usize>,
}

/// Returns the approximate minimal sphere of the points. There must be at least one; their
/// coordinates are about 1 in magnitude.
pub(super) fn minimal(points: &[[f64; 3]]) -> Approximation {
    /// Maximum number of steps, far more than any input has needed. If rounding causes a cycle, the
    /// exact steps take over.
    const MAX_STEPS: usize = 100;
    let (start, _) = most_distant(points, points[0]);
    let mut best = Approximation { center: points[start], support: vec![start] };
    let mut squared_radius = 0.0;
    for _ in 0..MAX_STEPS {
        let (furthest, square) = most_distant(points, best.center);
        if square <= squared_radius * (1.0 + f64::EPSILON) || best.support.contains(&furthest) {
            break;
        }
        best.support.push(furthest);
        let (next, square) = best_subset(points, &best.support);
        if square <= squared_radius {
            best.support.pop();
            break;
        }
        (best, squared_radius) = (next, square);
    }
    best
}

/// Returns the index of the point that is most distant from a center, and its squared distance.
fn most_distant(points: &[[f64; 3]], center: [f64; 3]) -> (usize, f64) {
    const LANES: usize = 8;
    // The search is by lanes, so that vector units help. The index is then looked up in the group
    // with the largest distance.
    let mut best = (0, -1.0);
    for (group, chunk) in points.chunks(LANES * 16).enumerate() {
        let mut lanes = [-1.0_f64; LANES];
        let (eights, rest) = chunk.as_chunks::<LANES>();
        for eight in eights {
            for (lane, &point) in lanes.iter_mut().zip(eight) {
                let square = squared_distance(&point, &center);
                *lane = if square > *lane { square } else { *lane };
            }
        }
        for (lane, &point) in lanes.iter_mut().zip(rest) {
            let square = squared_distance(&point, &center);
            *lane = if square > *lane { square } else { *lane };
        }
        let greatest = lanes.into_iter().fold(-1.0, f64::max);
        if greatest > best.1 {
            best = (group, greatest);
        }
    }
    let from = best.0 * LANES * 16;
    let within = points[from..].iter().position(|&point| squared_distance(&point, &center) == best.1);
    (from + within.unwrap_or(0), best.1)
}

/// Returns the best sphere through a subset of the points that includes the last one: its center
/// has the smallest maximum distance to all of them. Also returns that distance, squared.
fn best_subset(points: &[[f64; 3]], from: &[usize]) -> (Approximation, f64) {
    let (&last, others) = from.split_last().unwrap_or((&0, &[]));
    let mut best = (Approximation { center: points[last], support: vec![last] }, f64::INFINITY);
    for subset in 0_u32..1 << others.len() {
        if subset.count_ones() > 3 {
            continue;
        }
        let chosen = others.iter().enumerate().filter(|(i, _)| subset >> i & 1 == 1).map(|(_, &index)| index);
        let support: Vec<usize> = std::iter::once(last).chain(chosen).collect();
        let Some(center) = circumcenter(points, &support) else { continue };
        let reach = from.iter().map(|&i| squared_distance(&points[i], &center)).fold(0.0, f64::max);
        if reach < best.1 {
            best = (Approximation { center, support }, reach);
        }
    }
    best
}

/// Returns the center of the smallest sphere through one to four points, or `None` if they are
/// affinely dependent.
fn circumcenter(points: &[[f64; 3]], support: &[usize]) -> Option<[f64; 3]> {
    let origin = points[support[0]];
    let edge = |k: usize| sub(&points[support[k]], &origin);
    let offset = match support.len() {
        1 => [0.0; 3],
        2 => scale(&edge(1), 0.5),
        3 => {
            let (u, v) = (edge(1), edge(2));
            let normal = cross(&u, &v);
            let numerator = cross(&sub(&scale(&v, dot(&u, &u)), &scale(&u, dot(&v, &v))), &normal);
            scale(&numerator, 0.5 / dot(&normal, &normal))
        }
        _ => {
            let (u, v, w) = (edge(1), edge(2), edge(3));
            let (vw, wu, uv) = (cross(&v, &w), cross(&w, &u), cross(&u, &v));
            let numerator = add(&add(&scale(&vw, dot(&u, &u)), &scale(&wu, dot(&v, &v))), &scale(&uv, dot(&w, &w)));
            scale(&numerator, 0.5 / dot(&u, &vw))
        }
    };
    offset.iter().all(|x| x.is_finite()).then(|| add(&origin, &offset))
}

//! The minimal sphere in plain doubles: quick, nearly always right in its support, and never trusted.
//!
//! From a support of at most four points step to the most distant point: the new support is the subset of these five whose
//! sphere, about the new point among others, is best. Each step makes the sphere larger; ten or so reach the end.

use crate::math::vec3::{add, cross, dot, scale, squared_distance, sub};

/// A centre, and which points it rests on.
#[derive(Clone, Debug)]
pub(super) struct Approximation {
    pub(super) centre: [f64; 3],
    /// At most four indices.
    pub(super) support: Vec<usize>,
}

/// The sphere of points about the origin and about one large; there is at least one.
pub(super) fn minimal(points: &[[f64; 3]]) -> Approximation {
    /// Far more than were ever needed; where rounding leads in circles, the exact steps take over.
    const MOST_STEPS: usize = 100;
    let (start, _) = most_distant(points, points[0]);
    let mut best = Approximation { centre: points[start], support: vec![start] };
    let mut squared_radius = 0.0;
    for _ in 0..MOST_STEPS {
        let (furthest, square) = most_distant(points, best.centre);
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

/// The index of the point that is most distant from a centre, and its squared distance.
fn most_distant(points: &[[f64; 3]], centre: [f64; 3]) -> (usize, f64) {
    const LANES: usize = 8;
    // By lanes first, so that vector units can help; the index is looked up in the group that had the greatest.
    let mut best = (0, -1.0);
    for (group, chunk) in points.chunks(LANES * 16).enumerate() {
        let mut lanes = [-1.0_f64; LANES];
        let (eights, rest) = chunk.as_chunks::<LANES>();
        for eight in eights {
            for (lane, &point) in lanes.iter_mut().zip(eight) {
                let square = squared_distance(&point, &centre);
                *lane = if square > *lane { square } else { *lane };
            }
        }
        for (lane, &point) in lanes.iter_mut().zip(rest) {
            let square = squared_distance(&point, &centre);
            *lane = if square > *lane { square } else { *lane };
        }
        let greatest = lanes.into_iter().fold(-1.0, f64::max);
        if greatest > best.1 {
            best = (group, greatest);
        }
    }
    let from = best.0 * LANES * 16;
    let within = points[from..].iter().position(|&point| squared_distance(&point, &centre) == best.1);
    (from + within.unwrap_or(0), best.1)
}

/// Of the subsets that contain the last of these points the one about whose sphere's centre all of them are closest, and
/// their greatest squared distance.
fn best_subset(points: &[[f64; 3]], from: &[usize]) -> (Approximation, f64) {
    let (&last, others) = from.split_last().unwrap_or((&0, &[]));
    let mut best = (Approximation { centre: points[last], support: vec![last] }, f64::INFINITY);
    for subset in 0_u32..1 << others.len() {
        if subset.count_ones() > 3 {
            continue;
        }
        let chosen = others.iter().enumerate().filter(|(i, _)| subset >> i & 1 == 1).map(|(_, &index)| index);
        let support: Vec<usize> = std::iter::once(last).chain(chosen).collect();
        let Some(centre) = circumcentre(points, &support) else { continue };
        let reach = from.iter().map(|&i| squared_distance(&points[i], &centre)).fold(0.0, f64::max);
        if reach < best.1 {
            best = (Approximation { centre, support }, reach);
        }
    }
    best
}

/// The centre of the smallest sphere through one to four points; none where they have none.
fn circumcentre(points: &[[f64; 3]], support: &[usize]) -> Option<[f64; 3]> {
    let anchor = points[support[0]];
    let edge = |k: usize| sub(&points[support[k]], &anchor);
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
    offset.iter().all(|x| x.is_finite()).then(|| add(&anchor, &offset))
}

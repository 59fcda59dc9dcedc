//! The shortest translation that lies beyond planes. It is the nearest point to the origin that
//! lies beyond all planes, among points of one plane, of the line of two planes, and of three
//! planes.

use crate::math::vec3::{Vector, cross, dot, scaled_length as length};

/// Returns the shortest vector that lies beyond all planes. Each plane is given by its unit normal
/// and its signed distance from the origin. Returns `None` if no candidate from up to three planes
/// lies beyond all.
pub(super) fn shortest_beyond(planes: &[(Vector, f64)]) -> Option<Vector> {
    let is_beyond = |point: &Vector| {
        planes.iter().all(|(normal, height)| dot(normal, point) >= height - 1e-9 * (height.abs() + length(point)))
    };
    let mut best: Option<Vector> = None;
    let mut offer = |point: Option<Vector>| {
        if let Some(point) = point.filter(is_beyond)
            && best.is_none_or(|best| length(&point) < length(&best))
        {
            best = Some(point);
        }
    };
    offer(Some([0.0; 3]));
    for i in 0..planes.len() {
        offer(Some(planes[i].0.map(|x| x * planes[i].1)));
        for j in i + 1..planes.len() {
            offer(on_two(&planes[i], &planes[j]));
            for k in j + 1..planes.len() {
                offer(on_three([&planes[i], &planes[j], &planes[k]]));
            }
        }
    }
    best
}

/// Returns the point nearest to the origin on the line of two planes, or `None` if they are nearly
/// parallel.
fn on_two((n, g): &(Vector, f64), (m, h): &(Vector, f64)) -> Option<Vector> {
    let cosine = dot(n, m);
    let determinant = 1.0 - cosine * cosine;
    let (s, t) = ((g - h * cosine) / determinant, (h - g * cosine) / determinant);
    (determinant > 1e-9).then(|| std::array::from_fn(|k| s * n[k] + t * m[k]))
}

/// Returns the common point of three planes, or `None` if they nearly share a direction.
fn on_three([p, q, r]: [&(Vector, f64); 3]) -> Option<Vector> {
    let (qr, rp, pq) = (cross(&q.0, &r.0), cross(&r.0, &p.0), cross(&p.0, &q.0));
    let determinant = dot(&p.0, &qr);
    (determinant.abs() > 1e-6).then(|| std::array::from_fn(|k| (p.1 * qr[k] + q.1 * rp[k] + r.1 * pq[k]) / determinant))
}

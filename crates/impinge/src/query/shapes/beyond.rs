//! The shortest translation that is beyond planes: a point of one of them, of the line of two or of all three, whichever is nearest to
//! the origin and behind none.

use crate::math::vec3::{Vector, cross, dot, scaled_length as length};

/// The shortest vector that is beyond planes, each by its normal and its height; none where no three of them tell.
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

/// The point of the line of two planes that is nearest to the origin.
fn on_two((n, g): &(Vector, f64), (m, h): &(Vector, f64)) -> Option<Vector> {
    let cosine = dot(n, m);
    let determinant = 1.0 - cosine * cosine;
    let (s, t) = ((g - h * cosine) / determinant, (h - g * cosine) / determinant);
    (determinant > 1e-9).then(|| std::array::from_fn(|k| s * n[k] + t * m[k]))
}

fn on_three([p, q, r]: [&(Vector, f64); 3]) -> Option<Vector> {
    let (qr, rp, pq) = (cross(&q.0, &r.0), cross(&r.0, &p.0), cross(&p.0, &q.0));
    let determinant = dot(&p.0, &qr);
    (determinant.abs() > 1e-6).then(|| std::array::from_fn(|k| (p.1 * qr[k] + q.1 * rp[k] + r.1 * pq[k]) / determinant))
}

//! The closest points of two segments (Ericson 5.1.9), rounded. Callers prove their results
//! themselves.

use crate::math::vec3::{Vector, add, dot, scale, sub};

/// Returns one point of each segment so that their distance is minimal, up to rounding.
pub(super) fn closest([p, p_end]: [Vector; 2], [q, q_end]: [Vector; 2]) -> (Vector, Vector) {
    let (u, v, w) = (sub(&p_end, &p), sub(&q_end, &q), sub(&p, &q));
    let (a, e, f) = (dot(&u, &u), dot(&v, &v), dot(&v, &w));
    let (mut s, mut t) = (0.0, 0.0);
    if a > 0.0 && e > 0.0 {
        let (b, c) = (dot(&u, &v), dot(&u, &w));
        let denominator = a * e - b * b;
        if denominator > 0.0 {
            s = ((b * f - c * e) / denominator).clamp(0.0, 1.0);
        }
        t = (b * s + f) / e;
        if t < 0.0 {
            (t, s) = (0.0, (-c / a).clamp(0.0, 1.0));
        } else if t > 1.0 {
            (t, s) = (1.0, ((b - c) / a).clamp(0.0, 1.0));
        }
    } else if a > 0.0 {
        s = (-dot(&u, &w) / a).clamp(0.0, 1.0);
    } else if e > 0.0 {
        t = (f / e).clamp(0.0, 1.0);
    }
    (add(&p, &scale(&u, s)), add(&q, &scale(&v, t)))
}

//! The point of a simplex of up to four points that is nearest to the origin, in floats.
//!
//! All of the simplex's parts are tried and the nearest point wins, as van den Bergen's *backup procedure* does, so nothing
//! depends on a part being picked by signs that rounding has spoilt. What comes out is judged by others and proves nothing.

use crate::primitive::{dot, sub};

/// The nearest point of a simplex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// What each point counts for: not negative, and adding up to 1 up to rounding.
    pub(super) weights: [f64; 4],
    /// The sum of the points by their weights; zero where a tetrahedron holds the origin.
    pub(super) vector: [f64; 3],
    /// A direction from the nearest point to the origin: for a triangle its normal, which a point that is close to the origin
    /// has no digits left for.
    pub(super) towards_origin: [f64; 3],
}

/// The nearest point of the hull of one to four points.
pub(super) fn nearest(points: &[[f64; 3]]) -> Nearest {
    let mut best = Nearest { weights: [0.0; 4], vector: [f64::INFINITY; 3], towards_origin: [0.0; 3] };
    let mut winner = Part { numbers: [0; 4], len: 0 };
    let mut least = f64::INFINITY;
    for part in 1_usize..1 << points.len() {
        let members = Part::of(part, points.len());
        let Some(shares) = shares(points, &members) else { continue };
        let total: f64 = shares[..members.len].iter().sum();
        let mut found = Nearest { weights: [0.0; 4], vector: [0.0; 3], ..best };
        for (&member, share) in members.iter().zip(shares) {
            let weight = share / total;
            found.weights[member] = weight;
            found.vector = std::array::from_fn(|k| found.vector[k] + weight * points[member][k]);
        }
        let squared = if members.len == 4 { 0.0 } else { dot(&found.vector, &found.vector) };
        if squared < least {
            (least, best, winner) = (squared, found, members);
        }
    }
    if winner.len == 4 {
        best.vector = [0.0; 3];
    }
    best.towards_origin = best.vector.map(|x| -x);
    if winner.len == 3 {
        let [p, q, r, _] = winner.numbers.map(|number| points[number]);
        let normal = cross(&sub(&q, &p), &sub(&r, &p));
        let flip = if dot(&normal, &p) > 0.0 { -1.0 } else { 1.0 };
        best.towards_origin = normal.map(|x| flip * x);
    }
    best
}

/// Some of up to four points.
struct Part {
    numbers: [usize; 4],
    len: usize,
}

impl Part {
    fn of(part: usize, count: usize) -> Self {
        let mut members = Self { numbers: [0; 4], len: 0 };
        for number in (0..count).filter(|number| part >> number & 1 == 1) {
            members.numbers[members.len] = number;
            members.len += 1;
        }
        members
    }

    fn iter(&self) -> impl Iterator<Item = &usize> {
        self.numbers[..self.len].iter()
    }
}

/// What the members count for in the point of their affine hull that is nearest to the origin, up to a common factor; none
/// where that is not inside of their hull.
fn shares(points: &[[f64; 3]], members: &Part) -> Option<[f64; 4]> {
    let [p, q, r, s] = members.numbers.map(|member| points[member]);
    let shares = match members.len {
        1 => [1.0, 0.0, 0.0, 0.0],
        2 => {
            let edge = sub(&q, &p);
            [dot(&q, &edge), -dot(&p, &edge), 0.0, 0.0]
        }
        3 => {
            let normal = cross(&sub(&q, &p), &sub(&r, &p));
            [dot(&cross(&q, &r), &normal), dot(&cross(&r, &p), &normal), dot(&cross(&p, &q), &normal), 0.0]
        }
        _ => {
            let orientation = dot(&cross(&sub(&q, &p), &sub(&r, &p)), &sub(&s, &p)).signum();
            [
                orientation * dot(&cross(&q, &r), &s),
                -orientation * dot(&cross(&p, &r), &s),
                orientation * dot(&cross(&p, &q), &s),
                -orientation * dot(&cross(&p, &q), &r),
            ]
        }
    };
    shares[..members.len].iter().all(|&share| share > 0.0 && share.is_finite()).then_some(shares)
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_simplex() {
        let corners = [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [0.0, -2.0, 1.0], [0.0, 0.0, -3.0]];
        assert_eq!(nearest(&corners[..1]).vector, [1.0; 3]);
        assert_eq!(nearest(&corners[..2]).vector, [0.0, 1.0, 1.0]);
        assert_eq!(nearest(&corners[..3]).vector, [0.0, 0.0, 1.0]);
        assert_eq!(nearest(&corners).vector, [0.0; 3]);
        assert!(nearest(&corners).weights.iter().all(|&weight| weight > 0.0));
        let one = nearest(&[[2.0, 0.0, 0.0]; 4]);
        assert_eq!((one.vector, one.weights), ([2.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]));
    }
}

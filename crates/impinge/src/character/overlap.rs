//! Tests whether two convex sets overlap, by simplices of their difference, if floats can prove the
//! answer.
//!
//! # Source
//! Gilbert, Johnson, Keerthi, *A fast procedure for computing the distance between complex objects
//! in three-dimensional space*, 1988, used as a yes-or-no test: the answer is a plane between the
//! sets, or a tetrahedron of their differences around the origin. Unlike the source, both must hold
//! with a margin far above rounding errors; otherwise the result is undecided.

use crate::math::vec3::{Vector, cross, dot, length, scale, sub};

/// Maximum number of steps. Two to six are enough, except for sets that touch.
const MAX_STEPS: usize = 12;

/// Rounding error bound of a product of three edges, relative to the cube of the size.
const VOLUME_ROUNDING: f64 = 1e-13;

/// Reports whether the origin is in a convex set, or `None` if floats cannot decide. `farthest`
/// returns the set's farthest point along a direction. The errors of its points must be far below
/// `slack`, and no coordinate may exceed `size`.
pub(super) fn contains_origin(
    farthest: impl Fn(Vector) -> Vector,
    start: Vector,
    slack: f64,
    size: f64,
) -> Option<bool> {
    let mut direction = start;
    let mut simplex = Vec::with_capacity(4);
    for _ in 0..MAX_STEPS {
        let point = farthest(direction);
        if dot(&direction, &point) < -slack * length(&direction) {
            return Some(false);
        }
        simplex.push(point);
        if simplex.len() == 4 {
            match beyond_face(&simplex, slack, size)? {
                Some(hidden) => simplex.remove(hidden),
                None => return Some(true),
            };
        }
        direction = reduced(&mut simplex)?;
    }
    None
}

/// Returns the vertex of a tetrahedron that lies on the other side of its opposite face than the
/// origin. Returns `Some(None)` if the origin is inside with a margin, and `None` if it is too
/// close to a face to decide.
#[expect(clippy::option_option, reason = "not known, known to be none")]
fn beyond_face(tetrahedron: &[Vector], slack: f64, size: f64) -> Option<Option<usize>> {
    let error = VOLUME_ROUNDING * size * size * size;
    let mut is_clear = true;
    for hidden in 0..4 {
        let [a, b, c] = [1, 2, 3].map(|k| tetrahedron[(hidden + k) % 4]);
        let normal = cross(&sub(&b, &a), &sub(&c, &a));
        let outward = if dot(&normal, &sub(&tetrahedron[hidden], &a)) > 0.0 { scale(&normal, -1.0) } else { normal };
        let height = dot(&outward, &a);
        if height < 0.0 {
            return Some(Some(hidden));
        }
        is_clear &= height > slack * length(&normal) + error;
    }
    is_clear.then_some(None)
}

/// Reduces a triangle, segment or point, whose last vertex is new, to the part nearest to the
/// origin. Returns a direction from that part to the origin, or `None` if the origin is in the part
/// itself.
fn reduced(simplex: &mut Vec<Vector>) -> Option<Vector> {
    let across = |along: Vector, to: Vector| cross(&cross(&along, &to), &along);
    let towards = |from: Vector| scale(&from, -1.0);
    let direction = match simplex[..] {
        [c, b, a] => {
            let (ab, ac, ao) = (sub(&b, &a), sub(&c, &a), towards(a));
            let normal = cross(&ab, &ac);
            if dot(&cross(&normal, &ac), &ao) > 0.0 && dot(&ac, &ao) > 0.0 {
                *simplex = vec![c, a];
                across(ac, ao)
            } else if dot(&cross(&ab, &normal), &ao) > 0.0 || dot(&cross(&normal, &ac), &ao) > 0.0 {
                *simplex = vec![b, a];
                return reduced(simplex);
            } else {
                scale(&normal, 1_f64.copysign(dot(&normal, &ao)))
            }
        }
        [b, a] if dot(&sub(&b, &a), &towards(a)) > 0.0 => across(sub(&b, &a), towards(a)),
        [.., a] => {
            *simplex = vec![a];
            towards(a)
        }
        [] => return None,
    };
    // The length of a direction does not matter, but products of many lengths would overflow or
    // underflow.
    let largest = direction.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    (largest > 1e-150 && largest.is_finite()).then(|| scale(&direction, 1.0 / largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn farthest(points: &[Vector]) -> impl Fn(Vector) -> Vector + '_ {
        |direction| *points.iter().max_by(|a, b| dot(&direction, a).total_cmp(&dot(&direction, b))).unwrap()
    }

    /// Reports whether the origin is in the hull of points of a small grid, by all planes through
    /// them. The numbers are integers, so nothing rounds. Returns `None` on the border.
    fn truth(points: &[Vector]) -> Option<bool> {
        let mut is_inside = true;
        for a in points {
            for b in points {
                for c in points {
                    let normal = cross(&sub(b, a), &sub(c, a));
                    if normal != [0.0; 3] && points.iter().all(|p| dot(&normal, &sub(p, a)) <= 0.0) {
                        match dot(&normal, a).total_cmp(&0.0) {
                            std::cmp::Ordering::Less => return Some(false),
                            std::cmp::Ordering::Equal => is_inside = false,
                            std::cmp::Ordering::Greater => {}
                        }
                    }
                }
            }
        }
        is_inside.then_some(true)
    }

    #[test]
    fn answers_agree_with_all_face_planes() {
        let mut state = 5_u64;
        let mut next = |span: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 33) % span) as f64
        };
        let (mut inside, mut outside, mut border) = ([0, 0], [0, 0], 0);
        for case in 0..4_000_u32 {
            let shift = f64::from(case % 3);
            let points: Vec<Vector> = (0..8).map(|_| [next(7) - 3.0 + shift, next(7) - 3.0, next(7) - 3.0]).collect();
            let found = contains_origin(farthest(&points), [1.0, 0.0, 0.0], 1e-12, 8.0);
            match truth(&points) {
                Some(true) => {
                    assert!(found != Some(false), "{points:?}");
                    inside[usize::from(found.is_some())] += 1;
                }
                Some(false) => {
                    assert!(found != Some(true), "{points:?}");
                    outside[usize::from(found.is_some())] += 1;
                }
                // On the border, or with all points in one plane, there is no margin, so nothing is
                // proved.
                None => {
                    assert!(found != Some(true), "{points:?}");
                    border += 1;
                }
            }
        }
        // Undecided cases have the origin in a face of a simplex, which is frequent on a grid.
        assert!(inside[1] > 500 && outside[1] > 500 && border > 20, "{inside:?} {outside:?} {border}");
        assert!(6 * inside[0] < inside[1] && 10 * outside[0] < outside[1], "{inside:?} {outside:?}");
    }
}

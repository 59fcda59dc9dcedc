//! Closed-form distances of primitives: within their stated error, for needles and points as for
//! other triangles.

use impinge::primitive::{
    ClosestPoints, closest_on_segment, closest_on_segments, closest_on_triangle, closest_on_triangles,
};
use impinge_testkit::generate::Rng;

use crate::distance::oracle::{Point, point, rational, root_is_between, squared_distance};

/// Returns corners of one kind.
///
/// The kinds are: small integers, which tie; needles and slivers; uniform numbers; points and
/// segments; corners far from the origin; and very small corners.
fn corners<const N: usize>(rng: &mut Rng, kind: u64) -> [[f64; 3]; N] {
    let spread = |rng: &mut Rng| std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
    let base: [f64; 3] = spread(rng);
    let along: [f64; 3] = spread(rng);
    let width = rng.choose(&[1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0]);
    std::array::from_fn(|i| match kind % 6 {
        0 => std::array::from_fn(|_| rng.integer(0, 3) as f64),
        1 => {
            let (place, aside): (f64, [f64; 3]) = (rng.uniform(-1.0, 1.0), spread(rng));
            std::array::from_fn(|k| base[k] + place * along[k] + width * aside[k])
        }
        2 => spread(rng),
        3 => {
            if i % 2 == 0 {
                base
            } else {
                along
            }
        }
        4 => {
            let p: [f64; 3] = spread(rng);
            p.map(|x| 1e7 + 1e-3 * x)
        }
        _ => {
            let p: [f64; 3] = spread(rng);
            p.map(|x| 1e-150 * x)
        }
    })
}

/// Checks a result against rationals, and returns the used share of its stated error. The closest
/// points must lie on their sets.
fn check(found: &ClosestPoints, a: &[Point], b: &[Point], place: &str) -> f64 {
    let ClosestPoints { distance, error, point_a, point_b } = *found;
    assert!([distance, error].iter().chain(&point_a).chain(&point_b).all(|x| x.is_finite()), "{place}: {found:?}");
    let truth = squared_distance(a, b);
    assert!(root_is_between(&truth, (distance - error).max(0.0), distance + error), "{place}: {found:?}, not √{truth}");
    let size = a.iter().chain(b).flatten().fold(0.0_f64, |size, x| size.max(x.to_f64().value().abs()));
    for (witness, set) in [(point_a, a), (point_b, b)] {
        let off = squared_distance(&[point(witness)], set);
        let allowed = error + 4.0 * f64::EPSILON * size;
        assert!(root_is_between(&off, 0.0, allowed), "{place}: {witness:?} is off its set");
    }
    let root = truth.to_f64().value().sqrt();
    if error > 0.0 { (distance - root).abs() / error } else { 0.0 }
}

#[test]
fn closed_forms_are_within_their_error() {
    let mut rng = Rng::new(31);
    let (mut most, mut touching) = (0.0_f64, 0);
    for case in 0..400 {
        let kinds = [rng.next_u64(), if case % 3 == 0 { case } else { rng.next_u64() }];
        // Sets far apart from each other test nothing.
        let kinds = if kinds[0] % 6 > 3 { [kinds[0], kinds[0]] } else { kinds.map(|kind| kind % 4) };
        let p: [[f64; 3]; 1] = corners(&mut rng, kinds[0]);
        let segment: [[f64; 3]; 2] = corners(&mut rng, kinds[0]);
        let other: [[f64; 3]; 2] = corners(&mut rng, kinds[1]);
        let (a, b): ([[f64; 3]; 3], [[f64; 3]; 3]) = (corners(&mut rng, kinds[0]), corners(&mut rng, kinds[1]));
        let place = format!("case {case}");
        let exact = |points: &[[f64; 3]]| points.iter().map(|p| point(*p)).collect::<Vec<_>>();
        let used = [
            check(&closest_on_segment(&p[0], &other), &exact(&p), &exact(&other), &place),
            check(&closest_on_triangle(&p[0], &b), &exact(&p), &exact(&b), &place),
            check(&closest_on_segments(&segment, &other), &exact(&segment), &exact(&other), &place),
            check(&closest_on_triangles(&a, &b), &exact(&a), &exact(&b), &place),
        ];
        most = used.into_iter().fold(most, f64::max);
        let (there, back) = (closest_on_triangles(&a, &b), closest_on_triangles(&b, &a));
        assert_eq!(there.distance, back.distance, "{place}");
        if there.distance > 0.0 {
            assert_eq!((there.point_a, there.point_b), (back.point_b, back.point_a), "{place}");
        }
        let intersect = squared_distance(&exact(&a), &exact(&b)) == rational(0.0);
        assert_eq!(there.distance == 0.0, intersect, "{place}: {there:?}");
        touching += usize::from(intersect);
    }
    assert!((20..200).contains(&touching), "{touching} of 400 triangles intersect");
    assert!(most < 0.2, "{most} of the stated error was used");
}

#[test]
fn nearly_parallel_segments_keep_their_digits() {
    // The segments cross in their middles at an angle at which textbook formulas have no digits
    // left.
    let mut rng = Rng::new(32);
    for exponent in 1..60 {
        let tilt = 2.0_f64.powi(-exponent);
        let height = tilt * rng.choose(&[0.0, 1e-3, 1.0]);
        let a = [[-1.0, -0.7, 0.3], [1.0, 0.7, -0.3]];
        let b = [[-1.0, -0.7 - tilt, 0.3 + height], [1.0, 0.7 + tilt, -0.3 + height]];
        let found = closest_on_segments(&a, &b);
        check(&found, &a.map(point), &b.map(point), &format!("tilt 2^-{exponent}"));
    }
}

//! Every kind of shape against every other: all verbs answer, and closed forms check the answers.
//!
//! The signed distance of two convex sets is the maximum over all unit directions n of the gap
//! between their heights along n. So any direction, also that of the closest points, bounds it from
//! below, and points in the sets bound it from above. If both bounds agree with the answer, the
//! answer is right.

use impinge::Pose;
use impinge::query::{self, ContactOptions, Penetrates, Proximity, Query};
use impinge::shape::PlacedShape;
use impinge_testkit::Affine;
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;
use crate::shapes::support::{Known, dot};

/// A known shape with its pose in the world.
pub(crate) struct Placed<'k> {
    pub(crate) known: &'k Known,
    pub(crate) place: Affine,
    pub(crate) shape: PlacedShape,
}

impl<'k> Placed<'k> {
    pub(crate) fn new(known: &'k Known, place: Affine) -> Self {
        Self { known, place, shape: known.shape().at(pose(&place)).expect("rigid") }
    }

    /// Returns the height of the shape along a world direction. For a half-space it is the level of
    /// its plane.
    fn height(&self, n: &[f64; 3]) -> f64 {
        if let Some((_, level)) = self.plane() {
            return level;
        }
        let local = std::array::from_fn(|j| (0..3).map(|k| self.place.linear[k][j] * n[k]).sum());
        self.known.height(&local) + dot(n, &self.place.translation)
    }

    /// Returns the unit normal and the level of a half-space in the world, or `None` for other
    /// shapes.
    fn plane(&self) -> Option<([f64; 3], f64)> {
        let Known::HalfSpace(normal, level) = self.known else { return None };
        let length = dot(normal, normal).sqrt();
        let turned: [f64; 3] = std::array::from_fn(|k| dot(&self.place.linear[k], normal) / length);
        Some((turned, level / length + dot(&turned, &self.place.translation)))
    }
}

/// Returns the gap between the heights of two shapes along a direction from the first to the
/// second. The maximum over all directions is their signed distance.
pub(crate) fn gap_along(a: &Placed, b: &Placed, n: &[f64; 3]) -> f64 {
    -b.height(&n.map(|x| -x)) - a.height(n)
}

/// Returns directions along which both heights are finite: those of planes, else 300 random ones.
pub(crate) fn directions(a: &Placed, b: &Placed) -> Vec<[f64; 3]> {
    let unit = |n: [f64; 3]| n.map(|x| x / dot(&n, &n).sqrt());
    let mut rng = Rng::new(5);
    match (a.plane(), b.plane()) {
        (Some(_), Some(_)) => Vec::new(),
        (Some((n, _)), None) => vec![n],
        (None, Some((n, _))) => vec![n.map(|x| -x)],
        (None, None) => (0..300).map(|_| unit(std::array::from_fn(|_| rng.uniform(-1.0, 1.0)))).collect(),
    }
}

/// Reports whether no direction separates a point from a shape.
pub(crate) fn holds(shape: &Placed, point: &[f64; 3], directions: &[[f64; 3]]) -> bool {
    match shape.plane() {
        Some((n, level)) => dot(&n, point) <= level + 1e-9,
        None => directions.iter().all(|n| dot(n, point) <= shape.height(n) + 1e-9),
    }
}

/// Checks all verbs on a pair, in both orders, and reports whether the pair intersects.
fn check_pair(a: &Placed, b: &Placed) -> bool {
    let directions = directions(a, b);
    let best = directions.iter().map(|n| gap_along(a, b, n)).fold(f64::NEG_INFINITY, f64::max);
    let context = || format!("{:?} {:?} against {:?} {:?}: {best}", a.known, a.place, b.known, b.place);
    let found = query::distance(&a.shape, &b.shape);
    let proximity = query::proximity(&a.shape, &b.shape);
    let meets = query::intersects(&a.shape, &b.shape);
    let is_exact = a.known.is_exact() && b.known.is_exact();
    assert!(!is_exact || proximity != Proximity::Undecided, "{}", context());
    assert_eq!(found.proximity, proximity, "{}", context());
    assert!(found.lower <= found.upper && found.upper - found.lower < 1e-9, "{found:?} {}", context());
    assert!(best <= found.upper + 1e-12, "{found:?} {}", context());
    assert!(query::within(&a.shape, &b.shape, found.upper + 1e-9), "{}", context());
    assert!(meets || !query::within(&a.shape, &b.shape, found.lower - 1e-9), "{}", context());
    let back = query::distance(&b.shape, &a.shape);
    assert_eq!((found.lower, found.upper, proximity), (back.lower, back.upper, back.proximity), "{}", context());
    let [point_a, point_b] = found.points().expect("shapes have nearest points");
    assert!(holds(a, &point_a, &directions), "{found:?} {}", context());
    assert!(holds(b, &point_b, &directions), "{found:?} {}", context());
    let between: [f64; 3] = std::array::from_fn(|k| point_b[k] - point_a[k]);
    let apart = dot(&between, &between).sqrt();
    if !meets {
        assert!((apart - found.upper).abs() < 1e-9, "{found:?} {apart} {}", context());
        let n = if directions.len() == 1 { directions[0] } else { between.map(|x| x / apart) };
        assert!(gap_along(a, b, &n) >= found.lower - 1e-6, "{found:?} {}", context());
    }

    let (depth, depth_back) = (query::penetration(&a.shape, &b.shape), query::penetration(&b.shape, &a.shape));
    assert_eq!(depth.is_some(), meets, "{}", context());
    let penetrates = query::penetrates(&a.shape, &b.shape);
    assert_eq!(penetrates == Penetrates::Yes, depth.is_some_and(|depth| depth.lower > 0.0), "{}", context());
    assert!(meets || penetrates == Penetrates::No, "{}", context());
    let (Some(depth), Some(depth_back)) = (depth, depth_back) else { return meets };
    assert_eq!((depth.lower, depth.upper), (depth_back.lower, depth_back.upper), "{}", context());
    assert!((dot(&depth.normal, &depth.normal) - 1.0).abs() < 1e-14, "{depth:?} {}", context());
    assert!(depth.point_a.iter().chain(&depth.point_b).all(|x| x.is_finite()), "{depth:?} {}", context());
    if directions.is_empty() {
        assert_eq!((depth.lower, depth.upper), (f64::INFINITY, f64::INFINITY), "{}", context());
        return true;
    }
    assert!(dot(&depth.normal, &depth_back.normal) < -0.999_999, "{}", context());
    assert!(depth.lower <= -best + 1e-12, "{depth:?} {}", context());
    let n = if directions.len() == 1 { directions[0] } else { depth.normal };
    assert!((-gap_along(a, b, &n) - depth.upper).abs() < 1e-9, "{depth:?} {}", context());
    assert!(depth.upper - depth.lower < if is_exact { 1e-12 } else { 1e-10 }, "{depth:?} {}", context());
    // Moved apart by the upper bound of the depth, they are apart.
    let mut place = b.place;
    let by = depth.upper + 1e-9;
    place.translation = std::array::from_fn(|k| place.translation[k] + depth.normal[k] * by);
    assert!(!query::intersects(&a.shape, &Placed::new(b.known, place).shape), "{depth:?} {}", context());
    true
}

#[test]
fn every_pair_answers_every_verb() {
    let all = Known::all();
    let mut rng = Rng::new(55);
    let (mut meeting, mut count) = (0, 0);
    for a in &all {
        for b in &all {
            for reach in [0.0, 1.0, 2.0] {
                let mut places = [poses::rotation(&mut rng), poses::rotation(&mut rng)];
                places[0].translation = [0.5, 0.25, -1.0];
                places[1].translation =
                    std::array::from_fn(|k| places[0].translation[k] + reach * rng.uniform(-1.0, 1.0));
                meeting += usize::from(check_pair(&Placed::new(a, places[0]), &Placed::new(b, places[1])));
                count += 1;
            }
        }
    }
    assert!(meeting > count / 4 && meeting < count * 4 / 5, "{meeting} of {count}");
}

/// Checks two half-spaces that face each other, apart and overlapping, and two in the same
/// direction.
#[test]
fn half_spaces_intersect_unless_they_face_each_other() {
    let place = |normal, level, at: [f64; 3]| {
        Known::HalfSpace(normal, level).shape().at(Pose::from_translation(at).unwrap()).unwrap()
    };
    let floor = place([0.0, 0.0, 2.0], 1.0, [0.0; 3]);
    let ceiling = place([0.0, 0.0, -1.0], 0.0, [5.0, 0.0, 3.5]);
    let apart = query::distance(&floor, &ceiling);
    assert!(apart.lower <= 3.0 && 3.0 <= apart.upper && apart.upper - apart.lower < 1e-12, "{apart:?}");
    assert!(query::within(&floor, &ceiling, 3.0) && !query::within(&floor, &ceiling, 3_f64.next_down()));
    assert!(query::penetration(&floor, &ceiling).is_none());
    let low = place([0.0, 0.0, -1.0], 0.0, [5.0, 0.0, 0.5]);
    assert_eq!(query::proximity(&floor, &low), Proximity::Intersects);
    assert_eq!(query::penetration(&floor, &low).unwrap().upper, 0.0);
    let lower = place([0.0, 0.0, -1.0], 0.0, [5.0, 0.0, -0.5]);
    let depth = query::penetration(&lower, &floor).unwrap();
    assert!(depth.lower <= 1.0 && 1.0 <= depth.upper && depth.normal == [0.0, 0.0, -1.0], "{depth:?}");
    for other in [place([0.0, 0.0, 1.0], -7.0, [0.0; 3]), place([0.0, 1e-300, 1.0], -7.0, [0.0; 3])] {
        assert_eq!(query::penetration(&floor, &other).unwrap().lower, f64::INFINITY);
        assert_eq!(query::distance(&floor, &other).upper, 0.0);
    }
}

/// Checks that the contact of two half-spaces has the gap within the margin, the depth, or an
/// infinite depth if no translation separates them.
#[test]
fn contacts_of_half_spaces_have_their_depth() {
    let place =
        |normal, at: [f64; 3]| Known::HalfSpace(normal, 0.0).shape().at(Pose::from_translation(at).unwrap()).unwrap();
    let floor = place([0.0, 0.0, 1.0], [0.0; 3]);
    for (normal, height, [lower, upper]) in [
        ([0.0, 0.0, -2.0], 0.5, [-0.5; 2]),
        ([0.0, 0.0, -2.0], 0.0, [0.0; 2]),
        ([0.0, 0.0, -2.0], -3.0, [3.0; 2]),
        ([0.0, 0.0, 1.0], -3.0, [f64::INFINITY; 2]),
        ([1.0, 0.0, -1.0], 9.0, [f64::INFINITY; 2]),
    ] {
        let other = place(normal, [4.0, 0.0, height]);
        let options = ContactOptions { margin: 0.75, ..ContactOptions::default() };
        for (a, b) in [(&floor, &other), (&other, &floor)] {
            let found = Query::new().with_contacts(options).contacts(a, b);
            let [manifold] = &found[..] else { panic!("one manifold is expected, not {found:?}") };
            let [point] = &manifold.points[..] else { panic!("one point is expected, not {found:?}") };
            assert!(point.lower <= lower && upper <= point.upper, "{height}: {point:?}");
            assert!(lower.is_infinite() || point.upper - point.lower < 1e-12, "{height}: {point:?}");
            assert!(!point.lower.is_infinite() || lower.is_infinite(), "{height}: {point:?}");
            // The vector from the second point to the first one has the depth along the normal.
            if lower.is_finite() {
                let along: f64 = (0..3).map(|k| manifold.normal[k] * (point.point_a[k] - point.point_b[k])).sum();
                assert!((along - lower).abs() < 1e-12, "{height}: {manifold:?}");
            }
        }
        assert_eq!(query::contacts(&floor, &other).len(), usize::from(height <= 0.0 || lower.is_infinite()));
    }
    let far = place([0.0, 0.0, -1.0], [0.0, 0.0, 0.8]);
    assert!(
        Query::new().with_contacts(ContactOptions { margin: 0.75, most_points: 4 }).contacts(&floor, &far).is_empty()
    );
}

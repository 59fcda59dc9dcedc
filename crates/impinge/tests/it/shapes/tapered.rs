//! Tapered capsules against the spheres between their ends, of which they are the union.

use std::sync::Arc;

use impinge::hull::Hull;
use impinge::query::{self, Proximity};
use impinge::shape::{PlacedShape, Shape};
use impinge::sweep::{Motion, time_of_impact};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::rounds;

use crate::shapes::hulls::pose;
use crate::shapes::support::at;

/// Two spheres whose hull is a tapered capsule.
#[derive(Debug)]
struct Ends {
    centers: [[f64; 3]; 2],
    radii: [f64; 2],
}

impl Ends {
    /// Returns two spheres on a grid of quarters or anywhere. One may contain the other.
    fn random(rng: &mut Rng) -> Self {
        let on_grid = rng.one_in(2);
        let mut number = |most: i64| {
            if on_grid { rng.integer(-most, most) as f64 / 4.0 } else { rng.uniform(-1.0, 1.0) * most as f64 / 4.0 }
        };
        let centers = [0; 2].map(|_| [0; 3].map(|_| number(6)));
        Self { centers, radii: [0; 2].map(|_| number(5).abs()) }
    }

    fn shape(&self) -> Shape {
        Shape::tapered_capsule(self.centers[0], self.centers[1], self.radii).unwrap()
    }

    /// Returns the center and the radius of the sphere at a share of the way.
    fn sphere(&self, share: f64) -> ([f64; 3], f64) {
        let [start, end] = self.centers;
        let center = std::array::from_fn(|k| (1.0 - share) * start[k] + share * end[k]);
        (center, (1.0 - share) * self.radii[0] + share * self.radii[1])
    }

    /// Returns the least value of the distance of a center from a set less the radius. The distance
    /// of a convex set is convex, so bisection into thirds finds the least one.
    fn least(&self, distance: impl Fn([f64; 3]) -> f64) -> f64 {
        let value = |share: f64| {
            let (center, radius) = self.sphere(share);
            distance(center) - radius
        };
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..100 {
            let [left, right] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
            if value(left) <= value(right) { high = right } else { low = left }
        }
        value(low).min(value(high)).min(value(0.0)).min(value(1.0))
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Checks the distance, the depth and the verdict of two shapes, given the truth up to rounding.
/// Reports whether they intersect.
fn check(a: &PlacedShape, b: &PlacedShape, truth: f64, context: &dyn std::fmt::Debug) -> bool {
    /// Error of the truth.
    const OFF: f64 = 1e-12;
    let found = query::distance(a, b);
    assert!(found.lower <= truth.max(0.0) + OFF && truth <= found.upper + OFF, "{found:?} {truth} {context:?}");
    assert!(found.upper - found.lower < 1e-9, "{found:?} {truth} {context:?}");
    let wanted = match truth {
        _ if truth > 1e-9 => Some(Proximity::Apart),
        _ if truth < -1e-9 => Some(Proximity::Intersects),
        _ => None,
    };
    let proximity = query::proximity(a, b);
    assert!(wanted.is_none_or(|wanted| proximity == wanted), "{proximity:?} {truth} {context:?}");
    if proximity == Proximity::Apart {
        return false;
    }
    let depth = query::penetration(a, b).expect("they intersect");
    assert!(depth.lower <= (-truth).max(0.0) + OFF && -truth <= depth.upper + OFF, "{depth:?} {truth} {context:?}");
    assert!(depth.upper - depth.lower < 1e-9, "{depth:?} {truth} {context:?}");
    true
}

#[test]
fn tapered_capsules_and_spheres_agree_with_the_union_of_spheres() {
    let mut rng = Rng::new(711);
    let (mut meeting, mut apart, mut slanted) = (0, 0, 0);
    for _ in 0..rounds(1_000) {
        let ends = Ends::random(&mut rng);
        let center = [0; 3].map(|_| rng.integer(-8, 8) as f64 / 4.0);
        let radius = rng.integer(0, 4) as f64 / 4.0;
        let distance = |point: [f64; 3]| length(std::array::from_fn(|k| point[k] - center[k]));
        let truth = ends.least(distance) - radius;
        let shape = ends.shape().at(Pose::IDENTITY).unwrap();
        let sphere = Shape::sphere(center, radius).unwrap().at(Pose::IDENTITY).unwrap();
        let meets = check(&shape, &sphere, truth, &(&ends, center, radius));
        (meeting, apart) = (meeting + usize::from(meets), apart + usize::from(!meets));
        let of_ends = [0, 1].map(|end| distance(ends.centers[end]) - ends.radii[end]);
        slanted += usize::from(of_ends[0].min(of_ends[1]) - radius > truth + 1e-3);
    }
    assert!(meeting > 150 && apart > 250 && slanted > 150, "{meeting} {apart} {slanted}");
}

/// Checks boxes, hulls, triangles, capsules and meshes, from the distances of points.
#[test]
fn tapered_capsules_and_other_shapes_agree_with_the_union_of_spheres() {
    let mut rng = Rng::new(712);
    let cloud: Vec<[f64; 3]> = (0..12).map(|_| [0; 3].map(|_| rng.uniform(-1.0, 1.0))).collect();
    let mesh = Mesh::new(Positions::F64(cloud.clone()), (0..9).map(|i| [i, i + 1, i + 3]).collect::<Vec<_>>()).unwrap();
    let others = [
        Shape::cuboid([1.0, 0.5, 0.75]).unwrap(),
        Shape::hull(Arc::new(Hull::new(&cloud).unwrap())),
        Shape::triangle([[1.0, 0.0, 0.0], [-1.0, 0.5, 0.0], [0.0, -1.0, 0.5]]).unwrap(),
        Shape::capsule([0.0, 0.0, -1.0], [0.0, 0.5, 1.0], 0.5).unwrap(),
        Shape::mesh(&mesh),
    ];
    let (mut meeting, mut apart) = (0, 0);
    for round in 0..rounds(150) {
        let (ends, other) = (Ends::random(&mut rng), &others[round % others.len()]);
        let mut place = poses::rotation(&mut rng);
        place.translation = [0; 3].map(|_| rng.uniform(-2.0, 2.0));
        let (shape, other) = (ends.shape().at(Pose::IDENTITY).unwrap(), other.at(pose(&place)).unwrap());
        let distance = |point| query::distance(Shape::point(point).unwrap().at(Pose::IDENTITY).unwrap(), &other).upper;
        let truth = ends.least(distance);
        let context = || format!("{ends:?} {other:?}: {truth}");
        if truth > 1e-9 {
            let found = query::distance(&shape, &other);
            assert_eq!(found.proximity, Proximity::Apart, "{}", context());
            assert!(found.lower <= truth + 1e-11 && truth <= found.upper + 1e-11, "{found:?} {}", context());
            assert!(query::within(&shape, &other, truth + 1e-9) && !query::within(&shape, &other, truth - 1e-9));
            apart += 1;
        } else if truth < -1e-9 {
            assert_eq!(query::proximity(&shape, &other), Proximity::Intersects, "{}", context());
            assert!(!query::contacts(&shape, &other).is_empty(), "{}", context());
            meeting += 1;
        }
    }
    assert!(meeting > 25 && apart > 30, "{meeting} {apart}");
}

/// Checks spheres that touch the slanted side in integers: with ends 25 apart and radii 20 and 5
/// the normal of the side is (3, 4, 0) / 5.
#[test]
fn spheres_that_touch_the_side_exactly_are_hits() {
    let ends = Ends { centers: [[0.0; 3], [25.0, 0.0, 0.0]], radii: [20.0, 5.0] };
    let shape = ends.shape().at(Pose::IDENTITY).unwrap();
    for foot in [[12.0, 16.0], [16.0, 13.0], [20.0, 10.0], [24.0, 7.0], [28.0, 4.0]] {
        for radius in [5.0, 10.0, 40.0] {
            let center = [foot[0] + 0.6 * radius, foot[1] + 0.8 * radius, 0.0];
            assert_eq!([5.0 * center[0], 5.0 * center[1]].map(f64::fract), [0.0; 2]);
            for swapped in [false, true] {
                let center = if swapped { [center[0], 0.0, -center[1]] } else { center };
                let meets = |radius| {
                    query::proximity(&shape, Shape::sphere(center, radius).unwrap().at(Pose::IDENTITY).unwrap())
                };
                assert_ne!(meets(radius), Proximity::Apart, "{foot:?} {radius}");
                assert_eq!(meets(radius + 1e-9), Proximity::Intersects, "{foot:?} {radius}");
                assert_eq!(meets(radius - 1e-9), Proximity::Apart, "{foot:?} {radius}");
            }
        }
    }
}

#[test]
fn equal_radii_give_capsules_and_contained_spheres_are_left_out() {
    let cone = Shape::cone(1.0, 0.75).unwrap().at(at([4.0, 1.0, 0.5])).unwrap();
    let [p, q] = [[0.5, -1.0, 2.0], [3.5, 3.0, 2.0]];
    // The centers are 5 apart.
    let pairs = [
        (Shape::tapered_capsule(p, q, [0.5, 0.5]), Shape::capsule(p, q, 0.5)),
        (Shape::tapered_capsule(p, p, [0.5, 0.25]), Shape::sphere(p, 0.5)),
        (Shape::tapered_capsule(p, q, [6.0, 1.0]), Shape::sphere(p, 6.0)),
        (Shape::tapered_capsule(p, q, [0.25, 7.0]), Shape::sphere(q, 7.0)),
        (Shape::tapered_capsule(p, p, [0.0, 0.0]), Shape::capsule(p, p, 0.0)),
    ];
    for (tapered, known) in pairs {
        let [tapered, known] = [tapered, known].map(|shape| shape.unwrap().at(Pose::IDENTITY).unwrap());
        assert_eq!(query::distance(&tapered, &cone), query::distance(&known, &cone));
        assert_eq!(tapered.bounds(), known.bounds());
    }
    // The smaller sphere of 1 barely comes out of one of slightly less than 6.
    for radius in [6_f64.next_down(), 6.0 - 1e-12, 6.0 - 1e-6] {
        let barely = Shape::tapered_capsule(p, q, [radius, 1.0]).unwrap().at(Pose::IDENTITY).unwrap();
        let probe = |beyond: f64| {
            let point: [f64; 3] = std::array::from_fn(|k| p[k] + (q[k] - p[k]) / 5.0 * (6.0 + beyond));
            query::proximity(&barely, Shape::point(point).unwrap().at(Pose::IDENTITY).unwrap())
        };
        assert_eq!((probe(-1e-5), probe(1e-5)), (Proximity::Intersects, Proximity::Apart), "{radius}");
        assert_ne!(probe(0.0), Proximity::Apart);
    }
}

/// Checks a tapered capsule whose side lies on a floor, and its fall onto it.
#[test]
fn a_tapered_capsule_lies_on_its_side_with_two_contacts() {
    let ends = Ends { centers: [[0.0; 3], [0.0, 0.0, 1.25]], radii: [1.0, 0.25] };
    // The normal of the side is (4, 0, 3) / 5.
    let lying = Pose::new([[-0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, -0.6]], [0.25, 0.5, 0.99]).unwrap();
    let corners = vec![[-8.0, -8.0, 0.0], [8.0, -8.0, 0.0], [8.0, 8.0, 0.0], [-8.0, 8.0, 0.0]];
    let mesh = Mesh::new(Positions::F64(corners), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let floors =
        [Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap(), Shape::mesh(&mesh), Shape::cuboid([8.0, 8.0, 1.0]).unwrap()];
    for (floor, height) in floors.into_iter().zip([0.0, 0.0, -1.0]) {
        let under = at([0.0, 0.0, height]);
        let found = query::contacts(floor.at(under).unwrap(), ends.shape().at(lying).unwrap());
        let [manifold] = &found[..] else { panic!("one manifold is expected, not {found:?}") };
        assert_eq!(manifold.points.len(), 2, "{found:?}");
        assert!(manifold.normal[2] > 0.999_99, "{found:?}");
        for point in &manifold.points {
            assert!((0.5 * (point.lower + point.upper) - 0.01).abs() < 1e-3, "{found:?}");
        }
        let [from, to] = [2.0, 0.0].map(|z| Pose::new(*lying.linear(), [0.25, 0.5, 0.99 + z]).unwrap());
        let still = Motion::between(under, under).unwrap();
        let fall = Motion::between(from, to).unwrap();
        let impact = time_of_impact(&floor, ends.shape(), &still, &fall).unwrap();
        assert!(impact.t_lower <= 0.995 && impact.t_lower > 0.995 - 1e-6, "{impact:?}");
    }
}

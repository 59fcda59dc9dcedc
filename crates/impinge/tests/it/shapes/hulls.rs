//! Pairs of hulls that nearly touch, against the rational distance: the interval contains the
//! truth, the verdict is right, and the two agree.

use std::sync::Arc;

use dashu_ratio::RBig;
use impinge::Pose;
use impinge::hull::Hull;
use impinge::query::{self, Proximity};
use impinge::shape::Shape;
use impinge_testkit::Affine;
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::oracle::squared_distance_of_hulls;

fn rational(x: f64) -> RBig {
    RBig::try_from(x).expect("finite")
}

pub(crate) fn pose(affine: &Affine) -> Pose {
    Pose::new(affine.linear, affine.translation).expect("in range")
}

const IDENTITY: Affine = Affine { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

/// Returns points on a small grid, where many are coplanar, or uniform points.
fn cloud(rng: &mut Rng) -> Vec<[f64; 3]> {
    let count = rng.integer(1, 9);
    let on_grid = rng.one_in(2);
    let point = |rng: &mut Rng| {
        std::array::from_fn(|_| if on_grid { rng.integer(-2, 2) as f64 } else { rng.uniform(-1.0, 1.0) })
    };
    (0..count).map(|_| point(rng)).collect()
}

fn along(direction: &[f64; 3], place: &Affine, point: &[f64; 3]) -> f64 {
    (0..3).map(|k| direction[k] * (0..3).map(|j| place.linear[k][j] * point[j]).sum::<f64>()).sum()
}

/// Two clouds of points and their poses. The second is moved so that along some direction its
/// nearest face, edge or corner is about `gap` beyond the first cloud.
struct Scene {
    points: [Vec<[f64; 3]>; 2],
    places: [Affine; 2],
}

fn scene(rng: &mut Rng, gap: f64) -> Scene {
    let points = [cloud(rng), cloud(rng)];
    let mut places = if rng.one_in(3) { [IDENTITY; 2] } else { [poses::rotation(rng), poses::rotation(rng)] };
    if rng.one_in(3) {
        places[1] = places[0];
    }
    let n: [f64; 3] = match rng.integer(0, 2) {
        0 => [1.0, 0.0, 0.0],
        1 => std::array::from_fn(|k| places[0].linear[k][2]),
        _ => [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0],
    };
    let [far, near] = [extreme(rng, &n, &places[0], &points[0]), extreme(rng, &n.map(|x| -x), &places[1], &points[1])];
    places[1].translation = std::array::from_fn(|k| places[0].translation[k] + far[k] - near[k] + n[k] * gap);
    Scene { points, places }
}

/// Returns the linear image of a point that is farthest along a direction. If several tie, it is a
/// mean of two.
fn extreme(rng: &mut Rng, n: &[f64; 3], place: &Affine, points: &[[f64; 3]]) -> [f64; 3] {
    let height = |p: &[f64; 3]| along(n, place, p);
    let greatest = points.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
    let farthest: Vec<[f64; 3]> = points.iter().copied().filter(|p| height(p) > greatest - 1e-9).collect();
    let (p, q, t) = (rng.choose(&farthest), rng.choose(&farthest), rng.integer(0, 4) as f64 / 4.0);
    let mean: [f64; 3] = std::array::from_fn(|k| p[k] + t * (q[k] - p[k]));
    std::array::from_fn(|k| (0..3).map(|j| place.linear[k][j] * mean[j]).sum())
}

/// Counts of outcomes, so that tests can require a share of each.
#[derive(Debug, Default)]
struct Seen {
    meeting: usize,
    apart: usize,
    near: usize,
}

fn check_pair(rng: &mut Rng, gap: f64, seen: &mut Seen) {
    let Scene { points, places } = scene(rng, gap);
    let truth = squared_distance_of_hulls(&points[0], &places[0], &points[1], &places[1]);
    let [a, b] = [0, 1].map(|i| {
        let hull = Hull::new(&points[i]).expect("points");
        Shape::hull(Arc::new(hull)).at(pose(&places[i])).expect("any map")
    });
    let meets = truth == RBig::ZERO;
    let context = || format!("{points:?} {places:?}");
    assert_eq!(query::intersects(&a, &b), meets, "{}", context());
    assert_ne!(query::proximity(&a, &b), Proximity::Undecided);
    let found = query::distance(&a, &b);
    assert_eq!(found.distance() == 0.0, meets, "{}", context());
    assert_eq!(found.upper == 0.0, meets, "{}", context());
    let square = |x: f64| rational(x) * rational(x);
    assert!(square(found.lower) <= truth && truth <= square(found.upper), "{found:?} {}", context());
    assert!(found.upper - found.lower <= found.upper * 2_f64.powi(-36) || found.upper < 1e-150, "{found:?}");
    assert!(query::within(&a, &b, found.upper) && (meets || !query::within(&a, &b, found.lower.next_down())));
    // The closest points must have the reported distance, up to their rounding in the world frame.
    let nearest = found.points().expect("shapes have nearest points");
    let apart = (0..3).map(|k| (nearest[0][k] - nearest[1][k]).powi(2)).sum::<f64>().sqrt();
    assert!(meets || (apart - found.upper).abs() < 1e-12, "{found:?} {apart}");
    let back = query::distance(&b, &a);
    let nearest_back = back.points().expect("shapes have nearest points");
    assert_eq!((found.lower, found.upper, nearest[0]), (back.lower, back.upper, nearest_back[1]), "{}", context());
    match query::penetration(&a, &b) {
        None => assert!(!meets),
        Some(depth) => {
            assert!(meets && 0.0 <= depth.lower && depth.lower <= depth.upper, "{depth:?}");
            assert!((depth.normal.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14, "{depth:?}");
            assert!(depth.upper - depth.lower < 1e-12, "{depth:?} {}", context());
            let mut moved = places[1];
            let by = depth.upper + 1e-12;
            moved.translation = std::array::from_fn(|k| moved.translation[k] + depth.normal[k] * by);
            let freed = squared_distance_of_hulls(&points[0], &places[0], &points[1], &moved);
            assert!(freed > RBig::ZERO, "{depth:?} {}", context());
        }
    }
    seen.meeting += usize::from(meets);
    seen.apart += usize::from(!meets);
    seen.near += usize::from(!meets && found.upper < 1e-7);
}

fn check_many(count: usize) {
    let mut rng = Rng::new(51);
    let mut seen = Seen::default();
    let gaps = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-12, 1e-13, 1e-14];
    for case in 0..count {
        let gap = match case % 5 {
            0 => 0.0,
            1 | 2 => rng.choose(&gaps),
            _ => -rng.choose(&gaps),
        };
        check_pair(&mut rng, gap, &mut seen);
    }
    assert!(seen.meeting > count / 5 && seen.apart > count / 5 && seen.near > count / 10, "{seen:?}");
}

/// Checks touching, nearly touching and slightly overlapping hulls of one to nine points.
#[test]
fn near_hulls_are_decided_and_their_distance_is_in_its_interval() {
    check_many(5_000);
}

#[test]
#[ignore = "minutes: see CONTRIBUTING.md"]
fn hundred_thousand_near_hulls_are_decided() {
    check_many(100_000);
}

/// Checks a point in the plane of a triangle, near its corner: the depth is that across the plane,
/// not the longer one past the corner.
#[test]
fn depths_of_flat_sets_are_across_their_plane() {
    let corner = [0.0, 1.0, 0.0];
    let mut rng = Rng::new(54);
    for case in 0..300 {
        let share = rng.choose(&[2_f64.powi(-30), 2_f64.powi(-34), 2_f64.powi(-37), 2_f64.powi(-40)]);
        let edges: [[f64; 3]; 2] = if case == 0 {
            [[1.0, 1.0, 2.0], [-1.0, -1.0, 1.0]]
        } else {
            [0, 1].map(|_| std::array::from_fn(|_| rng.integer(-3, 3) as f64))
        };
        // Between the edges, at a fraction that causes no rounding.
        let point: [f64; 3] = std::array::from_fn(|k| corner[k] + share * (edges[0][k] + edges[1][k]));
        let [p, q] = edges.map(|edge| std::array::from_fn(|k| corner[k] + edge[k]));
        // A pose that both share leaves the point in the triangle.
        let place = pose(&if case % 2 == 0 { IDENTITY } else { poses::rotation(&mut rng) });
        let triangle = Shape::triangle([corner, p, q]).unwrap().at(place).unwrap();
        let point = Shape::point(point).unwrap().at(place).unwrap();
        let depth = query::penetration(&triangle, &point).expect("the point is in the triangle");
        assert!(depth.lower == 0.0 && depth.upper < 1e-13, "{case} {edges:?} {depth:?}");
    }
}

/// Checks that under maps that stretch and shear, the images are compared.
#[test]
fn sheared_hulls_are_decided() {
    let mut rng = Rng::new(52);
    let mut meeting = 0;
    for _ in 0..300 {
        let points = [cloud(&mut rng), cloud(&mut rng)];
        let places = [poses::large_integer_map(&mut rng), poses::large_integer_map(&mut rng)];
        let truth = squared_distance_of_hulls(&points[0], &places[0], &points[1], &places[1]);
        let [a, b] = [0, 1].map(|i| {
            let hull = Hull::new(&points[i]).expect("points");
            Shape::hull(Arc::new(hull)).at(pose(&places[i])).expect("any map")
        });
        let found = query::distance(&a, &b);
        assert_eq!(query::intersects(&a, &b), truth == RBig::ZERO);
        let square = |x: f64| rational(x) * rational(x);
        assert!(square(found.lower) <= truth && truth <= square(found.upper), "{found:?}");
        meeting += usize::from(truth == RBig::ZERO);
    }
    assert!((30..270).contains(&meeting), "{meeting}");
}

/// Checks that `within` is true for exactly the distance, and false for the next float below it.
#[test]
fn within_is_exact_at_the_distance() {
    let mut rng = Rng::new(53);
    for _ in 0..300 {
        // Pythagorean quadruples make the distances of corners integers.
        let [x, y, z, d] = rng.choose(&[[2.0, 1.0, 2.0, 3.0], [2.0, 3.0, 6.0, 7.0], [4.0, 4.0, 7.0, 9.0]]);
        let scale = 2_f64.powi(rng.integer(-30, 30) as i32);
        let half = [1.0, 2.0, 1.0].map(|h| h * scale);
        let a = Shape::cuboid(half).unwrap().at(Pose::IDENTITY).unwrap();
        let offset: [f64; 3] = std::array::from_fn(|k| 2.0 * half[k] + [x, y, z][k] * scale);
        let b = Shape::cuboid(half).unwrap().at(Pose::from_translation(offset).unwrap()).unwrap();
        assert!(query::within(&a, &b, d * scale) && !query::within(&a, &b, (d * scale).next_down()));
        assert!(!query::within(&a, &b, -1.0) && !query::within(&a, &b, f64::NAN));
        assert!(query::within(&a, &b, f64::INFINITY));
        // The same for spheres, whose radii reduce the distance.
        let r = rng.integer(0, 1) as f64 * scale;
        let ball = Shape::sphere([0.0; 3], r).unwrap();
        let pin = Shape::sphere([x * scale, y * scale, z * scale], 0.5 * scale).unwrap();
        let [ball, pin] = [ball, pin].map(|s| s.at(Pose::IDENTITY).unwrap());
        let left = d * scale - r - 0.5 * scale;
        assert!(query::within(&ball, &pin, left) && !query::within(&ball, &pin, left.next_down()));
    }
}

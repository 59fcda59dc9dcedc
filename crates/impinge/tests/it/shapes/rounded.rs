//! Rounded shapes against the rational distance of their cores, on grids full of ties, and against
//! laws of the Minkowski sum.

use std::sync::Arc;

use dashu_ratio::RBig;
use impinge::hull::Hull;
use impinge::input::InputErrorKind;
use impinge::query::{self, Proximity};
use impinge::shape::{PlacedShape, Shape};
use impinge::sweep::{Motion, time_of_impact};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::oracle::squared_distance_of_hulls;
use impinge_testkit::{Affine, rounds};

use crate::shapes::hulls::pose;

/// A polytope of a kind, and its corners.
struct Core {
    shape: Shape,
    corners: Vec<[f64; 3]>,
}

/// Returns a number on a grid of quarters.
fn quarter(rng: &mut Rng, most: i64) -> f64 {
    rng.integer(-most, most) as f64 / 4.0
}

/// Returns a box, a hull, a triangle or a segment on a grid.
fn core(rng: &mut Rng) -> Core {
    let point = |rng: &mut Rng| [0; 3].map(|_| quarter(rng, 6));
    match rng.integer(0, 4) {
        0 | 1 => {
            let half = [0; 3].map(|_| quarter(rng, 5).abs());
            let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { half[k] } else { -half[k] });
            Core { shape: Shape::cuboid(half).unwrap(), corners: (0..8).map(corner).collect() }
        }
        2 => {
            let corners: Vec<[f64; 3]> = (0..rng.integer(1, 7)).map(|_| point(rng)).collect();
            Core { shape: Shape::hull(Arc::new(Hull::new(&corners).unwrap())), corners }
        }
        3 => {
            let corners = [point(rng), point(rng), point(rng)];
            Core { shape: Shape::triangle(corners).unwrap(), corners: corners.to_vec() }
        }
        _ => {
            let ends = [point(rng), point(rng)];
            Core { shape: Shape::segment(ends).unwrap(), corners: ends.to_vec() }
        }
    }
}

/// Returns a turn by right angles, and a place on the grid.
fn place(rng: &mut Rng, reach: i64) -> Affine {
    let axes = rng.choose(&[[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]]);
    let signs = [0; 3].map(|_| if rng.one_in(2) { 1.0 } else { -1.0 });
    let row = |k: usize| std::array::from_fn(|j| if axes[k] == j { signs[k] } else { 0.0 });
    Affine { linear: [row(0), row(1), row(2)], translation: [0; 3].map(|_| quarter(rng, reach)) }
}

fn rational(x: f64) -> RBig {
    RBig::try_from(x).expect("finite")
}

fn square(x: &RBig) -> RBig {
    x.clone() * x.clone()
}

/// Returns the root of a number if it is a short float, of which a quarter of it is one too.
fn exact_root(squared: &RBig) -> Option<f64> {
    let root = squared.to_f64().value().sqrt();
    (square(&(rational(0.25 * root) + rational(0.75 * root))) == *squared).then_some(root)
}

/// Checks the distance of two shapes that are decided exactly, and the verdicts at a clearance.
fn check_distance(a: &PlacedShape, b: &PlacedShape, squared: &RBig, sum: &RBig) -> bool {
    let context = || format!("{a:?} {b:?}: {squared} {sum}");
    let meets = *squared <= square(sum);
    let wanted = if meets { Proximity::Intersects } else { Proximity::Apart };
    assert_eq!(query::proximity(a, b), wanted, "{}", context());
    let found = query::distance(a, b);
    assert_eq!(found.proximity, wanted, "{}", context());
    if meets {
        assert_eq!(found.upper, 0.0, "{}", context());
    } else {
        // The cores are between the two ends and the radii apart.
        let [lower, upper] = [found.lower, found.upper].map(|end| rational(end) + sum.clone());
        assert!(square(&lower) <= *squared && *squared <= square(&upper), "{found:?} {}", context());
        assert!(found.upper - found.lower < 1e-12, "{found:?} {}", context());
    }
    for clearance in [0.25, 1.0, 2.5] {
        let is_within = *squared <= square(&(sum.clone() + rational(clearance)));
        assert_eq!(query::within(a, b, clearance), is_within, "{clearance} {}", context());
    }
    meets
}

#[test]
fn rounded_polytopes_on_grids_agree_with_rationals() {
    let mut rng = Rng::new(701);
    let (mut meeting, mut apart, mut ties, mut by_radius) = (0, 0, 0, 0);
    for _ in 0..rounds(1_500) {
        let (a, b) = (core(&mut rng), core(&mut rng));
        let [place_a, mut place_b] = [place(&mut rng, 2), place(&mut rng, 8)];
        let mut radii = [0; 2].map(|_| quarter(&mut rng, 8).abs());
        if rng.one_in(4) {
            // Barely nearer or farther than a place on the grid.
            let k = rng.integer(0, 2) as usize;
            let x = place_b.translation[k];
            place_b.translation[k] = if rng.one_in(2) { x.next_up() } else { x.next_down() };
        }
        let squared = squared_distance_of_hulls(&a.corners, &place_a, &b.corners, &place_b);
        if rng.one_in(2)
            && let Some(root) = exact_root(&squared)
        {
            radii = [0.25 * root, 0.75 * root];
        }
        let rounded = |core: &Core, radius, place| core.shape.rounded(radius).unwrap().at(pose(place)).unwrap();
        let [rounded_a, rounded_b] = [rounded(&a, radii[0], &place_a), rounded(&b, radii[1], &place_b)];
        let sum = rational(radii[0]) + rational(radii[1]);
        let meets = check_distance(&rounded_a, &rounded_b, &squared, &sum);
        (meeting, apart) = (meeting + usize::from(meets), apart + usize::from(!meets));
        ties += usize::from(sum > RBig::ZERO && squared == square(&sum));
        by_radius += usize::from(meets && squared > RBig::ZERO);
        let depth = query::penetration(&rounded_a, &rounded_b);
        assert_eq!(depth.is_some(), meets);
        let Some(depth) = depth else { continue };
        if squared > RBig::ZERO {
            // The depth is the sum of the radii less the distance of the cores.
            let [near, far] = [depth.upper, depth.lower].map(|end| sum.clone() - rational(end));
            let near = near.max(RBig::ZERO);
            assert!(square(&near) <= squared && squared <= square(&far), "{depth:?} {squared} {sum}");
        } else {
            let core = query::penetration(rounded(&a, 0.0, &place_a), rounded(&b, 0.0, &place_b)).unwrap();
            let [low, high] = [core.lower, core.upper].map(|end| rational(end) + sum.clone());
            assert!(rational(depth.lower) <= high && low <= rational(depth.upper), "{depth:?} {core:?} {sum}");
        }
        assert!(depth.upper - depth.lower < 1e-12, "{depth:?}");
    }
    assert!(meeting > 500 && apart > 200 && ties > 60 && by_radius > 200, "{meeting} {apart} {ties} {by_radius}");
}

#[test]
fn rounded_polytopes_and_meshes_on_grids_agree_with_rationals() {
    let mut rng = Rng::new(702);
    let (mut meeting, mut apart, mut ties) = (0, 0, 0);
    for _ in 0..rounds(250) {
        let corners: Vec<[f64; 3]> = (0..6).map(|_| [0; 3].map(|_| quarter(&mut rng, 8))).collect();
        let faces: Vec<[u32; 3]> = (0..5).map(|_| [0; 3].map(|_| rng.integer(0, 5) as u32)).collect();
        let (core, place_a, place_b) = (core(&mut rng), place(&mut rng, 4), place(&mut rng, 10));
        let least = faces.iter().map(|face| {
            let triangle = face.map(|vertex| corners[vertex as usize]);
            squared_distance_of_hulls(&triangle, &place_a, &core.corners, &place_b)
        });
        let squared = least.min().unwrap();
        let exact = exact_root(&squared).filter(|_| rng.one_in(2));
        let radius = exact.unwrap_or_else(|| quarter(&mut rng, 10).abs());
        let mesh = Mesh::new(Positions::F64(corners), faces).unwrap();
        let surface = Shape::mesh(&mesh).at(pose(&place_a)).unwrap();
        let rounded = core.shape.rounded(radius).unwrap().at(pose(&place_b)).unwrap();
        let meets = check_distance(&surface, &rounded, &squared, &rational(radius));
        assert_eq!(!query::contacts(&surface, &rounded).is_empty(), meets);
        (meeting, apart) = (meeting + usize::from(meets), apart + usize::from(!meets));
        ties += usize::from(radius > 0.0 && squared == square(&rational(radius)));
    }
    assert!(meeting > 60 && apart > 60 && ties > 4, "{meeting} {apart} {ties}");
}

/// Checks that a radius may move from one shape to the other: the set of differences is the same,
/// and so are distances and times of impact.
#[test]
fn radii_may_move_to_the_other_shape() {
    let mut rng = Rng::new(703);
    let (mut meeting, mut hits, mut misses) = (0, 0, 0);
    for _ in 0..rounds(80) {
        let (a, b) = (core(&mut rng), core(&mut rng));
        let (here, radii) = (pose(&place(&mut rng, 2)), [0; 2].map(|_| quarter(&mut rng, 4).abs()));
        let angle = rng.uniform(0.0, 3.0);
        let start = Pose::from_axis_angle([1.0, 2.0, -1.0], angle, [0; 3].map(|_| quarter(&mut rng, 16))).unwrap();
        let end = Pose::new(*start.linear(), start.translation().map(|x| quarter(&mut rng, 4) - 0.5 * x)).unwrap();
        let motions = [Motion::between(here, here).unwrap(), Motion::between(start, end).unwrap()];
        let sum = radii[0] + radii[1];
        let found = [radii, [sum, 0.0], [0.0, sum]].map(|[one, two]| {
            let [a, b] = [a.shape.rounded(one).unwrap(), b.shape.rounded(two).unwrap()];
            let distance = query::distance(a.at(here).unwrap(), b.at(start).unwrap());
            (distance, time_of_impact(&a, &b, &motions[0], &motions[1]).unwrap())
        });
        let (distance, impact) = found[0];
        for (other, later) in &found[1..] {
            assert!(distance.lower <= other.upper + 1e-12 && other.lower <= distance.upper + 1e-12, "{found:?}");
            assert_eq!(impact.hit(), later.hit(), "{found:?}");
            assert!(impact.t_lower <= later.t_upper && later.t_lower <= impact.t_upper, "{found:?}");
        }
        meeting += usize::from(distance.upper == 0.0);
        hits += usize::from(impact.hit() && distance.upper > 0.0);
        misses += usize::from(!impact.hit());
    }
    assert!(meeting > 5 && hits > 15 && misses > 2, "{meeting} {hits} {misses}");
}

#[test]
fn rounded_points_and_segments_are_spheres_and_capsules() {
    let [p, q] = [[0.5, -1.0, 2.0], [1.5, 0.25, 2.0]];
    let other = Shape::cone(1.0, 0.75).unwrap().at(Pose::IDENTITY).unwrap();
    let pairs = [
        (Shape::point(p).unwrap().rounded(0.75), Shape::sphere(p, 0.75)),
        (Shape::segment([p, q]).unwrap().rounded(0.75), Shape::capsule(p, q, 0.75)),
        (Shape::sphere(p, 0.5).unwrap().rounded(0.25), Shape::sphere(p, 0.75)),
        (Shape::capsule(p, q, 0.25).unwrap().rounded(0.5), Shape::capsule(p, q, 0.75)),
        (
            Shape::cuboid([0.5; 3]).unwrap().rounded(0.5).unwrap().rounded(0.25),
            Shape::cuboid([0.5; 3]).unwrap().rounded(0.75),
        ),
    ];
    for (rounded, known) in pairs {
        let [rounded, known] = [rounded, known].map(|shape| shape.unwrap().at(Pose::IDENTITY).unwrap());
        assert_eq!(query::distance(&rounded, &other), query::distance(&known, &other));
        assert_eq!(query::contacts(&rounded, &other), query::contacts(&known, &other));
        assert_eq!(rounded.bounds(), known.bounds());
    }
}

/// Checks the faces, edges and corners of a rounded box on a floor and on a mesh.
#[test]
fn a_rounded_box_rests_on_its_face_its_edge_and_its_corner() {
    let die = Shape::cuboid([0.75, 0.5, 0.25]).unwrap().rounded(0.25).unwrap();
    let corners = vec![[-8.0, -8.0, 0.0], [8.0, -8.0, 0.0], [8.0, 8.0, 0.0], [-8.0, 8.0, 0.0]];
    let mesh = Mesh::new(Positions::F64(corners), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let floors = [Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap(), Shape::mesh(&mesh)];
    let diagonal = (0.5_f64.hypot(0.25)) + 0.25;
    let cases = [
        (Pose::IDENTITY, 0.5, 4),
        (
            Pose::from_axis_angle([1.0, 0.0, 0.0], 0.25_f64.atan2(0.5) + std::f64::consts::FRAC_PI_2, [0.0; 3])
                .unwrap(),
            diagonal,
            2,
        ),
    ];
    for floor in floors {
        let floor = floor.at(Pose::IDENTITY).unwrap();
        for (turn, height, count) in &cases {
            let resting = Pose::new(*turn.linear(), [0.25, 0.5, height - 0.01]).unwrap();
            let found = query::contacts(&floor, die.at(resting).unwrap());
            let [manifold] = &found[..] else { panic!("one manifold is expected, not {found:?}") };
            assert_eq!(manifold.points.len(), *count, "{found:?}");
            assert!(manifold.normal[2] > 0.999_999, "{found:?}");
            for point in &manifold.points {
                assert!(point.lower <= 0.01 + 1e-9 && point.upper >= 0.01 - 1e-9, "{found:?}");
                assert!((point.point_b[2] + 0.01).abs() < 1e-9, "{found:?}");
            }
        }
    }
}

#[test]
fn only_bounded_convex_shapes_are_rounded() {
    let kind = |shape: &Shape| shape.rounded(0.5).unwrap_err().kind().clone();
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap();
    let floor = Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap();
    assert_eq!(kind(&floor), InputErrorKind::NotRoundable { what: "half-space" });
    let mesh = Mesh::new(Positions::F64(vec![[0.0; 3]; 3]), vec![[0, 1, 2]]).unwrap();
    assert_eq!(kind(&Shape::solid(&mesh)), InputErrorKind::NotRoundable { what: "mesh" });
    let pair = Shape::compound(&[(ball.clone(), Pose::IDENTITY), (ball.clone(), Pose::IDENTITY)]).unwrap();
    assert_eq!(kind(&pair), InputErrorKind::NotRoundable { what: "compound" });
    assert!(matches!(ball.rounded(-1.0).unwrap_err().kind(), InputErrorKind::Negative { what: "radius", .. }));
    assert!(matches!(ball.rounded(f64::NAN).unwrap_err().kind(), InputErrorKind::NonFinite { .. }));
    let huge = Shape::sphere([0.0; 3], 3e38).unwrap();
    assert!(matches!(huge.rounded(3e38).unwrap_err().kind(), InputErrorKind::OutOfRange { .. }));
    let stretched = Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    let cube = Shape::cuboid([1.0; 3]).unwrap();
    assert!(cube.rounded(0.0).unwrap().at(stretched).is_ok());
    assert!(matches!(cube.rounded(0.5).unwrap().at(stretched).unwrap_err().kind(), InputErrorKind::NotRigid { .. }));
}

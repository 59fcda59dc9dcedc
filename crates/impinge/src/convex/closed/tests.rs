//! Closed forms compared with the iteration and exact arithmetic, on scenes full of ties.

use super::*;
use crate::convex::depth::{self, Effort, HULL_FALLBACK_WIDTH};
use crate::convex::distance::{self, separation_by_iteration};
use crate::convex::facets::Facets;
use crate::convex::gjk;
use crate::convex::manifold::{Contact, Faceted, contacts};
use crate::convex::min_norm::least_distance;
use crate::convex::posed::{Core, Pair, to_unit_length};
use crate::convex::turned::Turned;
use crate::math::Pose;
use crate::math::vec3::{dot, length, sub};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::rounds;

/// A core by its corners, or a cylinder or a cone; its pose and its radii.
#[derive(Clone, Debug)]
struct Scene {
    corners: Vec<Vector>,
    turned: Option<Turned>,
    pose: Pose,
    radius: [f64; 2],
}

impl Scene {
    fn swept(&self) -> Swept<'_> {
        let core = match (&self.turned, &self.corners[..]) {
            (Some(turned), _) => Core::Turned(turned),
            (None, corners) if corners.len() == 8 => Core::Cuboid(corners),
            (None, corners) => Core::Points(corners),
        };
        Swept { core, pose: &self.pose, radius: self.radius }
    }
}

impl Scene {
    /// Returns the scene with all lengths multiplied by a power of two.
    fn scaled(self, factor: f64) -> Self {
        let turned = |set: Turned| Turned { half_height: factor * set.half_height, radius: factor * set.radius, ..set };
        Self {
            corners: self.corners.iter().map(|corner| corner.map(|x| factor * x)).collect(),
            turned: self.turned.map(turned),
            pose: Pose::new(*self.pose.linear(), self.pose.translation().map(|x| factor * x)).unwrap(),
            radius: self.radius.map(|x| factor * x),
        }
    }
}

fn box_corners(half: Vector) -> Vec<Vector> {
    (0..8).map(|at| [0, 1, 2].map(|k| if at >> k & 1 == 1 { half[k] } else { -half[k] })).collect()
}

/// Returns a tiny rotation about a random axis, to first order.
fn nudge(rng: &mut Rng, angle: f64) -> [Vector; 3] {
    let [x, y, z] = [0; 3].map(|_| angle * rng.uniform(-1.0, 1.0));
    [[1.0, -z, y], [z, 1.0, -x], [-y, x, 1.0]]
}

fn linear(rng: &mut Rng, kind: i64) -> [Vector; 3] {
    match kind {
        0 | 1 => Pose::IDENTITY.linear().map(|row| row),
        2 => poses::cube_symmetry(rng),
        3 => poses::rotation(rng).linear,
        4 => poses::rotation(rng).linear.map(|row| row.map(|x| f64::from(x as f32))),
        _ => nudge(rng, 10.0_f64.powi(-(2 * kind as i32 - 7))),
    }
}

/// Returns a point of a grid, or of one that floats do not hold unless `is_grid` is set.
fn point(rng: &mut Rng, is_grid: bool, reach: i64) -> Vector {
    let step = if is_grid { 0.25 } else { [0.25, 0.5, 0.31][rng.integer(0, 2) as usize] };
    [0; 3].map(|_| step * rng.integer(-reach, reach) as f64)
}

const BOX: usize = 2;
const TRIANGLE: usize = 3;
const CYLINDER: usize = 4;
const CONE: usize = 5;

/// Returns a shape of a kind. If `is_grid` is set, all its numbers are multiples of a quarter and
/// its axes are parallel to those of the world.
fn random(rng: &mut Rng, kind: usize, is_round: bool, is_grid: bool) -> Scene {
    let corners = match kind {
        0 => vec![if rng.one_in(2) { [0.0; 3] } else { point(rng, is_grid, 2) }],
        1 if rng.one_in(2) => {
            let axis = rng.integer(0, 2) as usize;
            let half: Vector = std::array::from_fn(|k| if k == axis { 0.25 * rng.integer(0, 4) as f64 } else { 0.0 });
            vec![half.map(|x| -x), half]
        }
        1 => vec![point(rng, is_grid, 3), point(rng, is_grid, 3)],
        TRIANGLE => vec![point(rng, is_grid, 3), point(rng, is_grid, 3), point(rng, is_grid, 3)],
        CYLINDER | CONE => Vec::new(),
        _ => box_corners(
            [0; 3].map(|_| [0.0, 0.5, 0.5, 1.0, 1.0, 2.0, 0.3][rng.integer(0, if is_grid { 5 } else { 6 }) as usize]),
        ),
    };
    let size = |rng: &mut Rng| [0.0, 0.5, 0.5, 1.0, 0.3][rng.integer(0, if is_grid { 3 } else { 4 }) as usize];
    let turned = (kind == CYLINDER || kind == CONE).then(|| Turned {
        half_height: size(rng),
        radius: size(rng),
        is_cone: kind == CONE,
    });
    let of_map = if is_grid { rng.integer(0, 2) } else { rng.integer(0, 11) };
    let linear = if (kind == BOX || kind == TRIANGLE) && of_map == 0 && !is_grid {
        poses::large_integer_map(rng).linear
    } else {
        linear(rng, of_map)
    };
    let size = linear.as_flattened().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    let pose = Pose::new(linear, point(rng, is_grid, 4).map(|x| size * x)).unwrap();
    let radius = if is_round && kind < BOX {
        [0.0, 0.25, 0.5, 1.0, 0.3][rng.integer(0, if is_grid { 3 } else { 4 }) as usize]
    } else {
        0.0
    };
    let spread = if !is_grid && rng.one_in(8) { 1e-5 * radius } else { 0.0 };
    Scene { corners, turned, pose, radius: [radius - spread, radius + spread] }
}

/// Counts of the queries of one pair of kinds, and of those that closed forms answer: by the true
/// answer, of depths and of distances.
#[derive(Debug, Default)]
struct Shares {
    asked: [u32; 3],
    answered: [u32; 3],
    depths: [u32; 2],
    distances: [u32; 2],
}

const KINDS: [[usize; 2]; 12] = [
    [0, 0],
    [0, 1],
    [1, 0],
    [1, 1],
    [0, BOX],
    [BOX, 0],
    [1, BOX],
    [BOX, 1],
    [BOX, BOX],
    [0, TRIANGLE],
    [CYLINDER, 0],
    [0, CONE],
];

fn kinds_of(round: usize) -> [usize; 2] {
    KINDS[round % KINDS.len()]
}

#[test]
fn closed_forms_agree_with_the_iteration_and_exact_arithmetic() {
    let mut rng = Rng::new(35);
    let mut shares: [Shares; KINDS.len()] = Default::default();
    for round in 0..rounds(45_000) {
        let kinds = kinds_of(round);
        let (is_round, is_grid) = (!rng.one_in(3), rng.one_in(2));
        let scale = 2.0_f64.powi([0, 0, 0, 0, -60, 60, -95, 95, -110, 90][rng.integer(0, 9) as usize]);
        let [one, other] = kinds.map(|kind| random(&mut rng, kind, is_round, is_grid).scaled(scale));
        let [a, b] = [one.swept(), other.swept()];
        let [a, b] = if a.is_before(&b) { [a, b] } else { [b, a] };
        let pair = Pair::new(&a, &b);
        let is_turned = kinds.contains(&CYLINDER) || kinds.contains(&CONE);
        let shares = &mut shares[round % KINDS.len()];
        let clearance = scale * [0.0, 0.0, 0.25, 0.3][rng.integer(0, if is_grid { 2 } else { 3 }) as usize];
        let truth = distance::by_iteration(&pair, [a.radius, b.radius], clearance);
        let found = nearness(&a, &b, clearance);
        assert!(
            found.is_none_or(|found| found == truth || is_turned && truth == Proximity::Undecided),
            "{one:?} {other:?} {clearance}: {found:?}, not {truth:?}"
        );
        shares.asked[truth as usize] += 1;
        shares.answered[truth as usize] += u32::from(found.is_some());
        check_swapped([&a, &b], clearance);

        let truth = separation_by_iteration(&a, &b);
        shares.distances[0] += 1;
        if let Some(found) = separation(&a, &b) {
            shares.distances[1] += 1;
            let is_same = found.proximity == truth.proximity || is_turned && truth.proximity == Proximity::Undecided;
            assert!(is_same, "{one:?} {other:?}");
            assert!(found.lower <= truth.upper && truth.lower <= found.upper, "{one:?} {other:?} {found:?} {truth:?}");
            check_width([&a, &b], &found);
            check_points([&a, &b], &pair, &found, &truth);
        }
        shares.depths[0] += u32::from(truth.proximity == Proximity::Intersects);
        if truth.proximity == Proximity::Intersects
            && let Some(found) = super::depth(&a, &b, HULL_FALLBACK_WIDTH * pair.unit)
        {
            shares.depths[1] += 1;
            check_depth([&a, &b], &pair, &found);
        }
    }
    for (kinds, shares) in KINDS.iter().zip(&shares) {
        let report = format!("{kinds:?}: {shares:?}");
        let share = |some: u32, all: u32| f64::from(some) / f64::from(all);
        let [apart, intersecting, _] = shares.asked;
        let total = shares.asked.iter().sum();
        // A tenth of the scenes are left to the iteration because their sizes are extreme, and ties
        // are too.
        assert!(share(apart, total) > 0.3 && share(intersecting, total) > 0.08, "{report}");
        let [of_apart, of_intersecting] = [0, 1].map(|kind| share(shares.answered[kind], shares.asked[kind]));
        assert!((0.85..0.99).contains(&of_apart) && (0.7..0.95).contains(&of_intersecting), "{report}");
        assert!(share(shares.distances[1], shares.distances[0]) > 0.6, "{report}");
        assert!(share(shares.depths[1], shares.depths[0]) > 0.5, "{report}");
    }
}

/// Checks that swapping two shapes swaps the points and keeps every number.
fn check_swapped([a, b]: [&Swept<'_>; 2], clearance: f64) {
    assert_eq!(distance::nearness(a, b, clearance), distance::nearness(b, a, clearance), "{a:?} {b:?}");
    let [here, there] = [distance::separation(a, b), distance::separation(b, a)];
    let points = [there.points[1], there.points[0]];
    assert_eq!(here, Separation { points, ..there }, "{a:?} {b:?}");
}

fn extent([a, b]: [&Swept<'_>; 2]) -> f64 {
    Differences::between(a, b).map_or_else(|| around_point::found(a, b).unwrap().extent, |found| found.extent)
}

/// Checks that the interval of a distance is as narrow as documented.
fn check_width([a, b]: [&Swept<'_>; 2], found: &Separation) {
    let extent = extent([a, b]);
    let spread = a.radius[1] + b.radius[1] - a.radius[0] - b.radius[0];
    let is_turned = [a, b].iter().any(|shape| matches!(shape.core, Core::Turned(_)));
    let is_round = a.radius[1] + b.radius[1] > 0.0 || is_turned;
    let rest =
        if is_round { extent * 2.0_f64.powi(if is_turned { -42 } else { -45 }) + spread * (1.0 + 1e-9) } else { 0.0 };
    let core = found.upper + a.radius[1] + b.radius[1];
    assert!(found.upper - found.lower <= core * 2.0_f64.powi(-36) + rest, "{a:?} {b:?} {found:?}");
}

/// Checks that both points are in their shapes, and as far apart as the shapes.
fn check_points([a, b]: [&Swept<'_>; 2], pair: &Pair<'_>, found: &Separation, truth: &Separation) {
    let near = 1e-11 * pair.unit;
    let [p, q] = found.points;
    let apart = length(&sub(&p, &q));
    assert!(found.lower - near <= apart && apart <= found.upper + near, "{a:?} {b:?} {found:?} {truth:?}");
    for direction in
        [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.3, 0.5, -0.7], [-0.6, 0.5, 0.2], to_unit_length(sub(&q, &p))]
    {
        let [beyond_a, beyond_b] =
            [pair.a.support(direction), pair.b.support(direction)].map(|spot| pair.world(spot.point));
        let long = length(&direction);
        assert!(dot(&direction, &p) <= dot(&direction, &beyond_a) + long * a.radius[1] + near, "{a:?} {b:?} {found:?}");
        assert!(dot(&direction, &q) <= dot(&direction, &beyond_b) + long * b.radius[1] + near, "{a:?} {b:?} {found:?}");
    }
}

/// Checks a depth of cores against the iteration, and that the normal and the points belong to it.
fn check_depth([a, b]: [&Swept<'_>; 2], pair: &Pair<'_>, found: &Depth) {
    let core = &found.core;
    let near = 1e-11 * pair.unit;
    let sum = |end: usize| a.radius[end] + b.radius[end];
    let normal = to_unit_length(core.direction);
    let beyond = pair.support(normal);
    assert!(
        (dot(&beyond.vector, &normal) * pair.unit - core.upper).abs() < near,
        "{a:?} {b:?} {} {}",
        core.lower,
        core.upper
    );
    let (other, apart) = depth::by_iteration(pair, Effort::DEPTH);
    let [lower, upper] = [other.lower, other.upper].map(|end| end * pair.unit);
    if core.lower > 0.0 || lower > 0.0 {
        assert!(core.lower <= upper && lower.max(-apart) <= core.upper, "{a:?} {b:?} {} {upper}", core.upper);
    } else {
        let Some(exact) = least_distance(pair, &gjk::gap(pair).simplex) else { return };
        let [least, most] = exact.bounds(pair.unit).map(|end| end * pair.unit);
        assert!(
            least <= found.apart && -core.upper <= most,
            "{a:?} {b:?}: {} {} {least} {most}",
            core.upper,
            found.apart
        );
    }
    let off = sub(&sub(&core.points[0], &core.points[1]), &normal.map(|x| x * core.upper));
    assert!(length(&off) < 1e-9 * pair.unit, "{a:?} {b:?}: {off:?} {} {:?} {}", core.upper, normal, sum(0));
}

/// Scenes of extreme size are answered by the iteration. So a scene and its tiny copy, scaled by a
/// power of two, compare the contacts of both ways.
#[test]
fn contacts_have_the_same_features_as_those_of_the_iteration() {
    const TINY: f64 = f64::from_bits((1023 - 120) << 52);
    let mut rng = Rng::new(36);
    let (mut same, mut other, mut renamed, mut points) = (0, 0, 0, 0);
    for round in 0..rounds(8_000) {
        let kinds = kinds_of(round % 9);
        let (is_round, is_grid) = (!rng.one_in(3), rng.one_in(2));
        let [one, two] = kinds.map(|kind| random(&mut rng, kind, is_round, is_grid));
        let [small_one, small_two] = [&one, &two].map(|scene| scene.clone().scaled(TINY));
        if distance::nearness(&one.swept(), &two.swept(), 0.0) == Proximity::Apart {
            continue;
        }
        if super::depth(&small_one.swept(), &small_two.swept(), f64::INFINITY).is_some() {
            continue; // two points at the origins of equal frames
        }
        let [found, small] = [[&one, &two], [&small_one, &small_two]].map(|scenes| {
            let facets = scenes.map(|scene| Facets::of_points(&scene.corners));
            let [a, b] = [0, 1].map(|side| Faceted {
                swept: scenes[side].swept(),
                facets: facets[side].as_ref(),
                has_all_facets: false,
            });
            contacts(&a, &b, 0.0)
        });
        if dot(&found.normal, &small.normal) < 1.0 - 1e-12 {
            // Another direction is as good.
            other += 1;
            continue;
        }
        let in_order = |mut contacts: Vec<Contact>| {
            contacts.sort_by_key(|contact| contact.features);
            contacts
        };
        let [found, small] = [found, small].map(|found| in_order(found.contacts));
        let features = |contacts: &[Contact]| contacts.iter().map(|contact| contact.features).collect::<Vec<_>>();
        if features(&found) != features(&small) {
            // A contact is at the end of an edge, and belongs to the edge or to its end.
            renamed += 1;
            continue;
        }
        (same, points) = (same + 1, points + found.len());
        for (here, there) in found.iter().zip(&small) {
            for side in 0..2 {
                let off = length(&sub(&here.points[side], &there.points[side].map(|x| x / TINY)));
                assert!(off < 1e-6, "{one:?} {two:?} {found:?} {small:?}: {off}");
            }
        }
    }
    let asked = rounds(8_000);
    assert!(5 * same > asked && 20 * other < same && 200 * renamed < same, "{same} {other} {renamed} of {asked}");
    assert!(points > same + same / 3, "{points} points of {same}");
}

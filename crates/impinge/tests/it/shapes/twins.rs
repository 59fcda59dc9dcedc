//! Contacts of meshes against the contacts of the same scene made of convex shapes, at random
//! shallow poses.

use impinge::query::{self, Manifold};
use impinge::shape::{PlacedShape, Shape};
use impinge::{Mesh, Pose};
use impinge_testkit::generate::solids::{cuboid, plane_grid};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::{Mesh as Plain, rounds};

use super::mesh_contacts::{area, deepest, nearby};
use crate::shapes::hulls::pose;
use crate::shapes::support::{dot, engine};

/// Returns a box whose faces are divided: each triangle into four, some times.
fn divided(half: [f64; 3], times: usize) -> Plain {
    finer(cuboid(half.map(|x| -x), half), times)
}

fn finer(mut mesh: Plain, times: usize) -> Plain {
    for _ in 0..times {
        let mut finer = Plain::default();
        for face in &mesh.faces {
            let [p, q, r] = face.map(|vertex| mesh.vertices[vertex as usize]);
            let middle = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| 0.5 * (p[k] + q[k])) };
            let (pq, qr, rp) = (middle(p, q), middle(q, r), middle(r, p));
            for corners in [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]] {
                let first = finer.vertices.len() as u32;
                finer.vertices.extend(corners);
                finer.faces.push([first, first + 1, first + 2]);
            }
        }
        mesh = finer;
    }
    mesh
}

/// Kind of a cylinder in [`body`].
const CYLINDER: i64 = 1;

/// Returns a body that comes to rest: a box, a cylinder, a capsule or a hull.
fn body(rng: &mut Rng, kind: i64) -> Shape {
    match kind {
        0 => Shape::cuboid([0; 3].map(|_| rng.uniform(0.1, 0.6))).unwrap(),
        CYLINDER => Shape::cylinder(rng.uniform(0.1, 0.6), rng.uniform(0.1, 0.5)).unwrap(),
        2 => Shape::capsule([0.0, 0.0, -0.3], [0.0, 0.0, 0.3], rng.uniform(0.1, 0.3)).unwrap(),
        _ => {
            let points: Vec<[f64; 3]> = (0..12).map(|_| [0; 3].map(|_| rng.uniform(-0.5, 0.5))).collect();
            Shape::hull(std::sync::Arc::new(impinge::hull::Hull::new(&points).unwrap()))
        }
    }
}

/// Places a body so that it is slightly deep in a box, over its sides, edges or corners. Negative
/// `deeper` leave a gap.
fn sunk(
    rng: &mut Rng,
    twin: &PlacedShape,
    half: [f64; 3],
    body: &Shape,
    deeper: [f64; 3],
) -> Option<(PlacedShape, f64)> {
    let mut place = if rng.one_in(3) { poses::rotation(rng) } else { impinge_testkit::Affine::IDENTITY };
    if rng.one_in(3) {
        // Nearly level, as a body that rocks.
        let [x, y] = [0; 2].map(|_| rng.uniform(-0.01, 0.01));
        let tilt = Pose::from_axis_angle([x, y, 1e-3], (x * x + y * y).sqrt(), [0.0; 3]).ok()?;
        place.linear = *tilt.linear();
    }
    let side = rng.integer(0, 2) as usize;
    let mut middle: [f64; 3] = std::array::from_fn(|k| rng.uniform(-1.2, 1.2) * half[k]);
    middle[side] = if rng.one_in(2) { half[side] + 2.0 } else { -half[side] - 2.0 };
    // Falls along the axis until it touches, and then a little deeper.
    let there = |shift: f64| {
        let mut place = place;
        place.translation = middle;
        place.translation[side] -= shift * middle[side].signum();
        body.at(pose(&place)).unwrap()
    };
    let (mut low, mut high) = (0.0, 2.0 + half[side]);
    if !query::intersects(twin, there(high)) {
        return None;
    }
    for _ in 0..50 {
        let shift = 0.5 * (low + high);
        if query::intersects(twin, there(shift)) { high = shift } else { low = shift }
    }
    let deep = deeper[rng.integer(0, 2) as usize] * rng.uniform(0.5, 1.0);
    Some((there(high + deep), deep))
}

/// Depths of bodies that rest on each other.
const DEEP: [f64; 3] = [1e-4, 1e-3, 1e-2];

/// Difference of areas that does not count.
const AREA_SLACK: f64 = 1e-9;

/// Difference of areas of a cylinder that does not count. Four of many points on its rim are
/// chosen, and nearly in one line if it rocks. Both depend on its normal, which is within 2^-12.
const CYLINDER_AREA_SLACK: f64 = 1e-3;

/// Compares manifolds of a scene with the one of its convex twin. Reports whether the twin's normal
/// was the only good one.
fn compare(found: &[Manifold], twin: &Manifold, second_least: f64, slack: f64, context: &dyn Fn() -> String) -> bool {
    let depth = deepest(twin);
    for manifold in found {
        assert!(deepest(manifold) <= 1.01 * depth + 1e-9, "{depth} {}", context());
    }
    // If another way out is as short, either is right.
    if second_least < 1.02 * depth + 1e-6 {
        return false;
    }
    for manifold in found {
        assert!(dot(&manifold.normal, &twin.normal) > 1.0 - 1e-3, "{}", context());
    }
    assert_eq!(found.len(), 1, "{}", context());
    assert!((deepest(&found[0]) - depth).abs() <= 0.01 * depth + 1e-9, "{}", context());
    assert!(area(&found[0]) >= 0.99 * area(twin) - slack, "{} {} {}", area(&found[0]), area(twin), context());
    true
}

/// Returns the depth along the axis of the box other than the one of the twin's normal along which
/// the body leaves it soonest.
fn other_axis(twin: &PlacedShape, body: &PlacedShape, normal: &[f64; 3]) -> f64 {
    let (Some(a), Some(b)) = (twin.bounds(), body.bounds()) else { return 0.0 };
    let mut least = f64::INFINITY;
    for k in 0..3 {
        for (sign, depth) in [(1.0, a[1][k] - b[0][k]), (-1.0, b[1][k] - a[0][k])] {
            if sign * normal[k] < 0.99 {
                least = least.min(depth);
            }
        }
    }
    least
}

/// Checks bodies on boxes that are meshes, coarse and fine, as solids and as surfaces.
#[test]
fn bodies_on_mesh_boxes_have_the_contacts_of_bodies_on_boxes() {
    let mut rng = Rng::new(602);
    let (mut checked, mut unique, mut level) = (0, 0, 0);
    for _ in 0..rounds(300) {
        let half = if rng.one_in(2) { [1.0, 1.0, 0.5] } else { [0; 3].map(|_| rng.uniform(0.3, 1.5)) };
        let times = rng.integer(0, 3) as usize;
        let mesh: Mesh = engine(&divided(half, times));
        let twin = Shape::cuboid(half).unwrap().at(Pose::IDENTITY).unwrap();
        let kind = rng.integer(0, 3);
        let body = body(&mut rng, kind);
        let slack = if kind == CYLINDER { CYLINDER_AREA_SLACK } else { AREA_SLACK };
        let Some((body, sunk)) = sunk(&mut rng, &twin, half, &body, DEEP) else { continue };
        let truth = query::contacts(&twin, &body);
        let second = other_axis(&twin, &body, &truth[0].normal);
        for shape in [Shape::solid(&mesh), Shape::mesh(&mesh)] {
            let found = query::contacts(shape.at(Pose::IDENTITY).unwrap(), &body);
            let context = || format!("{half:?} {times} {body:?} {sunk}: {found:?}, not {truth:?}");
            unique += usize::from(compare(&found, &truth[0], second, slack, &context));
            checked += 1;
            level += usize::from(truth[0].points.len() == 4);
        }
    }
    assert!(checked > 350 && unique > 250 && level > 60, "{checked} {unique} {level}");
}

/// Checks boxes that are meshes on boxes that are meshes.
#[test]
fn mesh_boxes_on_mesh_boxes_have_the_contacts_of_boxes() {
    let mut rng = Rng::new(603);
    let (mut checked, mut unique) = (0, 0);
    for _ in 0..rounds(200) {
        let half = [0; 3].map(|_| rng.uniform(0.3, 1.5));
        let own = [0; 3].map(|_| rng.uniform(0.1, 0.6));
        let times = [0; 2].map(|_| rng.integer(0, 2) as usize);
        let base = Shape::solid(&engine(&divided(half, times[0]))).at(Pose::IDENTITY).unwrap();
        let twin = Shape::cuboid(half).unwrap().at(Pose::IDENTITY).unwrap();
        let Some((plain, sunk)) = sunk(&mut rng, &twin, half, &Shape::cuboid(own).unwrap(), DEEP) else { continue };
        let truth = query::contacts(&twin, &plain);
        let second = other_axis(&twin, &plain, &truth[0].normal);
        let upper = Shape::solid(&engine(&divided(own, times[1]))).at(*plain.world_from_local()).unwrap();
        let found = query::contacts(&base, &upper);
        let context = || format!("{half:?} {own:?} {times:?} {plain:?} {sunk}: {found:?}, not {truth:?}");
        unique += usize::from(compare(&found, &truth[0], second, AREA_SLACK, &context));
        checked += 1;
    }
    assert!(checked > 120 && unique > 80, "{checked} {unique}");
}

/// Checks boxes that are meshes a little above boxes that are meshes, within a margin.
#[test]
fn mesh_boxes_near_mesh_boxes_have_the_contacts_of_boxes() {
    let mut rng = Rng::new(604);
    let (mut checked, mut flat) = (0, 0);
    for _ in 0..rounds(200) {
        let half = [0; 3].map(|_| rng.uniform(0.3, 1.5));
        let own = [0; 3].map(|_| rng.uniform(0.1, 0.6));
        let times = [0; 2].map(|_| rng.integer(0, 2) as usize);
        let base = Shape::solid(&engine(&divided(half, times[0]))).at(Pose::IDENTITY).unwrap();
        let twin = Shape::cuboid(half).unwrap().at(Pose::IDENTITY).unwrap();
        let gaps = DEEP.map(|deep| -deep);
        let Some((plain, gap)) = sunk(&mut rng, &twin, half, &Shape::cuboid(own).unwrap(), gaps) else { continue };
        let truth = &nearby(&twin, &plain)[0];
        let upper = Shape::solid(&engine(&divided(own, times[1]))).at(*plain.world_from_local()).unwrap();
        let found = nearby(&base, &upper);
        let context = || format!("{half:?} {own:?} {times:?} {plain:?} {gap}: {found:?}, not {truth:?}");
        assert_eq!(found.len(), 1, "{}", context());
        assert!(dot(&found[0].normal, &truth.normal) > 1.0 - 1e-6, "{}", context());
        assert!((deepest(&found[0]) - deepest(truth)).abs() <= 1e-9, "{}", context());
        assert!(area(&found[0]) >= 0.99 * area(truth) - AREA_SLACK, "{}", context());
        checked += 1;
        flat += usize::from(truth.points.len() == 4);
    }
    assert!(checked > 120 && flat > 40, "{checked} {flat}");
}

/// Places a body above the middle of a base, often parallel to its upper side, and lets it fall
/// until it is slightly deep. The base rises by `slope` along x and y.
fn dropped(rng: &mut Rng, twin: &PlacedShape, slope: [f64; 2], body: &Shape) -> PlacedShape {
    let mut place = poses::rotation(rng);
    if rng.one_in(2) {
        let rise = slope[0].hypot(slope[1]);
        let axis = if rise > 0.0 { [slope[1], -slope[0], 0.0] } else { [0.0, 0.0, 1.0] };
        place.linear = *Pose::from_axis_angle(axis, rise.atan(), [0.0; 3]).unwrap().linear();
    }
    let [x, y] = [0; 2].map(|_| rng.uniform(-0.5, 0.5));
    let there = |z: f64| {
        let mut place = place;
        place.translation = [x, y, z];
        body.at(pose(&place)).unwrap()
    };
    let (mut low, mut high) = (-0.5, 4.0);
    for _ in 0..50 {
        let z = 0.5 * (low + high);
        if query::intersects(twin, there(z)) { low = z } else { high = z }
    }
    there(low - DEEP[rng.integer(0, 2) as usize] * rng.uniform(0.5, 1.0))
}

/// Checks bodies on ramps and on grids, away from their borders.
#[test]
fn bodies_on_mesh_ramps_and_grids_have_the_contacts_of_bodies_on_hulls() {
    let mut rng = Rng::new(605);
    let (mut checked, mut level) = (0, 0);
    for _ in 0..rounds(200) {
        let (slope, mesh, twin) = if rng.one_in(2) {
            // A box whose upper side leans.
            let mut ramp = cuboid([-3.0, -3.0, -3.0], [3.0, 3.0, 0.0]);
            let slope = [0; 2].map(|_| rng.uniform(-0.3, 0.3));
            for vertex in ramp.vertices.iter_mut().filter(|vertex| vertex[2] == 0.0) {
                vertex[2] = slope[0] * vertex[0] + slope[1] * vertex[1];
            }
            let hull = impinge::hull::Hull::new(&ramp.vertices).unwrap();
            (slope, finer(ramp, rng.integer(0, 3) as usize), Shape::hull(std::sync::Arc::new(hull)))
        } else {
            let width = [2.0, 0.5, 0.25, 0.125][rng.integer(0, 3) as usize];
            let count = (6.0 / width) as u32;
            let mut grid = plane_grid(count, count);
            grid.vertices.iter_mut().for_each(|[x, y, _]| (*x, *y) = (width * *x - 3.0, width * *y - 3.0));
            let corner = |i: usize| [[-3.0, 3.0][i & 1], [-3.0, 3.0][i >> 1 & 1], [-3.0, 0.0][i >> 2]];
            let hull = impinge::hull::Hull::new(&(0..8).map(corner).collect::<Vec<[f64; 3]>>()).unwrap();
            ([0.0; 2], grid, Shape::hull(std::sync::Arc::new(hull)))
        };
        let twin = twin.at(Pose::IDENTITY).unwrap();
        let kind = rng.integer(0, 3);
        let body = dropped(&mut rng, &twin, slope, &body(&mut Rng::new(checked), kind));
        let slack = if kind == CYLINDER { CYLINDER_AREA_SLACK } else { AREA_SLACK };
        let truth = query::contacts(&twin, &body);
        let found = query::contacts(Shape::mesh(&engine(&mesh)).at(Pose::IDENTITY).unwrap(), &body);
        let context = || format!("{} faces, {body:?}: {found:?}, not {truth:?}", mesh.faces.len());
        assert!(compare(&found, &truth[0], f64::INFINITY, slack, &context));
        checked += 1;
        level += usize::from(truth[0].points.len() > 1);
    }
    assert!(level > 50, "{level}");
}

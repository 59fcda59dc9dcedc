//! Rays through worlds, against closed forms and against all bodies one by one.

use std::sync::Arc;

use impinge::convex::Support;
use impinge::hull::Hull;
use impinge::partition::Ray;
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, BodyRayHit, BroadPhase, Options, World};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::icosphere;
use impinge_testkit::rounds;

use super::pose;

/// Returns the parameter at which a ray first hits a sphere, by the quadratic formula.
fn on_sphere(ray: &Ray, center: [f64; 3], radius: f64) -> Option<f64> {
    let from: [f64; 3] = std::array::from_fn(|k| ray.origin()[k] - center[k]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (a, b, c) =
        (dot(ray.direction(), ray.direction()), dot(from, ray.direction()), dot(from, from) - radius * radius);
    if c <= 0.0 {
        return Some(0.0);
    }
    let root = b * b - a * c;
    (root >= 0.0 && b < 0.0).then(|| (-b - root.sqrt()) / a).filter(|&t| t <= ray.reach())
}

fn random_ray(rng: &mut Rng) -> Ray {
    let origin = [0; 3].map(|_| rng.uniform(-6.0, 6.0));
    let to = [0; 3].map(|_| rng.uniform(-3.0, 3.0));
    let reach = if rng.one_in(3) { rng.uniform(0.0, 1.0) } else { f64::INFINITY };
    Ray::new(origin, std::array::from_fn(|k| to[k] - origin[k]), reach).unwrap()
}

#[test]
fn rays_hit_spheres_as_in_closed_form() {
    for broad_phase in BroadPhase::ALL {
        let mut rng = Rng::new(101);
        let mut world = World::with_options(Options { broad_phase, ..Options::default() });
        let balls: Vec<([f64; 3], f64)> =
            (0..40).map(|_| ([0; 3].map(|_| rng.uniform(-3.0, 3.0)), rng.uniform(0.1, 0.8))).collect();
        for (tag, &(center, radius)) in balls.iter().enumerate() {
            let ball = Body::new(Shape::sphere([0.0; 3], radius).unwrap()).tag(tag as u64);
            world.insert(ball.at(Pose::from_translation(center).unwrap())).unwrap();
        }
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..500 {
            let ray = random_ray(&mut rng);
            let mut expected: Vec<(f64, u64)> = balls
                .iter()
                .enumerate()
                .filter_map(|(tag, &(center, radius))| Some((on_sphere(&ray, center, radius)?, tag as u64)))
                .collect();
            expected.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
            let found = world.ray_cast_all(&ray, |_| true);
            assert_eq!(
                found.iter().map(|hit| hit.tag).collect::<Vec<_>>(),
                expected.iter().map(|hit| hit.1).collect::<Vec<_>>()
            );
            for (hit, (t, _)) in found.iter().zip(&expected) {
                assert!((hit.t - t).abs() < 1e-7 && hit.face.is_none(), "{hit:?} {t}");
            }
            assert_eq!(world.ray_cast(&ray, |_| true), found.first().copied());
            let odd = world.ray_cast(&ray, |traits| traits.tag % 2 == 1);
            assert_eq!(odd, found.iter().find(|hit| hit.tag % 2 == 1).copied());
            if found.is_empty() { misses += 1 } else { hits += 1 }
        }
        assert!(hits > 150 && misses > 50, "{hits} {misses}");
    }
}

#[test]
fn rays_hit_meshes_between_their_inner_and_outer_spheres() {
    let ball = icosphere(3);
    let mesh = Mesh::new(Positions::F64(ball.vertices), ball.faces).unwrap();
    for solid in [false, true] {
        let mut rng = Rng::new(102);
        let mut world = World::new();
        let shape = if solid { Shape::solid(&mesh) } else { Shape::mesh(&mesh) };
        let bodies: Vec<(BodyId, [f64; 3])> = (0..20)
            .map(|_| {
                let pose = pose(&mut rng, 4.0);
                (world.insert(Body::new(shape.clone()).at(pose)).unwrap(), *pose.translation())
            })
            .collect();
        let (mut hits, mut inside) = (0, 0);
        for _ in 0..600 {
            let ray = random_ray(&mut rng);
            let found = world.ray_cast_all(&ray, |_| true);
            for (body, center) in &bodies {
                let hit: Option<&BodyRayHit> = found.iter().find(|hit| hit.body == *body);
                // The mesh lies between two spheres.
                let (inner, outer) = (on_sphere(&ray, *center, 0.98), on_sphere(&ray, *center, 1.0 + 1e-12));
                if let Some(hit) = hit {
                    assert!(outer.is_some(), "{hit:?}");
                    let starts_inside = hit.t == 0.0;
                    inside += u32::from(starts_inside);
                    assert!(hit.face.is_none() == starts_inside && (!starts_inside || solid));
                    hits += 1;
                } else if solid {
                    assert!(inner.is_none());
                } else {
                    assert!(inner.is_none_or(|t| t == 0.0));
                }
            }
        }
        assert!(hits > 300 && (inside > 10) == solid, "{hits} {inside}");
    }
}

#[test]
fn rays_hit_a_floor_from_above() {
    let mut world = World::new();
    let floor = world.insert(Body::new(Shape::half_space([0.0, 0.0, 2.0], 2.0).unwrap())).unwrap();
    let down = Ray::new([3.0, 4.0, 5.0], [0.0, 0.0, -2.0], f64::INFINITY).unwrap();
    let hit = world.ray_cast(&down, |_| true).unwrap();
    assert!(hit.body == floor && (hit.t - 2.0).abs() < 1e-9 && (hit.point[2] - 1.0).abs() < 1e-9);
    let up = Ray::new([3.0, 4.0, 5.0], [0.0, 0.0, 2.0], f64::INFINITY).unwrap();
    assert!(world.ray_cast(&up, |_| true).is_none());
    let below = Ray::new([3.0, 4.0, -5.0], [0.0, 0.0, 2.0], f64::INFINITY).unwrap();
    assert_eq!(world.ray_cast(&below, |_| true).unwrap().t, 0.0);
    let short = Ray::new([3.0, 4.0, 5.0], [0.0, 0.0, -2.0], 1.5).unwrap();
    assert!(world.ray_cast(&short, |_| true).is_none());
}

/// Rectangle in the plane of x and y, swept by a sphere.
#[derive(Debug)]
struct RoundedPlate {
    half: [f64; 2],
    radius: f64,
}

impl RoundedPlate {
    /// Returns the signed distance of a point from the surface, which is negative inside.
    fn height(&self, [x, y, z]: [f64; 3]) -> f64 {
        let beyond = |x: f64, half: f64| (x.abs() - half).max(0.0);
        let (x, y) = (beyond(x, self.half[0]), beyond(y, self.half[1]));
        (x * x + y * y + z * z).sqrt() - self.radius
    }
}

impl Support for RoundedPlate {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let size = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        let out = direction.map(|x| if size > 0.0 { self.radius * x / size } else { 0.0 });
        let [x, y] = [0, 1].map(|k| self.half[k].copysign(direction[k]) + out[k]);
        [x, y, out[2]]
    }

    fn reach(&self) -> [f64; 3] {
        let [x, y] = self.half.map(|half| (half + self.radius) * (1.0 + 1e-14));
        [x, y, self.radius * (1.0 + 1e-14)]
    }
}

#[test]
fn rays_hit_custom_shapes_on_their_surface() {
    let mut rng = Rng::new(103);
    let plate = Arc::new(RoundedPlate { half: [1.0, 0.5], radius: 0.25 });
    let mut world = World::new();
    world.insert(Body::new(Shape::custom(plate.clone()).unwrap())).unwrap();
    let (mut hits, mut misses, mut past, mut short) = (0, 0, 0.0_f64, 0.0_f64);
    for _ in 0..4_000 {
        let ray = random_ray(&mut rng);
        let at = |t: f64| -> [f64; 3] { std::array::from_fn(|k| ray.origin()[k] + t * ray.direction()[k]) };
        // Heights along a ray are convex, so ternary search finds the minimum.
        let (mut from, mut to) = (0.0, ray.reach().min(100.0));
        for _ in 0..200 {
            let [low, high] = [from + (to - from) / 3.0, to - (to - from) / 3.0];
            if plate.height(at(low)) < plate.height(at(high)) { to = high } else { from = low }
        }
        let least = plate.height(at(from));
        let Some(hit) = world.ray_cast(&ray, |_| true) else {
            assert!(least > -1e-9, "{ray:?} goes {least} deep");
            misses += 1;
            continue;
        };
        assert!(least < 1e-9, "{ray:?} stays {least} away");
        hits += 1;
        let height = plate.height(hit.point);
        if hit.t > 0.0 {
            past = past.max(-height);
        }
        short = short.max(height);
    }
    assert!(hits > 200 && misses > 2_000, "{hits} hits, {misses} misses");
    // A ray that grazes the plate advances in small steps.
    assert!(past < 1e-11 && short < 1e-8, "past by {past:e}, short by {short:e}");
}

/// Returns a signed permutation of the axes and a shift by halves, which are exact in floats.
fn exact_pose(rng: &mut Rng) -> Pose {
    let mut rows = [[0.0; 3]; 3];
    let (first, step) = (rng.integer(0, 2) as usize, rng.integer(1, 2) as usize);
    for (row, numbers) in rows.iter_mut().enumerate() {
        numbers[(first + step * row) % 3] = if rng.one_in(2) { 1.0 } else { -1.0 };
    }
    Pose::new(rows, [0; 3].map(|_| rng.integer(-8, 8) as f64 / 2.0)).unwrap()
}

#[test]
fn rays_through_corners_and_edges_hit_and_rays_beside_them_miss() {
    let mut rng = Rng::new(104);
    let cross =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let cube: [[f64; 3]; 8] = std::array::from_fn(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.0 } else { 1.0 }));
    let triangle = [[0.0, 0.5, 0.0], [0.0, 1.0, -0.5], [0.0, 0.0, 1.0]];
    let shapes: [(Shape, &[[f64; 3]]); 4] = [
        (Shape::hull(Arc::new(Hull::new(&cross).unwrap())), &cross),
        (Shape::cuboid([1.0; 3]).unwrap(), &cube),
        (Shape::hull(Arc::new(Hull::new(&cube).unwrap())), &cube),
        (Shape::triangle(triangle).unwrap(), &triangle),
    ];
    let (mut touched, mut passed) = (0, 0);
    for round in 0..6_000 {
        let (shape, corners) = &shapes[round % 4];
        let pose = exact_pose(&mut rng);
        let placed = |corner: &[f64; 3]| -> [f64; 3] {
            std::array::from_fn(|row| {
                pose.translation()[row] + (0..3).map(|k| pose.linear()[row][k] * corner[k]).sum::<f64>()
            })
        };
        let [p, q] = [0; 2].map(|_| placed(&corners[rng.integer(0, corners.len() as i64 - 1) as usize]));
        // A corner, or the middle between two corners, which is on an edge or inside.
        let target: [f64; 3] = std::array::from_fn(|k| 0.5 * (p[k] + q[k]));
        let direction = [0; 3].map(|_| rng.integer(-3, 3) as f64);
        if direction == [0.0; 3] {
            continue;
        }
        let origin: [f64; 3] = std::array::from_fn(|k| target[k] - direction[k]);
        let mut world = World::new();
        world.insert(Body::new(shape.clone()).at(pose)).unwrap();
        for reach in [1.0, 1.5, f64::INFINITY] {
            let hit = world.ray_cast(&Ray::new(origin, direction, reach).unwrap(), |_| true);
            let t = hit.map(|hit| hit.t);
            assert!(
                t.is_some_and(|t| t <= 1.0 + 1e-9),
                "{shape:?} at {pose:?} from {origin:?} along {direction:?}: {t:?}"
            );
        }
        touched += 1;
        // The line through an extreme corner, moved outward by almost nothing.
        let across = [direction[1], -direction[0], 0.0];
        let height = |point: &[f64; 3]| (0..3).map(|k| point[k] * across[k]).sum::<f64>();
        if across != [0.0; 3] && corners.iter().all(|corner| height(&placed(corner)) <= height(&target)) {
            let outside = std::array::from_fn(|k| origin[k] + across[k] * 2.0_f64.powi(-44));
            let ray = Ray::new(outside, direction, f64::INFINITY).unwrap();
            assert_eq!(world.ray_cast(&ray, |_| true), None, "{shape:?} at {pose:?}: {ray:?} passes");
            passed += 1;
        }
    }
    assert!(touched > 5_000 && passed > 500, "{touched} touched, {passed} passed");
}

#[test]
fn grazing_rays_hit_at_their_nearest_point() {
    let mut rng = Rng::new(105);
    let shapes = [
        Shape::sphere([0.0; 3], 0.5).unwrap(),
        Shape::capsule([0.0; 3], [0.0, 0.0, 2.0], 0.5).unwrap(),
        Shape::cylinder(1.0, 0.5).unwrap(),
    ];
    for round in 0..rounds(1_200) {
        let (shape, pose) = (&shapes[round % 3], exact_pose(&mut rng));
        // A point at x = 1/2 on the surface, and a tangent direction that is not along the axis.
        let touched = [0.5, 0.0, if round % 3 == 0 { 0.0 } else { 0.75 }];
        let along = [0.0, rng.integer(1, 3) as f64, rng.integer(-3, 3) as f64];
        let turned = |v: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|row| (0..3).map(|k| pose.linear()[row][k] * v[k]).sum::<f64>())
        };
        let (target, direction) = (turned(touched), turned(along));
        let away = rng.integer(1, 3) as f64;
        let origin = std::array::from_fn(|k| target[k] + pose.translation()[k] - away * direction[k]);
        let mut world = World::new();
        world.insert(Body::new(shape.clone()).at(pose)).unwrap();
        let hit = world.ray_cast(&Ray::new(origin, direction, f64::INFINITY).unwrap(), |_| true);
        let t = hit.map(|hit| hit.t);
        assert!(
            t.is_some_and(|t| (t - away).abs() < 1e-3),
            "{shape:?} at {pose:?} along {direction:?}: {t:?}, not {away}"
        );
    }
}

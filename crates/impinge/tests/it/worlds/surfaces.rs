//! Normals and parts of ray hits, and rays that pass through the backs of faces.

use std::sync::Arc;

use impinge::hull::Hull;
use impinge::partition::Ray;
use impinge::primitive::ray_triangle;
use impinge::shape::Shape;
use impinge::world::{Body, BodyRayHit, RayOptions, World};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::{grid_soup, icosphere};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::rounds;

use super::kinds::pose_on_grid;

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn unit(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn is_near(one: Vector, other: Vector, error: f64) -> bool {
    let off = sub(one, other);
    dot(off, off) <= error * error
}

/// Returns the vector turned by the linear part of a pose.
fn turned(pose: &Pose, v: Vector) -> Vector {
    pose.linear().map(|row| dot(row, v))
}

/// Returns the point of the body that a pose takes to a point of the world; the pose is orthogonal.
fn local(pose: &Pose, point: Vector) -> Vector {
    let from = sub(point, *pose.translation());
    std::array::from_fn(|k| (0..3).map(|row| pose.linear()[row][k] * from[row]).sum())
}

fn cast(shape: &Shape, pose: Pose, ray: &Ray) -> Option<BodyRayHit> {
    let mut world = World::new();
    world.insert(Body::new(shape.clone()).at(pose)).unwrap();
    world.ray_cast(ray, |_| true)
}

#[test]
fn normals_of_solids_equal_their_closed_forms() {
    type Normal = fn(Vector) -> Option<Vector>;
    const FINE: f64 = 1e-11;
    const ROUND: f64 = 1.0 / (1 << 12) as f64;
    let shapes: [(Shape, Normal, f64); 8] = [
        (Shape::sphere([0.0; 3], 1.0).unwrap(), |p| Some(unit(p)), FINE),
        (
            Shape::capsule([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.5).unwrap(),
            |[x, y, z]| Some(unit([x, y, z - z.clamp(-1.0, 1.0)])),
            FINE,
        ),
        (Shape::cuboid([1.0, 0.5, 0.25]).unwrap(), |p| of_cuboid(p, [1.0, 0.5, 0.25]), FINE),
        (Shape::half_space([0.0, 3.0, 4.0], 1.0).unwrap(), |_| Some([0.0, 0.6, 0.8]), FINE),
        (Shape::ellipsoid([1.0, 0.5, 0.25]).unwrap(), |[x, y, z]| Some(unit([x, 4.0 * y, 16.0 * z])), ROUND),
        (Shape::cylinder(1.0, 0.5).unwrap(), of_cylinder, ROUND),
        (
            Shape::cuboid([0.75, 0.25, 0.5]).unwrap().rounded(0.25).unwrap(),
            |[x, y, z]| Some(unit([x - x.clamp(-0.75, 0.75), y - y.clamp(-0.25, 0.25), z - z.clamp(-0.5, 0.5)])),
            ROUND,
        ),
        (Shape::tapered_capsule([0.0; 3], [0.0, 0.0, 1.25], [1.0, 0.25]).unwrap(), of_tapered_capsule, ROUND),
    ];
    let mut rng = Rng::new(331);
    for (shape, normal, error) in &shapes {
        let (mut hits, mut inside) = (0, 0);
        for _ in 0..rounds(400) {
            let turn = poses::rotation(&mut rng);
            let pose = Pose::new(turn.linear, [0; 3].map(|_| rng.uniform(-1.0, 1.0))).unwrap();
            let origin = [0; 3].map(|_| rng.uniform(-2.0, 2.0));
            let to = [0; 3].map(|_| rng.uniform(-1.0, 1.0));
            let ray = Ray::new(origin, sub(to, origin), f64::INFINITY).unwrap();
            let Some(hit) = cast(shape, pose, &ray) else { continue };
            assert_eq!(hit.part, 0);
            if hit.t == 0.0 {
                inside += 1;
                assert_eq!(hit.normal, None, "{shape:?} {ray:?}");
                continue;
            }
            let Some(expected) = normal(local(&pose, hit.point)) else { continue };
            hits += 1;
            let found = hit.normal.unwrap();
            assert!(is_near(found, turned(&pose, expected), *error), "{shape:?} {ray:?} {found:?} {expected:?}");
        }
        assert!(hits > 50 && inside > 3, "{shape:?}: {hits} {inside}");
    }
}

/// Returns the normal of a cuboid at a point of a side, or `None` near an edge.
fn of_cuboid(p: Vector, half: Vector) -> Option<Vector> {
    let heights: Vector = std::array::from_fn(|k| p[k].abs() - half[k]);
    let side = (0..3).max_by(|&i, &j| heights[i].total_cmp(&heights[j]))?;
    let is_clear = (0..3).all(|k| k == side || heights[k] < -1e-6);
    is_clear.then(|| std::array::from_fn(|k| if k == side { p[k].signum() } else { 0.0 }))
}

fn of_cylinder([x, y, z]: Vector) -> Option<Vector> {
    let (above, beyond) = (z.abs() - 1.0, x.hypot(y) - 0.5);
    match () {
        () if above.max(beyond) - above.min(beyond) < 1e-3 => None,
        () if above > beyond => Some([0.0, 0.0, z.signum()]),
        () => Some(unit([x, y, 0.0])),
    }
}

/// Returns the normal of the tapered capsule whose side leans by a sine of 3/5.
fn of_tapered_capsule([x, y, z]: Vector) -> Option<Vector> {
    let across = x.hypot(y);
    let along = 0.8 * z - 0.6 * across;
    Some(match along {
        _ if along < 0.0 => unit([x, y, z]),
        _ if along > 1.0 => unit([x, y, z - 1.25]),
        _ => unit([0.8 * x / across, 0.8 * y / across, 0.6]),
    })
}

/// Hits of a soup of grid triangles, at signed permutations of the axes, against a loop over the
/// faces in exact numbers: integers and halves.
#[test]
fn faces_are_hit_on_their_fronts_only_if_backs_are_culled() {
    let mut rng = Rng::new(332);
    let (mut culled, mut kept, mut edge_on, mut shared, mut missed) = (0, 0, 0, 0, 0);
    for _ in 0..rounds(400) {
        let soup = grid_soup(&mut rng, 24, 2, 3);
        let mesh = Mesh::new(Positions::F64(soup.vertices.clone()), soup.faces.clone()).unwrap();
        let pose = pose_on_grid(&mut rng, 3);
        let corner = |rng: &mut Rng| soup.vertices[rng.integer(0, soup.vertices.len() as i64 - 1) as usize];
        let (from, to) = (corner(&mut rng).map(|x| x - 4.0), corner(&mut rng));
        let (origin, direction) = (pose.apply(from), turned(&pose, sub(to, from)));
        if direction == [0.0; 3] {
            continue;
        }
        let ray = Ray::new(origin, direction, f64::INFINITY).unwrap();
        let mut world = World::new();
        world.insert(Body::new(Shape::mesh(&mesh)).at(pose)).unwrap();
        for culls_back_faces in [false, true] {
            let mut first: Option<(f64, u32, Vector)> = None;
            for face in 0..mesh.faces().len() as u32 {
                let corners = mesh.corners(face);
                let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
                let along = dot(normal, sub(to, from));
                let Some(crossing) = ray_triangle(&from, &sub(to, from), &corners) else { continue };
                edge_on += u32::from(along == 0.0);
                if culls_back_faces && along >= 0.0 {
                    culled += 1;
                    continue;
                }
                if first.is_none_or(|first| crossing.t < first.0 * (1.0 - 1e-9)) {
                    let out = if along > 0.0 { normal.map(|x| -x) } else { normal };
                    first = Some((crossing.t, face, turned(&pose, out)));
                }
            }
            let found = world.ray_cast_with(&ray, RayOptions { culls_back_faces }, |_| true);
            assert_eq!(found.map(|hit| hit.face), first.map(|first| Some(first.1)), "{ray:?} {pose:?}");
            assert_eq!(
                found,
                world.ray_cast_all_with(&ray, RayOptions { culls_back_faces }, |_| true).first().copied()
            );
            let (Some(found), Some((t, _, normal))) = (found, first) else {
                missed += 1;
                continue;
            };
            kept += 1;
            shared += u32::from(found.point == pose.apply(to));
            assert!((found.t - t).abs() <= 1e-9 * t);
            match found.normal {
                Some(normal_found) => assert!(is_near(normal_found, unit(normal), 1e-11), "{found:?} {normal:?}"),
                None => assert_eq!(normal, [0.0; 3]),
            }
        }
    }
    assert!(
        culled > 300 && kept > 300 && edge_on > 50 && shared > 50 && missed > 3,
        "{culled} {kept} {edge_on} {shared} {missed}"
    );
}

#[test]
fn culling_leaves_solids_and_other_shapes_as_they_are() {
    let ball = icosphere(2);
    let turned_inside_out: Vec<[u32; 3]> = ball.faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let mesh = Mesh::new(Positions::F64(ball.vertices), turned_inside_out).unwrap();
    let ray = Ray::new([-3.0, 0.25, 0.125], [1.0, 0.0, 0.0], f64::INFINITY).unwrap();
    let culling = RayOptions { culls_back_faces: true };
    for (shape, t) in
        [(Shape::solid(&mesh), 2.0), (Shape::mesh(&mesh), 3.9), (Shape::sphere([0.0; 3], 1.0).unwrap(), 2.0)]
    {
        let mut world = World::new();
        world.insert(Body::new(shape)).unwrap();
        let hit = world.ray_cast_with(&ray, culling, |_| true).unwrap();
        assert!((hit.t - t).abs() < 0.2, "{hit:?}");
        assert!(hit.normal.unwrap()[0] < -0.8, "against the ray: {hit:?}");
    }
    let mut world = World::new();
    world.insert(Body::new(Shape::solid(&mesh))).unwrap();
    let from_inside = Ray::new([0.0; 3], [1.0, 0.0, 0.0], f64::INFINITY).unwrap();
    let hit = world.ray_cast(&from_inside, |_| true).unwrap();
    assert_eq!((hit.t, hit.normal, hit.face), (0.0, None, None));
}

#[test]
fn flat_shapes_have_two_sides_and_compounds_name_their_part() {
    let triangle = Shape::triangle([[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]).unwrap();
    let square = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0]];
    let plate = Shape::hull(Arc::new(Hull::new(&square).unwrap()));
    let mut rng = Rng::new(333);
    for _ in 0..rounds(100) {
        let turn = poses::rotation(&mut rng);
        let pose = Pose::new(turn.linear, [0; 3].map(|_| rng.uniform(-1.0, 1.0))).unwrap();
        for (shape, side) in [(&triangle, 1.0), (&triangle, -1.0), (&plate, 1.0), (&plate, -1.0)] {
            let (from, to) = ([rng.uniform(-9.0, 9.0), 1.0, 2.0 * side], [1.0, 1.5, 0.0]);
            let ray = Ray::new(pose.apply(from), turned(&pose, sub(to, from)), f64::INFINITY).unwrap();
            let hit = cast(shape, pose, &ray).unwrap();
            assert!(is_near(hit.normal.unwrap(), turned(&pose, [0.0, 0.0, side]), 1e-9), "{shape:?} {hit:?}");
        }
    }
    let cube = Shape::cuboid([0.5; 3]).unwrap();
    let at = |x: f64| Pose::from_translation([x, 0.0, 0.0]).unwrap();
    // The second and the third part have a side in one plane.
    let compound = Shape::compound(&[(cube.clone(), at(3.0)), (cube.clone(), at(0.0)), (cube, at(0.0))]).unwrap();
    let right = Ray::new([-3.0, 0.25, 0.0], [1.0, 0.0, 0.0], f64::INFINITY).unwrap();
    let left = Ray::new([9.0, 0.25, 0.0], [-1.0, 0.0, 0.0], f64::INFINITY).unwrap();
    let parts = [&right, &left].map(|ray| cast(&compound, Pose::IDENTITY, ray).map(|hit| (hit.part, hit.normal)));
    assert_eq!(parts, [Some((1, Some([-1.0, 0.0, 0.0]))), Some((0, Some([1.0, 0.0, 0.0])))]);
}

#[test]
fn normals_of_thin_faces_are_accurate() {
    let mut rng = Rng::new(334);
    let (mut thin, mut flat) = (0, 0);
    for _ in 0..rounds(3_000) {
        let scale = rng.choose(&[1_i64, (1 << 20) + 7, (1 << 40) + 12_345]);
        let mut vector = |size: i64| [0; 3].map(|_| rng.integer(-size, size));
        let (a, u, off) = (vector(8), vector(4), vector(1));
        let b: [i64; 3] = std::array::from_fn(|k| a[k] + scale * u[k]);
        let c: [i64; 3] = std::array::from_fn(|k| a[k] + 2 * scale * u[k] + off[k]);
        // The normal in integers, which hold it.
        let [e, f] = [b, c].map(|to| [0, 1, 2].map(|k| i128::from(to[k] - a[k])));
        let normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let corners = [a, b, c].map(|corner| corner.map(|x| x as f64));
        let found = Mesh::new(Positions::F64(corners.to_vec()), vec![[0, 1, 2]]).unwrap().face_normal(0);
        if normal == [0; 3] {
            flat += 1;
            assert_eq!(found, None);
            continue;
        }
        thin += u32::from(scale > 1);
        assert!(is_near(found.unwrap(), unit(normal.map(|x| x as f64)), 4e-12), "{corners:?} {found:?}");
    }
    assert!(thin > 1_000 && flat > 100, "{thin} {flat}");
}

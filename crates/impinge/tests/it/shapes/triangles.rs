//! Meshes that show shapes: their corners are on the surface, and the hull is as close as stated.

use impinge::{Mesh, Pose, Positions, Shape, query};

fn only(shape: &Shape, segments: usize) -> Mesh {
    let mut meshes = shape.to_meshes(segments);
    assert_eq!(meshes.len(), 1);
    meshes.remove(0).0
}

fn corners(mesh: &Mesh) -> Vec<[f64; 3]> {
    match mesh.positions() {
        Positions::F64(points) => points.clone(),
        Positions::F32(points) => points.iter().map(|point| point.map(f64::from)).collect(),
    }
}

fn round_shapes() -> Vec<Shape> {
    vec![
        Shape::sphere([3.0, 0.0, -1.0], 0.5).unwrap(),
        Shape::capsule([0.0; 3], [1.0, 2.0, 3.0], 0.25).unwrap(),
        Shape::tapered_capsule([0.0; 3], [0.0, 0.0, 2.0], [0.75, 0.25]).unwrap(),
        Shape::cylinder(1.0, 0.5).unwrap(),
        Shape::cone(1.0, 0.5).unwrap(),
        Shape::ellipsoid([1.0, 2.0, 0.5]).unwrap(),
        Shape::cuboid([1.0, 0.5, 0.25]).unwrap().rounded(0.125).unwrap(),
    ]
}

#[test]
fn corners_of_round_shapes_are_on_their_surface() {
    for shape in round_shapes() {
        let mesh = only(&shape, 24);
        assert!(mesh.is_closed(), "{shape:?}");
        let placed = shape.at(Pose::IDENTITY).unwrap();
        let middle = placed.bounds().map(|[low, high]| [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]))).unwrap();
        for corner in corners(&mesh) {
            let scaled = |factor: f64| {
                let point = [0, 1, 2].map(|k| middle[k] + factor * (corner[k] - middle[k]));
                Shape::point(point).unwrap().at(Pose::IDENTITY).unwrap()
            };
            assert!(query::intersects(&placed, scaled(1.0 - 1e-8)), "{corner:?} of {shape:?}");
            assert!(!query::intersects(&placed, scaled(1.0 + 1e-6)), "{corner:?} of {shape:?}");
        }
    }
}

#[test]
fn the_hull_of_a_sphere_is_as_close_as_stated() {
    for segments in [8, 24, 64] {
        let mesh = only(&Shape::sphere([0.0; 3], 1.0).unwrap(), segments);
        let least = (0..mesh.faces().len() as u32)
            .map(|face| {
                let center = [0, 1, 2].map(|k| mesh.corners(face).iter().map(|corner| corner[k]).sum::<f64>() / 3.0);
                center.iter().map(|x| x * x).sum::<f64>().sqrt()
            })
            .fold(f64::INFINITY, f64::min);
        let side = 1.0 - (std::f64::consts::PI / segments as f64).cos();
        assert!(1.0 - least < 2.1 * side && 1.0 - least > 0.5 * side, "{least} {side}");
    }
}

#[test]
fn a_cylinder_has_two_rings_and_flat_ends() {
    let mesh = only(&Shape::cylinder(1.0, 0.5).unwrap(), 16);
    let points = corners(&mesh);
    assert!(points.iter().all(|point| point[2].abs() == 1.0));
    let on_rim = |point: &&[f64; 3]| (point[0].hypot(point[1]) - 0.5).abs() < 1e-9;
    assert_eq!(points.iter().filter(on_rim).count(), 32);
}

#[test]
fn polytopes_and_meshes_have_their_own_triangles() {
    let cuboid = only(&Shape::cuboid([1.0, 2.0, 3.0]).unwrap(), 8);
    assert_eq!((cuboid.faces().len(), corners(&cuboid).len()), (12, 8));
    let same = only(&Shape::mesh(&cuboid), 8);
    assert_eq!(same.faces().as_ptr(), cuboid.faces().as_ptr());
}

#[test]
fn compounds_have_a_mesh_for_each_part_and_half_spaces_have_none() {
    let pose = Pose::from_translation([5.0, 0.0, 0.0]).unwrap();
    let plane = Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap();
    let point = Shape::point([0.0; 3]).unwrap();
    let parts = [(Shape::sphere([0.0; 3], 1.0).unwrap(), pose), (plane.clone(), pose), (point, pose)];
    let meshes = Shape::compound(&parts).unwrap().to_meshes(8);
    assert_eq!(meshes.len(), 1);
    assert_eq!(meshes[0].1.translation(), pose.translation());
    assert!(plane.to_meshes(8).is_empty());
}

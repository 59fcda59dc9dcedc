//! Points of pairs of faces, points of contained components, and any pair of faces.

use impinge::mesh::Containment;
use impinge::query::{self, any_intersecting_pair, common_points, contained_point, intersecting_pairs};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;

/// Largest coordinate of the scenes.
const MAX_COORDINATE: f64 = 6.0;

/// Returns a mesh of random triangles on a grid: many are coplanar, flat, or share corners.
fn grid_triangles(rng: &mut Rng, count: u32, height: i64) -> Mesh {
    let mut corner = || [0, 1, 2].map(|k| rng.integer(0, if k == 2 { height } else { 4 }) as f64);
    let corners: Vec<[f64; 3]> = (0..3 * count).map(|_| corner()).collect();
    let faces: Vec<[u32; 3]> = (0..count).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    Mesh::new(Positions::F64(corners), faces).unwrap()
}

fn face(mesh: &Mesh, face: u32) -> Mesh {
    Mesh::new(Positions::F64(mesh.corners(face).to_vec()), vec![[0, 1, 2]]).unwrap()
}

#[test]
fn common_points_lie_on_both_faces() {
    let mut rng = Rng::new(17);
    let (mut points_seen, mut coplanar) = (0, 0);
    for round in 0..24 {
        let height = if round % 2 == 0 { 0 } else { 2 };
        let [a, b] = [grid_triangles(&mut rng, 6, height), grid_triangles(&mut rng, 6, height)];
        let offset = [rng.integer(-2, 2) as f64, rng.integer(-2, 2) as f64 / 2.0, 0.0];
        let placed = b.at(Pose::from_translation(offset).unwrap());
        let pairs = intersecting_pairs(&a, placed);
        assert_eq!(any_intersecting_pair(&a, placed).is_some(), !pairs.is_empty());
        assert!(any_intersecting_pair(&a, placed).is_none_or(|pair| pairs.contains(&pair)));
        for (pair, point) in pairs.iter().zip(common_points(&a, placed, &pairs)) {
            let local: [f64; 3] = std::array::from_fn(|k| point[k] - offset[k]);
            for (mesh, at) in [(face(&a, pair[0]), point), (face(&b, pair[1]), local)] {
                let distance = mesh.closest_point(at).unwrap().unwrap().upper;
                assert!(distance < MAX_COORDINATE * 2_f64.powi(-38), "{distance} of {pair:?}");
            }
            coplanar += usize::from(height == 0);
            points_seen += 1;
        }
    }
    assert!(points_seen > 300 && coplanar > 100, "{points_seen} {coplanar}");
}

#[test]
fn a_contained_point_exists_if_a_solid_contains_a_component() {
    let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
    let large = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    let mut inside = 0;
    let mut rng = Rng::new(5);
    for _ in 0..300 {
        let at = [0; 3].map(|_: i32| rng.uniform(-1.0, 4.0));
        let scale = [[0.0625, 0.0, 0.0], [0.0, 0.0625, 0.0], [0.0, 0.0, 0.0625]];
        let small = large.at(Pose::new(scale, at).unwrap());
        if any_intersecting_pair(&large, small).is_some() {
            continue;
        }
        let point = contained_point(large.solid(), small);
        assert_eq!(point.is_some(), query::intersects(large.solid(), small));
        assert_eq!(contained_point(small, large.solid()), point);
        assert_eq!(contained_point(&large, small), None);
        if let Some(point) = point {
            assert_eq!(large.contains(&[point]).unwrap(), [Containment::Inside]);
            inside += 1;
        }
    }
    assert!((30..270).contains(&inside), "{inside}");
}

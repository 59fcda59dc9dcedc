//! Intersection curves: closed if the meshes are closed, of known length, and independent of how
//! the meshes are stored.

use std::f64::consts::PI;

use impinge::{Mesh, Positions, query};
use impinge_testkit::cases::Precision;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
use impinge_testkit::generate::solids::{cuboid, icosphere};
use impinge_testkit::{Affine, Mesh as Plain};

use crate::engine::ways::{engine_mesh, engine_pose};

#[test]
fn closed_meshes_intersect_in_closed_curves() {
    let knot = engine_mesh(&torus_knot(200, 50, TREFOIL), Precision::F64);
    let pose = impinge::Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [0.3, 0.2, 0.1]).expect("a pose");
    let curves = query::intersection_curves(&knot, knot.at(pose));
    assert!(curves.polylines.len() > 3, "{} curves", curves.polylines.len());
    assert_eq!(curves.closed(), curves.polylines.len());
    assert!(curves.points.is_empty());
    assert_eq!(curves.coplanar_pairs, 0);
}

#[test]
fn two_unit_spheres_intersect_in_a_circle() {
    let sphere = engine_mesh(&icosphere(5), Precision::F64);
    let apart = engine_pose(&Affine::translation([1.0, 0.013, 0.007]));
    let curves = query::intersection_curves(&sphere, sphere.at(apart));
    assert_eq!((curves.polylines.len(), curves.closed()), (1, 1));
    let half = (1.0_f64 + 0.013 * 0.013 + 0.007 * 0.007).sqrt() / 2.0;
    let circle = 2.0 * PI * (1.0 - half * half).sqrt();
    assert!((curves.length() / circle - 1.0).abs() < 0.005, "{} against {circle}", curves.length());
}

#[test]
fn repeated_vertices_link_up_like_shared_ones() {
    let shared = icosphere(3);
    let repeated = Plain {
        vertices: shared.faces.iter().flatten().map(|&v| shared.vertices[v as usize]).collect(),
        faces: (0..shared.faces.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect(),
    };
    let pose = engine_pose(&Affine::translation([0.5, 0.3, 0.2]));
    let (shared, repeated) = (engine_mesh(&shared, Precision::F64), engine_mesh(&repeated, Precision::F64));
    let expected = query::intersection_curves(&shared, shared.at(pose));
    assert_eq!(expected.closed(), 1);
    assert_eq!(query::intersection_curves(&repeated, repeated.at(pose)), expected);
}

#[test]
fn boxes_that_share_corners_and_edges_still_link_up() {
    // A cube stands on the top plane of a larger box. The curve is the outline of its bottom side.
    let (table, cup) = (cuboid([0.0; 3], [4.0, 4.0, 1.0]), cuboid([1.0, 1.0, 1.0], [2.0, 2.0, 2.0]));
    let (table, cup) = (engine_mesh(&table, Precision::F64), engine_mesh(&cup, Precision::F64));
    let curves = query::intersection_curves(&table, &cup);
    assert_eq!(curves.length(), 4.0);
    assert!(curves.coplanar_pairs > 0);
}

#[test]
fn a_corner_on_a_face_gives_a_point_and_no_curve() {
    let mesh = |corners: [[f64; 3]; 3]| Mesh::new(Positions::F64(corners.to_vec()), vec![[0, 1, 2]]).expect("a mesh");
    let floor = mesh([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
    let standing = mesh([[1.0, 1.0, 0.0], [1.0, 1.0, 2.0], [2.0, 1.0, 2.0]]);
    let curves = query::intersection_curves(&floor, &standing);
    assert_eq!(curves.points, [[1.0, 1.0, 0.0]]);
    assert!(curves.polylines.is_empty());
}

/// Splits a face at the middle of an edge, for many edges, and fills the gap to the face on the
/// other side with a face without area.
///
/// The vertices must lie on a grid, so that the middles are exact.
fn with_flat_faces(mesh: &Plain) -> Plain {
    let Plain { mut vertices, mut faces } = mesh.clone();
    let mut is_used = vec![false; faces.len()];
    for face in 0..mesh.faces.len() {
        let [p, r, x] = mesh.faces[face];
        // The face on the other side of the edge from p to r.
        let has_edge = |other: &[u32; 3]| (0..3).any(|k| (other[k], other[(k + 1) % 3]) == (r, p));
        let Some(other) = mesh.faces.iter().position(has_edge) else { continue };
        if is_used[face] || is_used[other] {
            continue;
        }
        (is_used[face], is_used[other]) = (true, true);
        let middle = vertices.len() as u32;
        vertices.push([0, 1, 2].map(|k| (vertices[p as usize][k] + vertices[r as usize][k]) / 2.0));
        faces[face] = [p, middle, x];
        faces.push([middle, r, x]);
        faces.push([p, r, middle]);
    }
    Plain { vertices, faces }
}

#[test]
fn curves_continue_across_faces_without_area() {
    let mut sphere = icosphere(3);
    sphere.vertices.iter_mut().flatten().for_each(|x| *x = (*x * 1024.0).round() / 1024.0);
    let cut = with_flat_faces(&sphere);
    let (sphere, cut) = (engine_mesh(&sphere, Precision::F64), engine_mesh(&cut, Precision::F64));
    let health = cut.health();
    assert!(cut.is_closed() && health.degenerate_faces > 300, "{health:?}");
    let mut rng = impinge_testkit::generate::Rng::new(4706);
    let mut met = 0;
    for round in 0..40 {
        let offset = [0; 3].map(|_| rng.uniform(-0.6, 0.6));
        let mut pose = engine_pose(&Affine::translation(offset));
        if round % 2 == 0 {
            // Middles and ends of edges lie on faces and on each other.
            pose = engine_pose(&Affine::translation(offset.map(|x| (x * 8.0).round() / 8.0 + 1.0 / 2048.0)));
        }
        let expected = query::intersection_curves(&sphere, sphere.at(pose));
        met += expected.closed();
        for (a, b) in [(&cut, &sphere), (&sphere, &cut), (&cut, &cut)] {
            let curves = query::intersection_curves(a, b.at(pose));
            assert_eq!(curves.polylines.len(), expected.polylines.len(), "{offset:?}");
            assert_eq!(curves.closed(), expected.closed(), "{offset:?}");
            assert_eq!(curves.points.len(), expected.points.len(), "{offset:?}");
            assert!((curves.length() - expected.length()).abs() <= 1e-12 * expected.length().max(1.0), "{offset:?}");
        }
    }
    assert!(met >= 40, "{met} closed curves");
}

#[test]
fn a_curve_crosses_a_face_without_area_inside_a_sheet() {
    let mesh =
        |vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]>| Mesh::new(Positions::F64(vertices), faces).expect("legal");
    let wall = mesh(vec![[-99.0, 5.0, -99.0], [99.0, 5.0, -99.0], [0.0, 5.0, 99.0]], vec![[0, 1, 2]]);
    let corners = vec![[0.0, 2.0, -9.0], [0.0, 4.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 0.0], [0.0, 9.0, 9.0]];
    let sheet = mesh(corners, vec![[0, 1, 2], [1, 3, 2], [4, 2, 3]]);
    for curves in [query::intersection_curves(&sheet, &wall), query::intersection_curves(&wall, &sheet)] {
        assert_eq!(curves.polylines.iter().map(Vec::len).collect::<Vec<_>>(), [3]);
        assert!(curves.points.is_empty());
    }
}

//! Winding numbers and containment of points, against solid angles and linear programming in
//! integers.

use impinge::InputErrorKind;
use impinge::mesh::Containment::{self, Inside, Outside, Surface};
use impinge_testkit::Mesh;
use impinge_testkit::generate::{Rng, solids};

use crate::solids::shapes::{engine, flipped, is_on_surface, moved, solid_angles, soup, sphere, without_faces};

/// Returns points on the half-integer grid around a mesh on the grid. Many lie on faces, edges and
/// corners, or in line with them.
pub(crate) fn grid_points(low: i64, high: i64) -> Vec<[f64; 3]> {
    let half = |i: i64| i as f64 / 2.0;
    let range = 2 * low..=2 * high;
    range
        .clone()
        .flat_map(|x| range.clone().flat_map(move |y| (2 * low..=2 * high).map(move |z| [half(x), half(y), half(z)])))
        .collect()
}

/// Returns boxes on the grid: a hollow box, a box in its hollow, and one beside them.
pub(crate) fn boxes() -> Mesh {
    solids::cuboid([0.0; 3], [6.0; 3])
        .joined(&flipped(solids::cuboid([1.0; 3], [5.0; 3])))
        .joined(&solids::cuboid([2.0; 3], [4.0; 3]))
        .joined(&solids::cuboid([6.0, 6.0, 0.0], [7.0, 7.0, 1.0]))
}

pub(crate) fn expected(mesh: &Mesh, point: [f64; 3]) -> Containment {
    let winding = solid_angles(mesh, point).round();
    match (is_on_surface(mesh, point), winding) {
        (true, _) => Surface,
        (false, 0.0) => Outside,
        _ => Inside,
    }
}

#[test]
fn grid_points_of_closed_meshes_are_decided_exactly() {
    let tetrahedron = solids::tetrahedron().scaled(4.0);
    let meshes = [boxes(), flipped(boxes()), tetrahedron.clone(), moved(tetrahedron, [0.5, 0.0, -0.5])];
    for (number, mesh) in meshes.iter().enumerate() {
        for soup_of_it in [mesh.clone(), soup(mesh)] {
            let solid = engine(&soup_of_it);
            assert!(solid.is_closed());
            let points = grid_points(-1, if number < 2 { 7 } else { 4 });
            let found = solid.contains(&points).expect("finite points");
            let windings = solid.winding_number(&points).expect("finite points");
            let mut counts = [0; 3];
            for ((&point, &found), winding) in points.iter().zip(&found).zip(&windings) {
                assert_eq!(found, expected(mesh, point), "mesh {number} at {point:?}");
                if found != Surface {
                    assert_eq!(winding.lower, winding.upper);
                    assert_eq!(winding.value, solid_angles(mesh, point).round(), "mesh {number} at {point:?}");
                } else {
                    let error = (winding.value - solid_angles(mesh, point)).abs();
                    assert!(error < 1e-9, "mesh {number} at {point:?}: {winding:?}");
                }
                counts[[Outside, Surface, Inside].iter().position(|&kind| kind == found).expect("decided")] += 1;
            }
            assert!(counts.iter().all(|&count| 50 * count > points.len()), "{counts:?}");
        }
    }
}

#[test]
fn intervals_of_open_meshes_contain_the_solid_angles() {
    let mut rng = Rng::new(5);
    let open_box = without_faces(solids::cuboid([0.0; 3], [2.0; 3]), &[2, 3]);
    let messy = solids::grid_soup(&mut rng, 60, 4, 3);
    let cap = without_faces(sphere(), &(0..160).collect::<Vec<_>>());
    let doubled = open_box.clone().joined(&open_box);
    let mut widest = 0.0_f64;
    for (name, mesh) in [("box", open_box), ("soup", messy), ("cap", cap), ("doubled", doubled)] {
        let solid = engine(&mesh);
        assert!(!solid.is_closed());
        let random: Vec<[f64; 3]> = (0..300).map(|_| std::array::from_fn(|_| rng.uniform(-3.0, 5.0))).collect();
        for points in [random, grid_points(-1, 4)] {
            let found = solid.winding_number(&points).expect("finite points");
            for (&point, winding) in points.iter().zip(&found) {
                let truth = solid_angles(&mesh, point);
                assert!(winding.lower <= winding.value && winding.value <= winding.upper);
                let on_surface = is_on_surface(&mesh, point);
                // The platform's arctangent is inaccurate for points on edges.
                if !on_surface {
                    assert!((winding.value - truth).abs() < 1e-9, "{name} at {point:?}: {winding:?}, not {truth}");
                    assert!(winding.lower <= truth + 1e-12 && truth - 1e-12 <= winding.upper, "{name} at {point:?}");
                    widest = widest.max(winding.upper - winding.lower);
                }
            }
        }
    }
    assert!(widest < 1e-9, "{widest:e}");
}

/// Away from the border one ray decides. Winding numbers always come from the whole border.
#[test]
fn points_in_open_meshes_are_those_with_a_winding_number() {
    let mut rng = Rng::new(6);
    let open_box = without_faces(solids::cuboid([0.0; 3], [2.0; 3]), &[2, 3]);
    let cracked = without_faces(solids::cuboid([0.0; 3], [4.0; 3]), &[5]);
    let sphere = without_faces(sphere(), &[3, 4, 90]);
    let nested = open_box.clone().joined(&cracked).joined(&flipped(cracked.clone()));
    let [mut inside, mut outside] = [0; 2];
    for (name, mesh) in [("box", open_box), ("cracked", cracked), ("sphere", sphere), ("nested", nested)] {
        let solid = engine(&mesh);
        assert!(!solid.is_closed());
        let far: Vec<[f64; 3]> = (0..300).map(|_| std::array::from_fn(|_| rng.uniform(-9.0, 13.0))).collect();
        let near: Vec<[f64; 3]> = (0..600).map(|_| std::array::from_fn(|_| rng.uniform(-1.0, 5.0))).collect();
        for points in [far, near, grid_points(-1, 4)] {
            let windings = solid.winding_number(&points).expect("finite points");
            for ((&point, winding), found) in points.iter().zip(windings).zip(solid.contains(&points).unwrap()) {
                let (is_in, is_out) =
                    (winding.lower.abs().min(winding.upper.abs()) > 0.5, winding.value.abs() < 0.4999);
                if is_on_surface(&mesh, point) {
                    assert_eq!(found, Surface, "{name} at {point:?}");
                } else if is_in || is_out {
                    assert_eq!(found, if is_in { Inside } else { Outside }, "{name} at {point:?}: {winding:?}");
                    *(if is_in { &mut inside } else { &mut outside }) += 1;
                }
            }
        }
    }
    assert!(inside > 300 && outside > 1_500, "{inside} {outside}");
}

#[test]
fn winding_numbers_of_long_borders_are_within_their_bounds() {
    let mut rng = Rng::new(6);
    let soup_of = |rng: &mut Rng, count: usize, size: f64| {
        let mut mesh = Mesh::default();
        for face in 0..count as u32 {
            let center: [f64; 3] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
            mesh.vertices.extend((0..3).map(|_| center.map(|x| x + rng.uniform(-size, size))));
            mesh.faces.push([3 * face, 3 * face + 1, 3 * face + 2]);
        }
        mesh
    };
    // A sphere without every third face; and separate triangles, small and large.
    let half = without_faces(soup(&solids::icosphere(5)), &(0..20480).step_by(3).collect::<Vec<_>>());
    let small = soup_of(&mut rng, 4000, 0.02);
    let large = soup_of(&mut rng, 3000, 0.7);
    let (mut inside, mut outside) = (0, 0);
    for (name, mesh) in
        [("sphere", half), ("small", small.clone()), ("large", large), ("far", moved(small, [1e6, 0.0, 3.0]))]
    {
        let solid = engine(&mesh);
        let offset = mesh.vertices[0].map(|x| if x > 1e5 { 1e6 } else { 0.0 });
        let points: Vec<[f64; 3]> = (0..120)
            .map(|i| {
                let reach = [1.0, 1.5, 20.0][i % 3];
                std::array::from_fn(|k| offset[k] + rng.uniform(-reach, reach))
            })
            .collect();
        let found = solid.winding_number(&points).expect("finite points");
        let contained = solid.contains(&points).expect("finite points");
        for ((&point, winding), &at) in points.iter().zip(&found).zip(&contained) {
            let truth = solid_angles(&mesh, point);
            assert!(winding.upper - winding.lower < 1.1e-5, "{name} at {point:?}: {winding:?}");
            assert!(
                winding.lower - 1e-11 <= truth && truth <= winding.upper + 1e-11,
                "{name} at {point:?}: {winding:?}, {truth}"
            );
            let expected = if truth.abs() > 0.5 { Inside } else { Outside };
            if (truth.abs() - 0.5).abs() > 1e-11 {
                assert_eq!(at, expected, "{name} at {point:?}: {truth}");
            }
            *if at == Inside { &mut inside } else { &mut outside } += 1;
        }
    }
    assert!(inside > 20 && outside > 100, "{inside} {outside}");
}

#[test]
fn containment_is_undecided_only_at_winding_number_one_half() {
    // A box without its lid covers half of all directions as seen from the plane of the lid.
    let open = engine(&without_faces(solids::cuboid([0.0; 3], [2.0; 3]), &[2, 3]));
    let at = |z: f64| open.contains(&[[0.75, 1.25, z]]).expect("finite")[0];
    assert_eq!(at(1.0), Inside);
    assert_eq!(at(2.0 - 1e-9), Inside);
    assert_eq!(at(2.0 + 1e-9), Outside);
    assert_eq!(at(2.0), Containment::Undecided);
    assert!(Containment::Undecided.is_contained() && Surface.is_contained() && !Outside.is_contained());
}

#[test]
fn scaling_by_powers_of_two_keeps_containment() {
    let mesh = boxes();
    let points = grid_points(-1, 7);
    let expected = engine(&mesh).contains(&points).expect("finite points");
    for exponent in [-140, -40, 40, 120] {
        let factor = 2.0_f64.powi(exponent);
        let scaled: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| x * factor)).collect();
        let found = engine(&mesh.clone().scaled(factor)).contains(&scaled).expect("finite points");
        assert_eq!(found, expected, "2^{exponent}");
    }
}

#[test]
fn duplicates_and_faces_without_area_keep_containment() {
    // The same box twice has winding number 2. A sliver closes a mesh with an edge split on one
    // side only.
    let cube = solids::cuboid([0.0; 3], [2.0; 3]);
    let twice = engine(&cube.clone().joined(&cube));
    assert_eq!(twice.winding_number(&[[1.0, 0.5, 0.25]]).expect("finite")[0].value, 2.0);
    let mut split = cube.clone();
    let [a, b, c] = split.faces[0];
    let middle = split.vertices.len() as u32;
    let [p, q] = [a, b].map(|vertex| split.vertices[vertex as usize]);
    split.vertices.push(std::array::from_fn(|k| (p[k] + q[k]) / 2.0));
    split.faces[0] = [a, middle, c];
    split.faces.push([middle, b, c]);
    assert!(!engine(&split).is_closed());
    split.faces.push([a, b, middle]);
    split.faces.push([a, a, b]);
    let solid = engine(&split);
    assert!(solid.is_closed());
    let points = grid_points(-1, 3);
    assert_eq!(solid.contains(&points).expect("finite"), engine(&cube).contains(&points).expect("finite"));
}

#[test]
fn invalid_points_are_rejected_by_index() {
    let mesh = engine(&sphere());
    let error = mesh.contains(&[[0.0; 3], [0.0, f64::NAN, 0.0]]).expect_err("not finite");
    assert_eq!(error.kind(), &InputErrorKind::NonFinite { what: "point", index: 1 });
    let error = mesh.winding_number(&[[2.0_f64.powi(128), 0.0, 0.0]]).expect_err("out of range");
    assert!(matches!(error.kind(), InputErrorKind::OutOfRange { what: "point", index: 0, .. }));
}

#[test]
fn an_empty_mesh_contains_no_point() {
    let empty = engine(&Mesh::default());
    assert!(empty.is_closed());
    assert_eq!(empty.contains(&[[0.0; 3]]).expect("finite"), [Outside]);
    assert_eq!(empty.winding_number(&[[0.0; 3]]).expect("finite")[0].value, 0.0);
}

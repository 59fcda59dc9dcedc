//! BSP trees over the faces of meshes, against the mesh itself and against solid angles.

use impinge::mesh::Containment::{Inside, Outside, Surface};
use impinge::mesh::{Ray, SolidBsp};
use impinge::{InputErrorKind, Mesh, Positions};
use impinge_testkit::generate::{Rng, solids};

use crate::solids::shapes::{engine, flipped, moved, soup, sphere, without_faces};
use crate::solids::winding::{boxes, expected, grid_points};

#[test]
fn points_on_the_grid_agree_with_solid_angles() {
    let tetrahedron = solids::tetrahedron().scaled(4.0);
    let round = solids::cube_sphere(3).scaled(4.0);
    let meshes = [boxes(), flipped(boxes()), tetrahedron.clone(), moved(tetrahedron, [0.5, 0.0, -0.5]), round];
    for (number, mesh) in meshes.iter().enumerate() {
        for mesh in [mesh.clone(), soup(mesh)] {
            let solid = engine(&mesh);
            let tree = SolidBsp::build(&solid);
            let mut counts = [0; 3];
            let points = grid_points(-1, 7);
            let truth: Vec<_> = points.iter().map(|&point| expected(&mesh, point)).collect();
            // The second pass uses the classification of cells that the first one cached.
            for (point, &truth) in points.iter().zip(&truth).chain(points.iter().zip(&truth)) {
                let found = tree.contains(*point).expect("a finite point");
                assert_eq!(found, truth, "mesh {number} at {point:?}");
                counts[[Outside, Surface, Inside].iter().position(|&kind| kind == found).expect("decided")] += 1;
            }
            assert!(counts[0] > 1000 && counts[2] > 50 && (number == 4 || counts[1] > 100), "{number}: {counts:?}");
        }
    }
}

/// Returns random rays, half of them along grid lines through corners and edges.
fn rays(rng: &mut Rng, count: usize, reach: f64) -> Vec<Ray> {
    let half = |x: f64| (2.0 * x).round() / 2.0;
    (0..count)
        .map(|number| {
            let mut origin: [f64; 3] = std::array::from_fn(|_| rng.uniform(-reach, reach));
            let mut direction: [f64; 3] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
            if number % 2 == 0 {
                origin = origin.map(half);
                direction = direction.map(|x| (1.5 * x).round());
            }
            if direction == [0.0; 3] {
                direction[number % 3] = -1.0;
            }
            Ray::new(origin, direction).expect("a ray")
        })
        .collect()
}

#[test]
fn rays_hit_the_same_face_first() {
    let mut rng = Rng::new(71);
    let meshes = [
        boxes(),
        soup(&boxes()),
        solids::icosphere(3).scaled(3.0),
        solids::grid_soup(&mut rng, 300, 6, 4),
        solids::fan(100).scaled(6.0),
        without_faces(sphere(), &(0..160).collect::<Vec<_>>()).scaled(4.0),
    ];
    for (number, mesh) in meshes.iter().enumerate() {
        let solid = engine(mesh);
        let tree = SolidBsp::build(&solid);
        let mut hits = 0;
        for ray in rays(&mut rng, 3_000, 8.0) {
            let found = tree.ray_cast(&ray);
            assert_eq!(found, solid.ray_cast(&ray), "mesh {number}: {ray:?}");
            hits += usize::from(found.is_some());
        }
        assert!(hits > 100, "mesh {number}: {hits}");
    }
}

#[test]
fn cells_of_round_solids_are_shallow_and_classify_all_their_points() {
    let mut rng = Rng::new(72);
    for subdivisions in [2, 4] {
        let mesh = engine(&solids::icosphere(subdivisions));
        let faces = mesh.faces().len();
        let tree = SolidBsp::build(&mesh);
        // With planes of faces alone the depth would equal the number of faces.
        assert!(tree.depth() < 64 && tree.cells() > faces, "{} deep, {} cells", tree.depth(), tree.cells());
        assert!(tree.memory() < 600 * faces, "{} bytes a face", tree.memory() / faces);
        let points: Vec<[f64; 3]> = (0..20_000).map(|_| std::array::from_fn(|_| rng.uniform(-1.1, 1.1))).collect();
        let truth = mesh.contains(&points).expect("finite points");
        let found: Vec<_> = points.iter().map(|&point| tree.contains(point).expect("a finite point")).collect();
        assert_eq!(found, truth);
        assert!(truth.iter().filter(|&&found| found == Inside).count() > 5_000);
    }
}

#[test]
fn degenerate_meshes_have_small_trees_and_right_answers() {
    let mut rng = Rng::new(73);
    let coincident: Vec<[u32; 3]> = (0..2_000).map(|_| [0, 1, 2]).collect();
    let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [2.0, 0.0, 0.0]];
    let of = |faces: Vec<[u32; 3]>| Mesh::new(Positions::F64(corners.clone()), faces).expect("a legal mesh");
    let closed_flat = of(vec![[0, 1, 2], [0, 2, 1]]);
    let segments = of(vec![[0, 1, 3], [0, 3, 1], [3, 3, 3]]);
    let meshes = [
        of(coincident),
        of(Vec::new()),
        closed_flat,
        segments,
        engine(&solids::fan(500)),
        engine(&solids::grid_soup(&mut rng, 400, 3, 3)),
        engine(&without_faces(solids::cuboid([0.0; 3], [2.0; 3]), &[2, 3])),
    ];
    for (number, mesh) in meshes.iter().enumerate() {
        let tree = SolidBsp::build(mesh);
        assert!(tree.memory() < 2_000 * (mesh.faces().len() + 1), "mesh {number}: {}", tree.memory());
        assert!(tree.depth() < 200, "mesh {number}: {}", tree.depth());
        let points = grid_points(-1, 4);
        let truth = mesh.contains(&points).expect("finite points");
        for (&point, truth) in points.iter().zip(truth) {
            assert_eq!(tree.contains(point).expect("a finite point"), truth, "mesh {number} at {point:?}");
        }
    }
    let error = SolidBsp::build(&meshes[1]).contains([0.0, f64::NAN, 0.0]).expect_err("not a number");
    assert!(matches!(error.kind(), InputErrorKind::NonFinite { .. }), "{error:?}");
}

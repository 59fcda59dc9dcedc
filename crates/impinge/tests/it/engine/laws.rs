//! Invariants: changes of a query that must not change its answer. Oracles that share no code with
//! the engine check the answers.

use impinge_testkit::cases::Precision;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::knots::{TREFOIL, bumpy_sphere, stadium, torus_knot};
use impinge_testkit::generate::poses::{large_integer_map, rotation};
use impinge_testkit::generate::solids::{grid_soup, icosphere, plane_grid, rod, strips};
use impinge_testkit::{Affine, Mesh, oracle};

use crate::engine::ways::{engine_mesh, pairs_in_every_way, posed_pairs_in_every_way};

/// Returns two small meshes full of ties: integer corners, shared vertices, zero areas and
/// duplicates.
fn soups(seed: u64) -> (Mesh, Mesh, Rng) {
    let mut rng = Rng::new(seed);
    let (side, reach) = (rng.integer(2, 12), rng.integer(1, 3));
    let count = rng.integer(1, 200) as usize;
    let a = grid_soup(&mut rng, count, side, reach);
    let count = rng.integer(1, 200) as usize;
    let b = grid_soup(&mut rng, count, side, reach);
    (a, b, rng)
}

fn step(x: i64, y: i64, z: i64) -> Affine {
    Affine::translation([x, y, z].map(|v| v as f64))
}

#[test]
fn soups_have_the_pairs_of_brute_force() {
    let mut met = 0;
    for seed in 0..60 {
        let (a, b, mut rng) = soups(seed);
        let (pose_a, pose_b) = match seed % 4 {
            0 => (Affine::IDENTITY, Affine::IDENTITY),
            1 => (step(1, 0, -1), step(0, 1, rng.integer(-6, 6))),
            2 => (large_integer_map(&mut rng), large_integer_map(&mut rng)),
            _ => (rotation(&mut rng), rotation(&mut rng)),
        };
        let expected = oracle::brute_force(a.at(pose_a), b.at(pose_b));
        met += usize::from(!expected.is_empty());
        let precision = if seed % 2 == 0 { Precision::F32 } else { Precision::F64 };
        assert_eq!(posed_pairs_in_every_way(a.at(pose_a), b.at(pose_b), precision), expected, "seed {seed}");
    }
    assert!((18..=58).contains(&met), "{met} of 60 soups intersect");
}

/// Returns long triangles with integer corners through and past the cube from 0 to `side`. Some hit
/// grid points exactly.
fn long_triangles(rng: &mut Rng, count: usize, side: i64) -> Mesh {
    let mut mesh = Mesh::default();
    for _ in 0..count {
        let through: [i64; 3] = std::array::from_fn(|_| rng.integer(0, side));
        let along: [i64; 3] = std::array::from_fn(|_| rng.integer(-6, 6));
        let across: [i64; 3] = std::array::from_fn(|_| rng.integer(-9, 9));
        let (before, after) = (rng.integer(0, 500), rng.integer(0, 500));
        let first = mesh.vertices.len() as u32;
        let corner = |steps: i64, aside: i64| -> [f64; 3] {
            std::array::from_fn(|axis| (through[axis] + steps * along[axis] + aside * across[axis]) as f64)
        };
        mesh.vertices.extend([corner(-before, 0), corner(after, 0), corner(after, 1)]);
        mesh.faces.push([first, first + 1, first + 2]);
    }
    mesh
}

#[test]
fn much_larger_triangles_have_the_pairs_of_brute_force() {
    let (mut met, mut large_met) = (0, 0);
    for seed in 1000..1040 {
        let mut rng = Rng::new(seed);
        let small = |rng: &mut Rng| grid_soup(rng, 250, 14, 2);
        let (few, many) = (long_triangles(&mut rng, 4, 14), long_triangles(&mut rng, 24, 14));
        let (a, b, large_from) = match seed % 3 {
            0 => (many, small(&mut rng), 0),
            1 => (small(&mut rng), many, 0),
            // Large and small triangles are in one tree, on either side.
            _ => (small(&mut rng).joined(&few), small(&mut rng).joined(&few), 250),
        };
        let (pose_a, pose_b) = match seed % 4 {
            0 => (Affine::IDENTITY, Affine::IDENTITY),
            1 => (step(0, 1, 0), step(1, rng.integer(-3, 3), 0)),
            2 => (large_integer_map(&mut rng), large_integer_map(&mut rng)),
            _ => (rotation(&mut rng), rotation(&mut rng)),
        };
        let expected = oracle::brute_force(a.at(pose_a), b.at(pose_b));
        met += usize::from(!expected.is_empty());
        large_met += expected.iter().filter(|(a, b)| *a.max(b) >= large_from).count();
        let precision = if seed % 2 == 0 { Precision::F32 } else { Precision::F64 };
        assert_eq!(posed_pairs_in_every_way(a.at(pose_a), b.at(pose_b), precision), expected, "seed {seed}");
    }
    assert!(met >= 20 && large_met > 1000, "{met} of 40 intersect, large triangles {large_met} times");
}

#[test]
fn swapping_the_meshes_swaps_the_pairs() {
    let mut total = 0;
    for seed in 100..120 {
        let (a, b, mut rng) = soups(seed);
        let (pose_a, pose_b) = (step(0, 0, 0), step(rng.integer(-2, 2), 0, 1));
        let forward = posed_pairs_in_every_way(a.at(pose_a), b.at(pose_b), Precision::F32);
        let mut back: Vec<_> = posed_pairs_in_every_way(b.at(pose_b), a.at(pose_a), Precision::F32)
            .into_iter()
            .map(|(b, a)| (a, b))
            .collect();
        back.sort_unstable();
        assert_eq!(forward, back, "seed {seed}");
        total += forward.len();
    }
    assert!(total > 1000, "only {total} pairs");
}

#[test]
fn permuting_corners_and_faces_changes_no_pair() {
    let mut total = 0;
    for seed in 200..215 {
        let (a, b, mut rng) = soups(seed);
        let pose = step(0, 1, 0);
        let expected = posed_pairs_in_every_way(a.at(Affine::IDENTITY), b.at(pose), Precision::F32);
        let mut turned = a.clone();
        for face in &mut turned.faces {
            for _ in 0..rng.integer(0, 2) {
                face.rotate_left(1);
            }
            if rng.one_in(2) {
                face.swap(0, 1);
            }
        }
        let mut order: Vec<u32> = (0..turned.faces.len() as u32).collect();
        for last in (1..order.len()).rev() {
            order.swap(last, rng.integer(0, last as i64) as usize);
        }
        turned.faces = order.iter().map(|&face| turned.faces[face as usize]).collect();
        let mut found: Vec<_> = posed_pairs_in_every_way(turned.at(Affine::IDENTITY), b.at(pose), Precision::F32)
            .into_iter()
            .map(|(face, b)| (order[face as usize], b))
            .collect();
        found.sort_unstable();
        assert_eq!(found, expected, "seed {seed}");
        total += found.len();
    }
    assert!(total > 1000, "only {total} pairs");
}

#[test]
fn moving_both_by_one_integer_map_changes_no_pair() {
    let mut total = 0;
    for seed in 300..315 {
        let (a, b, mut rng) = soups(seed);
        let expected = oracle::brute_force(a.at(Affine::IDENTITY), b.at(step(1, 0, 0)));
        let map = large_integer_map(&mut rng);
        // The map is applied after the step: the image of the step is added to the translation.
        // Integers make this exact.
        let mut after_step = map;
        for row in 0..3 {
            after_step.translation[row] += map.linear[row][0];
        }
        assert_eq!(posed_pairs_in_every_way(a.at(map), b.at(after_step), Precision::F32), expected, "seed {seed}");
        total += expected.len();
    }
    assert!(total > 1000, "only {total} pairs");
}

#[test]
fn scaling_by_powers_of_two_changes_no_pair() {
    let sphere = icosphere(3).rounded_to_f32();
    let expected = oracle::grid(sphere.at(Affine::IDENTITY), sphere.at(Affine::translation([0.5, 0.25, 0.125])));
    assert!(expected.len() > 50);
    for exponent in [-120, -60, -20, -3, 5, 40, 100] {
        let scale = 2.0_f64.powi(exponent);
        let scaled = sphere.clone().scaled(scale);
        let step = Affine::translation([0.5 * scale, 0.25 * scale, 0.125 * scale]);
        let found = posed_pairs_in_every_way(scaled.at(Affine::IDENTITY), scaled.at(step), Precision::F32);
        assert_eq!(found, expected, "scale 2^{exponent}");
    }
}

#[test]
fn large_meshes_have_the_pairs_of_the_grid() {
    let deep = rotated([1.0, 2.0, 3.0], 0.7, [0.3, 0.2, 0.1]);
    let knot = torus_knot(200, 50, TREFOIL);
    let slivers = stadium(100, 25, 60);
    let (rod, strips) = (rod(500), strips(100));
    // The rotation has the angle of a triangle with sides 3, 4 and 5. The step up makes the strips
    // touch everywhere at once.
    let crossed = Affine { linear: [[3.0, -4.0, 0.0], [4.0, 3.0, 0.0], [0.0, 0.0, 5.0]], translation: [0.0, 0.0, 1.0] };
    let sphere = bumpy_sphere(40);
    let plane = plane_grid(40, 40);
    let scenes = [
        ("knots, deep", &knot, &knot, deep),
        ("knots, shallow", &knot, &knot, rotated([1.0, 2.0, 3.0], 0.7, [4.5, 0.5, 0.3])),
        ("slivers", &slivers, &slivers, Affine::translation([0.0006, 0.0004, 0.0005])),
        ("long ones, rotated", &rod, &rod, rotated([1.0, 2.0, 3.0], 0.7, [0.3, 0.2, 0.1])),
        ("long ones that touch", &strips, &strips, crossed),
        ("near-coincident", &sphere, &sphere, rotated([1.0, 2.0, 3.0], 0.01, [0.0; 3])),
        ("one plane", &plane, &plane, step(1, 0, 0)),
        ("far from the origin", &knot, &knot, Affine { translation: [1e7, -1e7, 1e7], ..deep }),
    ];
    for (name, a, b, pose) in scenes {
        let home = if name.starts_with("far") { Affine::translation([1e7, -1e7, 1e7]) } else { Affine::IDENTITY };
        let expected = oracle::grid(a.at(home), b.at(pose));
        assert!(expected.len() > 100, "{name}: only {} pairs", expected.len());
        assert_eq!(posed_pairs_in_every_way(a.at(home), b.at(pose), Precision::F64), expected, "{name}");
    }
}

#[test]
fn a_mesh_intersects_itself_in_every_face_and_its_neighbors() {
    let sphere = icosphere(3);
    let expected = oracle::grid(sphere.at(Affine::IDENTITY), sphere.at(Affine::IDENTITY));
    assert!(expected.len() > 12 * sphere.faces.len());
    for pose in [Affine::IDENTITY, rotated([1.0, 0.0, 2.0], 1.0, [3.0, 4.0, 5.0])] {
        let found = posed_pairs_in_every_way(sphere.at(pose), sphere.at(pose), Precision::F64);
        assert_eq!(found, expected);
    }
}

#[test]
fn extreme_maps_change_no_pair() {
    let (a, b, _) = soups(401);
    let expected = oracle::brute_force(a.at(Affine::IDENTITY), b.at(Affine::IDENTITY));
    assert!(expected.len() > 20, "{} pairs", expected.len());
    let stretch = |x: f64, y: f64, z: f64| Affine {
        linear: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
        translation: [0.0; 3],
    };
    let (huge, tiny) = (2.0_f64.powi(60), 2.0_f64.powi(-60));
    let shear = Affine { linear: [[1.0, huge, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };
    for map in
        [stretch(huge, huge, huge), stretch(tiny, tiny, tiny), stretch(1.0, 1.0, tiny), stretch(-1.0, 1.0, 1.0), shear]
    {
        let (mesh_a, mesh_b) = (engine_mesh(&a, Precision::F32), engine_mesh(&b, Precision::F32));
        assert_eq!(pairs_in_every_way((&mesh_a, &map), (&mesh_b, &map)), expected, "{map:?}");
    }
}

#[test]
fn triangles_of_any_relative_size_intersect() {
    // The plane of the large triangle, x - y + z = 0, separates two corners of the tetrahedron from
    // the other two.
    let small = Mesh {
        vertices: vec![[-1.0, -1.0, -1.0], [2.0, -1.0, -1.0], [-1.0, 2.0, -1.0], [-1.0, -1.0, 2.0]],
        faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    };
    let large = Mesh { vertices: vec![[3.0, 1.0, -2.0], [-1.0, 2.0, 3.0], [-2.0, -3.0, -1.0]], faces: vec![[0, 1, 2]] };
    let every_face = [(0, 0), (1, 0), (2, 0), (3, 0)];
    for exponent in 2..=64 {
        let scale = 2.0_f64.powi(exponent);
        let grown = Affine { linear: [[scale, 0.0, 0.0], [0.0, scale, 0.0], [0.0, 0.0, scale]], translation: [0.0; 3] };
        let found = posed_pairs_in_every_way(small.at(Affine::IDENTITY), large.at(grown), Precision::F32);
        assert_eq!(found, every_face, "scale 2^{exponent}");
        let shrunk = Affine { linear: grown.linear.map(|row| row.map(|x| x / scale / scale)), ..grown };
        let found = posed_pairs_in_every_way(small.at(shrunk), large.at(Affine::IDENTITY), Precision::F32);
        assert_eq!(found, every_face, "scale 2^-{exponent}");
    }
}

#[test]
fn maps_beyond_the_range_of_floats_are_decided() {
    // The map from one mesh to the other has entries of 2^1030, beyond the range of floats.
    let flat = Mesh { vertices: vec![[-1.0, -1.0, 0.5], [1.0, -1.0, 0.5], [0.0, 1.0, 0.5]], faces: vec![[0, 1, 2]] };
    let upright = Mesh { vertices: vec![[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]], faces: vec![[0, 1, 2]] };
    let scaled = |exponent: i32, z: f64| {
        let scale = 2.0_f64.powi(exponent);
        let linear = [[scale, 0.0, 0.0], [0.0, scale, 0.0], [0.0, 0.0, scale]];
        Affine { linear, translation: [0.0, 0.0, z] }
    };
    let (tiny, huge) = (-996, 34);
    for (shift, expected) in [(0.0, vec![(0, 0)]), (1.0, vec![(0, 0)]), (2.0_f64.powi(35), vec![])] {
        let found =
            posed_pairs_in_every_way(flat.at(scaled(tiny, 0.0)), upright.at(scaled(huge, shift)), Precision::F64);
        assert_eq!(found, expected, "{shift}");
    }
}

/// Returns a rotation about an axis by the testkit's own sine and cosine, followed by a
/// translation.
fn rotated(axis: [f64; 3], angle: f64, translation: [f64; 3]) -> Affine {
    use impinge_testkit::generate::{cos, sin};
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|v| v / length);
    let (s, c) = (sin(angle), cos(angle));
    let k = 1.0 - c;
    let linear = [
        [c + x * x * k, x * y * k - z * s, x * z * k + y * s],
        [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
        [z * x * k - y * s, z * y * k + x * s, c + z * z * k],
    ];
    Affine { linear, translation }
}

#[test]
#[ignore = "two knots of 2,000,000 triangles: about two minutes; run once for a record"]
fn the_headline_knots_have_the_pairs_of_the_grid() {
    let knot = torus_knot(2000, 500, TREFOIL);
    for offset in [[0.3, 0.2, 0.1], [4.5, 0.5, 0.3], [9.0, 0.0, 0.0]] {
        let pose = rotated([1.0, 2.0, 3.0], 0.7, offset);
        let expected = oracle::grid(knot.at(Affine::IDENTITY), knot.at(pose));
        let found = posed_pairs_in_every_way(knot.at(Affine::IDENTITY), knot.at(pose), Precision::F64);
        assert_eq!(found, expected);
        println!("offset {offset:?}: {} pairs, those of the oracle", found.len());
        // The same query with the vertices of the second mesh moved and rounded beforehand.
        let baked = Mesh {
            vertices: knot.vertices.iter().map(|&v| pose.apply_rounded(v)).collect(),
            faces: knot.faces.clone(),
        };
        let expected = oracle::grid(knot.at(Affine::IDENTITY), baked.at(Affine::IDENTITY));
        let found = posed_pairs_in_every_way(knot.at(Affine::IDENTITY), baked.at(Affine::IDENTITY), Precision::F64);
        assert_eq!(found, expected);
        println!("offset {offset:?}, baked: {} pairs, those of the oracle", found.len());
    }
}

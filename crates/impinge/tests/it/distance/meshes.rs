//! Distances of meshes against all pairs of faces in rationals, and invariants.

use dashu_ratio::RBig;
use impinge::primitive::closest_on_triangles;
use impinge::query::{self, Distance, Proximity, Query};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
use impinge_testkit::generate::poses::{cube_symmetry, large_integer_map, rotation};
use impinge_testkit::generate::solids::{cuboid, grid_soup, icosphere, plane_grid};
use impinge_testkit::{Affine, Mesh as Plain};

use crate::distance::oracle::{Point, image, root_is_between, squared_distance};
use crate::distance::ways::{distance_in_every_way, engine_mesh, engine_pose};

pub(crate) fn images(mesh: &Plain, pose: &Affine) -> Vec<[Point; 3]> {
    mesh.faces.iter().map(|face| face.map(|v| image(pose, mesh.vertices[v as usize]))).collect()
}

/// Returns the squared distances of all pairs of faces. The face of `a` comes first.
pub(crate) fn all_pairs(a: &[[Point; 3]], b: &[[Point; 3]]) -> Vec<([u32; 2], RBig)> {
    let mut pairs = Vec::new();
    for (i, p) in a.iter().enumerate() {
        for (j, q) in b.iter().enumerate() {
            pairs.push(([i as u32, j as u32], squared_distance(p, q)));
        }
    }
    pairs
}

/// Returns the smallest squared distance.
pub(crate) fn least(pairs: &[([u32; 2], RBig)]) -> &RBig {
    pairs.iter().map(|(_, squared)| squared).min().expect("faces")
}

fn faces(distance: &Distance) -> [u32; 2] {
    distance.witness.and_then(|witness| witness.faces).expect("meshes with faces")
}

/// Returns two small soups of integer corners with many ties, and poses that move them apart or
/// into each other. Some poses distort.
fn scene(seed: u64) -> (Plain, Plain, Affine, Affine) {
    let mut rng = Rng::new(seed);
    let side = rng.integer(1, 6);
    let (count_a, count_b) = (rng.integer(1, 6) as usize, rng.integer(1, 6) as usize);
    let (a, b) = (grid_soup(&mut rng, count_a, side, 2), grid_soup(&mut rng, count_b, side, 2));
    let gap = rng.integer(0, side) as f64;
    let apart = Affine::translation([gap, rng.integer(-2, 2) as f64, 0.0]);
    let scale = rng.choose(&[1e-6, 1e-3, 1.0, 1e3, 1e6]);
    let times = |pose: Affine, scale: f64| Affine::new(pose.linear.map(|row| row.map(|x| x * scale)), pose.translation);
    match seed % 6 {
        0 => (a, b, Affine::IDENTITY, apart),
        1 => (
            a.scaled(scale),
            b.scaled(scale),
            Affine::IDENTITY,
            Affine::translation(apart.translation.map(|x| x * scale)),
        ),
        2 => {
            let turn = rotation(&mut rng);
            let by = [0, 1, 2].map(|k| turn.translation[k] + apart.translation[k]);
            (a, b, turn, Affine::new(turn.linear, by))
        }
        3 => {
            let (map, other) = (large_integer_map(&mut rng), large_integer_map(&mut rng));
            (a, b, map, if rng.one_in(3) { other } else { map })
        }
        4 => {
            let far = |mut mesh: Plain| {
                mesh.vertices.iter_mut().flatten().for_each(|x| *x = *x * 1e-3 + 1e7);
                mesh
            };
            let by = apart.translation.map(|x| x * 1e-3 - 2e7);
            (far(a), far(b), Affine::translation([-2e7; 3]), Affine::translation(by))
        }
        _ => (a, b, times(rotation(&mut rng), scale), times(rotation(&mut rng), scale * 2.0)),
    }
}

#[test]
fn soups_have_the_distance_of_all_their_pairs() {
    let (mut met, mut tied) = (0, 0);
    for seed in 0..72 {
        let (a, b, pose_a, pose_b) = scene(seed);
        let pairs = all_pairs(&images(&a, &pose_a), &images(&b, &pose_b));
        let truth = least(&pairs);
        let (mesh_a, mesh_b) = (engine_mesh(&a), engine_mesh(&b));
        let found = distance_in_every_way((&mesh_a, &pose_a), (&mesh_b, &pose_b));
        assert!(root_is_between(truth, found.lower, found.upper), "seed {seed}: {found:?}, not √{truth}");
        assert_eq!(found.upper == 0.0, *truth == RBig::ZERO, "seed {seed}: {found:?}");
        let at = faces(&found);
        let of_witness = &pairs.iter().find(|(faces, _)| *faces == at).expect("a pair").1;
        assert!(root_is_between(of_witness, found.lower, found.upper), "seed {seed}: {found:?}, but √{of_witness}");
        if *truth == RBig::ZERO {
            met += 1;
        }
        let intersects = query::intersects(mesh_a.at(engine_pose(&pose_a)), mesh_b.at(engine_pose(&pose_b)));
        assert_eq!(intersects, found.upper == 0.0, "seed {seed}");
        tied += usize::from(pairs.iter().filter(|pair| pair.1 == *truth).count() > 1);
    }
    assert!((10..60).contains(&met), "{met} of 72 intersect");
    assert!(tied > 15, "{tied} of 72 tie");
}

#[test]
fn smooth_meshes_have_the_distance_of_all_their_pairs() {
    // The trees have several levels, whose nodes have slabs. The meshes are apart, close, nested
    // and stretched.
    let sphere = icosphere(3);
    let knot = torus_knot(32, 10, TREFOIL);
    let small = knot.clone().scaled(0.125);
    let mut rng = Rng::new(17);
    let (mut apart, mut meeting) = (0, 0);
    for (a, b, reach) in [(&sphere, &knot, 5.0), (&knot, &knot, 7.0), (&sphere, &small, 2.0), (&small, &sphere, 0.1)] {
        let (mesh_a, mesh_b) = (engine_mesh(a), engine_mesh(b));
        for round in 0..4 {
            let turn = if round == 3 { large_integer_map(&mut rng) } else { rotation(&mut rng) };
            let size = turn.linear.as_flattened().iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            let gap = [0; 3].map(|_| rng.uniform(-reach, reach) * size);
            let pose = Affine::new(turn.linear, gap);
            let found = distance_in_every_way((&mesh_a, &Affine::IDENTITY), (&mesh_b, &pose));
            let corners = |mesh: &Plain, pose: &Affine| -> Vec<[[f64; 3]; 3]> {
                let at = |v: u32| pose.apply_rounded(mesh.vertices[v as usize]);
                mesh.faces.iter().map(|face| face.map(at)).collect()
            };
            let (on_a, on_b) = (corners(a, &Affine::IDENTITY), corners(b, &pose));
            let least = on_a.iter().flat_map(|p| on_b.iter().map(move |q| closest_on_triangles(p, q).distance));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!((found.upper - least).abs() <= 1e-10 * size, "round {round}: {found:?}, not {least}");
            *(if least > 0.0 { &mut apart } else { &mut meeting }) += 1;
        }
    }
    assert!(apart >= 12 && meeting >= 1, "{apart} apart, {meeting} meeting");
}

#[test]
fn swapping_the_meshes_keeps_the_distance() {
    for seed in 200..260 {
        let (a, b, pose_a, pose_b) = scene(seed);
        let (mesh_a, mesh_b) = (engine_mesh(&a), engine_mesh(&b));
        let there = distance_in_every_way((&mesh_a, &pose_a), (&mesh_b, &pose_b));
        let back = distance_in_every_way((&mesh_b, &pose_b), (&mesh_a, &pose_a));
        assert_eq!((there.lower, there.upper), (back.lower, back.upper), "seed {seed}");
    }
}

#[test]
fn moving_both_keeps_the_distance() {
    let sphere = icosphere(2);
    let mesh = engine_mesh(&sphere);
    let apart = Affine::translation([3.0, 0.25, 0.5]);
    let still = distance_in_every_way((&mesh, &Affine::IDENTITY), (&mesh, &apart));
    let mut rng = Rng::new(5);
    for _ in 0..6 {
        let turn = Affine::new(cube_symmetry(&mut rng), [0.0; 3]);
        let step = [0; 3].map(|_| rng.integer(-1 << 20, 1 << 20) as f64);
        let moved = |pose: &Affine| {
            let offset = turn.apply_rounded(pose.translation);
            Affine::new(turn.linear, [0, 1, 2].map(|k| offset[k] + step[k]))
        };
        let found = distance_in_every_way((&mesh, &moved(&Affine::IDENTITY)), (&mesh, &moved(&apart)));
        assert!(found.lower <= still.upper && still.lower <= found.upper, "{found:?} and {still:?}");
        assert!(found.upper - found.lower < 1e-12, "{found:?}: the interval must stay narrow far from the origin");
    }
}

#[test]
fn ties_go_to_the_first_faces() {
    // Two planes of squares face each other. Every pair of faces that overlap in projection has the
    // same distance.
    let plane = engine_mesh(&plane_grid(4, 3));
    for (gap, step) in [(1.0, 0.0), (0.25, 1.0), (3.0, 0.5)] {
        let pose = Affine::translation([step, 0.0, gap]);
        let found = distance_in_every_way((&plane, &Affine::IDENTITY), (&plane, &pose));
        assert!(found.lower <= gap && gap <= found.upper && found.upper - found.lower < 1e-12, "{found:?}");
        let flat = Affine::translation([step, 0.0, 0.0]);
        let touching = distance_in_every_way((&plane, &Affine::IDENTITY), (&plane, &flat));
        let pairs = query::intersecting_pairs(&plane, plane.at(engine_pose(&flat)));
        assert_eq!(touching.upper, 0.0);
        assert!(pairs.contains(&faces(&touching)), "{touching:?}");
        assert_eq!(faces(&found), pairs[0], "the same overlap in projection");
    }
}

#[test]
fn an_empty_mesh_is_infinitely_far() {
    let empty = Mesh::new(Positions::F64(vec![[0.0; 3]]), Vec::new()).expect("an empty mesh");
    let sphere = engine_mesh(&icosphere(1));
    for found in [query::distance(&empty, &sphere), query::distance(&sphere, &empty), query::distance(&empty, &empty)] {
        let proximity = Proximity::Apart;
        assert_eq!(found, Distance { lower: f64::INFINITY, upper: f64::INFINITY, witness: None, proximity });
    }
    assert!(!query::within(&empty, &sphere, f64::INFINITY));
}

#[test]
fn nested_spheres_have_the_distance_of_their_surfaces() {
    let outer = engine_mesh(&icosphere(3).scaled(2.0));
    let inner = engine_mesh(&icosphere(3));
    let found = distance_in_every_way((&outer, &Affine::IDENTITY), (&inner, &Affine::translation([0.25, 0.0, 0.0])));
    assert!((0.72..0.76).contains(&found.upper), "{found:?}");
    let pose = Affine::translation([0.95, 0.01, 0.0]);
    let near = distance_in_every_way((&outer, &Affine::IDENTITY), (&inner, &pose));
    assert!((0.01..0.06).contains(&near.upper), "{near:?}");
}

#[test]
fn meshes_far_apart_have_accurate_distances() {
    let sphere = engine_mesh(&icosphere(2));
    for exponent in [2, 5, 8, 11, 14, 17, 30, 80] {
        let away = 10.0_f64.powi(exponent);
        let pose = Affine::translation([0.6 * away, 0.8 * away, 0.0]);
        let found = distance_in_every_way((&sphere, &Affine::IDENTITY), (&sphere, &pose));
        let expected = away - 2.0;
        assert!((found.upper / expected - 1.0).abs() < 2e-3, "{found:?} at {away:e}");
        assert!(found.upper - found.lower <= 1e-12 * away, "{found:?} at {away:e}");
    }
}

#[test]
fn a_tiny_screw_over_a_plate_of_1000_km_has_its_distance() {
    let plate = engine_mesh(&cuboid([-5e5, -5e5, -1.0], [5e5, 5e5, 0.0]));
    let screw = engine_mesh(&icosphere(3).scaled(1e-3));
    let pose = Affine::translation([1234.5, -77.0, 0.003]);
    let found = distance_in_every_way((&plate, &Affine::IDENTITY), (&screw, &pose));
    assert!((0.0019..0.0021).contains(&found.upper), "{found:?}");
}

#[test]
fn distances_under_stretching_poses_are_in_world_units() {
    let cube = engine_mesh(&cuboid([-1.0; 3], [1.0; 3]));
    let stretch = Affine::new([[3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]], [10.0, 0.0, 0.0]);
    let found = distance_in_every_way((&cube, &Affine::IDENTITY), (&cube, &stretch));
    assert!(found.lower <= 6.0 && 6.0 <= found.upper && found.upper - found.lower < 1e-12, "{found:?}");
    let shear = Affine::new([[1.0, 0.0, 0.0], [100.0, 1.0, 0.0], [0.0, 0.0, -1.0]], [0.0, 0.0, 5.0]);
    let found = distance_in_every_way((&cube, &shear), (&cube, &stretch));
    assert!(found.lower > 0.0 && found.upper - found.lower < 1e-11, "{found:?}");
}

#[test]
fn a_cache_of_other_meshes_changes_no_distance() {
    let (large, small) = (engine_mesh(&icosphere(3)), engine_mesh(&cuboid([0.0; 3], [1.0; 3])));
    let apart = Pose::from_translation([5.0, 0.0, 0.0]).expect("a pose");
    let mut cache = query::Cache::default();
    let options = impinge::mesh::Options::default();
    let first = Query::new().with_options(options).with_cache(&mut cache).distance(&large, large.at(apart));
    assert!(first.upper > 2.9);
    let second = Query::new().with_options(options).with_cache(&mut cache).distance(&small, small.at(apart));
    assert_eq!(second, query::distance(&small, small.at(apart)));
}

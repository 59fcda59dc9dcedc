//! Meshes that move: after a refit, or a full or partial rebuild, they answer as if they were new.

use impinge::hierarchy::Builder;
use impinge::mesh::{Aging, Ray};
use impinge::query::{Cache, Query};
use impinge::{InputErrorKind, Mesh, Pose, Positions, query};
use impinge_testkit::cases::Precision;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
use impinge_testkit::generate::poses::rotation;
use impinge_testkit::generate::solids::{cube_sphere, grid_soup};
use impinge_testkit::rounds;
use impinge_testkit::{Affine, oracle};

use crate::engine::ways::{engine_mesh, engine_pose, on_threads, pairs_in_every_way};

/// Returns the bytes of the arrays of the hierarchy.
fn bits(mesh: &Mesh) -> [Vec<u8>; 3] {
    let parts = mesh.parts();
    [parts.frame.to_vec(), parts.nodes.to_vec(), parts.leaves.to_vec()]
}

fn singles(vertices: &[[f64; 3]]) -> Positions {
    Positions::F32(vertices.iter().map(|v| v.map(|x| x as f32)).collect())
}

/// Returns the vertices moved in one of [`WAYS`] ways. Most ways keep them on a grid, so that
/// touching is common.
fn deformed(rng: &mut Rng, way: u64, vertices: &[[f64; 3]]) -> Positions {
    let power = |exponent: i32| 2.0_f64.powi(exponent);
    let moved = |f: &mut dyn FnMut(&[f64; 3]) -> [f64; 3]| vertices.iter().map(f).collect::<Vec<_>>();
    match way {
        // Each coordinate moves by at most one step.
        0 => singles(&moved(&mut |v| v.map(|x| x + rng.integer(-1, 1) as f64))),
        // Folded in half.
        1 => singles(&moved(&mut |v| [v[0].min(6.0 - v[0]), v[1], v[2]])),
        // Flattened to a plane, a line, a point.
        2 => singles(&moved(&mut |v| [v[0], v[1], 3.0])),
        3 => singles(&moved(&mut |v| [v[0], 2.0, 3.0])),
        4 => singles(&moved(&mut |_| [3.0, 2.0, 3.0])),
        // Shuffled, so that no neighbors stay neighbors.
        5 => {
            let mut mixed = vertices.to_vec();
            for at in (1..mixed.len()).rev() {
                mixed.swap(at, rng.integer(0, at as i64) as usize);
            }
            singles(&mixed)
        }
        // A very different size, and double precision instead of single precision.
        6 => singles(&moved(&mut |v| v.map(|x| x * power(-40)))),
        7 => Positions::F64(moved(&mut |v| v.map(|x| x * power(100) + power(60)))),
        _ => Positions::F64(moved(&mut |v| v.map(|x| x + x * x * power(-45)))),
    }
}

const WAYS: u64 = 9;

#[test]
fn a_refit_to_the_same_positions_changes_no_bit() {
    let knot = torus_knot(150, 40, TREFOIL);
    let soup = grid_soup(&mut Rng::new(17), 3_000, 12, 2);
    for (name, mesh) in [("knot", &knot), ("soup", &soup)] {
        for positions in [singles(&mesh.vertices), Positions::F64(mesh.vertices.clone())] {
            for builder in Builder::ALL {
                let built = Mesh::with_builder(positions.clone(), mesh.faces.clone(), builder).expect("a legal mesh");
                let mut in_place = Mesh::with_builder(positions.clone(), mesh.faces.clone(), builder).expect("legal");
                let aging = in_place.refit(positions.clone()).expect("as before");
                assert!(bits(&in_place) == bits(&built), "{name}, {}", builder.name());
                assert_eq!(aging.ratio(), 1.0, "{name}, {}", builder.name());
                // There and back again.
                let elsewhere = deformed(&mut Rng::new(1), 0, &mesh.vertices);
                let back = built.refitted(elsewhere).and_then(|away| away.refitted(positions.clone())).expect("legal");
                assert!(bits(&back) == bits(&built), "{name}, {}", builder.name());
            }
        }
    }
}

/// Checks that a refit discards the packets that queries cached. Stale packets would answer for the
/// old positions.
#[test]
fn a_refit_discards_cached_packets() {
    let knot = torus_knot(150, 40, TREFOIL);
    let moved: Vec<[f64; 3]> = knot.vertices.iter().map(|v| v.map(|x| 1.5 * x)).collect();
    let places = [&knot.vertices, &moved];
    for [before, after] in [places.map(|at| singles(at)), places.map(|at| Positions::F64(at.clone()))] {
        let still = Mesh::new(before.clone(), knot.faces.clone()).expect("a legal mesh");
        let mut mesh = Mesh::new(before, knot.faces.clone()).expect("a legal mesh");
        let new = mesh.memory();
        let pairs = query::intersecting_pairs(&mesh, &still);
        assert!(mesh.memory() > new + 1_000, "{} bytes are cached", mesh.memory() - new);
        let asked = mesh.clone();
        mesh.refit(after.clone()).expect("as many vertices");
        assert_eq!(mesh.memory(), new);
        let expected = Mesh::new(after, knot.faces.clone()).expect("a legal mesh");
        let moved_pairs = query::intersecting_pairs(&mesh, &still);
        assert_eq!(moved_pairs, query::intersecting_pairs(&expected, &still));
        assert_ne!(moved_pairs, pairs);
        assert_eq!(query::intersecting_pairs(&asked, &still), pairs, "a clone stays where it was");
    }
}

#[test]
fn refitted_meshes_have_the_pairs_of_new_ones_and_of_brute_force() {
    let (mut met, mut asked) = (0, 0);
    for seed in 0..rounds(2) as u64 {
        for way in 0..WAYS {
            let mut rng = Rng::new(1_000 * seed + way);
            let soup = grid_soup(&mut rng, 150, 6, 2);
            let positions = deformed(&mut rng, way, &soup.vertices);
            let still = Mesh::new(singles(&soup.vertices), soup.faces.clone()).expect("a legal mesh");
            let fresh = Mesh::new(positions.clone(), soup.faces.clone()).expect("a legal mesh");
            let refitted = [1, 2].map(|threads| {
                on_threads(threads, || still.refitted(positions.clone()).expect("as many vertices as before"))
            });
            assert!(
                bits(&refitted[0]) == bits(&refitted[1]),
                "seed {seed}, way {way}: the number of threads changes bits"
            );
            let place = (&Affine::IDENTITY, Affine::translation([1.0, 0.0, 0.0]));
            let expected = pairs_in_every_way((&fresh, place.0), (&still, &place.1));
            let found = pairs_in_every_way((&refitted[0], place.0), (&still, &place.1));
            assert_eq!(found, expected, "seed {seed}, way {way}");
            let vertices = (0..positions.len()).map(|vertex| positions.get(vertex)).collect();
            let moved = impinge_testkit::Mesh { vertices, faces: soup.faces.clone() };
            assert_eq!(
                found,
                oracle::brute_force(moved.at(Affine::IDENTITY), soup.at(place.1)),
                "seed {seed}, way {way}"
            );
            met += usize::from(!found.is_empty());
            asked += 1;
        }
    }
    assert!(met * 10 >= asked * 5 && met < asked, "{met} of {asked} soups intersect");
}

#[test]
fn every_query_uses_the_vertices_of_the_last_refit() {
    let sphere = cube_sphere(8);
    let grown: Vec<[f64; 3]> = sphere.vertices.iter().map(|v| [3.0 * v[0], v[1], 0.5 * v[2]]).collect();
    let mut moving = Mesh::new(Positions::F64(sphere.vertices.clone()), sphere.faces.clone()).expect("a legal mesh");
    let other = Mesh::new(Positions::F64(sphere.vertices.clone()), sphere.faces.clone()).expect("a legal mesh");
    let ask = |mesh: &Mesh| {
        let point = [2.2, 0.1, 0.05];
        let ray = Ray::new([2.2, 0.1, 9.0], [0.0, 0.0, -1.0]).expect("a ray");
        (
            query::intersecting_pairs(mesh, &other),
            query::self_intersecting_pairs(mesh),
            mesh.closest_point(point).expect("a point"),
            mesh.winding_number(&[point]).map(|winding| format!("{winding:?}")).expect("a point"),
            mesh.ray_cast(&ray),
            // The witness among the intersecting faces may depend on the hierarchy.
            (query::distance(mesh, &other).lower, query::distance(mesh, &other).upper),
            (mesh.health(), mesh.is_closed()),
        )
    };
    // This fills everything that is built on first use.
    let before = ask(&moving);
    moving.refit(Positions::F64(grown.clone())).expect("as many vertices as before");
    let fresh = Mesh::new(Positions::F64(grown.clone()), sphere.faces.clone()).expect("a legal mesh");
    assert_eq!(ask(&moving), ask(&fresh));
    assert_ne!(ask(&moving), before);
    assert!(*moving.positions() == Positions::F64(grown));
}

#[test]
fn a_refit_that_fails_leaves_the_mesh_unchanged() {
    let soup = grid_soup(&mut Rng::new(33), 400, 9, 2);
    let mut mesh = Mesh::new(singles(&soup.vertices), soup.faces.clone()).expect("a legal mesh");
    let (before, count) = (bits(&mesh), soup.vertices.len());
    let spoiled = |value: f64| {
        let mut vertices = soup.vertices.clone();
        vertices[count / 2][1] = value;
        Positions::F64(vertices)
    };
    let (shorter, vertex) = (Positions::F64(soup.vertices[1..].to_vec()), count / 2);
    for (positions, expected) in [
        (spoiled(f64::NAN), InputErrorKind::NonFinite { what: "vertex", index: vertex }),
        (spoiled(f64::NEG_INFINITY), InputErrorKind::NonFinite { what: "vertex", index: vertex }),
        (spoiled(1e39), InputErrorKind::OutOfRange { what: "vertex", index: vertex, limit: "2^128" }),
        (shorter, InputErrorKind::OtherCount { what: "vertices", count: count - 1, expected: count }),
    ] {
        assert_eq!(mesh.refitted(positions.clone()).map(|_| ()).map_err(|e| e.kind().clone()), Err(expected.clone()));
        assert_eq!(mesh.refit(positions).map(|_| ()).map_err(|e| e.kind().clone()), Err(expected));
        assert!(bits(&mesh) == before && *mesh.positions() == singles(&soup.vertices));
    }
    let empty = Mesh::new(Positions::F32(Vec::new()), Vec::new()).expect("a legal mesh");
    assert_eq!(empty.refitted(Positions::F64(Vec::new())).map(|mesh| mesh.aging().ratio()), Ok(1.0));
}

#[test]
fn clones_answer_on_their_snapshot_while_the_mesh_moves() {
    let knot = torus_knot(120, 30, TREFOIL);
    let mut mesh = Mesh::new(Positions::F64(knot.vertices.clone()), knot.faces.clone()).expect("a legal mesh");
    let frame =
        |t: f64| Positions::F64(knot.vertices.iter().map(|v| [v[0] + t * v[1], v[1], v[2] - t * v[0]]).collect());
    std::thread::scope(|scope| {
        for step in 1..6 {
            let snapshot = mesh.clone();
            let expected = query::intersecting_pairs(&snapshot, &snapshot);
            let asking =
                scope.spawn(move || (0..10).all(|_| query::intersecting_pairs(&snapshot, &snapshot) == expected));
            mesh.refit(frame(0.1 * f64::from(step))).expect("as many vertices as before");
            mesh.rebuild(Builder::default());
            assert!(asking.join().expect("no panic"), "step {step}");
        }
    });
}

/// Returns the faces of a knot, each with its own corners.
fn loose_knot() -> impinge_testkit::Mesh {
    let knot = torus_knot(200, 50, TREFOIL);
    let vertices: Vec<[f64; 3]> = knot.faces.iter().flatten().map(|&v| knot.vertices[v as usize]).collect();
    let faces = (0..knot.faces.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    impinge_testkit::Mesh { vertices, faces }
}

/// Returns the vertices after shuffling the first twelfth of the faces, so that none stays beside
/// its neighbors.
fn shuffled_in_part(mesh: &impinge_testkit::Mesh) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(7);
    let mut vertices = mesh.vertices.clone();
    for face in (1..mesh.faces.len() / 12).rev() {
        let other = rng.integer(0, face as i64) as usize;
        for corner in 0..3 {
            vertices.swap(3 * face + corner, 3 * other + corner);
        }
    }
    vertices
}

#[test]
fn an_aged_tree_is_detected_and_repaired() {
    let knot = loose_knot();
    // The upper nodes of this builder separate the knot, so that only some of them contain shuffled
    // faces.
    let build = |vertices: &[[f64; 3]]| {
        let positions = Positions::F64(vertices.to_vec());
        Mesh::with_builder(positions, knot.faces.clone(), Builder::SweepSah).expect("a legal mesh")
    };
    let built = build(&knot.vertices);
    // A rigid motion, a mirror or another size does not age the tree, or hardly.
    for (scale, most) in [([1.0, 1.0, 1.0], 1.001), ([-4.0, 4.0, 4.0], 1.001), ([1.1, 1.0, 0.9], 1.1)] {
        let moved = knot.vertices.iter().map(|v| std::array::from_fn(|k| scale[k] * v[k] + 2.0)).collect();
        let mut mesh = built.clone();
        let aging = mesh.refit(Positions::F64(moved)).expect("legal");
        assert!(aging.ratio() <= most && !aging.is_worth_rebuilding(), "{aging:?}");
        let before = bits(&mesh);
        assert_eq!(mesh.rebuild_aged(), 0);
        assert!(bits(&mesh) == before);
    }
    let mut mesh = built.clone();
    let vertices = shuffled_in_part(&knot);
    let aging = mesh.refit(Positions::F64(vertices.clone())).expect("legal");
    assert!(aging.is_worth_rebuilding() && mesh.aging() == aging, "{aging:?}");

    let fresh = build(&vertices);
    let expected = query::intersecting_pairs(&fresh, &built);
    assert!(expected.len() > 100);
    let (mut partly, mut wholly) = (mesh.clone(), mesh.clone());
    let on_two = on_threads(2, || {
        let mut mesh = mesh.clone();
        (mesh.rebuild_aged(), bits(&mesh))
    });
    let rebuilt = on_threads(1, || partly.rebuild_aged());
    assert!(on_two == (rebuilt, bits(&partly)), "the number of threads changes bits");
    // The shuffled faces, and the faces between them.
    assert!((knot.faces.len() / 12..knot.faces.len()).contains(&rebuilt), "{rebuilt}, {aging:?}");
    wholly.rebuild(Builder::SweepSah);
    assert!(bits(&wholly) == bits(&fresh));
    for (name, young) in [("in part", &mut partly), ("as a whole", &mut wholly)] {
        assert_eq!(young.validate(), Ok(()), "{name}");
        assert!(young.aging().cost < aging.cost / Aging::WORTH_REBUILDING, "{name}: {:?}, {aging:?}", young.aging());
        assert_eq!((young.aging().ratio(), young.rebuild_aged()), (1.0, 0), "{name}: {:?}", young.aging());
        assert_eq!(query::intersecting_pairs(&*young, &built), expected, "{name}");
    }
    // The old mesh is unchanged, and still reports its age.
    assert_eq!((mesh.aging(), query::intersecting_pairs(&mesh, &built)), (aging, expected));
}

#[test]
fn partly_rebuilt_trees_answer_like_new_ones() {
    let mut rebuilt_in_part = 0;
    for seed in 0..40 {
        let mut rng = Rng::new(500 + seed);
        let soup = grid_soup(&mut rng, 900, 12, 1);
        let mut mesh = Mesh::new(singles(&soup.vertices), soup.faces.clone()).expect("a legal mesh");
        let still = mesh.clone();
        for _ in 0..3 {
            // Vertices on one side move far away: each is mirrored, or moves among other vertices.
            let side = rng.integer(2, 11) as f64;
            let mut away = |v: &[f64; 3]| if rng.one_in(2) { [v[2], 12.0 - v[0], v[1]] } else { *v };
            let moved: Vec<[f64; 3]> = soup.vertices.iter().map(|v| if v[0] < side { away(v) } else { *v }).collect();
            mesh.refit(singles(&moved)).expect("as many vertices as before");
            let rebuilt = mesh.rebuild_aged();
            rebuilt_in_part += usize::from(0 < rebuilt && rebuilt < soup.faces.len());
            assert_eq!(mesh.validate(), Ok(()), "seed {seed}");
            let fresh = Mesh::new(singles(&moved), soup.faces.clone()).expect("a legal mesh");
            let expected = query::intersecting_pairs(&fresh, &still);
            assert_eq!(query::intersecting_pairs(&mesh, &still), expected, "seed {seed}");
        }
    }
    assert!(rebuilt_in_part > 20, "{rebuilt_in_part} of 120 in part");
}

#[test]
fn cached_hits_change_no_answer() {
    let knot = torus_knot(60, 12, TREFOIL);
    let ball = cube_sphere(6);
    let meshes = [&knot, &ball].map(|mesh| engine_mesh(mesh, Precision::F64));
    let mut rng = Rng::new(2211);
    let (mut met, mut apart) = (0, 0);
    // One cache serves all meshes. Faces of one mesh are tried on another, which may not have them.
    let mut cache = Cache::default();
    for _ in 0..40 {
        let [a, b] = [0; 2].map(|_| &meshes[rng.integer(0, 1) as usize]);
        let turn = rotation(&mut rng);
        let from = [0; 3].map(|_| rng.uniform(-4.0, 4.0));
        for step in 0..30 {
            // Along a line, and sometimes far from it.
            let stray = if rng.one_in(8) { 3.0 } else { 0.02 * f64::from(step) };
            let pose = engine_pose(&Affine::new(turn.linear, from.map(|x| x - x.signum() * stray)));
            let truth = query::intersects(a, b.at(pose));
            assert_eq!(Query::new().with_cache(&mut cache).intersects(a, b.at(pose)), truth);
            *(if truth { &mut met } else { &mut apart }) += 1;
        }
    }
    assert!(met > 200 && apart > 200, "{met} intersect, {apart} apart");
}

/// Checks that the caps of holes and the sheets of faces follow the vertices of a refitted mesh.
/// They decide whether something penetrates an open mesh.
#[test]
fn an_open_mesh_penetrates_by_its_moved_vertices() {
    let sphere = cube_sphere(8);
    // Without some neighboring faces the sphere has a hole around its first vertex.
    let faces: Vec<[u32; 3]> = sphere.faces.iter().copied().filter(|face| !face.contains(&0)).collect();
    let made =
        |vertices: &[[f64; 3]]| Mesh::new(Positions::F64(vertices.to_vec()), faces.clone()).expect("a legal mesh");
    let hole = sphere.vertices[0];
    let mut rng = Rng::new(47);
    let (mut changed, mut decided) = (0, 0);
    for _ in 0..40 {
        let mut moving = made(&sphere.vertices);
        let [p, q, r] = std::array::from_fn(|_| rng.integer(0, 4) as f64 / 4.0);
        let grown: Vec<[f64; 3]> =
            sphere.vertices.iter().map(|v| [(1.0 + p) * v[0] + q, v[1] * (1.0 - 0.5 * q), v[2] + r * v[0]]).collect();
        // A small copy near the old hole.
        let pose = Pose::from_matrix([
            [0.25, 0.0, 0.0, 0.75 * hole[0]],
            [0.0, 0.25, 0.0, 0.75 * hole[1]],
            [0.0, 0.0, 0.25, 0.75 * hole[2]],
            [0.0, 0.0, 0.0, 1.0],
        ])
        .expect("a legal pose");
        let ask = |mesh: &Mesh| query::penetrates(mesh, made(&sphere.vertices).at(pose));
        let before = ask(&moving);
        moving.refit(Positions::F64(grown.clone())).expect("as many vertices as before");
        let after = ask(&moving);
        assert_eq!(after, ask(&made(&grown)));
        changed += u32::from(after != before);
        decided += u32::from(after != query::Penetrates::Undecided);
    }
    assert!(changed >= 10 && (1..40).contains(&decided), "{changed} changed, {decided} decided");
}

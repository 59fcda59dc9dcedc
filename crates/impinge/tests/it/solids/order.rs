//! Invariance of solids: neither the order of the faces nor the first corner of a face changes an
//! answer.

use impinge::mesh::Containment;
use impinge::query;
use impinge::{Mesh, Pose};
use impinge_testkit::generate::bricks::{self, Cut, Scene};
use impinge_testkit::generate::solids::cuboid;
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::{Affine, Mesh as Plain, rounds};

use crate::solids::shapes::{A, B, BOTH, NEITHER, engine, moved, pose, sphere, surface_or_solid, without_faces};

/// Answers of the verbs about two solids, without witnesses and normals, which may be any of those
/// that tie.
#[derive(Debug, PartialEq)]
struct Answers {
    penetrates: query::Penetrates,
    intersections: [query::SolidIntersection; 4],
    proximity: [query::Proximity; 4],
    are_at_distance_zero: [bool; 4],
    within: [bool; 8],
}

fn answers_about(a: &Mesh, b: &Mesh, place: Pose) -> Answers {
    let b = b.at(place);
    let solids = [NEITHER, A, B, BOTH];
    let within = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
        query::within(
            surface_or_solid(a, solids[i % 4][0]),
            surface_or_solid(b, solids[i % 4][1]),
            if i < 4 { 0.0 } else { 0.75 },
        )
    });
    let intersections =
        solids.map(|solid| query::solid_intersection(surface_or_solid(a, solid[0]), surface_or_solid(b, solid[1])));
    for (solid, found) in solids.into_iter().zip(&intersections) {
        assert_eq!(query::intersects(surface_or_solid(a, solid[0]), surface_or_solid(b, solid[1])), found.intersects);
    }
    Answers {
        penetrates: query::penetrates(a, b),
        intersections,
        proximity: solids.map(|solid| query::proximity(surface_or_solid(a, solid[0]), surface_or_solid(b, solid[1]))),
        are_at_distance_zero: solids
            .map(|solid| query::distance(surface_or_solid(a, solid[0]), surface_or_solid(b, solid[1])).upper == 0.0),
        within,
    }
}

/// Checks that intervals of the same number overlap. Their ends may differ: rounding depends on the
/// order, and so does the place from which a search begins.
fn assert_intervals_agree(ours: [&Mesh; 2], again: [&Mesh; 2], place: Pose) {
    let overlap = |x: [f64; 2], y: [f64; 2]| assert!(x[0] <= y[1] && y[0] <= x[1], "{x:?} {y:?}");
    let [x, y] =
        [ours, again].map(|[a, b]| query::distance(surface_or_solid(a, true), surface_or_solid(b.at(place), true)));
    overlap([x.lower, x.upper], [y.lower, y.upper]);
    match [ours, again].map(|[a, b]| query::penetration(a, b.at(place))) {
        [None, None] => {}
        [Some(x), Some(y)] => {
            overlap([x.lower, x.upper], [y.lower, y.upper]);
            assert_eq!(x.upper == 0.0, y.upper == 0.0, "{x:?} {y:?}");
        }
        depths => panic!("{depths:?}"),
    }
}

/// Returns two meshes and the pose of the second: bricks on one lattice, spheres with holes, or
/// rotated bricks.
fn scene(rng: &mut Rng, case: usize) -> ([Plain; 2], Affine) {
    let bricks = Scene::random(rng);
    let cut = rng.choose(&[Cut::AsLattice, Cut::AsLattice, Cut::Whole]);
    let [a, b] = [0, 1].map(|side| bricks::mesh(rng, &bricks.bricks[side], cut));
    let translation = bricks.half_steps.map(|x| x as f64 / 2.0);
    match case % 4 {
        0 => {
            let holes = |rng: &mut Rng| {
                let first = rng.integer(0, 200) as usize;
                without_faces(sphere(), &[first, first + rng.integer(1, 9) as usize])
            };
            ([holes(rng), holes(rng).scaled(0.5)], Affine { translation, ..poses::rotation(rng) })
        }
        1 => ([a, b], Affine { translation, ..poses::rotation(rng) }),
        _ => ([a, moved(b, translation)], Affine::IDENTITY),
    }
}

#[test]
fn the_order_of_the_faces_changes_no_answer_about_solids() {
    let mut rng = Rng::new(91);
    let cases = rounds(300);
    let (mut penetrating, mut apart, mut undecided, mut deep) = (0, 0, 0, 0);
    for case in 0..cases {
        let ([a, b], place) = scene(&mut rng, case);
        let place = pose(&place);
        let again = [&a, &b].map(|mesh| engine(&bricks::reordered(&mut rng, mesh.clone())));
        let [a, b] = [&a, &b].map(engine);
        let answers = answers_about(&a, &b, place);
        assert_eq!(answers_about(&again[0], &again[1], place), answers, "case {case}");
        if case.is_multiple_of(5) {
            assert_intervals_agree([&a, &b], again.each_ref(), place);
            deep += usize::from(answers.penetrates == query::Penetrates::Yes);
        }
        penetrating += usize::from(answers.penetrates == query::Penetrates::Yes);
        undecided += usize::from(answers.penetrates == query::Penetrates::Undecided);
        apart += usize::from(answers.penetrates == query::Penetrates::No);
    }
    assert!(10 * penetrating > 2 * cases && 10 * apart > 2 * cases, "{penetrating} {apart} of {cases}");
    assert!(100 * undecided > cases && 100 * deep > 4 * cases, "{undecided} {deep} of {cases}");
}

#[test]
fn the_order_of_the_faces_changes_no_answer_about_points() {
    let mut rng = Rng::new(92);
    let cases = rounds(100);
    let (mut closed, mut inside) = (0, 0);
    for case in 0..cases {
        let ([a, _], _) = scene(&mut rng, case);
        let (mesh, again) = (engine(&a), engine(&bricks::reordered(&mut rng, a)));
        let coordinate =
            |rng: &mut Rng| if rng.one_in(2) { rng.integer(-1, 7) as f64 / 2.0 } else { rng.uniform(-1.0, 4.0) };
        let points: Vec<[f64; 3]> = (0..50).map(|_| std::array::from_fn(|_| coordinate(&mut rng))).collect();
        assert_eq!(mesh.is_closed(), again.is_closed());
        let contained = mesh.contains(&points);
        assert_eq!(contained, again.contains(&points), "case {case}");
        closed += usize::from(mesh.is_closed());
        inside += contained.as_ref().expect("finite points").iter().filter(|at| **at == Containment::Inside).count();
        if mesh.is_closed() {
            assert_eq!(mesh.winding_number(&points), again.winding_number(&points), "case {case}");
        }
    }
    assert!(2 * closed > cases && 10 * closed < 9 * cases, "{closed} of {cases} are closed");
    assert!(2 * inside > cases, "{inside} points of {cases} scenes are inside");
}

#[test]
fn the_tested_point_of_an_open_mesh_does_not_depend_on_the_order() {
    // A rod in a box without its upper side. Half of the rod is outside, and nothing touches.
    let open = engine(&without_faces(cuboid([0.0; 3], [1.0; 3]), &[2, 3]));
    let rod = cuboid([0.375, 0.375, 0.25], [0.625, 0.625, 4.0]);
    let mut rng = Rng::new(93);
    let answers = |rod: Plain| {
        let rod = engine(&rod);
        assert!(!query::intersects(&open, &rod));
        (
            query::penetrates(&open, &rod),
            query::solid_intersection(surface_or_solid(&open, true), surface_or_solid(&rod, true)),
        )
    };
    let expected = answers(rod.clone());
    for _ in 0..40 {
        assert_eq!(answers(bricks::reordered(&mut rng, rod.clone())), expected);
    }
}

//! Solids of many bodies on a lattice, whose interiors are known cell by cell. Their bodies share
//! many walls, edges and corners.

use impinge::query::{self, Penetrates};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::bricks::{self, Brick, Cut, Scene};
use impinge_testkit::{Mesh, rounds};
use rayon::prelude::*;

use crate::solids::shapes::{engine, flipped, moved};

fn yes_or_no(intersect: bool) -> Penetrates {
    if intersect { Penetrates::Yes } else { Penetrates::No }
}

/// Returns both meshes of a scene, in one frame.
fn meshes(rng: &mut Rng, scene: &Scene, cut: Cut) -> [Mesh; 2] {
    let [a, b] = [0, 1].map(|side| bricks::mesh(rng, &scene.bricks[side], cut));
    [a, moved(b, scene.half_steps.map(|x| x as f64 / 2.0))]
}

fn penetrates([a, b]: &[Mesh; 2]) -> Penetrates {
    query::penetrates(&engine(a), &engine(b))
}

/// Checks the answer for a scene, also with the meshes swapped and their faces in several orders.
fn assert_decided(rng: &mut Rng, scene: &Scene, expected: bool) {
    assert_eq!(scene.penetrates(), expected);
    let both = meshes(rng, scene, Cut::AsLattice);
    assert_eq!(penetrates(&both), yes_or_no(expected), "{scene:?}");
    for _ in 0..8 {
        assert_eq!(penetrates_in_other_order(rng, &both), yes_or_no(expected), "{scene:?}");
    }
}

/// Returns the answer with the meshes swapped and their faces in another order.
fn penetrates_in_other_order(rng: &mut Rng, [a, b]: &[Mesh; 2]) -> Penetrates {
    let (a, b) = (bricks::reordered(rng, a.clone()), bricks::reordered(rng, b.clone()));
    penetrates(&[b, a])
}

#[test]
fn bricks_of_one_lattice_are_always_decided() {
    let scenes = rounds(10_000);
    let outcome = |case: usize| -> [usize; 3] {
        let mut rng = Rng::new(710_000 + case as u64);
        let scene = Scene::random(&mut rng);
        let both = meshes(&mut rng, &scene, Cut::AsLattice);
        let [a, b] = both.each_ref().map(engine);
        let pairs = query::intersecting_pairs(&a, &b);
        let expected = scene.penetrates();
        assert_eq!(query::penetrates_of_pairs(&a, &b, &pairs), yes_or_no(expected), "case {case}: {scene:?}");
        if case.is_multiple_of(8) {
            assert_eq!(
                penetrates_in_other_order(&mut rng, &both),
                yes_or_no(expected),
                "case {case}, in another order: {scene:?}"
            );
        }
        let touches = !expected && scene.touches();
        [touches, expected, touches && pairs.len() > 256].map(usize::from)
    };
    let sum = |x: [usize; 3], y: [usize; 3]| std::array::from_fn(|k| x[k] + y[k]);
    let [touching, penetrating, crowded] = (0..scenes).into_par_iter().map(outcome).reduce(|| [0; 3], sum);
    assert!(10 * touching > 2 * scenes, "{touching} of {scenes} touch");
    assert!(10 * penetrating > scenes, "{penetrating} of {scenes} penetrate");
    assert!(200 * crowded > scenes, "{crowded} of {scenes} touch in many faces");
}

#[test]
fn bricks_with_walls_cut_in_other_ways_are_never_answered_wrongly() {
    let mut rng = Rng::new(72);
    let scenes = rounds(1_000);
    let mut decided = 0;
    for case in 0..scenes {
        let scene = Scene::random(&mut rng);
        let cut = if case.is_multiple_of(2) { Cut::ByChance } else { Cut::Whole };
        let both = meshes(&mut rng, &scene, cut);
        let answer = penetrates(&both);
        let expected = yes_or_no(scene.penetrates());
        assert!(answer == Penetrates::Undecided || answer == expected, "case {case}: {answer:?}, {cut:?} {scene:?}");
        assert_eq!(
            penetrates_in_other_order(&mut rng, &both),
            answer,
            "case {case}, in another order: {cut:?} {scene:?}"
        );
        decided += usize::from(answer == expected);
    }
    assert!(10 * decided > 7 * scenes, "{decided} of {scenes} are decided");
}

#[test]
fn membranes_cut_in_two_ways_have_no_interior() {
    // Both sides of a membrane lie on each other. If they are cut into different triangles, no face
    // cancels another one, and the tested points lie on edges of the other side.
    let outcome = |case: usize| -> [usize; 2] {
        let mut rng = Rng::new(730_000 + case as u64);
        let around = Brick::new([0; 3], [3; 3]);
        let mut membrane = || {
            let low: [i64; 3] = std::array::from_fn(|_| rng.integer(0, 1));
            let mut high = low.map(|x| x + rng.integer(1, 2));
            let axis = rng.integer(0, 2) as usize;
            high[axis] = low[axis];
            Brick { low, high, inside_out: rng.one_in(2) }
        };
        let membranes = vec![membrane(), membrane()];
        let half_steps = std::array::from_fn(|_| rng.integer(0, 4));
        let scene = Scene { bricks: [vec![around], membranes], half_steps };
        assert!(!scene.penetrates());
        let both = meshes(&mut rng, &scene, Cut::ByChance);
        let answer = penetrates(&both);
        assert_ne!(answer, Penetrates::Yes, "case {case}: {scene:?}");
        assert_eq!(penetrates_in_other_order(&mut rng, &both), answer, "case {case}, in another order: {scene:?}");
        [usize::from(answer == Penetrates::No), usize::from(answer == Penetrates::Undecided)]
    };
    let scenes = rounds(1_000);
    let sum = |x: [usize; 2], y: [usize; 2]| [x[0] + y[0], x[1] + y[1]];
    let [apart, undecided] = (0..scenes).into_par_iter().map(outcome).reduce(|| [0; 2], sum);
    assert!(20 * apart > scenes, "{apart} of {scenes} are decided");
    assert!(4 * undecided > scenes, "{undecided} of {scenes} are undecided");
}

#[test]
fn floors_upon_floors_do_not_penetrate() {
    let mut rng = Rng::new(73);
    for size in 1..=6 {
        let floor: Vec<Brick> = (0..size * size).map(|i| Brick::unit([i / size, i % size, 0])).collect();
        for (half_steps, expected) in [([0, 0, 2], false), ([1, 2, 2], false), ([0, 0, 1], true), ([0, 0, 0], true)] {
            assert_decided(&mut rng, &Scene { bricks: [floor.clone(), floor.clone()], half_steps }, expected);
        }
    }
}

#[test]
fn checkerboards_share_edges_and_do_not_penetrate() {
    // Four faces of two bricks share each edge. Any two faces of opposite orientation could belong
    // to one body.
    let mut rng = Rng::new(77);
    let board = |white: i64| -> Vec<Brick> {
        let cells = (0..36).map(|i| [i / 6, i % 6, 0]).filter(|cell| (cell[0] + cell[1]) % 2 == white);
        cells.map(Brick::unit).collect()
    };
    for (white, half_steps, expected) in [
        (0, [0, 0, 2], false),
        (1, [0, 0, 2], false),
        (1, [0, 0, 0], false),
        (1, [0, 0, 1], false),
        (0, [1, 0, 0], true),
    ] {
        assert_decided(&mut rng, &Scene { bricks: [board(0), board(white)], half_steps }, expected);
    }
}

#[test]
fn bodies_that_share_a_corner_are_tested_one_by_one() {
    let mut rng = Rng::new(74);
    // The large brick touches both unit cubes in the corner that they share. One cube is inside the
    // brick.
    let cubes = vec![Brick::unit([0; 3]), Brick::unit([-1; 3])];
    for cubes in [cubes.clone(), cubes.into_iter().rev().collect()] {
        let bricks = [cubes, vec![Brick::new([0; 3], [2; 3])]];
        assert_decided(&mut rng, &Scene { bricks, half_steps: [0; 3] }, true);
    }
    // The same with tetrahedra, so that nothing touches except the corner.
    let tip = |along: f64| {
        let vertices = vec![
            [0.0; 3],
            [along, 0.25 * along, 0.25 * along],
            [0.25 * along, along, 0.25 * along],
            [0.25 * along, 0.25 * along, along],
        ];
        let mesh = Mesh { vertices, faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] };
        if along < 0.0 { flipped(mesh) } else { mesh }
    };
    let large = bricks::mesh(&mut rng, &[Brick::new([0; 3], [2; 3])], Cut::AsLattice);
    for both in [tip(1.0).joined(&tip(-1.0)), tip(-1.0).joined(&tip(1.0))] {
        assert_eq!(penetrates(&[both.clone(), large.clone()]), Penetrates::Yes);
        assert_eq!(penetrates(&[large.clone(), both]), Penetrates::Yes);
    }
    assert_eq!(penetrates(&[tip(-1.0), large]), Penetrates::No);
}

#[test]
fn fins_without_thickness_hide_no_body() {
    let mut rng = Rng::new(75);
    let large = bricks::mesh(&mut rng, &[Brick::new([-1; 3], [2; 3])], Cut::AsLattice);
    // A unit cube inside the large brick. A fin from one of its edges passes out through a wall.
    let fin =
        Mesh { vertices: vec![[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [5.25, 1.5, 0.25]], faces: vec![[0, 1, 2], [0, 2, 1]] };
    let cube = bricks::mesh(&mut rng, &[Brick::unit([0; 3])], Cut::AsLattice);
    for both in [cube.clone().joined(&fin), fin.clone().joined(&cube)] {
        assert_eq!(penetrates(&[both.clone(), large.clone()]), Penetrates::Yes);
        assert_eq!(penetrates(&[large.clone(), both]), Penetrates::Yes);
    }
    assert_eq!(penetrates(&[fin, large]), Penetrates::No);
}

#[test]
fn a_body_touched_at_every_tested_point_is_not_reported_apart() {
    // A tetrahedron inside a cube. A spike from outside touches each point of its faces that is
    // tested.
    let body = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut around = bricks::mesh(&mut Rng::new(76), &[Brick::new([-20; 3], [20; 3])], Cut::Whole);
    for face in faces {
        let [a, b, c] = face.map(|vertex: usize| body[vertex]);
        let cross = |u: [f64; 3], v: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3])
        };
        let less = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] - q[k]) };
        let outward = cross(less(b, a), less(c, a)).map(|x| x / 16.0);
        for corners in [[a, b, c], [b, c, a], [c, a, b]] {
            let tip: [f64; 3] =
                std::array::from_fn(|k| 0.5 * corners[0][k] + 0.25 * corners[1][k] + 0.25 * corners[2][k]);
            let from_tip = |along: [f64; 3]| -> [f64; 3] {
                std::array::from_fn(|k| tip[k] + 2.0 * outward[k] + (along[k]) / 16.0)
            };
            let base = [from_tip(less(b, a)), from_tip(less(c, b)), from_tip(less(a, c))];
            let spike = Mesh {
                vertices: [vec![tip], base.to_vec()].concat(),
                faces: faces.map(|f| f.map(|i| i as u32)).to_vec(),
            };
            around = around.joined(&spike);
        }
    }
    let body = Mesh { vertices: body.to_vec(), faces: faces.map(|face| face.map(|i| i as u32)).to_vec() };
    let answer = penetrates(&[body.clone(), around.clone()]);
    assert!(answer.possibly());
    assert_eq!(penetrates(&[around, body]), answer);
}

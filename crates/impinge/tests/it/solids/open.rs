//! Open meshes beside others: away from the surfaces that could close its border, an open mesh is
//! decided like a closed one.

use impinge::query::{self, Penetrates};
use impinge_testkit::generate::bricks::{self, Brick, Cut, Scene};
use impinge_testkit::generate::{Rng, solids};
use impinge_testkit::{Affine, Mesh, rounds};

use crate::solids::shapes::{engine, moved, pose, sphere, without_faces};

fn penetrates(a: &Mesh, b: &Mesh) -> Penetrates {
    let (a, b) = (engine(a), engine(b));
    let answer = query::penetrates(&a, &b);
    assert_eq!(query::penetrates(&b, &a), answer, "swapping");
    answer
}

/// Returns a unit cube with a crack: for one of its faces the corner at the origin is 2.7e-16
/// lower, as after exports that round twice.
fn cracked_cube() -> Mesh {
    let mut mesh = solids::cuboid([0.0; 3], [1.0; 3]);
    let lower = mesh.vertices.len() as u32;
    mesh.vertices.push([0.0, 0.0, -2.7e-16]);
    let face = &mut mesh.faces[8];
    assert!(face.contains(&0));
    face.iter_mut().filter(|vertex| **vertex == 0).for_each(|vertex| *vertex = lower);
    mesh
}

#[test]
fn cracked_meshes_apart_do_not_penetrate() {
    let cracked = cracked_cube();
    assert!(!engine(&cracked).is_closed());
    for gap in [1e-6, 1e-3, 0.1, 0.5, 0.9, 1.2, 5.0] {
        for along in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, -1.0]] {
            let beside = moved(cracked.clone(), along.map(|x: f64| x * (1.0 + gap)));
            assert_eq!(penetrates(&cracked, &beside), Penetrates::No, "{gap} along {along:?}");
        }
    }
    // Only their boxes overlap: one mesh stands in the corner of an angle.
    let angle = moved(cracked.clone(), [0.0, 0.0, -2.0]).joined(&solids::cuboid([2.0, 0.0, -2.0], [3.0, 1.0, 2.0]));
    assert_eq!(penetrates(&cracked, &angle), Penetrates::No);
}

#[test]
fn touching_far_from_a_crack_is_decided() {
    // The crack is in the side at x = 0.
    let cracked = cracked_cube();
    let small = |x: f64| solids::cuboid([x, 0.25, 0.25], [x + 0.5, 0.75, 0.75]);
    assert_eq!(penetrates(&cracked, &small(1.0)), Penetrates::No);
    assert_eq!(penetrates(&cracked, &small(1.0_f64.next_down())), Penetrates::Yes);
    assert_eq!(penetrates(&cracked, &small(0.25)), Penetrates::Yes, "inside");
    // A wall on the crack may touch it.
    assert_eq!(penetrates(&cracked, &solids::cuboid([-1.0, -1.0, -1.0], [0.0, 2.0, 2.0])), Penetrates::Undecided);
}

#[test]
fn touching_beyond_the_reach_of_a_hole_is_decided() {
    let open = without_faces(sphere(), &[0]);
    let corners = sphere().faces[0].map(|vertex| sphere().vertices[vertex as usize]);
    let middle: [f64; 3] = std::array::from_fn(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0);
    let along = |by: f64| moved(sphere(), middle.map(|x| x * by));
    assert_eq!(penetrates(&open, &moved(sphere(), [2.5, 0.0, 0.0])), Penetrates::No);
    assert_eq!(penetrates(&open, &moved(sphere(), [1.0, 0.0, 0.0])), Penetrates::Yes);
    assert_eq!(penetrates(&open, &along(2.03)), Penetrates::Undecided, "at the hole");
    assert_eq!(penetrates(&open, &along(2.5)), Penetrates::No);
    assert_eq!(penetrates(&open, &along(-2.03)), Penetrates::No, "on the other side");
    assert_eq!(penetrates(&open.clone().scaled(0.25), &sphere()), Penetrates::Yes);
    assert_eq!(penetrates(&open, &sphere().scaled(0.25)), Penetrates::Yes);
    assert_eq!(penetrates(&open, &Mesh::default()), Penetrates::No);
}

#[test]
fn the_reach_of_a_hole_is_measured_in_the_frame_of_its_mesh() {
    // A cube without its upper side, twice: the winding number exceeds 0.5 up to a quarter above
    // the opening.
    let cup = without_faces(solids::cuboid([0.0; 3], [1.0; 3]), &[2, 3]);
    let cup = engine(&cup.clone().joined(&cup));
    let lid = engine(&moved(solids::cuboid([-9.0, -9.0, 0.0], [9.0, 9.0, 9.0]), [0.0, 0.0, 1.125]));
    // A thin cube has the same height.
    let thin = Affine { linear: [[1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };
    assert_eq!(query::penetrates(cup.at(pose(&thin)), &lid), Penetrates::Undecided);
}

/// Moves one coordinate of a corner by 1e-15, so that cracks open at the edges there.
fn with_a_crack(rng: &mut Rng, mut mesh: Mesh) -> Mesh {
    if !mesh.vertices.is_empty() {
        let vertex = rng.integer(0, mesh.vertices.len() as i64 - 1) as usize;
        mesh.vertices[vertex][rng.integer(0, 2) as usize] += if rng.one_in(2) { 1e-15 } else { -1e-15 };
    }
    mesh
}

#[test]
fn cracked_bricks_are_never_answered_wrongly() {
    let mut rng = Rng::new(81);
    let scenes = rounds(1_000);
    let (mut decided, mut touching) = (0, 0);
    for case in 0..scenes {
        let scene = Scene::random(&mut rng);
        let [a, b] = [0, 1].map(|side| bricks::mesh(&mut rng, &scene.bricks[side], Cut::AsLattice));
        let a = with_a_crack(&mut rng, a);
        let b =
            moved(if rng.one_in(2) { with_a_crack(&mut rng, b) } else { b }, scene.half_steps.map(|x| x as f64 / 2.0));
        let expected = if scene.penetrates() { Penetrates::Yes } else { Penetrates::No };
        let answer = penetrates(&a, &b);
        assert!(answer == Penetrates::Undecided || answer == expected, "case {case}: {answer:?}, {scene:?}");
        let (again_a, again_b) = (bricks::reordered(&mut rng, a), bricks::reordered(&mut rng, b));
        assert_eq!(penetrates(&again_a, &again_b), answer, "case {case}, in another order: {scene:?}");
        decided += usize::from(answer == expected);
        touching += usize::from(answer == expected && !scene.penetrates() && scene.touches());
    }
    assert!(10 * decided > 4 * scenes, "{decided} of {scenes} are decided");
    assert!(100 * touching > 2 * scenes, "{touching} of {scenes} are proved to touch only");
}

#[test]
fn touching_at_a_wall_far_from_a_crack_is_decided() {
    // Bricks as fine as the lattice, with a crack in one corner: touching at the other end is
    // decided.
    let mut rng = Rng::new(82);
    let mut long = bricks::mesh(&mut rng, &[Brick::new([0; 3], [4, 2, 2])], Cut::AsLattice);
    let crack = long.vertices.iter().position(|vertex| *vertex == [0.0; 3]).expect("a corner at the origin");
    long.vertices[crack][0] -= 1e-15;
    let other = bricks::mesh(&mut rng, &[Brick::new([0; 3], [4, 2, 2])], Cut::AsLattice);
    assert!(!engine(&long).is_closed());
    assert_eq!(penetrates(&long, &moved(other.clone(), [4.0, 0.0, 0.0])), Penetrates::No);
    assert_eq!(penetrates(&long, &moved(other.clone(), [4.0, 1.0, 0.5])), Penetrates::No);
    assert_eq!(penetrates(&long, &moved(other.clone(), [3.5, 0.0, 0.0])), Penetrates::Yes);
    assert_eq!(penetrates(&long, &moved(other, [-4.0, 0.0, 0.0])), Penetrates::Undecided);
}

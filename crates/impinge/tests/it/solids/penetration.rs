//! Overlap of interiors, against boxes and polycubes with interiors known in integers.
//!
//! They have many coplanar walls, edges on edges, edges on faces and corners on everything, often
//! without any crossing.

use std::collections::BTreeSet;

use impinge::query::{self, Penetrates};
use impinge_testkit::generate::{Rng, poses, solids};
use impinge_testkit::{Affine, Mesh};

use crate::solids::shapes::{engine, flipped, moved, pose, soup, sphere};

fn penetrates(a: &Mesh, b: &Mesh, maps: [Affine; 2]) -> Penetrates {
    let (mesh_a, mesh_b) = (engine(a), engine(b));
    let (placed_a, placed_b) = (mesh_a.at(pose(&maps[0])), mesh_b.at(pose(&maps[1])));
    let answer = query::penetrates(placed_a, placed_b);
    assert_eq!(query::penetrates(placed_b, placed_a), answer, "swapping");
    assert_eq!(answer.possibly(), answer != Penetrates::No);
    answer
}

fn yes_or_no(overlap: bool) -> Penetrates {
    if overlap { Penetrates::Yes } else { Penetrates::No }
}

/// Returns the same pose for both meshes: the identity, an integer map, a rotation, or a mirror.
fn places(rng: &mut Rng, case: usize) -> [Affine; 2] {
    let place = match case % 4 {
        0 => Affine::IDENTITY,
        1 => {
            Affine { linear: [[3.0, 4.0, 12.0], [-4.0, 12.0, -3.0], [-12.0, -3.0, 4.0]], translation: [7.0, -1.0, 0.5] }
        }
        2 => poses::rotation(rng),
        _ => Affine { linear: [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.25; 3] },
    };
    [place; 2]
}

/// Returns the same placed mesh with other coordinates: sometimes mirrored in its own frame, and
/// moved there by integers, which its pose undoes.
fn shifted(rng: &mut Rng, mesh: Mesh, place: Affine, case: usize) -> (Mesh, Affine) {
    let (mut mesh, mut place) = (mesh, place);
    if rng.one_in(3) {
        mesh.vertices.iter_mut().for_each(|vertex| vertex[0] = -vertex[0]);
        place.linear.iter_mut().for_each(|row| row[0] = -row[0]);
    }
    if case % 4 == 2 {
        // The map is no integer map, so moving would round.
        return (mesh, place);
    }
    let by: [f64; 3] = std::array::from_fn(|_| rng.integer(-9, 9) as f64);
    let back = |i: usize| (0..3).map(|k| place.linear[i][k] * by[k]).sum::<f64>();
    let translation = std::array::from_fn(|i| place.translation[i] - back(i));
    (moved(mesh, by), Affine { translation, ..place })
}

/// Returns the mesh with the other diagonal for each pair of faces that forms a flat quadrilateral.
fn other_diagonals(mut mesh: Mesh) -> Mesh {
    for pair in mesh.faces.chunks_mut(2) {
        // [a, b, c], [a, c, d] becomes [a, b, d], [b, c, d].
        let ([a, b, c], [a_too, c_too, d]) = (pair[0], pair[1]);
        if a == a_too && c == c_too {
            (pair[0], pair[1]) = ([a, b, d], [b, c, d]);
        }
    }
    mesh
}

#[test]
fn boxes_on_the_grid_penetrate_as_in_integers() {
    let mut rng = Rng::new(1);
    let (mut touching, mut meeting) = (0, 0);
    for case in 0..600 {
        let mut corners = || {
            let low: [i64; 3] = std::array::from_fn(|_| rng.integer(0, 3));
            let high: [i64; 3] = std::array::from_fn(|k| low[k] + rng.integer(1, 3));
            [low, high]
        };
        let (a, b) = (corners(), corners());
        let overlap = (0..3).all(|k| a[0][k].max(b[0][k]) < a[1][k].min(b[1][k]));
        let touch = !overlap && (0..3).all(|k| a[0][k].max(b[0][k]) <= a[1][k].min(b[1][k]));
        let cuboid = |[low, high]: [[i64; 3]; 2]| solids::cuboid(low.map(|x| x as f64), high.map(|x| x as f64));
        let mut mesh_b = cuboid(b);
        if rng.one_in(2) {
            mesh_b = other_diagonals(mesh_b);
        }
        if rng.one_in(3) {
            mesh_b = flipped(mesh_b);
        }
        if rng.one_in(3) {
            mesh_b = soup(&mesh_b);
        }
        let [place_a, place_b] = places(&mut rng, case);
        let (mesh_b, place_b) = shifted(&mut rng, mesh_b, place_b, case);
        assert_eq!(penetrates(&cuboid(a), &mesh_b, [place_a, place_b]), yes_or_no(overlap), "case {case}: {a:?} {b:?}");
        touching += usize::from(touch);
        meeting += usize::from(overlap);
    }
    assert!(touching > 100 && meeting > 100, "{touching} {meeting}");
}

/// Returns the surface of a set of unit cubes. Each square is cut along a random diagonal.
fn polycube(rng: &mut Rng, cubes: &BTreeSet<[i64; 3]>) -> Mesh {
    let mut mesh = Mesh::default();
    for &cube in cubes {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beside = cube;
                beside[axis] += 2 * side - 1;
                if cubes.contains(&beside) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let first = mesh.vertices.len() as u32;
                for [x, y] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                    let mut corner = cube;
                    corner[axis] += side;
                    corner[u] += x;
                    corner[v] += y;
                    mesh.vertices.push(corner.map(|x| x as f64));
                }
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| first + i);
                let halves = if rng.one_in(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                mesh.faces.extend(halves.map(|[p, q, r]| if side == 1 { [p, q, r] } else { [p, r, q] }));
            }
        }
    }
    mesh
}

#[test]
fn polycubes_on_one_grid_and_between_two_penetrate_as_in_integers() {
    let mut rng = Rng::new(2);
    let (mut touching, mut meeting) = (0, 0);
    for case in 0..240 {
        // Sparse sets, whose cubes often touch only in edges and corners. Set b may be shifted by
        // half a cube along each axis.
        let mut cubes = |sparse: u64| -> BTreeSet<[i64; 3]> {
            let all = (0..27).map(|i| [i / 9, i / 3 % 3, i % 3]);
            all.filter(|_| rng.one_in(sparse)).collect()
        };
        let (a, b) = (cubes(4), cubes(3));
        let off: [i64; 3] = std::array::from_fn(|_| if case % 2 == 0 { 0 } else { rng.integer(0, 1) });
        let off: [i64; 3] = if case % 3 == 0 { std::array::from_fn(|k| off[k] + 2 * rng.integer(0, 2)) } else { off };
        let overlap =
            |p: &[i64; 3], q: &[i64; 3], distance: i64| (0..3).all(|k| (2 * p[k] - 2 * q[k] - off[k]).abs() < distance);
        let overlapping = a.iter().any(|p| b.iter().any(|q| overlap(p, q, 2)));
        let touch = !overlapping && a.iter().any(|p| b.iter().any(|q| overlap(p, q, 3)));
        let mesh_a = polycube(&mut rng, &a);
        let mesh_b = moved(polycube(&mut rng, &b), off.map(|x| x as f64 / 2.0));
        let [place_a, place_b] = places(&mut rng, case);
        let (mesh_b, place_b) = shifted(&mut rng, mesh_b, place_b, case);
        assert_eq!(
            penetrates(&mesh_a, &mesh_b, [place_a, place_b]),
            yes_or_no(overlapping),
            "case {case}: {a:?} {b:?} {off:?}"
        );
        touching += usize::from(touch);
        meeting += usize::from(overlapping);
    }
    assert!(touching > 30 && meeting > 80, "{touching} {meeting}");
}

#[test]
fn shells_within_shells_have_their_interiors() {
    let cube = |size: f64| solids::cuboid([-size; 3], [size; 3]);
    let shell = cube(3.0).joined(&flipped(cube(2.0)));
    let here = [Affine::IDENTITY; 2];
    assert_eq!(penetrates(&shell, &cube(2.0), here), Penetrates::No, "fills the hollow");
    assert_eq!(penetrates(&shell, &cube(1.0), here), Penetrates::No, "in the hollow");
    assert_eq!(penetrates(&shell, &cube(2.5), here), Penetrates::Yes);
    assert_eq!(penetrates(&shell, &cube(4.0), here), Penetrates::Yes);
    assert_eq!(penetrates(&shell, &shell, here), Penetrates::Yes, "itself");
    assert_eq!(penetrates(&cube(1.0), &flipped(cube(1.0)), here), Penetrates::Yes, "turned inside out");
    // Both shells are oriented outward, so the inner one has winding number 2 and is solid.
    let solid = cube(3.0).joined(&cube(2.0));
    assert_eq!(penetrates(&solid, &cube(2.0), here), Penetrates::Yes);
    // A membrane of two sheets has no interior.
    let sheet = solids::plane_grid(2, 2);
    let membrane = sheet.clone().joined(&flipped(sheet));
    assert_eq!(penetrates(&cube(3.0), &membrane, here), Penetrates::No);
    assert_eq!(penetrates(&cube(1.0), &membrane, here), Penetrates::No);
    assert_eq!(penetrates(&cube(3.0), &membrane.joined(&cube(1.0)), here), Penetrates::Yes);
}

#[test]
fn round_bodies_that_touch_in_points_do_not_penetrate() {
    let ball = sphere();
    let top = ball.vertices.iter().fold([f64::MIN; 3], |top, &v| if v[2] > top[2] { v } else { top });
    let upon = moved(ball.clone(), [0.0, 0.0, 2.0 * top[2]]);
    let here = [Affine::IDENTITY; 2];
    assert!(query::intersects(&engine(&ball), &engine(&upon)));
    assert_eq!(penetrates(&ball, &upon, here), Penetrates::No);
    assert_eq!(penetrates(&ball, &moved(ball.clone(), [0.0, 0.0, 2.0 * top[2] - 1e-12]), here), Penetrates::Yes);
    assert_eq!(penetrates(&ball, &ball, here), Penetrates::Yes);
    // A corner of one body on the inner side of a face of the other.
    let box_of_it = solids::cuboid([-5.0; 3], [5.0, 5.0, top[2]]);
    assert_eq!(penetrates(&box_of_it, &ball, here), Penetrates::Yes);
    let lid = solids::cuboid([-5.0, -5.0, top[2]], [5.0; 3]);
    assert_eq!(penetrates(&lid, &ball, here), Penetrates::No);
}

#[test]
fn overlapping_shells_are_never_answered_wrongly() {
    // Boxes of one mesh intersect each other. The answer may be undecided there.
    let mut rng = Rng::new(9);
    let mut counts = [0; 3];
    for case in 0..300 {
        let mut boxes = |count: usize| -> Vec<[[i64; 3]; 2]> {
            let mut corners = || {
                let low: [i64; 3] = std::array::from_fn(|_| rng.integer(0, 4));
                [low, std::array::from_fn(|k| low[k] + rng.integer(1, 3))]
            };
            (0..count).map(|_| corners()).collect()
        };
        let (a, b) = (boxes(3), boxes(2));
        let overlap = a.iter().any(|p| b.iter().any(|q| (0..3).all(|k| p[0][k].max(q[0][k]) < p[1][k].min(q[1][k]))));
        let joined = |boxes: &[[[i64; 3]; 2]]| {
            let cuboids = boxes.iter().map(|corners| {
                let [low, high] = corners.map(|corner| corner.map(|x| x as f64));
                solids::cuboid(low, high)
            });
            cuboids.reduce(|all, one| all.joined(&one)).expect("some")
        };
        let answer = penetrates(&joined(&a), &joined(&b), [Affine::IDENTITY; 2]);
        assert!(answer == Penetrates::Undecided || answer == yes_or_no(overlap), "case {case}: {a:?} {b:?}");
        counts[answer as usize] += 1;
    }
    assert!(counts[0] > 10 && counts[2] > 100, "{counts:?}");
}

#[test]
fn empty_meshes_have_no_interior() {
    assert_eq!(penetrates(&Mesh::default(), &sphere(), [Affine::IDENTITY; 2]), Penetrates::No);
}

/// Copies of a body in one place add faces at every edge, and a contact for each pair of them. They
/// enclose the same points.
#[test]
fn bodies_that_coincide_many_times_answer_as_one() {
    const COPIES: usize = 12;
    let copies = |mesh: &Mesh| (1..COPIES).fold(mesh.clone(), |all, _| all.joined(mesh));
    let mut rng = Rng::new(50);
    let mut counts = [0; 3];
    for case in 0..60 {
        let mut offset = || rng.integer(-2, 2) as f64;
        let (a, b) = (
            solids::cuboid([0.0; 3], [2.0; 3]),
            moved(solids::cuboid([0.0; 3], [2.0; 3]), [offset(), offset(), offset()]),
        );
        let expected = penetrates(&a, &b, [Affine::IDENTITY; 2]);
        let answer = penetrates(&copies(&a), &copies(&b), [Affine::IDENTITY; 2]);
        assert_eq!(answer, expected, "case {case}");
        counts[answer as usize] += 1;
    }
    assert!(counts[0] > 10 && counts[2] > 10, "{counts:?}");
}

//! Repairs solids that were damaged on purpose. The repair must restore them.

use impinge_testkit::generate::{Rng, bricks, solids};

use super::*;
use crate::Positions;
use crate::mesh::Containment;

fn mesh(vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(Positions::F64(vertices), faces).expect("a valid mesh")
}

fn oriented(mesh: &Mesh) -> (Mesh, Repair) {
    mesh.repaired(RepairOptions { weld: 0.0, orient: true }).expect("a valid tolerance")
}

fn welded(mesh: &Mesh, weld: f64) -> (Mesh, Repair) {
    mesh.repaired(RepairOptions { weld, orient: false }).expect("a valid tolerance")
}

/// Turns random faces, each with a chance of `percent` in a hundred.
fn turn(rng: &mut Rng, faces: &mut [[u32; 3]], percent: i64) {
    faces.iter_mut().filter(|_| rng.integer(0, 99) < percent).for_each(|face| face.swap(1, 2));
}

/// Returns a brick of the lattice, hollow or not. Its outer surface and that of its cavity are
/// closed.
fn hollow_brick(rng: &mut Rng) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let outer = bricks::Brick::new([0; 3], [4, 5, 6]);
    let inner = bricks::Brick::new([1; 3], [2, 3, 4]).turned();
    let both = [outer, inner];
    let shown = if rng.integer(0, 1) == 0 { &both[..] } else { &both[..1] };
    let made = bricks::mesh(rng, shown, bricks::Cut::ByChance);
    (made.vertices, made.faces)
}

#[test]
fn turned_faces_are_turned_back() {
    let mut rng = Rng::new(4701);
    let mut turned_some = 0;
    for _ in 0..300 {
        let (vertices, given) = hollow_brick(&mut rng);
        let mut faces = given.clone();
        turn(&mut rng, &mut faces, 10);
        // All faces have the same area. The first 296 are the outer side.
        let turned = |range: std::ops::Range<usize>| range.filter(|&face| faces[face] != given[face]).count();
        let len = given.len();
        if turned(0..296) > 74 || turned(296..len) > (len - 296) / 4 {
            continue;
        }
        let bad = mesh(vertices.clone(), faces);
        let (repaired, repair) = oriented(&bad);
        let expected: Vec<u32> =
            (0..).zip(bad.faces()).zip(&given).filter(|((_, a), b)| a != b).map(|((n, _), _)| n).collect();
        assert_eq!(repair.turned_faces, expected);
        assert!(repair.one_sided_faces.is_empty() && repaired.is_closed());
        assert_eq!(repaired.faces(), given);
        turned_some += usize::from(!repair.turned_faces.is_empty());
        assert_eq!(oriented(&repaired).1, Repair::default(), "nothing is left to do");
    }
    assert!(turned_some > 250, "{turned_some}");
}

#[test]
fn half_of_the_faces_turned_is_outward() {
    let mut rng = Rng::new(4702);
    for round in 0..200 {
        let cube = solids::cuboid([1.0, 2.0, 3.0], [2.0, 4.0, 9.0]);
        let mut faces = cube.faces.clone();
        if round % 2 == 0 {
            turn(&mut rng, &mut faces, 50);
        } else {
            faces.iter_mut().for_each(|face| face.swap(1, 2)); // inside out as a whole
        }
        let (repaired, _) = oriented(&mesh(cube.vertices, faces));
        assert_eq!(repaired.faces(), cube.faces, "outward as the cuboid was made");
        assert_eq!(repaired.contains(&[[1.5, 3.0, 5.0]]), Ok(vec![Containment::Inside]));
    }
}

#[test]
fn cavities_stay_cavities_when_all_is_turned() {
    let mut rng = Rng::new(4703);
    let both = [bricks::Brick::new([0; 3], [9; 3]), bricks::Brick::new([3; 3], [6; 3]).turned()];
    let made = bricks::mesh(&mut rng, &both, bricks::Cut::Whole);
    let mut inside_out = made.faces.clone();
    inside_out.iter_mut().for_each(|face| face.swap(1, 2));
    let (repaired, repair) = oriented(&mesh(made.vertices, inside_out));
    assert_eq!(repair.turned_faces.len(), made.faces.len());
    assert_eq!(repaired.faces(), made.faces);
    assert_eq!(repaired.contains(&[[4.5; 3]]), Ok(vec![Containment::Outside]));
}

#[test]
fn bodies_with_vertices_of_their_own_may_share_a_wall() {
    // Both cut the wall between them alike, so that four faces have each of its edges by position.
    let [left, right] = [0.0, 1.0].map(|x| solids::cuboid([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]));
    let mut rng = Rng::new(4704);
    let mut vertices = left.vertices;
    vertices.extend(right.vertices);
    let mut given = left.faces;
    given.extend(right.faces.iter().map(|face| face.map(|vertex| vertex + 8)));
    let mut turned = 0;
    for _ in 0..50 {
        let mut faces = given.clone();
        turn(&mut rng, &mut faces, 20);
        let (repaired, repair) = oriented(&mesh(vertices.clone(), faces));
        assert_eq!(repaired.faces(), given);
        turned += repair.turned_faces.len();
    }
    assert!(turned > 150, "{turned} of 1200 faces were turned");
}

#[test]
fn one_sided_sheets_are_reported_and_kept() {
    // Five quadrilaterals in a ring; the last one joins the first upside down.
    let vertices: Vec<[f64; 3]> = (0..10)
        .map(|i| {
            let (angle, half) =
                (f64::from(i / 2) * std::f64::consts::TAU / 5.0, f64::from(i / 2) * std::f64::consts::PI / 5.0);
            let (out, up) = (f64::from(2 * (i % 2) - 1) * half.cos(), f64::from(2 * (i % 2) - 1) * half.sin());
            [(3.0 + out) * angle.cos(), (3.0 + out) * angle.sin(), up]
        })
        .collect();
    let ring = |i: u32| if i < 10 { i } else { [1, 0][i as usize - 10] };
    let faces: Vec<[u32; 3]> = (0..5)
        .map(|quad| [2 * quad, 2 * quad + 1, 2 * quad + 2, 2 * quad + 3].map(ring))
        .flat_map(|[a, b, c, d]| [[a, b, c], [b, d, c]])
        .collect();
    let strip = mesh(vertices, faces);
    let (repaired, repair) = oriented(&strip);
    assert_eq!(repaired.faces(), strip.faces());
    assert_eq!((repair.turned_faces.len(), repair.one_sided_faces.len()), (0, 10));
}

#[test]
fn cracks_are_welded_and_nothing_moves_too_far() {
    let mut rng = Rng::new(4705);
    for _ in 0..200 {
        let cube = solids::cuboid([0.0; 3], [1.0; 3]);
        // Each face has corners of its own, displaced by less than half of the tolerance.
        let tolerance = 10.0_f64.powi(rng.integer(-12, -5) as i32);
        let off = |rng: &mut Rng, x: f64| x + tolerance * rng.uniform(-0.25, 0.25);
        let vertices: Vec<[f64; 3]> =
            cube.faces.iter().flatten().map(|&v| cube.vertices[v as usize].map(|x| off(&mut rng, x))).collect();
        let cracked = mesh(vertices.clone(), (0..12).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect());
        assert!(!cracked.is_closed());
        let closing = cracked.closing_tolerance().expect("it closes");
        assert!(closing <= 10.0 * tolerance, "{closing} of {tolerance}");
        for weld in [tolerance, closing] {
            let (repaired, repair) = welded(&cracked, weld);
            assert!(repaired.is_closed() && repair.greatest_move <= weld && repair.greatest_move > 0.0);
            assert_eq!(repaired.faces(), cracked.faces());
            for (vertex, before) in vertices.iter().enumerate() {
                let after = repaired.positions().get(vertex);
                let is_moved = repair.welded_vertices.binary_search(&(vertex as u32)).is_ok();
                assert_eq!(is_moved, after != *before);
                let far = (0..3).map(|k| (after[k] - before[k]).powi(2)).sum::<f64>().sqrt();
                assert!(far <= weld * (1.0 + 1e-9));
            }
        }
        assert!(welded(&cracked, 1e-3 * tolerance).1.welded_vertices.len() < 6, "hardly any are that near by chance");
    }
}

#[test]
fn welding_equals_brute_force() {
    let mut rng = Rng::new(4706);
    let mut moved = 0;
    for round in 0..300 {
        // On a grid, so that many distances are equal, or equal to the tolerance.
        let step = [1.0, 1e-300, 1e30, 1.0 / 3.0][round % 4];
        let vertices: Vec<[f64; 3]> = (0..60).map(|_| [0; 3].map(|_| step * rng.integer(-4, 4) as f64)).collect();
        let tolerance = step * [1.0, 1.5, 2.0][round % 3];
        let faces = (0..20).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        let (repaired, repair) = welded(&mesh(vertices.clone(), faces), tolerance);
        let mut stayed: Vec<[f64; 3]> = Vec::new();
        for (vertex, at) in vertices.iter().enumerate() {
            let distance = |to: &[f64; 3]| (0..3).map(|k| ((at[k] - to[k]) / tolerance).powi(2)).sum::<f64>().sqrt();
            // The first of equally near vertices.
            let nearest = stayed.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied();
            let expected = nearest.filter(|to| distance(to) <= 1.0).unwrap_or(*at);
            if expected == *at && !stayed.contains(at) {
                stayed.push(*at);
            }
            assert_eq!(repaired.positions().get(vertex), expected, "{vertex} of {vertices:?}");
        }
        moved += repair.welded_vertices.len();
    }
    assert!(moved > 1_000, "{moved}");
}

#[test]
fn tolerances_of_any_size_are_fast() {
    let vertices: Vec<[f64; 3]> = (0..30_000).map(|i| [f64::from(i) * 1e-30, 1e38, -1e-38]).collect();
    let faces = (0..10_000).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    let line = mesh(vertices, faces);
    for (tolerance, moved) in [(5e-324, 0), (1e-300, 0), (1e-31, 0), (1e30, 29_999), (f64::MAX, 29_999)] {
        assert_eq!(welded(&line, tolerance).1.welded_vertices.len(), moved, "{tolerance}");
    }
    for tolerance in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(line.repaired(RepairOptions { weld: tolerance, orient: false }).is_err());
    }
}

#[test]
fn remaining_defects_are_reported() {
    let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1e-9, 0.0]];
    let (_, repair) = welded(&mesh(vertices, vec![[0, 1, 2], [2, 0, 3], [0, 1, 3]]), 1e-6);
    assert_eq!((repair.welded_vertices, repair.greatest_move), (vec![3], 1e-9));
    assert_eq!((repair.duplicate_faces, repair.degenerate_faces), (vec![1], vec![2]));
}

#[test]
fn a_needle_in_a_closed_sheet_does_not_open_it() {
    // Three vertices at one position, and a face between two of them. By vertex numbers only one of
    // its sides has a neighbor.
    let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let outward = [[0, 5, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [2, 1, 4]];
    let inside_out = outward.map(|[a, b, c]| [a, c, b]);
    let bad = mesh(vec![o, x, y, z, y, y], inside_out.to_vec());
    assert!(bad.is_closed());
    let (repaired, repair) = oriented(&bad);
    assert_eq!(repair.turned_faces, [0, 1, 2, 3, 4]);
    assert_eq!(repaired.faces(), outward);
}

#[test]
fn a_tolerance_that_closes_no_crack_is_not_returned() {
    let near = |x: f64| [x * 1e-6, 0.0, 0.0];
    // A tetrahedron with a crack of 0.9e-6 at one corner, and a vertex of another one that attracts
    // one side of the crack.
    let vertices = vec![
        near(1.4),
        [5.0, 5.0, 5.0],
        [5.0, 6.0, 5.0],
        [6.0, 5.0, 5.0],
        near(0.0),
        near(0.9),
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let closed = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let cracked = [[4, 7, 6], [5, 6, 8], [4, 8, 7], [6, 7, 8]];
    let both = mesh(vertices, closed.into_iter().chain(cracked).collect());
    let closing = both.closing_tolerance().expect("a larger one closes it");
    assert!(closing > 1.5e-6, "{closing}");
    assert!(welded(&both, closing).0.health().open_edges == 0);
}

//! `within` at exactly the clearance, and one float to either side of the distance.

use impinge::exact::{Placement, triangles_within};
use impinge::query;
use impinge_testkit::Affine;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::{large_integer_map, rotation};
use impinge_testkit::generate::solids::{cuboid, grid_soup};

use crate::distance::meshes::{all_pairs, images, least};
use crate::distance::oracle::{image, rational, squared_distance};
use crate::distance::ways::{engine_mesh, engine_pose, within_in_every_way};

#[test]
fn boxes_at_exactly_the_clearance_are_within() {
    // The distances are 5, 13 and 7 by Pythagoras: across an edge, and corner to corner.
    let cube = engine_mesh(&cuboid([0.0; 3], [1.0; 3]));
    for (step, distance) in [([4.0, 5.0, 0.5], 5.0), ([4.0, 5.0, 13.0], 13.0), ([3.0, -4.0, 7.0], 7.0)] {
        for scale in [1e-6, 1e-3, 1.0, 1024.0] {
            let scaled = Affine::new([[scale, 0.0, 0.0], [0.0, scale, 0.0], [0.0, 0.0, scale]], [0.0; 3]);
            let moved = Affine::new(scaled.linear, step.map(|x: f64| x * scale));
            let truth = images(&cuboid([0.0; 3], [1.0; 3]), &moved);
            let pairs = all_pairs(&images(&cuboid([0.0; 3], [1.0; 3]), &scaled)[..], &truth[..]);
            let clearance = distance * scale;
            for clearance in [clearance.next_down(), clearance, clearance.next_up()] {
                let expected = *least(&pairs) <= rational(clearance) * rational(clearance);
                assert_eq!(within_in_every_way((&cube, &scaled), (&cube, &moved), clearance), expected);
                if scale == 1.0 || scale == 1024.0 {
                    assert_eq!(expected, clearance >= distance * scale, "these numbers are exact");
                }
            }
        }
    }
}

#[test]
fn soups_are_within_their_distance_and_not_within_less() {
    let (mut within, mut asked) = (0, 0);
    for seed in 0..40 {
        let mut rng = Rng::new(900 + seed);
        let (a, b) = (grid_soup(&mut rng, 4, 4, 2), grid_soup(&mut rng, 4, 4, 2));
        let (pose_a, pose_b) = match seed % 4 {
            0 => (Affine::IDENTITY, Affine::translation([rng.integer(0, 9) as f64, 5.0, 0.0])),
            1 => (large_integer_map(&mut rng), large_integer_map(&mut rng)),
            _ => (rotation(&mut rng), rotation(&mut rng)),
        };
        let pairs = all_pairs(&images(&a, &pose_a), &images(&b, &pose_b));
        let squared = least(&pairs);
        let root = squared.to_f64().value().sqrt();
        let (mesh_a, mesh_b) = (engine_mesh(&a), engine_mesh(&b));
        for clearance in [root.next_down().next_down(), root.next_down(), root, root.next_up(), root * 1.5, 0.0] {
            let expected = clearance >= 0.0 && *squared <= rational(clearance) * rational(clearance);
            let found = within_in_every_way((&mesh_a, &pose_a), (&mesh_b, &pose_b), clearance);
            assert_eq!(found, expected, "seed {seed} at {clearance:e}");
            within += usize::from(found);
            asked += 1;
        }
    }
    assert!((asked / 4..asked * 3 / 4).contains(&within), "{within} of {asked}");
}

#[test]
fn triangles_within_is_the_rational_comparison() {
    let mut rng = Rng::new(77);
    let (mut equal, mut near) = (0, 0);
    for case in 0..400 {
        let mut triangle = || [[0; 3]; 3].map(|p| p.map(|_: i32| rng.integer(0, 5) as f64));
        let (a, b) = (triangle(), triangle());
        let pose = if case % 2 == 0 { Affine::IDENTITY } else { Affine::translation([6.0, 0.0, 0.25]) };
        let placement = Placement::new(&engine_pose(&Affine::IDENTITY), &engine_pose(&pose));
        let squared = squared_distance(&a.map(|p| image(&Affine::IDENTITY, p)), &b.map(|p| image(&pose, p)));
        let root = squared.to_f64().value().sqrt();
        for clearance in [root.next_down(), root, root.next_up(), 1.0, 2.0] {
            let limit = rational(clearance) * rational(clearance);
            let expected = clearance >= 0.0 && squared <= limit;
            assert_eq!(triangles_within(&placement, &a, &b, clearance), expected, "{a:?} {b:?} {clearance}");
            equal += usize::from(squared == limit && clearance > 0.0);
            near += usize::from(expected);
        }
    }
    assert!(equal > 15 && near > 200, "{equal} {near}");
}

#[test]
fn nothing_is_within_a_negative_or_nan_clearance() {
    let cube = engine_mesh(&cuboid([0.0; 3], [1.0; 3]));
    assert!(query::within(&cube, &cube, 0.0));
    for invalid in [-1.0, -f64::MIN_POSITIVE, f64::NAN, f64::NEG_INFINITY] {
        assert!(!query::within(&cube, &cube, invalid));
    }
    assert!(query::within(&cube, &cube, f64::INFINITY));
}

/// Checks two plates whose faces all have the same distance up to the last bits.
#[test]
fn plates_of_many_ties_agree_with_all_pairs() {
    let n = 5;
    let vertices: Vec<[f64; 3]> = (0..n * n).map(|i| [f64::from(i % n), f64::from(i / n), 0.0]).collect();
    let corners = (0..n * n).filter(|i| i % n < n - 1 && i / n < n - 1).map(|i| i as u32);
    let n = n as u32;
    let faces = corners.flat_map(|i| [[i, i + 1, i + n + 1], [i, i + n + 1, i + n]]).collect();
    let plate = impinge_testkit::Mesh { vertices, faces };
    let mesh = engine_mesh(&plate);
    let mut rng = Rng::new(4710);
    let mut within = 0;
    for round in 0..24 {
        let turn = if round % 2 == 0 { Affine::IDENTITY } else { rotation(&mut rng) };
        let gap: f64 = [0.1 + 0.2, 0.25, 1.0 / 3.0][round % 3];
        let shift = [[0.25, 0.25, gap], [0.0, 0.0, gap], [0.5, 0.0, gap]][round / 3 % 3];
        let moved = [0, 1, 2].map(|i| (0..3).map(|k| turn.linear[i][k] * shift[k]).sum::<f64>());
        let upper = Affine { linear: turn.linear, translation: moved };
        let placement = Placement::new(&engine_pose(&turn), &engine_pose(&upper));
        for clearance in [gap.next_down(), gap, gap.next_up(), 0.5 * gap, gap + 1e-15] {
            let corners = |face: u32| mesh.corners(face);
            let numbers = 0..mesh.faces().len() as u32;
            let expected = numbers
                .clone()
                .any(|a| numbers.clone().any(|b| triangles_within(&placement, &corners(a), &corners(b), clearance)));
            assert_eq!(
                within_in_every_way((&mesh, &turn), (&mesh, &upper), clearance),
                expected,
                "{round} {clearance}"
            );
            within += usize::from(expected);
        }
    }
    assert!((20..100).contains(&within), "{within} of 120");
}

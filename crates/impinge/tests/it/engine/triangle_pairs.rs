//! Single pairs of triangles with many ties, against linear programming in integers: directly, and
//! through whole meshes.

use impinge_testkit::Mesh;
use impinge_testkit::cases::Precision;
use impinge_testkit::generate::pairs::{TrianglePair, tie_heavy, under_large_integer_maps, under_rotations};
use impinge_testkit::oracle::triangles_meet;

use crate::engine::ways::{engine_mesh, engine_pose};
use impinge::exact::{Placement, triangles_intersect};
use impinge::query;

const PAIRS: usize = 60_000;

fn wrong(pairs: impl Iterator<Item = TrianglePair>, truth: impl Iterator<Item = TrianglePair>) -> (usize, usize) {
    let (mut wrong, mut hits) = (0, 0);
    for (pair, plain) in pairs.zip(truth) {
        // The maps do not change the answer for the plain pair, which the oracle finds faster.
        let expected = triangles_meet(&plain.a, &plain.world_from_a, &plain.b, &plain.world_from_b);
        let placement = Placement::new(&engine_pose(&pair.world_from_a), &engine_pose(&pair.world_from_b));
        wrong += usize::from(triangles_intersect(&placement, &pair.a, &pair.b) != expected);
        hits += usize::from(expected);
    }
    (wrong, hits)
}

#[test]
fn tie_heavy_pairs_under_large_integer_maps_are_never_wrong() {
    let (wrong, hits) = wrong(under_large_integer_maps(11, PAIRS), tie_heavy(11, PAIRS));
    assert_eq!(wrong, 0, "of {PAIRS} pairs");
    assert!((PAIRS * 3 / 10..PAIRS * 9 / 10).contains(&hits), "{hits} of {PAIRS} pairs intersect");
}

#[test]
fn tie_heavy_pairs_are_decided_by_the_whole_engine() {
    // Each pair is two meshes of one triangle. The descent and the filter decide, or pass the pair
    // to the exact stage.
    const FEW: usize = 4_000;
    let mut hits = 0;
    let sets = under_large_integer_maps(5, FEW).zip(tie_heavy(5, FEW)).chain(tie_heavy(6, FEW).zip(tie_heavy(6, FEW)));
    for (pair, plain) in sets {
        let mesh = |corners: [[f64; 3]; 3]| Mesh { vertices: corners.to_vec(), faces: vec![[0, 1, 2]] };
        let (a, b) = (engine_mesh(&mesh(pair.a), Precision::F64), engine_mesh(&mesh(pair.b), Precision::F64));
        let expected = triangles_meet(&plain.a, &plain.world_from_a, &plain.b, &plain.world_from_b);
        let found = query::intersects(a.at(engine_pose(&pair.world_from_a)), b.at(engine_pose(&pair.world_from_b)));
        assert_eq!(found, expected, "{pair:?}");
        hits += usize::from(expected);
    }
    assert!((2 * FEW * 3 / 10..2 * FEW * 9 / 10).contains(&hits), "{hits} of {} pairs intersect", 2 * FEW);
}

#[test]
fn rotated_pairs_agree_with_the_oracle() {
    const FEW: usize = 3_000;
    let mut hits = 0;
    for pair in under_rotations(7, FEW) {
        let expected = triangles_meet(&pair.a, &pair.world_from_a, &pair.b, &pair.world_from_b);
        let placement = Placement::new(&engine_pose(&pair.world_from_a), &engine_pose(&pair.world_from_b));
        assert_eq!(triangles_intersect(&placement, &pair.a, &pair.b), expected, "{pair:?}");
        hits += usize::from(expected);
    }
    assert!((FEW / 4..FEW * 9 / 10).contains(&hits), "{hits} of {FEW} pairs intersect");
}

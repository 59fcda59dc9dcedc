//! Positions in double precision whose detail single precision cannot hold. Packets round it, but
//! answers stay exact.

use impinge_testkit::cases::Precision;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::rotation;
use impinge_testkit::generate::solids::grid_soup;
use impinge_testkit::{Affine, Mesh, oracle};

use crate::engine::ways::posed_pairs_in_every_way;

/// Returns the mesh with every coordinate times `unit`, plus `aside`. Panics if that rounds.
fn moved(mesh: &Mesh, unit: f64, aside: f64) -> Mesh {
    let mut moved = mesh.clone();
    for x in moved.vertices.as_flattened_mut() {
        let to = *x * unit + aside;
        assert_eq!((to - aside) / unit, *x, "rounded");
        *x = to;
    }
    moved
}

fn same_in_single_precision(mesh: &Mesh) -> bool {
    let corners: Vec<[f32; 3]> = mesh.vertices.iter().map(|v| v.map(|x| x as f32)).collect();
    corners.iter().all(|corner| *corner == corners[0])
}

/// Checks soups on a grid of spacing `unit`, moved by `aside` from the origin: unturned against the
/// answer at the origin, and turned against the oracle.
fn details_decide(unit: f64, aside: f64) {
    let (mut met, mut turned_met) = (0, 0);
    for seed in 0..30 {
        let mut rng = Rng::new(seed);
        let [a, b] = [0; 2].map(|_| grid_soup(&mut rng, 60, 6, 2));
        let expected = oracle::brute_force(a.at(Affine::IDENTITY), b.at(Affine::IDENTITY));
        let [a, b] = [a, b].map(|mesh| moved(&mesh, unit, aside));
        assert!(same_in_single_precision(&a), "single precision holds this");
        let posed = (a.at(Affine::IDENTITY), b.at(Affine::IDENTITY));
        assert_eq!(posed_pairs_in_every_way(posed.0, posed.1, Precision::F64), expected, "seed {seed}");
        met += usize::from(!expected.is_empty());

        // Both are turned about the origin by one rotation. Their images have coordinates that no
        // float holds.
        let turn = rotation(&mut rng);
        let turned = posed_pairs_in_every_way(a.at(turn), b.at(turn), Precision::F64);
        assert_eq!(turned, oracle::brute_force(a.at(turn), b.at(turn)), "seed {seed}, turned");
        turned_met += usize::from(!turned.is_empty());
    }
    assert!(met >= 20 && turned_met >= 20, "{met} and {turned_met} of 30 soups intersect");
}

#[test]
fn tenths_of_a_millimeter_decide_10000_km_from_the_origin() {
    details_decide(1.0 / 8192.0, 1e7);
}

#[test]
fn detail_below_single_precision_decides() {
    details_decide(1.0 / (1_u64 << 38) as f64, 1.0);
}

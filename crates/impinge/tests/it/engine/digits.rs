//! Positions in double precision whose detail single precision cannot hold: packets blur it, answers do not.

use impinge_testkit::cases::Precision;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::rotation;
use impinge_testkit::generate::solids::grid_soup;
use impinge_testkit::{Affine, Mesh, oracle};

use crate::engine::ways::posed_pairs_in_every_way;

/// The mesh with every coordinate times `unit` and then moved by `aside`, where that rounds nothing.
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

/// Soups on a grid of this unit, `aside` from the origin: as at the origin, and turned as the oracle says.
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

        // Turned alike about the origin, where images are no numbers that a float could hold.
        let turn = rotation(&mut rng);
        let turned = posed_pairs_in_every_way(a.at(turn), b.at(turn), Precision::F64);
        assert_eq!(turned, oracle::brute_force(a.at(turn), b.at(turn)), "seed {seed}, turned");
        turned_met += usize::from(!turned.is_empty());
    }
    assert!(met >= 20 && turned_met >= 20, "{met} and {turned_met} of 30 soups meet");
}

#[test]
fn n5_tenths_of_a_millimetre_ten_thousand_kilometres_away() {
    details_decide(1.0 / 8192.0, 1e7);
}

#[test]
fn n6_detail_of_a_billionth_of_the_place() {
    details_decide(1.0 / (1_u64 << 38) as f64, 1.0);
}

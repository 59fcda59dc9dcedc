//! The human mesh of the repository, under small steps and arbitrary turns.

use impinge::Pose;
use impinge::hull::Hull;
use impinge_testkit::generate::Rng;

use crate::realign::ways::{Ways, any_rotation};

/// Returns the vertices of the human mesh.
fn human() -> Vec<[f64; 3]> {
    let bytes = include_bytes!("../../../../../data/human_makehuman_cc0.ply");
    let end = b"end_header\n";
    let start = bytes.windows(end.len()).position(|window| window == end).expect("a header") + end.len();
    let coordinate = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes")));
    bytes[start..]
        .chunks_exact(12)
        .take(13_380)
        .map(|vertex| [coordinate(&vertex[..4]), coordinate(&vertex[4..8]), coordinate(&vertex[8..])])
        .collect()
}

#[test]
fn boxes_of_the_turning_human_are_exact() {
    let points = human();
    let hull = Hull::new(&points).expect("legal");
    let mut ways = Ways::new(&points, &hull, [0.0, 0.9, 0.0]);
    let mut rng = Rng::new(61);
    for case in 0..150 {
        ways.check(&any_rotation(&mut rng, [0.1 * f64::from(case), -3.0, 1e3]));
    }
    let step = Pose::from_axis_angle([1.0, -2.0, 0.5], 0.02, [0.001, 0.0, 0.0]).expect("legal");
    let mut pose = Pose::IDENTITY;
    for _ in 0..150 {
        ways.check(&pose);
        pose = step.compose(&pose).expect("legal");
    }
}

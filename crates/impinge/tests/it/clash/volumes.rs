//! Volumes of common material, compared with the cells of a lattice.

use impinge::query;
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::bricks::{self, Cut, Scene, windings};
use impinge_testkit::generate::solids::{cuboid, icosphere};

/// Returns the volume that the insides of both sets of bricks share. Cells overlap by halves.
fn volume_of_cells(scene: &Scene) -> f64 {
    let [a, b] = [0, 1].map(|side| windings(&scene.bricks[side]));
    let overlap = |p: i64, q: i64, step: i64| 0.5 * (2 - (2 * p - 2 * q - step).abs()).max(0) as f64;
    let pairs = a.keys().flat_map(|p| b.keys().map(move |q| (p, q)));
    pairs.map(|(p, q)| (0..3).map(|k| overlap(p[k], q[k], scene.half_steps[k])).product::<f64>()).sum()
}

fn mesh(solid: impinge_testkit::Mesh) -> Mesh {
    Mesh::new(Positions::F64(solid.vertices), solid.faces).unwrap()
}

#[test]
fn volumes_of_bricks_are_those_of_the_lattice() {
    let mut rng = Rng::new(21);
    let turned = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [4.0, -2.0, 1.0]).unwrap();
    let (mut filled, mut narrow, mut count) = (0, 0, 0);
    for round in 0..400 {
        let scene = Scene::random(&mut rng);
        let cut = rng.choose(&[Cut::AsLattice, Cut::ByChance, Cut::Whole]);
        let [a, b] = scene.bricks.each_ref().map(|heap| mesh(bricks::mesh(&mut rng, heap, cut)));
        let step = Pose::from_translation(scene.half_steps.map(|step| 0.5 * step as f64)).unwrap();
        let world = if round % 2 == 0 { Pose::IDENTITY } else { turned };
        let found = query::common_volume(a.at(world), b.at(world.compose(&step).unwrap())).unwrap();
        let expected = volume_of_cells(&scene);
        assert!(found.lower <= expected + 1e-9 && expected <= found.upper + 1e-9, "{round}: {found:?} {expected}");
        let swapped = query::common_volume(b.at(world.compose(&step).unwrap()), a.at(world)).unwrap();
        assert_eq!(found, swapped);
        count += 1;
        filled += usize::from(expected > 0.0);
        narrow += usize::from(found.is_proved && found.upper - found.lower < 1e-6);
    }
    assert!(filled > 40 && narrow * 10 > count * 9, "{filled} {narrow}");
}

#[test]
fn the_volume_of_a_ball_in_a_block_is_bounded() {
    let ball = mesh(icosphere(2));
    // The block has the eighth of the ball with positive coordinates.
    let block = mesh(cuboid([0.0; 3], [2.0; 3]));
    let volume: f64 = (0..ball.faces().len() as u32)
        .map(|face| {
            let [[a, b, c], [d, e, f], [g, h, i]] = ball.corners(face);
            (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)) / 6.0
        })
        .sum();
    let found = query::common_volume(&ball, &block).unwrap();
    assert!(found.lower <= volume / 8.0 + 1e-9 && volume / 8.0 <= found.upper + 1e-9, "{found:?} {volume}");
    assert!(found.upper - found.lower < 0.05 * volume, "{found:?}");
}

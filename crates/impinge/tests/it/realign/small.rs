//! Small sets with many ties, under rotations that keep ties, shears, far offsets and every scale.

use impinge::Pose;
use impinge::hull::Hull;
use impinge::volume::realign::{LooseBox, Realign, RotatedBox};
use impinge::volume::{BoundingVolume, MinMax};
use impinge_testkit::generate::{Rng, poses};

use crate::realign::ways::{Ways, any_rotation, turned};

/// Returns points of a coarse grid with many duplicates, at one of several scales and offsets.
fn points(rng: &mut Rng, case: usize) -> Vec<[f64; 3]> {
    let count = rng.integer(1, 40) as usize;
    let scale = [1.0, 0.1, 1e-6, 1e6][case % 4];
    let offset = [0.0, 0.0, 1e7][case % 3];
    (0..count).map(|_| std::array::from_fn(|_| offset + scale * rng.integer(-2, 2) as f64)).collect()
}

fn pose(rng: &mut Rng, case: usize) -> Pose {
    let translation = std::array::from_fn(|_| rng.choose(&[0.0, 1.0, -0.1, 1e7, 1e-9]));
    match case % 6 {
        // Axes map to axes, so every face of the grid is a plateau.
        0 => Pose::new(poses::cube_symmetry(rng), translation).expect("legal"),
        // Half of a right angle, and turns whose matrix has equal entries.
        1 => turned([1.0, 0.0, 0.0, std::f64::consts::SQRT_2 - 1.0], translation),
        2 => turned(std::array::from_fn(|k| if k == 0 { 3.0 } else { rng.integer(-1, 1) as f64 }), translation),
        3 => any_rotation(rng, translation),
        4 => {
            let map = poses::large_integer_map(rng);
            Pose::new(map.linear, map.translation).expect("legal")
        }
        // Nearly a plateau: a turn by a few units in the last place.
        _ => turned([1.0, rng.integer(-9, 9) as f64 * 1e-16, rng.integer(-9, 9) as f64 * 1e-16, 0.0], translation),
    }
}

#[test]
fn tight_methods_have_the_bits_of_the_exact_box() {
    let mut rng = Rng::new(51);
    let mut rounded = 0;
    for case in 0..4000 {
        let points = points(&mut rng, case);
        let hull = Hull::new(&points).expect("legal");
        let pivot = if case % 2 == 0 { [0.0; 3] } else { points[0] };
        let mut ways = Ways::new(&points, &hull, pivot);
        for turn in 0..4 {
            let pose = pose(&mut rng, case + turn);
            let exact = ways.check(&pose);
            // Rounding to nearest would cut a point off.
            let nearest = points.iter().map(|&point| pose.apply(point)).any(|image| !exact.contains(image));
            let inner = points.iter().map(|&point| pose.apply(point)).fold(0, |inner, image| {
                inner + usize::from((0..3).any(|k| exact.min()[k] == image[k] || exact.max()[k] == image[k]))
            });
            rounded += usize::from(nearest || inner == 0);
        }
    }
    assert!(rounded > 1000, "{rounded}");
}

/// Checks that 1,000 turns, each a little further, grow no box beyond the box of a single turn.
#[test]
fn boxes_do_not_grow_over_many_turns() {
    let bounds = MinMax::new([-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]).expect("legal");
    let corners = [[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]];
    let mut rotated = RotatedBox::new(&bounds);
    let mut loose = LooseBox::new(&corners, [0.0; 3]).expect("legal");
    let first = loose.realign(&Pose::IDENTITY);
    let step = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.01, [0.0; 3]).expect("legal");
    let mut pose = Pose::IDENTITY;
    let mut wrapped = bounds;
    for _ in 0..1000 {
        pose = step.compose(&pose).expect("legal");
        let turned = rotated.realign(&pose);
        assert!((0..3).all(|k| turned.max()[k] <= 6.0_f64.sqrt() * 2.5), "{turned:?}");
        assert_eq!(loose.realign(&pose), first);
        wrapped = wrapped.moved(&step).expect("in range");
    }
    // The documentation warns of this: a box around the previous box grows without limit.
    assert!(wrapped.max()[0] > 1000.0, "{wrapped:?}");
}

/// Checks poses and points of every valid size.
#[test]
fn boxes_of_extreme_sizes_are_exact() {
    let mut rng = Rng::new(53);
    for case in 0..600 {
        let powers = [-120, -60, 0, 60, 126];
        let scale = 2f64.powi(powers[case % 5]);
        let points: Vec<[f64; 3]> =
            (0..9).map(|_| std::array::from_fn(|_| scale * rng.integer(-3, 3) as f64 / 2.0)).collect();
        let stretch = 2f64.powi([-63, 0, 63][case / 5 % 3]);
        let linear = any_rotation(&mut rng, [0.0; 3]).linear().map(|row| row.map(|x| x * stretch));
        let translation = std::array::from_fn(|_| rng.choose(&[0.0, 2f64.powi(300), -(2f64.powi(-300)), 1.0]));
        let Ok(pose) = Pose::new(linear, translation) else { continue };
        let hull = Hull::new(&points).expect("legal");
        Ways::new(&points, &hull, points[0]).check(&pose);
    }
}

/// Checks that batches give the same boxes as single calls.
#[test]
fn batches_give_the_same_boxes_as_single_calls() {
    let mut rng = Rng::new(54);
    let boxes: Vec<RotatedBox> =
        (0..1001).map(|case| RotatedBox::new(&MinMax::of(&points(&mut rng, case)).expect("legal"))).collect();
    let poses: Vec<Pose> = (0..1001).map(|case| pose(&mut rng, case)).collect();
    let mut images = vec![MinMax::of(&[[0.0; 3]]).expect("legal")];
    RotatedBox::realign_each(&boxes, &poses, &mut images);
    let single: Vec<MinMax> = boxes.iter().zip(&poses).map(|(one, pose)| one.clone().realign(pose)).collect();
    assert_eq!(images, single);
    RotatedBox::realign_all(&boxes, &poses[7], &mut images);
    let single: Vec<MinMax> = boxes.iter().map(|one| one.clone().realign(&poses[7])).collect();
    assert_eq!(images, single);
    RotatedBox::realign_each(&boxes[..5], &poses[..3], &mut images);
    assert_eq!(images.len(), 3);
}

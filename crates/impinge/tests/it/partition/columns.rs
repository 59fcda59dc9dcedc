//! The sweep of columns with thousands of boxes, and on several numbers of threads.

use impinge::partition::{BoxTree, ColumnSweep, Partition};
use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;

use crate::partition::brute;
use crate::partition::scenes::{ALL, Scene};

#[test]
fn pairs_of_every_scene_agree_with_brute_force() {
    // One finder serves all scenes, so that memory of earlier calls would show.
    let mut columns = ColumnSweep::new();
    let mut pairs = Vec::new();
    for scene in ALL {
        let mut rng = Rng::new(80);
        for count in [0, 1, 2, 40, 700, 2500] {
            let count = if scene == Scene::Coincident { count / 4 } else { count };
            let boxes: Vec<MinMax> = (0..count).map(|_| scene.draw(&mut rng)).collect();
            columns.find(&boxes, &mut pairs);
            let expected = brute::pairs(&(0..).zip(boxes.iter().copied()).collect());
            assert_eq!(pairs, expected, "{count} of {scene:?}");
            assert!(count < 700 / 4 || expected.len() > 100, "{} pairs in {scene:?}", expected.len());
        }
    }
}

/// Returns boxes in scenes that are hard for grids: flat, long, with a few large boxes among many
/// small ones, and of all sizes.
fn shaped(kind: usize, count: usize, rng: &mut Rng) -> Vec<MinMax> {
    let side = (8.0 * count as f64).cbrt();
    (0..count)
        .map(|at| {
            let size = match kind {
                3 => 0.5 / (1e-3 + rng.unit()),
                4 if at % 500 == 0 => 0.4 * side,
                _ => 1.0,
            };
            let place = match kind {
                0 => [rng.uniform(0.0, side), rng.uniform(0.0, 8.0 * side), 5.0],
                1 => [rng.uniform(0.0, 2.0 * count as f64), 0.0, 0.0],
                2 => [0.0, rng.uniform(0.0, 1.0), rng.uniform(0.0, 2.0 * count as f64)],
                _ => [0; 3].map(|_: i32| rng.uniform(0.0, if kind == 3 { 3.0 * side } else { side })),
            };
            let extent = [0; 3].map(|_: i32| size * rng.uniform(0.5, 1.5));
            MinMax::new(place, std::array::from_fn(|k| place[k] + extent[k])).expect("in range")
        })
        .collect()
}

#[test]
fn pairs_of_36000_boxes_agree_with_the_tree_on_any_number_of_threads() {
    let mut rng = Rng::new(81);
    for kind in 0..6 {
        let boxes = shaped(kind, 36_000, &mut rng);
        let expected = BoxTree::build(&boxes).pairs();
        assert!(expected.len() > 5000, "{} pairs in scene {kind}", expected.len());
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let mut pairs = Vec::new();
            pool.install(|| ColumnSweep::new().find(&boxes, &mut pairs));
            assert!(pairs == expected, "{threads} threads, scene {kind}: {} of {}", pairs.len(), expected.len());
        }
    }
}

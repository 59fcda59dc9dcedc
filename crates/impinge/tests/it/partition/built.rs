//! Partitions that are built at once from all boxes.

use impinge::partition::{KdTree, Partition};
use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;

use crate::partition::brute::{self, Boxes};
use crate::partition::kinds::built;
use crate::partition::scenes::ALL;

#[test]
fn every_kind_that_is_built_answers_as_brute_force() {
    for scene in ALL {
        let mut rng = Rng::new(90);
        for count in [0, 1, 9, 60, 400] {
            let boxes: Vec<MinMax> = (0..count).map(|_| scene.draw(&mut rng)).collect();
            let named: Boxes = (0..).zip(boxes.iter().copied()).collect();
            let questions = scene.questions(&mut rng, 12);
            let pairs = brute::pairs(&named);
            for (name, partition) in built(&boxes) {
                let name = format!("{name}, {count} of {scene:?}");
                assert_eq!(partition.pairs(), pairs, "{name}");
                let hits = brute::compare(&*partition, &named, &questions, &name);
                assert!(count < 400 || hits > 20, "{name}: {hits} found");
            }
        }
    }
}

#[test]
fn nearest_points_with_ties_agree_with_brute_force() {
    let mut rng = Rng::new(91);
    for coarse in [false, true] {
        let place = |rng: &mut Rng| -> [f64; 3] {
            [0; 3].map(|_: i32| if coarse { rng.integer(0, 6) as f64 } else { rng.uniform(0.0, 6.0) })
        };
        let points: Vec<[f64; 3]> = (0..2000).map(|_| place(&mut rng)).collect();
        let named = (0..).zip(points.iter().map(|&point| MinMax::new(point, point).expect("in range"))).collect();
        let tree = KdTree::of_points(&points).expect("finite");
        for _ in 0..200 {
            let point = place(&mut rng);
            for count in [1, 2, 17] {
                let found: Vec<_> = tree.nearest(point, count).iter().map(|n| (n.key, n.distance_squared)).collect();
                assert_eq!(found, brute::nearest(&named, point, count), "{point:?}");
            }
        }
    }
}

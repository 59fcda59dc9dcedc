//! Thousands of steps in which boxes are added, removed, moved a little, and moved far.

use std::ops::ControlFlow;

use impinge::partition::{BoxTree, Changes, ColumnSweep, Dynamic, Move, Work};
use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use crate::partition::brute::{self, Boxes};
use crate::partition::kinds::dynamic;
use crate::partition::scenes::{ALL, Scene};

/// Upper limit of keys, exclusive.
const KEYS: i64 = 120;

fn moves(scene: Scene, boxes: &Boxes, rng: &mut Rng, count: usize) -> Vec<Move> {
    let mut moves = Vec::new();
    for _ in 0..count {
        let key = rng.integer(0, KEYS - 1) as u32;
        let to = match (boxes.get(&key), rng.integer(0, 9)) {
            (Some(_), 0) => None,
            (Some(bounds), 1..=7) => Some(scene.nudge(bounds, rng)),
            (None, 0..=2) => None,
            _ => Some(scene.draw(rng)),
        };
        moves.push(Move { key, to });
    }
    moves
}

fn apply(boxes: &mut Boxes, moves: &[Move]) {
    for step in moves {
        match step.to {
            Some(bounds) => boxes.insert(step.key, bounds),
            None => boxes.remove(&step.key),
        };
    }
}

fn without(pairs: &[[u32; 2]], others: &[[u32; 2]]) -> Vec<[u32; 2]> {
    pairs.iter().filter(|pair| others.binary_search(pair).is_err()).copied().collect()
}

#[test]
fn every_kind_follows_brute_force_through_thousands_of_steps() {
    for (seed, scene) in ALL.into_iter().enumerate() {
        let mut rng = Rng::new(700 + seed as u64);
        let mut partitions = dynamic(scene);
        let mut boxes = Boxes::new();
        let mut pairs = Vec::new();
        let mut changes = Changes::default();
        let (mut columns, mut swept) = (ColumnSweep::new(), Vec::new());
        let (mut began, mut ended, mut steps_with_pairs, mut found) = (0, 0, 0, 0);
        let steps = rounds(600);
        for step in 0..steps {
            let moves = moves(scene, &boxes, &mut rng, 1 + step % 12);
            apply(&mut boxes, &moves);
            let now = brute::pairs(&boxes);
            if step % 4 == 0 {
                let (keys, listed): (Vec<u32>, Vec<MinMax>) = boxes.iter().map(|(&key, &bounds)| (key, bounds)).unzip();
                columns.find(&listed, &mut swept);
                let named: Vec<[u32; 2]> = swept.iter().map(|pair| pair.map(|at| keys[at as usize])).collect();
                assert_eq!(named, now, "columns, {scene:?}, step {step}");
            }
            let questions = if step % 12 == 0 { Some(scene.questions(&mut rng, 2)) } else { None };
            for (name, partition) in &mut partitions {
                let name = format!("{name}, {scene:?}, step {step}");
                partition.step(&moves, &mut changes);
                assert_eq!(changes.began(), without(&now, &pairs), "{name}: began");
                assert_eq!(changes.ended(), without(&pairs, &now), "{name}: ended");
                if step % 4 == 0 {
                    assert_eq!(partition.pairs(), now, "{name}");
                }
                if let Some(questions) = &questions {
                    found += brute::compare(&**partition, &boxes, questions, &name);
                }
            }
            (began, ended) = (began + without(&now, &pairs).len(), ended + without(&pairs, &now).len());
            steps_with_pairs += usize::from(!now.is_empty());
            pairs = now;
        }
        // A scene without pairs, or without changes, would test nothing.
        assert!(began > steps / 4 && ended > steps / 4, "{scene:?}: {began} began, {ended} ended");
        assert!(
            2 * steps_with_pairs > steps && found > steps,
            "{scene:?}: {steps_with_pairs} with pairs, {found} found"
        );
        // Remove all boxes.
        for (name, partition) in &mut partitions {
            for key in 0..KEYS as u32 {
                assert_eq!(partition.remove(key), boxes.get(&key).copied(), "{name}");
            }
            assert!(partition.is_empty() && partition.pairs().is_empty() && partition.bounds().is_none(), "{name}");
        }
    }
}

#[test]
fn the_order_of_insertion_changes_no_pairs() {
    for scene in ALL {
        let mut rng = Rng::new(77);
        let drawn: Vec<_> = (0..100_u32).map(|key| (key, scene.draw(&mut rng))).collect();
        let expected = brute::pairs(&drawn.iter().copied().collect());
        let mut shuffled = drawn.clone();
        for at in (1..shuffled.len()).rev() {
            shuffled.swap(at, rng.integer(0, at as i64) as usize);
        }
        for order in [&drawn, &shuffled] {
            for (name, mut partition) in dynamic(scene) {
                order.iter().for_each(|&(key, bounds)| _ = partition.insert(key, bounds));
                assert_eq!(partition.pairs(), expected, "{name}, {scene:?}");
            }
        }
    }
}

#[test]
fn pairs_between_two_partitions_agree_with_brute_force() {
    let mut hits = 0;
    for scene in [Scene::Grid, Scene::Sizes] {
        let mut rng = Rng::new(78);
        let ones: Boxes = (0..80).map(|key| (3 * key, scene.draw(&mut rng))).collect();
        let others: Boxes = (0..60).map(|key| (key, scene.draw(&mut rng))).collect();
        let expected = brute::pairs_between(&ones, &others);
        hits += expected.len();
        for margin in [0.0, 0.3] {
            let trees = [&ones, &others].map(|boxes| {
                let mut tree = BoxTree::with_margin(margin);
                boxes.iter().for_each(|(&key, &bounds)| _ = tree.insert(key, bounds));
                tree
            });
            assert_eq!(trees[0].pairs_with_tree(&trees[1]), expected, "two trees at once, margin {margin}");
            assert!(trees[0].pairs_with_tree(&BoxTree::new()).is_empty());
        }
        for (name, mut one) in dynamic(scene) {
            ones.iter().for_each(|(&key, &bounds)| _ = one.insert(key, bounds));
            for (other_name, mut other) in dynamic(scene) {
                others.iter().for_each(|(&key, &bounds)| _ = other.insert(key, bounds));
                assert_eq!(one.pairs_with(&*other), expected, "{name} with {other_name}");
            }
        }
    }
    assert!(hits > 40, "{hits} pairs");
}

#[test]
fn searches_stay_short_under_steady_churn() {
    const BOXES: u32 = 500;
    let scene = Scene::Spread;
    // 500 boxes of volume 1 in a volume of about 4,000, as in the benchmark `partitions`.
    let wide = |rng: &mut Rng| {
        let low = [0; 3].map(|_: i32| rng.uniform(0.0, 15.0));
        MinMax::new(low, low.map(|x| x + 1.0)).expect("in range")
    };
    for (name, mut partition) in dynamic(scene) {
        let mut rng = Rng::new(79);
        for key in 0..BOXES {
            partition.insert(key, wide(&mut rng));
        }
        let mut work = Vec::new();
        for step in 0..10_000 {
            let mut touched = Work::default();
            for _ in 0..8 {
                let key = rng.integer(0, i64::from(BOXES) - 1) as u32;
                let bounds = partition.get(key).expect("each has a box");
                let to = if step % 20 == 0 { wide(&mut rng) } else { scene.nudge(&bounds, &mut rng) };
                partition.insert(key, to);
                let _ = partition.overlapping_counted(&to, &mut touched, &mut |_| ControlFlow::Continue(()));
            }
            work.push(touched.nodes + touched.boxes);
        }
        work.sort_unstable();
        let (median, rare) = (work[work.len() / 2], work[work.len() * 999 / 1000]);
        assert!(rare < 5 * median, "{name}: {median} at the median, {rare} at 99.9 percent");
    }
}

//! Pairs of boxes by their gaps: every pair within reach is visited, in order, and the gap is a
//! lower bound.

use impinge::partition::{BoxTree, Dynamic};
use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;

use crate::partition::scenes::ALL;

/// Returns the distance of two boxes, or minus the translation along an axis that separates them.
fn gap(a: &MinMax, b: &MinMax) -> f64 {
    let apart: [f64; 3] = std::array::from_fn(|k| (b.min()[k] - a.max()[k]).max(a.min()[k] - b.max()[k]));
    let widest = apart.iter().fold(f64::NEG_INFINITY, |widest, &x| widest.max(x));
    if widest <= 0.0 { widest } else { apart.iter().map(|x| x.max(0.0).powi(2)).sum::<f64>().sqrt() }
}

fn tree_of(boxes: &[MinMax], margin: f64) -> BoxTree {
    let mut tree = BoxTree::with_margin(margin);
    (0..).zip(boxes).for_each(|(key, bounds)| _ = tree.insert(key, *bounds));
    tree
}

/// Checks visits against all pairs with their gaps. The visits end at `reach`.
fn check(visits: &[([u32; 2], f64)], mut expected: Vec<(f64, [u32; 2])>, reach: f64) {
    expected.retain(|(gap, _)| *gap <= reach);
    expected.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    assert!(visits.is_sorted_by(|one, other| (one.1, one.0) < (other.1, other.0)));
    let mut seen: Vec<[u32; 2]> = visits.iter().map(|(pair, _)| *pair).collect();
    let mut wanted: Vec<[u32; 2]> = expected.iter().map(|(_, pair)| *pair).collect();
    let exact = |pair: [u32; 2]| expected.iter().find(|(_, own)| *own == pair).map(|(gap, _)| *gap);
    for (pair, bound) in visits {
        // A pair that is visited but not expected is beyond the reach by rounding alone.
        let exact = exact(*pair).unwrap_or(reach);
        assert!(*bound <= exact && exact - *bound <= 1e-14 * exact.abs() + 1e-150, "{bound} of {exact}");
    }
    seen.sort_unstable();
    wanted.sort_unstable();
    wanted.retain(|pair| seen.binary_search(pair).is_err());
    assert!(wanted.is_empty(), "{wanted:?} are missing");
}

#[test]
fn pairs_within_reach_come_in_ascending_order_of_their_gaps() {
    let mut rng = Rng::new(91);
    let (mut ties, mut visited, mut overlapping) = (0, 0, 0);
    for scene in ALL {
        for (count, margin) in [(0, 0.0), (1, 0.0), (2, 0.0), (30, 0.0), (60, 0.5)] {
            let boxes: Vec<MinMax> = (0..count).map(|_| scene.draw(&mut rng)).collect();
            let tree = tree_of(&boxes, margin);
            let all: Vec<(f64, [u32; 2])> = (0..count as u32)
                .flat_map(|one| (one + 1..count as u32).map(move |other| [one, other]))
                .map(|pair| (gap(&boxes[pair[0] as usize], &boxes[pair[1] as usize]), pair))
                .collect();
            let middle = all.get(all.len() / 2).map_or(0.0, |(gap, _)| *gap);
            for reach in [f64::INFINITY, middle, 0.0, -0.5] {
                let mut visits = Vec::new();
                tree.for_each_pair_by_gap(reach, &mut |pair, gap| {
                    visits.push((pair, gap));
                    reach
                });
                check(&visits, all.clone(), reach);
                ties += visits.windows(2).filter(|two| two[0].1 == two[1].1).count();
                overlapping += visits.iter().filter(|(_, gap)| *gap < 0.0).count();
                visited += visits.len();
            }
        }
    }
    assert!(ties > 1000 && overlapping > 1000 && visited > 10_000, "{ties} {overlapping} {visited}");
}

#[test]
fn pairs_of_two_trees_come_in_ascending_order_of_their_gaps() {
    let mut rng = Rng::new(92);
    let mut visited = 0;
    for scene in ALL {
        for counts in [[0, 5], [1, 40], [25, 1], [30, 20]] {
            let boxes = counts.map(|count| (0..count).map(|_| scene.draw(&mut rng)).collect::<Vec<MinMax>>());
            let [one, other] = [tree_of(&boxes[0], 0.0), tree_of(&boxes[1], 0.25)];
            let mut visits = Vec::new();
            one.for_each_pair_with_tree_by_gap(&other, f64::INFINITY, &mut |pair, gap| {
                visits.push((pair, gap));
                f64::INFINITY
            });
            let pairs = (0..counts[0] as u32).flat_map(|a| (0..counts[1] as u32).map(move |b| [a, b]));
            let all: Vec<_> = pairs.map(|[a, b]| (gap(&boxes[0][a as usize], &boxes[1][b as usize]), [a, b])).collect();
            assert_eq!(visits.len(), all.len());
            check(&visits, all, f64::INFINITY);
            visited += visits.len();
        }
    }
    assert!(visited > 3000);
}

#[test]
fn a_reach_that_shrinks_ends_the_search() {
    let mut rng = Rng::new(93);
    let boxes: Vec<MinMax> = (0..300).map(|_| ALL[1].draw(&mut rng)).collect();
    let mut visits = 0;
    tree_of(&boxes, 0.0).for_each_pair_by_gap(f64::INFINITY, &mut |_, gap| {
        visits += 1;
        gap
    });
    assert_eq!(visits, 1);
    tree_of(&boxes, 0.0).for_each_pair_by_gap(f64::INFINITY, &mut |_, _| {
        visits += 1;
        if visits == 10 { f64::NEG_INFINITY } else { f64::INFINITY }
    });
    assert_eq!(visits, 10);
}

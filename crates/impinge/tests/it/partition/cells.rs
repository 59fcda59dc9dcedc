//! Grids under steps of many moves, with boxes in cells that differ by multiples of eight.

use impinge::partition::{Changes, Dynamic, HashedGrid, HierarchicalGrid, Move, UniformGrid};
use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;

use crate::partition::brute::{self, Boxes};

/// Returns a box for grids with cells of size 1.
///
/// Corners lie at fractions of cells that grids distinguish, or between them. Boxes are up to 20
/// cells long along one axis, and may be flat along others.
fn draw(rng: &mut Rng) -> MinMax {
    let long = rng.integer(0, 5);
    let low = [0; 3].map(|_: i32| {
        let multiple = 8.0 * rng.integer(-1, 1) as f64;
        multiple
            + rng.choose(&[0.0, 0.25, 0.5, 1.0 / 256.0, 1.0 / 300.0])
            + if rng.one_in(3) { rng.unit() } else { 0.0 }
    });
    let high = std::array::from_fn(|k| {
        let extent = if k as i64 == long { rng.integer(0, 20) as f64 } else { rng.choose(&[0.0, 0.25, 0.5, 1.5]) };
        low[k] + extent
    });
    MinMax::new(low, high).expect("in range")
}

fn nudge(bounds: &MinMax, rng: &mut Rng) -> MinMax {
    let shift = [0; 3].map(|_: i32| rng.choose(&[0.0, 0.25, -0.25, 1.0 / 256.0, -1.0 / 512.0, 1.0]));
    let (min, max) = (bounds.min(), bounds.max());
    let low = [0, 1, 2].map(|k| min[k] + shift[k]);
    MinMax::new(low, [0, 1, 2].map(|k| (max[k] + shift[k]).max(low[k]))).expect("in range")
}

#[test]
fn steps_of_many_moves_among_similar_cells_agree_with_brute_force() {
    let (began, pairs, twice) = follow(250, 400);
    assert!(began > 2_000 && pairs > 40_000 && twice > 2_000, "{began} began, {pairs} pairs, {twice} twice");
}

#[test]
fn few_boxes_in_similar_cells_agree_with_brute_force() {
    let (began, pairs, _) = follow(16, 4_000);
    assert!(began > 1_000 && pairs > 1_000, "{began} began, {pairs} pairs");
}

/// Runs steps with keys below `keys` and compares each with brute force.
///
/// Returns the number of pairs that began, the number of pairs summed over all steps, and the
/// number of moves of boxes that had already moved in the same step.
fn follow(keys: i64, steps: usize) -> (usize, usize, usize) {
    let all = MinMax::new([-20.0; 3], [25.0; 3]).expect("in range");
    let mut grids: Vec<(&str, Box<dyn Dynamic>)> = vec![
        ("hashed", Box::new(HashedGrid::new(1.0).expect("a size"))),
        ("uniform", Box::new(UniformGrid::over(&all, 1.0).expect("few cells"))),
        ("hierarchical", Box::new(HierarchicalGrid::new(0.25).expect("a size"))),
    ];
    let mut rng = Rng::new(801);
    let (mut boxes, mut pairs, mut changes) = (Boxes::new(), Vec::new(), Changes::default());
    let (mut began, mut were, mut twice) = (0, 0, 0);
    for step in 0..steps {
        let mut moves: Vec<Move> = Vec::new();
        for _ in 0..40 {
            // Some boxes move twice in a step, by a little or far.
            let key = match moves.last() {
                Some(last) if rng.one_in(8) => last.key,
                _ => rng.integer(0, keys - 1) as u32,
            };
            twice += usize::from(moves.iter().any(|earlier| earlier.key == key));
            let to = match boxes.get(&key) {
                Some(_) if rng.one_in(20) => None,
                Some(bounds) if !rng.one_in(10) => Some(nudge(bounds, &mut rng)),
                _ => Some(draw(&mut rng)),
            };
            _ = match to {
                Some(bounds) => boxes.insert(key, bounds),
                None => boxes.remove(&key),
            };
            moves.push(Move { key, to });
        }
        let now = brute::pairs(&boxes);
        for (name, grid) in &mut grids {
            grid.step(&moves, &mut changes);
            let new = |pairs: &[[u32; 2]], others: &Vec<[u32; 2]>| -> Vec<[u32; 2]> {
                pairs.iter().filter(|pair| others.binary_search(pair).is_err()).copied().collect()
            };
            assert_eq!(changes.began(), new(&now, &pairs), "{name}, step {step}: began");
            assert_eq!(changes.ended(), new(&pairs, &now), "{name}, step {step}: ended");
            if step % 8 == 0 {
                assert_eq!(grid.pairs(), now, "{name}, step {step}");
                for _ in 0..20 {
                    let asked = draw(&mut rng);
                    let found = brute::found(|visit| grid.overlapping(&asked, visit));
                    assert_eq!(found, brute::overlapping(&boxes, &asked), "{name}, step {step}");
                }
            }
        }
        began += changes.began().len();
        were += now.len();
        pairs = now;
    }
    (began, were, twice)
}

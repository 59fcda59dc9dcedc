//! Memory of partitions under steady changes: after 10,000 steps no more is allocated than after a
//! few thousand.

use impinge::partition::{
    Axis, BoxTree, Changes, ColumnSweep, Dynamic, HashedGrid, HierarchicalGrid, LooseOctree, Move, Octree,
    SweepOneAxis, SweepThreeAxes, UniformGrid,
};
use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;

use crate::{COUNTED, alone};

const STEPS: usize = 10_000;

/// Number of steps after which all reusable memory should be allocated.
const SETTLED: usize = 4_000;

/// Runs all steps, and compares the peak memory in the last quarter with the peak before step
/// [`SETTLED`].
///
/// Lists grow to their maximum length by doubling, which becomes rarer. So the limit is 1.5 times;
/// memory that grows with the steps would reach 2.5 times.
fn check(name: &str, start: usize, mut step: impl FnMut(usize)) {
    let (mut settled, mut last) = (0, 0);
    for at in 0..STEPS {
        step(at);
        let alive = COUNTED.current_usage().saturating_sub(start);
        if at < SETTLED {
            settled = settled.max(alive);
        } else if at >= STEPS * 3 / 4 {
            last = last.max(alive);
        }
    }
    assert!(settled > 1_000, "{name}: {settled} bytes are too few to be all of it");
    assert!(last * 2 <= settled * 3, "{name}: {settled} bytes were alive until step {SETTLED}, {last} at the end");
}

/// Returns a random corner in a region that moves away with the steps, so that no place is used
/// forever.
fn place(rng: &mut Rng, at: usize) -> [f64; 3] {
    let far = at as f64 * 0.05;
    [far, -far, 0.0].map(|from| from + rng.uniform(0.0, 8.0))
}

fn unit_box(min: [f64; 3]) -> MinMax {
    MinMax::new(min, min.map(|x| x + 1.0)).expect("in range")
}

fn churn<P: Dynamic>(name: &str, make: impl FnOnce() -> P) {
    const BOXES: u32 = 100;
    let start = COUNTED.current_usage();
    let mut partition = make();
    let (mut rng, mut changes, mut moves) = (Rng::new(83), Changes::default(), Vec::new());
    (0..BOXES).for_each(|key| _ = partition.insert(key, unit_box(place(&mut rng, 0))));
    let (mut began, mut ended) = (0, 0);
    check(name, start, |at| {
        moves.clear();
        for _ in 0..3 {
            let key = rng.integer(0, i64::from(BOXES) - 1) as u32;
            let to = if rng.one_in(10) { None } else { Some(unit_box(place(&mut rng, at))) };
            moves.push(Move { key, to });
        }
        partition.step(&moves, &mut changes);
        began += changes.began().len();
        ended += changes.ended().len();
    });
    assert!(began > STEPS && ended > STEPS, "{name}: {began} pairs began, {ended} ended");
}

#[test]
fn memory_does_not_creep_under_steady_churn() {
    let _alone = alone();
    let over = MinMax::new([-10.0; 3], [20.0; 3]).expect("in order");
    churn("tree", BoxTree::new);
    churn("tree with margin", || BoxTree::with_margin(0.3));
    churn("uniform grid", || UniformGrid::over(&over, 2.5).expect("few cells"));
    churn("hashed grid", || HashedGrid::new(2.5).expect("a size"));
    churn("hierarchical grid", || HierarchicalGrid::new(1.0).expect("a size"));
    churn("octree", || Octree::over(&over));
    churn("loose octree", || LooseOctree::over(&over));
    churn("one axis", || SweepOneAxis::along(Axis::X));
    churn("three axes", SweepThreeAxes::new);

    let start = COUNTED.current_usage();
    let (mut rng, mut sweep, mut pairs) = (Rng::new(85), ColumnSweep::new(), Vec::new());
    let mut boxes: Vec<MinMax> = (0..100).map(|_| unit_box(place(&mut rng, 0))).collect();
    check("columns", start, |at| {
        for _ in 0..3 {
            let key = rng.integer(0, boxes.len() as i64 - 1) as usize;
            boxes[key] = unit_box(place(&mut rng, at));
        }
        sweep.find(&boxes, &mut pairs);
    });
}

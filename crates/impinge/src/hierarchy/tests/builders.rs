//! Every builder on boxes of every kind, and the dynamic tree against a plain list.

use super::*;
use crate::hierarchy::area::half_area;

fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(run)
}

#[test]
fn every_builder_puts_every_box_in_one_leaf_of_bounded_depth() {
    for (name, boxes) in scenes() {
        // From the whole scene, and few enough for seven builders.
        let boxes: Vec<Aabb> = boxes.iter().copied().step_by(boxes.len().div_ceil(25_000).max(1)).collect();
        for builder in Builder::ALL {
            let name = format!("{name}, {}", builder.name());
            let tree = on_threads(1, || builder.build(&boxes));
            assert!(
                tree == on_threads(2, || builder.build(&boxes)),
                "{name}: the number of threads changes the result"
            );
            let depth = depth_of_binary(&name, &tree, &boxes);
            assert!(depth <= MAX_DEPTH && depth == tree.depth(), "{name}: {depth} deep");
            check_wide(&name, &tree);
        }
    }
}

#[test]
fn leaves_of_any_capacity_are_valid() {
    let boxes = scenes().into_iter().filter(|(_, boxes)| boxes.len() == 513 || boxes.len() == 70_000);
    for (name, boxes) in boxes {
        for builder in Builder::ALL {
            for capacity in [1, 3, LEAF_CAPACITY] {
                let name = format!("{name}, {}, {capacity}", builder.name());
                let tree = builder.build_with_leaves_of(capacity, &boxes);
                assert!(depth_of_binary(&name, &tree, &boxes) <= MAX_DEPTH, "{name}");
                let fullest = tree.nodes.iter().filter(|node| node.right.is_none()).map(|node| node.count).max();
                assert!(fullest.is_some_and(|count| count as usize <= capacity), "{name}: {fullest:?}");
            }
        }
    }
}

#[test]
fn a_chain_is_halved_if_it_grows_too_deep() {
    // Each box is smaller than the last, so that by area one box after the other is split off,
    // beyond the allowed depth.
    let boxes: Vec<Aabb> = (0..1_000)
        .map(|i| {
            let x = 0.9_f32.powi(i % 700);
            Aabb { min: [x; 3], max: [1.01 * x; 3] }
        })
        .collect();
    let mut deepest = 0;
    for builder in Builder::ALL {
        let tree = builder.build_with_leaves_of(1, &boxes);
        let depth = depth_of_binary(builder.name(), &tree, &boxes);
        assert!(depth <= MAX_DEPTH, "{}: {depth}", builder.name());
        deepest = deepest.max(depth);
    }
    assert!(deepest > 36, "{deepest}: no builder made a chain of it");
}

#[test]
fn better_builders_make_trees_of_lower_cost() {
    let (_, boxes) = scenes().into_iter().find(|(name, _)| *name == "random").expect("the scene");
    let sah = |builder: Builder| builder.build(&boxes).statistics().sah;
    let [median, binned, sweep, ploc, insertion, reinsertion] = [
        Builder::Median,
        Builder::BinnedSah,
        Builder::SweepSah,
        Builder::Ploc,
        Builder::Insertion,
        Builder::Reinsertion,
    ]
    .map(sah);
    assert!(
        sweep <= 1.01 * binned && binned < 1.03 * sweep && binned < 1.05 * median,
        "sweep {sweep}, binned {binned}, median {median}"
    );
    assert!(reinsertion < ploc, "reinsertion {reinsertion}, PLOC {ploc}");
    assert!(insertion < 2.0 * binned, "insertion {insertion}, binned {binned}");
}

#[test]
fn reinsertion_never_increases_the_cost() {
    let cost = |tree: &BinaryTree| -> f64 {
        tree.nodes.iter().filter(|node| node.right.is_some()).map(|node| half_area(&node.bounds)).sum()
    };
    let mut improved = 0;
    for (name, boxes) in scenes() {
        let boxes = &boxes[..boxes.len().min(25_000)];
        for builder in [Builder::Morton, Builder::Median] {
            let tree = builder.build(boxes);
            let better = optimize(&tree, boxes, LEAF_CAPACITY);
            depth_of_binary(name, &better, boxes);
            let (before, after) = (cost(&tree), cost(&better));
            assert!(after <= before * (1.0 + 1e-9), "{name}, {}: {before} became {after}", builder.name());
            improved += usize::from(after < 0.95 * before);
        }
    }
    assert!(improved >= 4, "only {improved} trees became better by a twentieth");
}

/// Returns boxes on a small grid, many of them equal, flat or points.
fn grid_box(rng: &mut Rng) -> Aabb {
    let min = [0; 3].map(|_| rng.integer(0, 12) as f32);
    Aabb { min, max: min.map(|x| x + rng.integer(0, 3) as f32) }
}

#[test]
fn inserted_and_removed_boxes_match_a_plain_list() {
    let mut rng = Rng::new(5);
    let mut tree = DynamicTree::new();
    let mut plain: Vec<Option<Aabb>> = Vec::new();
    let mut found_in_all = 0;
    for step in 0..6_000 {
        let alive: Vec<u32> = (0..plain.len() as u32).filter(|&number| plain[number as usize].is_some()).collect();
        // The tree grows, then shrinks to nothing, and grows again.
        let grows = !(1_500..4_000).contains(&step);
        let inserts = if grows { !rng.one_in(4) } else { rng.one_in(4) };
        if alive.is_empty() || inserts {
            let bounds = grid_box(&mut rng);
            let number = tree.insert(bounds) as usize;
            if number == plain.len() {
                plain.push(None);
            }
            assert!(plain[number].replace(bounds).is_none(), "number {number} is in use");
        } else if rng.one_in(5) {
            let (number, bounds) = (rng.choose(&alive), grid_box(&mut rng));
            assert_eq!(tree.replace(number, bounds), plain[number as usize].replace(bounds));
        } else {
            let number = rng.choose(&alive);
            assert_eq!(tree.remove(number), plain[number as usize].take());
            assert_eq!((tree.remove(number), tree.get(number)), (None, None));
        }
        assert_eq!(tree.len(), plain.iter().flatten().count());
        if step % 50 == 0 {
            let region = grid_box(&mut rng);
            let mut found = Vec::new();
            tree.for_each_overlapping(&region, |number| found.push(number));
            found.sort_unstable();
            let overlaps =
                |b: &Aabb| (0..3).all(|axis| b.min[axis] <= region.max[axis] && region.min[axis] <= b.max[axis]);
            let expected: Vec<u32> =
                (0..plain.len() as u32).filter(|&i| plain[i as usize].as_ref().is_some_and(overlaps)).collect();
            assert_eq!(found, expected);
            found_in_all += found.len();
            check_dynamic(&tree, &plain);
        }
    }
    assert!(found_in_all > 500, "{found_in_all}");
}

/// Checks that the neutral tree holds the current boxes under their numbers.
fn check_dynamic(tree: &DynamicTree, plain: &[Option<Aabb>]) {
    let binary = tree.to_binary(LEAF_CAPACITY);
    let numbers: Vec<u32> = (0..plain.len() as u32).filter(|&i| plain[i as usize].is_some()).collect();
    let boxes: Vec<Aabb> = plain.iter().flatten().copied().collect();
    let place = |number: &u32| numbers.binary_search(number).expect("a box that is there") as u32;
    let renumbered =
        BinaryTree { order: binary.order.iter().map(place).collect::<Vec<u32>>().into(), nodes: binary.nodes };
    assert!(depth_of_binary("dynamic", &renumbered, &boxes) <= MAX_DEPTH);
}

#[test]
fn equal_boxes_are_built_quickly() {
    // A builder that is quadratic for equal boxes would take minutes.
    let boxes = vec![Aabb { min: [0.25; 3], max: [0.5; 3] }; 250_000];
    for builder in Builder::ALL {
        let tree = builder.build(&boxes);
        assert!(tree.depth() <= MAX_DEPTH && tree.order.len() == boxes.len(), "{}", builder.name());
    }
}

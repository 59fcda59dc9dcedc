//! Boxes of every kind pass through the builder and the collapse. No box is lost or repeated, and
//! no leaf is too deep.

mod builders;
pub(super) mod maps;

use super::*;
use crate::volume::Aabb;
use impinge_testkit::generate::Rng;

/// Returns scenes that are hard for a tree, by chance or by design.
fn scenes() -> Vec<(&'static str, Vec<Aabb>)> {
    let mut rng = Rng::new(71);
    let cube = |center: [f32; 3], half: f32| Aabb { min: center.map(|x| x - half), max: center.map(|x| x + half) };
    let at = |x: f64| (x as f32).clamp(f32::MIN, f32::MAX);
    let mut random = |count: usize, spread: f64, half: f64| -> Vec<Aabb> {
        (0..count).map(|_| cube([0; 3].map(|_| at(rng.uniform(-spread, spread))), at(half))).collect()
    };
    // Each bit of the codes splits off one box, down to a cell that holds the rest.
    let chain = (0..22).flat_map(|i| (0..3).map(move |axis| (axis, 2.0_f32.powi(-i)))).map(|(axis, x)| {
        let mut center = [0.0; 3];
        center[axis] = x;
        cube(center, 0.0)
    });
    let chain = chain.chain(std::iter::repeat_n(cube([0.0; 3], 0.0), 100_000)).collect();
    let near = random(40_000, 2.0_f64.powi(-60), 0.0);
    let clusters = [near.clone(), near.iter().map(|b| cube(b.min.map(|x| x + 1.0), 0.0)).collect()].concat();
    let one_side = |side: f32| Aabb { min: [f32::MAX.copysign(side) * 0.75; 3], max: [f32::MAX.copysign(side); 3] };
    let huge: Vec<Aabb> = (0..5_000)
        .map(|i| match i % 4 {
            0 => Aabb { min: [f32::MIN; 3], max: [f32::MAX; 3] },
            1 => one_side(1.0),
            2 => Aabb { min: one_side(-1.0).max, max: one_side(-1.0).min },
            _ => cube([i as f32; 3], 1.0),
        })
        .collect();
    vec![
        ("none", Vec::new()),
        ("one", random(1, 1.0, 0.1)),
        ("nine", random(9, 1.0, 0.1)),
        ("64", random(64, 1.0, 0.1)),
        ("65", random(65, 1.0, 0.1)),
        ("513", random(513, 1.0, 0.1)),
        ("random", random(100_000, 1.0, 0.01)),
        ("equal", vec![cube([0.5, -0.25, 3.0], 1.0); 100_000]),
        ("nested", (0..50_000).map(|i| cube([0.0; 3], 1.0 + i as f32)).collect()),
        ("sorted", (0..70_000).map(|i| cube([i as f32, 0.0, 0.0], 0.5)).collect()),
        ("sorted backwards", (0..70_000).map(|i| cube([-(i as f32), 1.0, 0.0], 0.5)).collect()),
        ("halving", (0..60_000).map(|i| cube([2.0_f32.powi(-(i % 140)); 3], 0.0)).collect()),
        ("chain", chain),
        ("clusters 2^-60 wide", clusters),
        ("near the largest float", huge),
    ]
}

fn holds(outer: &Aabb, inner: &Aabb) -> bool {
    (0..3).all(|axis| outer.min[axis] <= inner.min[axis] && inner.max[axis] <= outer.max[axis])
}

/// Walks the tree from its root and returns the depth of the deepest leaf.
fn depth_of_binary(name: &str, tree: &BinaryTree, boxes: &[Aabb]) -> usize {
    let mut order = tree.order.to_vec();
    order.sort_unstable();
    assert!(order.iter().enumerate().all(|(at, &index)| at == index as usize), "{name}: not a permutation");
    assert_eq!(order.len(), boxes.len(), "{name}");

    let (mut deepest, mut visited, mut covered) = (0, 0, 0);
    let mut stack = if tree.nodes.is_empty() { Vec::new() } else { vec![(0_u32, 0)] };
    while let Some((at, depth)) = stack.pop() {
        let node = tree.nodes[at as usize];
        visited += 1;
        deepest = deepest.max(depth);
        let Some(right) = node.right else {
            assert!((1..=LEAF_CAPACITY).contains(&tree.held(at).len()), "{name}");
            // Leaves are in order, so each box is in exactly one leaf.
            assert_eq!(node.first, covered, "{name}");
            covered += node.count;
            let least = tree.held(at).iter().fold(Aabb::EMPTY, |b, &index| b.union(boxes[index as usize]));
            assert_eq!(node.bounds, least, "{name}: a leaf's box");
            continue;
        };
        let children = [at + 1, at + right.get()];
        let [low, high] = children.map(|child| tree.nodes[child as usize]);
        assert_eq!((low.first, high.first, low.count + high.count), (node.first, node.first + low.count, node.count));
        assert_eq!(node.bounds, low.bounds.union(high.bounds), "{name}: an inner box");
        stack.extend([(children[1], depth + 1), (children[0], depth + 1)]);
    }
    assert_eq!((visited, covered as usize), (tree.nodes.len(), boxes.len()), "{name}");
    deepest
}

fn check_wide(name: &str, binary: &BinaryTree) {
    let (wide, leaves) = WideTree::collapse(binary);
    assert_eq!(wide.nodes().is_empty(), binary.nodes.is_empty(), "{name}");
    let mut seen_nodes = vec![0; wide.nodes().len()];
    let mut seen_leaves = vec![0; leaves.len()];
    if let Some(root) = seen_nodes.first_mut() {
        *root += 1;
    }
    for (at, node) in wide.nodes().iter().enumerate() {
        assert!((1..=crate::simd::LANES).contains(&node.count()), "{name}");
        let leaves_here = (0..node.count()).filter(|&lane| matches!(node.child(lane), Child::Leaf(_))).count();
        assert_eq!(leaves_here, if node.holds_leaves() { node.count() } else { 0 }, "{name}: nodes beside leaves");
        for lane in 0..crate::simd::LANES {
            let bounds = Aabb {
                min: std::array::from_fn(|axis| node.min[axis][lane]),
                max: std::array::from_fn(|axis| node.max[axis][lane]),
            };
            if lane >= node.count() {
                assert_eq!(bounds, Aabb::EMPTY, "{name}: an unused lane");
                continue;
            }
            match node.child(lane) {
                Child::Inner(child) => {
                    assert!(child as usize > at, "{name}: a child before its parent");
                    seen_nodes[child as usize] += 1;
                    let child = &wide.nodes()[child as usize];
                    for lane in 0..child.count() {
                        let inner = Aabb {
                            min: std::array::from_fn(|axis| child.min[axis][lane]),
                            max: std::array::from_fn(|axis| child.max[axis][lane]),
                        };
                        assert!(holds(&bounds, &inner), "{name}: {inner:?} is not in {bounds:?}");
                    }
                }
                Child::Leaf(leaf) => {
                    seen_leaves[leaf as usize] += 1;
                    assert_eq!(bounds, binary.nodes[leaves[leaf as usize] as usize].bounds, "{name}");
                }
            }
        }
    }
    assert!(seen_nodes.iter().all(|&count| count == 1), "{name}: every node has one parent");
    assert!(seen_leaves.iter().all(|&count| count == 1), "{name}: every leaf has one parent");
    // Each leaf of the binary tree occurs once among the wide tree's leaves.
    let mut of_wide = leaves;
    of_wide.sort_unstable();
    let of_binary: Vec<u32> =
        (0..binary.nodes.len() as u32).filter(|&node| binary.nodes[node as usize].right.is_none()).collect();
    assert_eq!(of_wide, of_binary, "{name}");
}

#[test]
fn every_box_is_in_one_leaf_of_bounded_depth() {
    let mut deepest = 0;
    for (name, boxes) in scenes() {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| build_morton(&boxes))
        });
        assert!(one == two, "{name}: the number of threads changes the result");
        let depth = depth_of_binary(name, &one, &boxes);
        assert!(depth <= MAX_DEPTH, "{name}: {depth} deep");
        deepest = deepest.max(depth);
        check_wide(name, &one);
    }
    assert!(deepest > 40, "{deepest}: no scene needed its ranges halved");
}

#[test]
fn medians_fill_the_leaves() {
    for (name, boxes) in scenes() {
        let leaves = build_morton(&boxes).nodes.iter().filter(|node| node.right.is_none()).count();
        assert!(leaves <= boxes.len() / 4 + 1, "{name}: {leaves} leaves for {} boxes", boxes.len());
    }
}

#[test]
fn nodes_of_leaves_are_full() {
    // If boxes are spread evenly, few lanes stay empty.
    let (_, boxes) = &scenes()[6];
    let (wide, leaves) = WideTree::collapse(&build_morton(boxes));
    assert!(leaves.len() * LEAF_CAPACITY < boxes.len() * 11 / 10, "{} leaves for {}", leaves.len(), boxes.len());
    let bottom = wide.nodes().iter().filter(|node| node.holds_leaves()).count();
    assert!(bottom * LEAF_CAPACITY * 9 < leaves.len() * 10, "{} leaves in {bottom} nodes", leaves.len());
}

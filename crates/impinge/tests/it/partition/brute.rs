//! Oracle: compares every box by its numbers.
//!
//! The time is linear in the number of boxes, and quadratic for pairs. It checks every kind of
//! `impinge::partition`.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use impinge::partition::{Partition, Ray};
use impinge::volume::MinMax;

/// Boxes by key.
pub(crate) type Boxes = BTreeMap<u32, MinMax>;

pub(crate) fn overlap(a: &MinMax, b: &MinMax) -> bool {
    (0..3).all(|k| a.min()[k] <= b.max()[k] && b.min()[k] <= a.max()[k])
}

pub(crate) fn pairs(boxes: &Boxes) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    for (&one, a) in boxes {
        pairs.extend(boxes.range(one + 1..).filter(|(_, b)| overlap(a, b)).map(|(&other, _)| [one, other]));
    }
    pairs
}

pub(crate) fn pairs_between(ones: &Boxes, others: &Boxes) -> Vec<[u32; 2]> {
    let with = |(&one, a)| others.iter().filter(move |(_, b)| overlap(a, b)).map(move |(&other, _)| [one, other]);
    ones.iter().flat_map(with).collect()
}

pub(crate) fn overlapping(boxes: &Boxes, bounds: &MinMax) -> Vec<u32> {
    boxes.iter().filter(|(_, b)| overlap(b, bounds)).map(|(&key, _)| key).collect()
}

pub(crate) fn at(boxes: &Boxes, point: [f64; 3]) -> Vec<u32> {
    let holds = |b: &MinMax| (0..3).all(|k| b.min()[k] <= point[k] && point[k] <= b.max()[k]);
    boxes.iter().filter(|(_, b)| holds(b)).map(|(&key, _)| key).collect()
}

/// Returns each box that the ray enters, by the public predicate on single boxes, which has its own
/// tests.
pub(crate) fn ray(boxes: &Boxes, ray: &Ray) -> Vec<(u32, f64)> {
    boxes.iter().filter_map(|(&key, b)| ray.enters(b).map(|t| (key, t))).collect()
}

pub(crate) fn nearest(boxes: &Boxes, point: [f64; 3], count: usize) -> Vec<(u32, f64)> {
    let squared = |b: &MinMax| -> f64 {
        let gap = |k: usize| (b.min()[k] - point[k]).max(point[k] - b.max()[k]).max(0.0);
        gap(0) * gap(0) + gap(1) * gap(1) + gap(2) * gap(2)
    };
    let mut all: Vec<(u32, f64)> = boxes.iter().map(|(&key, b)| (key, squared(b))).collect();
    all.sort_by(|one, other| one.1.total_cmp(&other.1).then(one.0.cmp(&other.0)));
    all.truncate(count);
    all
}

/// Returns the keys that a search visits, sorted. Panics if a key is visited twice.
pub(crate) fn found(search: impl FnOnce(&mut dyn FnMut(u32) -> ControlFlow<()>) -> ControlFlow<()>) -> Vec<u32> {
    let mut keys = Vec::new();
    let flow = search(&mut |key| {
        keys.push(key);
        ControlFlow::Continue(())
    });
    assert_eq!(flow, ControlFlow::Continue(()));
    keys.sort_unstable();
    let len = keys.len();
    keys.dedup();
    assert_eq!(keys.len(), len, "a box was visited twice");
    keys
}

/// Compares all queries of a partition with the oracle, and returns the number of boxes found.
pub(crate) fn compare(partition: &dyn Partition, boxes: &Boxes, questions: &Questions, name: &str) -> usize {
    let mut hits = 0;
    assert_eq!(partition.len(), boxes.len(), "{name}");
    let mut all = Vec::new();
    partition.each(&mut |key, bounds| all.push((key, *bounds)));
    assert_eq!(all, boxes.iter().map(|(&key, b)| (key, *b)).collect::<Vec<_>>(), "{name}");
    assert_eq!(partition.bounds().is_none(), boxes.is_empty(), "{name}");
    for bounds in &questions.boxes {
        let expected = overlapping(boxes, bounds);
        assert_eq!(found(|visit| partition.overlapping(bounds, visit)), expected, "{name}: {bounds:?}");
        hits += expected.len();
    }
    for &point in &questions.points {
        assert_eq!(found(|visit| partition.at(point, visit)), at(boxes, point), "{name}: {point:?}");
        for count in [1, 5] {
            let nearest_found: Vec<(u32, f64)> =
                partition.nearest(point, count).iter().map(|n| (n.key, n.distance_squared)).collect();
            assert_eq!(nearest_found, nearest(boxes, point, count), "{name}: nearest {count} to {point:?}");
        }
    }
    for question in &questions.rays {
        let mut entered = Vec::new();
        partition.ray(question, &mut |visit| {
            entered.push((visit.key, visit.t));
            visit.reach
        });
        entered.sort_by_key(|entry| entry.0);
        let expected = ray(boxes, question);
        assert_eq!(entered, expected, "{name}: {question:?}");
        // The first box, found with a reach that shrinks.
        let mut first = f64::INFINITY;
        partition.ray(question, &mut |visit| {
            first = first.min(visit.t);
            visit.t
        });
        assert_eq!(first, expected.iter().map(|e| e.1).fold(f64::INFINITY, f64::min), "{name}: {question:?}");
        hits += expected.len();
    }
    hits
}

/// Queries for each partition.
#[derive(Default)]
pub(crate) struct Questions {
    pub(crate) boxes: Vec<MinMax>,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) rays: Vec<Ray>,
}

//! Partitions at the limits of the range, empty, and with searches that are stopped.

use std::ops::ControlFlow;

use impinge::partition::Ray;
use impinge::volume::MinMax;

use crate::partition::brute::{self, Boxes};
use crate::partition::kinds::dynamic;
use crate::partition::scenes::{ALL, Scene};

#[test]
fn an_empty_partition_finds_nothing() {
    for (name, mut partition) in dynamic(Scene::Grid) {
        let all = MinMax::new([-1e90; 3], [1e90; 3]).expect("in range");
        assert!(partition.is_empty() && partition.bounds().is_none() && partition.pairs().is_empty(), "{name}");
        assert_eq!(brute::found(|visit| partition.overlapping(&all, visit)), [], "{name}");
        assert!(partition.nearest([0.0; 3], 3).is_empty(), "{name}");
        partition.ray(&Ray::new([0.0; 3], [1.0; 3], 1.0).expect("a ray"), &mut |_| unreachable!("{name}"));
        assert_eq!((partition.remove(3), partition.get(3)), (None, None), "{name}");
    }
}

#[test]
fn the_largest_and_smallest_boxes_agree_with_brute_force() {
    let limit = 2.0_f64.powi(320);
    let tiny = f64::from_bits(1);
    let corners = [
        ([-limit; 3], [limit; 3]),
        ([limit; 3], [limit; 3]),
        ([-limit; 3], [-limit; 3]),
        ([-limit, 0.0, 0.0], [limit, 0.0, 0.0]),
        ([0.0; 3], [0.0; 3]),
        ([-0.0; 3], [-0.0; 3]),
        ([0.0; 3], [tiny; 3]),
        ([tiny; 3], [1.0; 3]),
        ([-1.0; 3], [-tiny; 3]),
        ([1.0; 3], [2.0; 3]),
        ([1e300; 3].map(|x: f64| x.min(limit)), [limit; 3]),
    ];
    let boxes: Boxes =
        corners.iter().enumerate().map(|(key, c)| (key as u32, MinMax::new(c.0, c.1).expect("in range"))).collect();
    let expected = brute::pairs(&boxes);
    assert!(expected.len() > 15 && expected.len() < 45, "{}", expected.len());
    let mut questions = brute::Questions::default();
    questions.boxes.extend(boxes.values());
    questions.points.extend(corners.iter().flat_map(|c| [c.0, c.1]));
    for direction in [[1.0; 3], [-1.0, 0.0, 0.0], [2.0_f64.powi(-600), 0.0, 0.0], [2.0_f64.powi(299); 3]] {
        for origin in [[0.0; 3], [-2.0_f64.powi(300); 3], [0.5; 3]] {
            questions.rays.push(Ray::new(origin, direction, f64::INFINITY).expect("a ray"));
        }
    }
    for scene in ALL {
        for (name, mut partition) in dynamic(scene) {
            boxes.iter().for_each(|(&key, &bounds)| _ = partition.insert(key, bounds));
            assert_eq!(partition.pairs(), expected, "{name}");
            brute::compare(&*partition, &boxes, &questions, name);
            for point in [[f64::NAN; 3], [f64::INFINITY, 0.0, 0.0], [1e100; 3].map(|x: f64| x * 1e100)] {
                assert_eq!(brute::found(|visit| partition.at(point, visit)), [], "{name}");
                assert!(partition.nearest(point, 2).is_empty(), "{name}");
            }
        }
    }
}

#[test]
fn a_search_ends_when_the_visitor_breaks() {
    for (name, mut partition) in dynamic(Scene::Grid) {
        for key in 0..50 {
            partition.insert(key, MinMax::new([f64::from(key % 5); 3], [6.0; 3]).expect("in range"));
        }
        let all = MinMax::new([-1.0; 3], [9.0; 3]).expect("in range");
        let mut visits = 0;
        let flow = partition.overlapping(&all, &mut |_| {
            visits += 1;
            if visits == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!((flow, visits), (ControlFlow::Break(()), 3), "{name}");
        let mut visits = 0;
        partition.ray(&Ray::new([0.0; 3], [1.0; 3], 9.0).expect("a ray"), &mut |_| {
            visits += 1;
            -1.0
        });
        assert_eq!(visits, 1, "{name}");
    }
}

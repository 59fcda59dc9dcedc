//! Clearances against the distances of all pairs, and against checks with paddings.

use impinge::query::batch::Execution;
use impinge::query::{self, Proximity};
use impinge::robot::{CheckError, CheckOptions, ClearanceOptions, Other};
use impinge::scene::Scene;
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::{configurations, grid_pose, robot, shapes};

#[test]
fn clearances_are_the_least_distance_of_all_pairs() {
    let mut rng = Rng::new(5);
    let all = shapes();
    let (mut positive, mut zero, mut beyond, mut on_obstacles) = (0, 0, 0, 0);
    for round in 0..rounds(30) {
        let robot = robot(&mut rng, 6);
        let mut scene = Scene::new();
        for part in 0..[0, 2, 20][round % 3] {
            let shape = all[rng.integer(0, 7) as usize].clone();
            scene.add(part.to_string(), shape, grid_pose(&mut rng, 12)).unwrap();
        }
        let ignored: Vec<_> = scene.parts().filter(|part| part.index() % 3 == 1).map(|part| (2, part)).collect();
        let limit = [f64::INFINITY, 0.75][round % 2];
        let options = ClearanceOptions { obstacles: Some(&scene), ignored: ignored.clone(), limit };
        let q = configurations(&mut rng, &robot, 6);
        let found = robot.clearances(&q, &options, Execution::default()).unwrap();
        assert_eq!(found, robot.clearances(&q, &options, Execution::default().sequentially()).unwrap());
        let columns = robot.coordinates().len();
        for (row, found) in found.values.iter().enumerate() {
            let q = &q[row * columns..(row + 1) * columns];
            let poses = robot.poses(q).unwrap();
            let at = |link: usize| robot.links()[link].shape.as_ref().unwrap().at(poses[link]).unwrap();
            let mut least = (f64::INFINITY, f64::INFINITY);
            let mut include = |a: &impinge::shape::PlacedShape, b: &impinge::shape::PlacedShape| {
                let distance = query::distance(a, b);
                least = (least.0.min(distance.lower), least.1.min(distance.upper));
            };
            robot.pairs().iter().for_each(|&[a, b]| include(&at(a), &at(b)));
            for link in (0..poses.len()).filter(|&link| robot.links()[link].shape.is_some()) {
                for part in scene.parts().filter(|part| !ignored.contains(&(link, *part))) {
                    include(&at(link), &scene.shape(part).at(*scene.pose(part)).unwrap());
                }
            }
            if least.0 > limit {
                assert_eq!((found.lower, found.upper, found.pair), (limit, f64::INFINITY, None));
                beyond += 1;
                continue;
            }
            assert!((found.lower - least.0).abs() < 1e-9 || found.lower == least.0, "{found:?} {least:?}");
            assert!((found.upper - least.1).abs() < 1e-9 || found.upper == least.1, "{found:?} {least:?}");
            let Some((link, other)) = found.pair else { continue };
            on_obstacles += usize::from(matches!(other, Other::Obstacle(_)));
            let check = |padding: f64| {
                let padding = CheckOptions {
                    obstacles: Some(&scene),
                    self_padding: padding,
                    padding: vec![padding; poses.len()],
                    ignored: ignored.clone(),
                    ..CheckOptions::default()
                };
                !robot.check(q, &padding, Execution::default()).unwrap().values[0].is_empty()
            };
            assert!(check(found.upper));
            if found.lower > 0.0 {
                positive += 1;
                // Round shapes are undecided to within rounding.
                assert!(!check(found.lower * (1.0 - 1e-9)));
                let [a, b] = found.points.unwrap();
                let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                assert!((apart - found.upper).abs() < 1e-9);
            } else {
                zero += 1;
                if let Other::Link(other) = other {
                    assert_ne!(query::proximity(at(link), at(other)), Proximity::Apart);
                }
            }
        }
    }
    assert!(positive > 20 && zero > 20 && beyond > 2 && on_obstacles > 10, "{positive} {zero} {beyond} {on_obstacles}");
}

#[test]
fn invalid_limits_are_errors() {
    let robot = robot(&mut Rng::new(1), 5);
    let q = configurations(&mut Rng::new(2), &robot, 1);
    for limit in [-1.0, f64::NAN] {
        let options = ClearanceOptions { limit, ..ClearanceOptions::default() };
        assert_eq!(robot.clearances(&q, &options, Execution::default()).unwrap_err(), CheckError::Padding);
    }
}

//! Checks of many configurations against queries pair by pair at the poses of the links.

use impinge::query::batch::{Execution, Status};
use impinge::query::{self, Proximity};
use impinge::robot::{CheckError, CheckOptions, Collision, Joint, JointKind, Other, Robot};
use impinge::scene::{Scene, Stop};
use impinge::{Budget, Pose, Shape};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::cuboid;
use impinge_testkit::rounds;

use super::{configurations, grid_pose, link, mesh, robot, shapes};

/// Returns the collisions of a configuration, by one query for each pair.
fn expected(robot: &Robot, q: &[f64], options: &CheckOptions<'_>) -> Vec<Collision> {
    let poses = robot.poses(q).unwrap();
    let at = |link: usize| robot.links()[link].shape.as_ref().map(|shape| shape.at(poses[link]).unwrap());
    let ask = |a: &impinge::shape::PlacedShape, b: &impinge::shape::PlacedShape, clearance: f64| {
        // Without a clearance this is `intersects`.
        if clearance > 0.0 { query::nearness(a, b, clearance) } else { query::proximity(a, b) }
    };
    let collision = |link, other, found: Proximity| {
        (found != Proximity::Apart).then(|| Collision { link, other, is_undecided: found == Proximity::Undecided })
    };
    let mut found = Vec::new();
    for &[a, b] in robot.pairs() {
        let proximity = ask(&at(a).unwrap(), &at(b).unwrap(), options.self_padding);
        found.extend(collision(a, Other::Link(b), proximity));
    }
    for (link, placed) in (0..robot.links().len()).filter_map(|link| Some((link, at(link)?))) {
        let clearance = options.padding.get(link).copied().unwrap_or(0.0);
        for part in options.obstacles.iter().flat_map(|scene| scene.parts()) {
            let scene = options.obstacles.unwrap();
            if !options.ignored.contains(&(link, part)) {
                let obstacle = scene.shape(part).at(*scene.pose(part)).unwrap();
                found.extend(collision(link, Other::Obstacle(part), ask(&placed, &obstacle, clearance)));
            }
        }
    }
    found
}

#[test]
fn checks_equal_queries_at_the_poses() {
    let mut rng = Rng::new(2);
    let (mut rows, mut hits, mut on_obstacles, mut ignored) = (0, 0, 0, 0);
    let all = shapes();
    for round in 0..rounds(40) {
        let robot = robot(&mut rng, 7);
        let mut scene = Scene::new();
        for part in 0..[0, 3, 24][round % 3] {
            let shape = all[rng.integer(0, 7) as usize].clone();
            let pose = (Pose::from_translation([3.0, 0.0, 0.0]).unwrap() * grid_pose(&mut rng, 6)).unwrap();
            scene.add(part.to_string(), shape, pose).unwrap();
        }
        if round % 6 == 5 {
            scene.add("floor", Shape::half_space([0.0, 0.0, 1.0], -2.0).unwrap(), Pose::IDENTITY).unwrap();
        }
        // Their boxes hold the robot. Most links are far from the walls of the room, and some are
        // inside of the blocks.
        let around = [None, Some("room"), Some("block"), Some("open block")][round / 3 % 4];
        if let Some(name) = around {
            let mut plain = cuboid([-4.0; 3], [4.0; 3]);
            plain.faces.truncate(if name == "open block" { 11 } else { 12 });
            let mesh = mesh(&plain);
            let shape = if name == "room" { Shape::from(&mesh) } else { Shape::from(mesh.solid()) };
            scene.add(name, shape, Pose::from_translation([1.5, 0.0, 1.0]).unwrap()).unwrap();
        }
        let paddings = [0.0, 0.25, 0.5];
        let options = CheckOptions {
            stop: Stop::All,
            obstacles: (round % 4 > 0).then_some(&scene),
            self_padding: paddings[round % 3],
            padding: (0..robot.links().len()).map(|_| paddings[rng.integer(0, 2) as usize]).collect(),
            ignored: scene.parts().filter(|part| part.index() % 3 == 1).map(|part| (2, part)).collect(),
        };
        let q = configurations(&mut rng, &robot, 12);
        let found = robot.check(&q, &options, Execution::default()).unwrap();
        let alone = robot.check(&q, &options, Execution::default().sequentially()).unwrap();
        assert_eq!(found, alone);
        let first = CheckOptions { stop: Stop::First, ..options.clone() };
        let first = robot.check(&q, &first, Execution::default()).unwrap();
        let columns = robot.coordinates().len();
        for (row, collisions) in found.values.iter().enumerate() {
            let q = &q[row * columns..(row + 1) * columns];
            assert_eq!(*collisions, expected(&robot, q, &options));
            assert_eq!(first.values[row], collisions[..collisions.len().min(1)]);
            let is_undecided = collisions.iter().any(|collision| collision.is_undecided);
            assert_eq!(found.status[row], if is_undecided { Status::Undecided } else { Status::Ok });
            rows += 1;
            hits += usize::from(!collisions.is_empty());
            on_obstacles += collisions.iter().filter(|c| matches!(c.other, Other::Obstacle(_))).count();
        }
        ignored += options.ignored.len();
    }
    assert!(hits * 10 > rows && hits * 20 < 19 * rows, "{hits} of {rows}");
    assert!(on_obstacles > rows / 10 && ignored > 20, "{on_obstacles} {ignored}");
}

#[test]
fn links_that_touch_collide_and_a_clearance_is_exact() {
    let cube = Shape::cuboid([0.5; 3]).unwrap();
    let slide = |name: &str, parent: &str, child: &str| {
        Joint::fixed(name, parent, child, Pose::IDENTITY).moving(JointKind::Prismatic, [1.0, 0.0, 0.0])
    };
    let links = vec![link(0, Some(cube.clone())), link(1, None), link(2, Some(cube))];
    let robot = Robot::new(links, vec![slide("a", "0", "1"), slide("b", "1", "2")]).unwrap();
    let check = |self_padding: f64, x: f64| {
        let options = CheckOptions { self_padding, ..CheckOptions::default() };
        !robot.check(&[0.75, x - 0.75], &options, Execution::default()).unwrap().values[0].is_empty()
    };
    assert!(check(0.0, 1.0) && !check(0.0, 1.0 + 1e-15));
    assert!(check(0.5, 1.5) && !check(0.5, 1.5 + 1e-15));
}

#[test]
fn invalid_clearances_and_spent_budgets_are_errors() {
    let mut rng = Rng::new(3);
    let robot = robot(&mut rng, 7);
    let q = configurations(&mut rng, &robot, 9);
    for self_padding in [-1.0, f64::NAN, f64::INFINITY] {
        let options = CheckOptions { self_padding, ..CheckOptions::default() };
        assert_eq!(robot.check(&q, &options, Execution::default()).unwrap_err(), CheckError::Padding);
    }
    let is_canceled = || true;
    let budget = Budget::new().with_cancel(&is_canceled);
    let stopped = robot.check(&q, &CheckOptions::default(), Execution::default().with_budget(&budget));
    assert!(matches!(stopped, Err(CheckError::Stopped(_))));
}

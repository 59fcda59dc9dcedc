//! Audits against closed forms and samples, and objects that a robot holds.

use impinge::query::batch::Execution;
use impinge::robot::{
    AuditOptions, AuditedPair, CheckOptions, Joint, JointKind, Link, Mimic, Other, PairFinding, Robot, RobotError,
};
use impinge::scene::Stop;
use impinge::{Pose, Shape};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::{configurations, grid_pose, link, robot, shapes};

fn audit(robot: &Robot, options: AuditOptions) -> Vec<AuditedPair> {
    let found = robot.audit(&options, Execution::default()).unwrap();
    assert_eq!(found, robot.audit(&options, Execution::default().sequentially()).unwrap());
    found
}

/// Returns an arm of three rods whose joints turn by at most a limit.
fn arm(limit: f64) -> Robot {
    let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.0625).unwrap();
    let tip = Pose::from_translation([1.0, 0.0, 0.0]).unwrap();
    let joint = |name: usize| {
        let joint = Joint::fixed(name.to_string(), name.to_string(), (name + 1).to_string(), tip);
        joint.moving(JointKind::Revolute, [0.0, 0.0, 1.0]).limited(-limit, limit)
    };
    Robot::new((0..3).map(|name| link(name, Some(rod.clone()))).collect(), vec![joint(0), joint(1)]).unwrap()
}

#[test]
fn the_ends_of_an_arm_collide_if_it_folds_far_enough() {
    // With both angles at 120 degrees the rods are a triangle; their ends touch at a little less.
    let options = AuditOptions { samples: 200, ..AuditOptions::default() };
    for (limit, is_free) in [(1.0, true), (1.9, true), (2.2, false), (3.0, false)] {
        let found = audit(&arm(limit), options);
        assert_eq!(found.iter().map(|pair| pair.links).collect::<Vec<_>>(), [[0, 1], [0, 2], [1, 2]]);
        assert_eq!((&found[0].finding, found[0].is_checked), (&PairFinding::Adjacent, false));
        assert_eq!(found[1].finding == PairFinding::ProvedNever, is_free, "{limit} {found:?}");
        if let PairFinding::Witness(q) = &found[1].finding {
            assert!(q.iter().all(|x| x.abs() <= limit));
        }
    }
    let few = audit(&arm(1.9), AuditOptions { max_boxes: 1, ..options });
    assert_eq!(few[1].finding, PairFinding::Open);
}

#[test]
fn findings_agree_with_samples() {
    let mut rng = Rng::new(11);
    let (mut never, mut witness, mut always, mut open, mut adjacent) = (0, 0, 0, 0, 0);
    for _ in 0..rounds(40) {
        let mut robot = robot(&mut rng, 5);
        let ignored = [[0, 1], [1, 3]];
        robot.choose(ignored.map(|pair| (pair, Some(String::new()))));
        let options = AuditOptions { samples: 60, seed: rng.integer(0, 9) as u64, max_boxes: 300 };
        let mut everything = robot.clone();
        let found = audit(&robot, options);
        everything
            .choose(found.iter().map(|pair| (pair.links, (pair.finding == PairFinding::Adjacent).then(String::new))));
        let check = CheckOptions { stop: Stop::All, ..CheckOptions::default() };
        let hits = |q: &[f64], pair: [usize; 2]| {
            let found = everything.check(q, &check, Execution::default()).unwrap();
            found.values[0].iter().any(|hit| [hit.link] == pair[..1] && hit.other == Other::Link(pair[1]))
        };
        for pair in &found {
            assert_eq!(pair.is_checked, robot.pairs().contains(&pair.links));
            match &pair.finding {
                PairFinding::Adjacent => adjacent += 1,
                PairFinding::Witness(q) => {
                    witness += 1;
                    assert!(hits(q, pair.links));
                }
                PairFinding::Always(q) => {
                    always += 1;
                    assert!(hits(q, pair.links));
                }
                PairFinding::ProvedNever => {
                    never += 1;
                    // Values at the limits and between, which are ties on a grid.
                    for _ in 0..20 {
                        let mut range =
                            |[low, high]: [f64; 2]| [low, high, 0.5 * (low + high)][rng.integer(0, 2) as usize];
                        let finite = |limit: f64| limit.clamp(-3.0, 3.0);
                        let q: Vec<f64> = robot.coordinates().iter().map(|c| range(c.limits.map(finite))).collect();
                        if robot.check_rows(&q).is_ok() {
                            assert!(!hits(&q, pair.links), "{pair:?} {q:?}");
                        }
                    }
                }
                PairFinding::Open => open += 1,
            }
        }
    }
    let counts = [never, witness, open, adjacent];
    assert!(counts.iter().all(|count| *count > 8), "{counts:?} {always}");
}

#[test]
fn pairs_that_collide_in_every_sample_have_a_witness() {
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap();
    let turn = |name: usize| {
        let joint = Joint::fixed(name.to_string(), name.to_string(), (name + 1).to_string(), Pose::IDENTITY);
        joint.moving(JointKind::Revolute, [0.0, 0.0, 1.0]).limited(-1.0, 1.0)
    };
    let links = vec![link(0, Some(ball.clone())), link(1, None), link(2, Some(ball))];
    let robot = Robot::new(links, vec![turn(0), turn(1)]).unwrap();
    let found = audit(&robot, AuditOptions { samples: 20, ..AuditOptions::default() });
    assert!(matches!(&found[..], [AuditedPair { finding: PairFinding::Always(q), .. }] if q.len() == 2), "{found:?}");
    // Without samples the middle of the limits is a witness.
    let found = audit(&robot, AuditOptions { samples: 0, ..AuditOptions::default() });
    assert_eq!(found[0].finding, PairFinding::Witness(vec![0.0; 2]));
}

#[test]
fn angles_without_limits_take_all_values() {
    let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.0625).unwrap();
    let at = |x: f64| Pose::from_translation([x, 0.0, 0.0]).unwrap();
    let turn = |name: &str, parent: &str, child: &str, origin: Pose| {
        Joint::fixed(name, parent, child, origin).moving(JointKind::Continuous, [0.0, 0.0, 1.0])
    };
    let made = |distance: f64| {
        let links = vec![link(0, None), link(1, Some(rod.clone())), link(2, Some(rod.clone()))];
        Robot::new(links, vec![turn("a", "0", "1", at(0.0)), turn("b", "0", "2", at(distance))]).unwrap()
    };
    let options = AuditOptions { samples: 0, ..AuditOptions::default() };
    assert_eq!(audit(&made(2.25), options)[0].finding, PairFinding::ProvedNever);
    assert!(matches!(audit(&made(1.75), options)[0].finding, PairFinding::Witness(_)));
    // Half of an angle does not repeat with the angle.
    let mut joints = made(2.25).joints().to_vec();
    joints[1].mimic = Some(Mimic { joint: "a".into(), multiplier: 0.5, offset: 0.0 });
    let follower = Robot::new(made(2.25).links().to_vec(), joints).unwrap();
    assert_eq!(audit(&follower, options)[0].finding, PairFinding::Open);
}

#[test]
fn attached_objects_are_links_of_the_robot() {
    let mut rng = Rng::new(12);
    let all = shapes();
    let (mut held_hits, mut touching) = (0, 0);
    for _ in 0..rounds(30) {
        let mut robot = robot(&mut rng, 5);
        robot.choose([([0, 2], Some("chosen".to_owned()))]);
        let shape = all[rng.integer(0, 6) as usize].clone();
        let (holder, touch) = (rng.integer(0, 4) as usize, rng.integer(0, 4) as usize);
        let pose = grid_pose(&mut rng, 2);
        let holding = robot.attached("held", shape.clone(), holder, pose, &[touch]).unwrap();
        // The same robot from the start.
        let mut links = robot.links().to_vec();
        links.push(Link { name: "held".into(), shape: Some(shape) });
        let mut joints = robot.joints().to_vec();
        joints.push(Joint::fixed("fixed", links[holder].name.clone(), "held", pose));
        let mut whole = Robot::new(links, joints).unwrap();
        whole.choose([([0, 2], Some("chosen".to_owned())), ([touch, 5], Some(String::new()))]);
        assert_eq!((holding.pairs(), holding.coordinates()), (whole.pairs(), whole.coordinates()));
        let q = configurations(&mut rng, &robot, 10);
        let check = CheckOptions { stop: Stop::All, ..CheckOptions::default() };
        let found = holding.check(&q, &check, Execution::default()).unwrap();
        assert_eq!(found, whole.check(&q, &check, Execution::default()).unwrap());
        let alone = robot.check(&q, &check, Execution::default()).unwrap();
        for (with, without) in found.values.iter().zip(&alone.values) {
            let of_robot = with.iter().filter(|hit| hit.other != Other::Link(5)).copied();
            assert_eq!(of_robot.collect::<Vec<_>>(), *without);
            held_hits += with.len() - without.len();
            assert!(!with.iter().any(|hit| hit.link == touch && hit.other == Other::Link(5)));
        }
        touching += usize::from(holding.ignored_reason(touch, 5).is_some() && touch != holder);
        let taken = robot.attached("3", all[0].clone(), holder, pose, &[]);
        assert_eq!(taken.unwrap_err(), RobotError::LinkNameTaken { link: "3".into() });
    }
    assert!(held_hits > 30 && touching > 10, "{held_hits} {touching}");
}

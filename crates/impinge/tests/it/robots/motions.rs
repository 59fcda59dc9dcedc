//! Motions with proofs: closed forms, and laws against samples.

use impinge::query::batch::{Execution, Status};
use impinge::robot::{
    CertificateError, CheckError, CheckOptions, Joint, JointKind, Link, MotionCheck, MotionOptions, Other, Robot,
    Verdict,
};
use impinge::scene::Scene;
use impinge::{Budget, Pose, Shape};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::{configurations, grid_pose, link, robot, shapes};

fn motion(robot: &Robot, starts: &[f64], ends: &[f64], options: &MotionOptions<'_>) -> MotionCheck {
    let mut found = robot.check_motions(starts, ends, options, Execution::default()).unwrap();
    assert_eq!(found.values.len(), 1);
    found.values.pop().unwrap()
}

/// Returns a robot that is a sphere of 5 mm on a rail along x.
fn rail() -> Robot {
    let links = vec![link(0, None), link(1, Some(Shape::sphere([0.0; 3], 0.005).unwrap()))];
    let slide = Joint::fixed("slide", "0", "1", Pose::IDENTITY).moving(JointKind::Prismatic, [1.0, 0.0, 0.0]);
    Robot::new(links, vec![slide]).unwrap()
}

fn obstacles(parts: &[(Shape, [f64; 3])]) -> Scene {
    let mut scene = Scene::new();
    for (at, (shape, place)) in parts.iter().enumerate() {
        scene.add(at.to_string(), shape.clone(), Pose::from_translation(*place).unwrap()).unwrap();
    }
    scene
}

fn against(scene: &Scene) -> MotionOptions<'_> {
    let check = CheckOptions { obstacles: Some(scene), ..CheckOptions::default() };
    MotionOptions { check, keeps_certificate: true, ..MotionOptions::default() }
}

#[test]
fn a_thin_plate_is_hit_at_its_time_and_a_slot_is_free() {
    let plate = obstacles(&[(Shape::cuboid([0.0005, 1.0, 1.0]).unwrap(), [0.025, 0.0, 0.0])]);
    let found = motion(&rail(), &[-0.5], &[0.5], &against(&plate));
    assert_eq!(found.verdict, Verdict::Collides);
    let hit_at = found.hit_at.unwrap();
    assert!(found.free_until <= 0.5195 + 1e-15 && hit_at >= 0.5195 - 1e-15, "{found:?}");
    assert!(hit_at - found.free_until < 1e-9 && found.certificate.is_none());
    assert!(matches!(found.collision.unwrap().other, Other::Obstacle(_)));

    let half = Shape::cuboid([0.0005, 0.5, 1.0]).unwrap();
    let slot = obstacles(&[(half.clone(), [0.025, 0.5085, 0.0]), (half, [0.025, -0.5085, 0.0])]);
    let mut options = against(&slot);
    let found = motion(&rail(), &[-0.5], &[0.5], &options);
    assert_eq!((found.verdict, found.free_until, found.hit_at), (Verdict::Free, 1.0, None));
    // The sphere passes with 3.5 mm to spare.
    for (padding, verdict) in [(0.0034, Verdict::Free), (0.0036, Verdict::Collides)] {
        options.check.padding = vec![0.0, padding];
        assert_eq!(motion(&rail(), &[-0.5], &[0.5], &options).verdict, verdict);
    }
}

#[test]
fn an_arm_hits_a_post_at_its_angle() {
    let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.125).unwrap();
    let turn = Joint::fixed("turn", "0", "1", Pose::IDENTITY).moving(JointKind::Revolute, [0.0, 0.0, 1.0]);
    let robot = Robot::new(vec![link(0, None), link(1, Some(rod))], vec![turn]).unwrap();
    let post = obstacles(&[(Shape::sphere([0.0; 3], 0.125).unwrap(), [0.0, 0.75, 0.0])]);
    let found = motion(&robot, &[0.0], &[2.0], &against(&post));
    // The axis of the rod is at the distance 0.75 cos(angle) from the center of the post.
    let truth = (0.25_f64 / 0.75).acos() / 2.0;
    assert!((found.free_until - truth).abs() < 1e-9 && (found.hit_at.unwrap() - truth).abs() < 1e-9);
    // A motion that starts in contact collides at once.
    let found = motion(&robot, &[2.0], &[0.0], &against(&post));
    assert_eq!(found.verdict, Verdict::Collides);
    let found = motion(&robot, &[std::f64::consts::FRAC_PI_2], &[0.0], &against(&post));
    assert_eq!((found.verdict, found.free_until, found.hit_at), (Verdict::Collides, 0.0, Some(0.0)));
}

/// Returns whether a configuration collides.
fn collides(robot: &Robot, q: &[f64], options: &CheckOptions<'_>) -> bool {
    !robot.check(q, options, Execution::default().sequentially()).unwrap().values[0].is_empty()
}

#[test]
fn verdicts_agree_with_samples_and_with_the_reversed_motion() {
    let mut rng = Rng::new(7);
    let all = shapes();
    let (mut free, mut hits, mut undecided, mut verified, mut gaps) = (0, 0, 0, 0, 0);
    for round in 0..rounds(40) {
        let robot = robot(&mut rng, 6);
        let mut scene = Scene::new();
        for part in 0..[0, 2, 20][round % 3] {
            let far = Pose::from_translation([4.0, 0.0, 0.0]).unwrap();
            let pose = (far * grid_pose(&mut rng, 6)).unwrap();
            scene.add(part.to_string(), all[rng.integer(0, 7) as usize].clone(), pose).unwrap();
        }
        let mut options = against(&scene);
        options.max_steps = 3000;
        options.check.self_padding = [0.0, 0.0625][round % 2];
        for _ in 0..4 {
            // Motions from a grid, to places beside it and so without ties.
            let start = configurations(&mut rng, &robot, 1);
            let end: Vec<f64> = start.iter().map(|x| x + rng.uniform(-0.9, 0.9)).collect();
            if collides(&robot, &start, &options.check) {
                continue;
            }
            let found = motion(&robot, &start, &end, &options);
            let reversed = motion(&robot, &end, &start, &options);
            if ![found.verdict, reversed.verdict].contains(&Verdict::Undecided) {
                assert_eq!(found.verdict, reversed.verdict);
            }
            let at = |t: f64| -> Vec<f64> { start.iter().zip(&end).map(|(p, q)| (1.0 - t) * p + t * q).collect() };
            for k in 0..=40 {
                let t =
                    found.free_until * f64::from(k) / 40.0 * if found.verdict == Verdict::Free { 1.0 } else { 0.999 };
                assert!(!collides(&robot, &at(t), &options.check), "{t} {found:?}");
            }
            match found.verdict {
                Verdict::Free => {
                    free += 1;
                    let certificate = found.certificate.unwrap();
                    robot.verify(&certificate, &options.check).unwrap();
                    for at in [0, certificate.rows.len().saturating_sub(1)] {
                        let mut changed = certificate.clone();
                        let Some(row) = changed.rows.get_mut(at) else { continue };
                        row.half *= 0.5;
                        let is_gap =
                            matches!(robot.verify(&changed, &options.check), Err(CertificateError::Gap { .. }));
                        gaps += usize::from(is_gap);
                        changed = certificate.clone();
                        changed.rows[at].link = 99;
                        let refused = robot.verify(&changed, &options.check);
                        assert_eq!(refused, Err(CertificateError::Row { row: at }));
                        verified += 1;
                    }
                }
                Verdict::Collides => {
                    hits += 1;
                    assert!(collides(&robot, &found.hit.unwrap(), &options.check));
                    assert!(found.free_until <= found.hit_at.unwrap());
                }
                Verdict::Undecided => undecided += 1,
            }
        }
    }
    // Intervals of a pair may overlap, so that it is covered without half of one.
    assert!(gaps * 2 > verified, "{gaps} of {verified}");
    assert!(free > 15 && hits > 15 && verified > 10, "{free} {hits} {undecided} {verified}");
    assert!(undecided * 5 < free + hits, "{free} {hits} {undecided}");
}

#[test]
fn rows_that_are_too_long_do_not_hold() {
    let plate = obstacles(&[(Shape::cuboid([0.0005, 1.0, 1.0]).unwrap(), [0.025, 0.0, 0.0])]);
    let options = against(&plate);
    let certificate = motion(&rail(), &[-0.5], &[0.0], &options).certificate.unwrap();
    assert_eq!(rail().verify(&certificate, &options.check), Ok(()));
    let mut changed = certificate.clone();
    changed.end = vec![0.25];
    assert!(matches!(rail().verify(&changed, &options.check), Err(CertificateError::TooNear { .. })));
    let far = obstacles(&[(Shape::cuboid([0.0005, 1.0, 1.0]).unwrap(), [-0.1, 0.0, 0.0])]);
    assert!(rail().verify(&certificate, &against(&far).check).is_err());
}

#[test]
fn motions_that_are_not_proved_are_undecided() {
    // Two spheres slide past each other and touch at one time that is not examined.
    let sphere = Shape::sphere([0.0; 3], 0.5).unwrap();
    let scene = obstacles(&[(sphere.clone(), [1.0 / 3.0, 1.0, 0.0])]);
    let slide = Joint::fixed("slide", "0", "1", Pose::IDENTITY).moving(JointKind::Prismatic, [1.0, 0.0, 0.0]);
    let robot = Robot::new(vec![link(0, None), link(1, Some(sphere))], vec![slide]).unwrap();
    let found = robot.check_motions(&[0.0], &[1.0], &against(&scene), Execution::default()).unwrap();
    assert_ne!(found.values[0].verdict, Verdict::Free);
    if found.values[0].verdict == Verdict::Undecided {
        assert_eq!(found.status, [Status::Undecided]);
        assert!((found.values[0].free_until - 1.0 / 3.0).abs() < 1e-4);
    }
    // No steps are left.
    let options = MotionOptions { max_steps: 2, ..against(&scene) };
    assert_eq!(motion(&robot, &[0.0], &[0.25], &options).verdict, Verdict::Undecided);
    // Nothing bounds a half-space that a link carries.
    let links = vec![link(0, None), link(1, Some(Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap()))];
    let turn = Joint::fixed("turn", "0", "1", Pose::IDENTITY).moving(JointKind::Revolute, [1.0, 0.0, 0.0]);
    let carrier = Robot::new(links, vec![turn]).unwrap();
    let scene = obstacles(&[(Shape::sphere([0.0; 3], 0.5).unwrap(), [0.0, 0.0, 1.0])]);
    assert_eq!(motion(&carrier, &[0.0], &[0.25], &against(&scene)).verdict, Verdict::Undecided);
    assert_eq!(motion(&carrier, &[0.0], &[1.5], &against(&scene)).verdict, Verdict::Collides);
}

#[test]
fn a_floating_robot_that_turns_through_no_rotation_is_not_free() {
    // In the middle the quaternion is zero, and the rod might point anywhere, such as to the post.
    let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.125).unwrap();
    let free = Joint::fixed("free", "0", "1", Pose::IDENTITY).moving(JointKind::Floating, [0.0, 0.0, 1.0]);
    let robot = Robot::new(vec![link(0, None), link(1, Some(rod))], vec![free]).unwrap();
    let ends = [1.0, -1.0].map(|w| [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, w]);
    for (place, verdict) in [([0.0, 0.75, 0.0], Verdict::Undecided), ([0.0, 3.0, 0.0], Verdict::Free)] {
        let post = obstacles(&[(Shape::sphere([0.0; 3], 0.125).unwrap(), place)]);
        let options = MotionOptions { max_steps: 1000, ..against(&post) };
        assert_eq!(motion(&robot, &ends[0], &ends[1], &options).verdict, verdict);
    }
}

#[test]
fn links_in_a_common_frame_need_few_steps() {
    // The whole arm turns by a turn, but its links stay where they are relative to each other.
    let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.125).unwrap();
    let at_tip = Pose::from_translation([1.0, 0.0, 0.0]).unwrap();
    let links = (0..4).map(|name| link(name, (name > 0).then(|| rod.clone()))).collect();
    let joint = |name: usize| {
        let joint = Joint::fixed(name.to_string(), name.to_string(), (name + 1).to_string(), at_tip);
        joint.moving(JointKind::Revolute, [0.0, 0.0, 1.0])
    };
    let robot = Robot::new(links, (0..3).map(joint).collect()).unwrap();
    let options = MotionOptions { keeps_certificate: true, ..MotionOptions::default() };
    let found = motion(&robot, &[0.0, 1.0, 1.0], &[6.0, 1.0, 1.0], &options);
    let certificate = found.certificate.unwrap();
    assert_eq!((found.verdict, certificate.rows.len()), (Verdict::Free, 1));
    assert_eq!(robot.verify(&certificate, &options.check), Ok(()));
    // The elbow moves a little, too: the near links move by its lever, not by that of the arm.
    let found = motion(&robot, &[0.0, 1.0, 1.0], &[6.0, 1.0, 1.125], &options);
    assert!(found.verdict == Verdict::Free && found.certificate.unwrap().rows.len() <= 2);
}

#[test]
fn invalid_motions_and_spent_budgets_are_errors() {
    let robot = rail();
    let options = MotionOptions::default();
    let refused = robot.check_motions(&[0.0, 1.0], &[0.0], &options, Execution::default());
    assert_eq!(refused.unwrap_err(), CheckError::Lengths { starts: 2, ends: 1 });
    assert!(robot.check_motions(&[f64::NAN], &[0.0], &options, Execution::default()).is_err());
    let is_canceled = || true;
    let budget = Budget::new().with_cancel(&is_canceled);
    let stopped = robot.check_motions(&[0.0], &[1.0], &options, Execution::default().with_budget(&budget));
    assert!(matches!(stopped, Err(CheckError::Stopped(_))));
    let alone = Robot::new(vec![Link { name: "a".into(), shape: None }], Vec::new()).unwrap();
    assert_eq!(motion(&alone, &[], &[], &options).verdict, Verdict::Free);
}

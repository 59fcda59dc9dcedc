//! Poses of links against products of single poses.

use std::collections::HashMap;

use impinge::Pose;
use impinge::robot::{ConfigurationError, Joint, JointKind, Robot};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::{configurations, link, robot};

/// Returns the motion of a joint by the platform's sine and cosine.
fn motion(joint: &Joint, values: &[f64]) -> Pose {
    let turned = |angle: f64| Pose::from_axis_angle(joint.axis, angle, [0.0; 3]).unwrap();
    match joint.kind {
        JointKind::Fixed => Pose::IDENTITY,
        JointKind::Revolute | JointKind::Continuous => turned(values[0]),
        JointKind::Prismatic => {
            let length = joint.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
            Pose::from_translation(joint.axis.map(|x| x / length * values[0])).unwrap()
        }
        JointKind::Planar => {
            let length = joint.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
            let [x, y, z] = joint.axis.map(|x| x / length);
            // The smallest rotation that takes z to the axis.
            let tilt = match (x, y, z) {
                (_, _, -1.0) => Pose::from_axis_angle([1.0, 0.0, 0.0], std::f64::consts::PI, [0.0; 3]),
                (0.0, 0.0, _) => Ok(Pose::IDENTITY),
                _ => Pose::from_axis_angle([-y, x, 0.0], z.acos(), [0.0; 3]),
            };
            let moved = tilt.unwrap().apply([values[0], values[1], 0.0]);
            (Pose::from_translation(moved).unwrap() * turned(values[2])).unwrap()
        }
        JointKind::Floating => {
            let length = values[3..].iter().map(|x| x * x).sum::<f64>().sqrt();
            let [x, y, z, w] = [3, 4, 5, 6].map(|k: usize| values[k] / length);
            Pose::from_quaternion_wxyz([values[0], values[1], values[2]], [w, x, y, z]).unwrap()
        }
    }
}

/// Returns the values of the coordinates of a joint, followed through the chain of mimics.
fn values(robot: &Robot, joint: &Joint, configuration: &[f64]) -> Vec<f64> {
    if let Some(mimic) = &joint.mimic {
        let followed = robot.joints().iter().find(|other| other.name == mimic.joint).unwrap();
        return vec![mimic.multiplier * values(robot, followed, configuration)[0] + mimic.offset];
    }
    let own =
        |(_, coordinate): &(usize, &impinge::robot::Coordinate)| robot.joints()[coordinate.joint].name == joint.name;
    robot.coordinates().iter().enumerate().filter(own).map(|(at, _)| configuration[at]).collect()
}

#[test]
fn poses_are_products_of_the_motions_of_the_joints() {
    let mut rng = Rng::new(1);
    let (mut followers, mut deep) = (0, 0);
    for _ in 0..rounds(60) {
        let robot = robot(&mut rng, 9);
        let q = configurations(&mut rng, &robot, 1);
        let poses = robot.poses(&q).unwrap();
        let above: HashMap<&str, &Joint> = robot.joints().iter().map(|joint| (joint.child.as_str(), joint)).collect();
        followers += robot.joints().iter().filter(|joint| joint.mimic.is_some()).count();
        for (at, link) in robot.links().iter().enumerate() {
            let (mut expected, mut name, mut depth) = (Pose::IDENTITY, link.name.as_str(), 0);
            while let Some(joint) = above.get(name) {
                let moved = (joint.parent_from_joint * motion(joint, &values(&robot, joint, &q))).unwrap();
                expected = (moved * expected).unwrap();
                (name, depth) = (&joint.parent, depth + 1);
            }
            deep = deep.max(depth);
            for i in 0..3 {
                for j in 0..3 {
                    assert!((poses[at].linear()[i][j] - expected.linear()[i][j]).abs() < 1e-13);
                }
                assert!((poses[at].translation()[i] - expected.translation()[i]).abs() < 1e-12);
            }
        }
    }
    assert!(followers > 20 && deep > 3);
}

#[test]
fn turns_about_coordinate_axes_keep_their_axis_exactly() {
    for axis in [[1.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 0.5]] {
        let turn = Joint::fixed("turn", "0", "1", Pose::IDENTITY).moving(JointKind::Continuous, axis);
        let robot = Robot::new(vec![link(0, None), link(1, None)], vec![turn]).unwrap();
        for angle in [0.1, 1.0, 1e5, std::f64::consts::PI] {
            let [_, turned] = robot.poses(&[angle]).unwrap()[..] else { unreachable!() };
            assert_eq!(turned.apply(axis), axis);
        }
        assert_eq!(robot.poses(&[0.0]).unwrap()[1], Pose::IDENTITY);
    }
}

#[test]
fn invalid_configurations_name_the_row_and_the_coordinate() {
    let turn = Joint::fixed("turn", "0", "1", Pose::IDENTITY).moving(JointKind::Continuous, [0.0, 0.0, 1.0]);
    let free = Joint::fixed("free", "1", "2", Pose::IDENTITY).moving(JointKind::Floating, [0.0; 3]);
    let robot = Robot::new(vec![link(0, None), link(1, None), link(2, None)], vec![turn, free]).unwrap();
    let names: Vec<&str> = robot.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    assert_eq!(names, ["turn", "free/x", "free/y", "free/z", "free/qx", "free/qy", "free/qz", "free/qw"]);
    let fine = [0.5, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 2.0];
    assert_eq!(robot.check_rows(&[fine, fine].concat()), Ok(2));
    let changed = |coordinate: usize, value: f64| {
        let mut rows = [fine, fine].concat();
        rows[8 + coordinate] = value;
        robot.check_rows(&rows).unwrap_err()
    };
    assert_eq!(changed(0, f64::NAN), ConfigurationError::NonFinite { row: 1, coordinate: 0 });
    assert_eq!(changed(0, 1e7), ConfigurationError::OutOfRange { row: 1, coordinate: 0 });
    assert_eq!(changed(2, 1e39), ConfigurationError::OutOfRange { row: 1, coordinate: 2 });
    assert_eq!(changed(7, 0.0), ConfigurationError::ZeroQuaternion { row: 1, coordinate: 4 });
    assert_eq!(robot.check_rows(&fine[1..]), Err(ConfigurationError::Count { count: 7, coordinates: 8 }));
}

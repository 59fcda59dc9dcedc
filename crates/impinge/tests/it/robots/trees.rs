//! Links and joints that are no robot, and the pairs that are checked.

use impinge::robot::{IgnoredReason, Joint, JointKind, Mimic, Robot, RobotError};
use impinge::{Pose, Shape};

use super::link;

fn joint(name: &str, parent: usize, child: usize) -> Joint {
    let joint = Joint::fixed(name, parent.to_string(), child.to_string(), Pose::IDENTITY);
    joint.moving(JointKind::Revolute, [0.0, 0.0, 1.0])
}

fn error(links: usize, joints: Vec<Joint>) -> RobotError {
    Robot::new((0..links).map(|name| link(name, None)).collect(), joints).unwrap_err()
}

#[test]
fn what_is_no_tree_is_an_error_that_names_the_link() {
    let name = |x: &str| x.to_owned();
    assert_eq!(error(0, Vec::new()), RobotError::NoLinks);
    assert_eq!(error(2, Vec::new()), RobotError::SeveralRoots { links: vec![name("0"), name("1")] });
    assert_eq!(error(2, vec![joint("a", 0, 7)]), RobotError::UnknownLink { joint: name("a"), link: name("7") });
    assert_eq!(error(3, vec![joint("a", 0, 1), joint("a", 1, 2)]), RobotError::JointNameTaken { joint: name("a") });
    assert_eq!(
        error(2, vec![joint("a", 0, 1), joint("b", 0, 1)]),
        RobotError::TwoParents { link: name("1"), joints: [name("a"), name("b")] }
    );
    // All links in a cycle, and a cycle beside the tree.
    assert_eq!(error(2, vec![joint("a", 0, 1), joint("b", 1, 0)]), RobotError::Cycle { link: name("0") });
    let beside = vec![joint("a", 1, 2), joint("b", 2, 1)];
    assert_eq!(error(3, beside), RobotError::Cycle { link: name("1") });
    assert_eq!(error(1, vec![joint("a", 0, 0)]), RobotError::Cycle { link: name("0") });
    let twice = Robot::new(vec![link(0, None), link(0, None)], Vec::new()).unwrap_err();
    assert_eq!(twice, RobotError::LinkNameTaken { link: name("0") });
}

#[test]
fn invalid_joints_are_errors_that_name_the_joint() {
    let of = |change: &dyn Fn(&mut Joint)| {
        let mut joints = vec![joint("a", 0, 1), joint("b", 1, 2)];
        change(&mut joints[1]);
        error(3, joints)
    };
    let mimic = |joint: &str, multiplier| Some(Mimic { joint: joint.to_owned(), multiplier, offset: 0.0 });
    for (invalid, start) in [
        (of(&|joint| joint.axis = [0.0; 3]), "joint \"b\": its axis has no direction"),
        (of(&|joint| joint.axis[1] = f64::NAN), "joint \"b\": its axis has no direction"),
        (of(&|joint| joint.limits = Some([1.0, 0.0])), "joint \"b\": invalid limits: lower 1, upper 0"),
        (of(&|joint| joint.limits = Some([f64::NAN, 0.0])), "joint \"b\": invalid limits: lower NaN"),
        (of(&|joint| joint.mimic = mimic("b", 1.0)), "joint \"b\": it follows itself"),
        (of(&|joint| joint.mimic = mimic("c", 1.0)), "joint \"b\": it follows the joint \"c\", which does not exist"),
        (of(&|joint| joint.mimic = mimic("a", f64::INFINITY)), "joint \"b\": its multiplier"),
        (
            of(&|joint| {
                joint.parent_from_joint =
                    Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap()
            }),
            "joint \"b\": its origin",
        ),
        (
            of(&|joint| (joint.kind, joint.mimic) = (JointKind::Planar, mimic("a", 1.0))),
            "joint \"b\": only joints with one",
        ),
    ] {
        assert!(invalid.to_string().starts_with(start), "{invalid}");
    }
}

#[test]
fn pairs_that_are_ignored_have_a_reason() {
    // 0 - 1 = 2 - 3, where = is a fixed joint, and 4 without a shape between 0 and 5.
    let fixed = |name: &str, parent: usize, child: usize| {
        Joint::fixed(name, parent.to_string(), child.to_string(), Pose::IDENTITY)
    };
    let joints = vec![joint("a", 0, 1), fixed("b", 1, 2), joint("c", 2, 3), joint("d", 0, 4), fixed("e", 4, 5)];
    let ball = Shape::sphere([0.0; 3], 0.5).unwrap();
    let links = (0..6).map(|name| link(name, (name != 4).then(|| ball.clone()))).collect();
    let mut robot = Robot::new(links, joints).unwrap();
    assert_eq!(robot.pairs(), [[0, 2], [0, 3], [0, 5], [1, 3], [1, 5], [2, 5], [3, 5]]);
    let reasons =
        [([0, 1], IgnoredReason::Adjacent), ([1, 2], IgnoredReason::Rigid), ([2, 3], IgnoredReason::Adjacent)];
    assert_eq!(robot.ignored(), reasons);
    robot.choose([([5, 0], Some("Never".to_owned())), ([1, 2], None), ([0, 3], Some(String::new())), ([3, 0], None)]);
    assert_eq!(robot.pairs(), [[0, 2], [0, 3], [1, 2], [1, 3], [1, 5], [2, 5], [3, 5]]);
    assert_eq!(robot.ignored_reason(0, 5), Some(IgnoredReason::Disabled("Never".to_owned())));
}

//! Links and joints of URDF files, and errors in them.

use impinge::Pose;
use impinge::robot::JointKind;
use impinge_files::{LoadErrorKind, RobotOptions, load_robot};

use super::{data, load, message, robot};

#[test]
fn a_robot_of_primitives_is_read() {
    let loaded = load_robot(data().join("gantry.urdf"), &RobotOptions::default()).unwrap();
    let names: Vec<&str> = loaded.robot.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    assert_eq!((loaded.name.as_str(), loaded.warnings.len()), ("gantry", 0));
    assert_eq!(names, ["slide", "shoulder", "elbow", "wrist", "grip"]);
    let limits: Vec<[f64; 2]> = loaded.robot.coordinates().iter().map(|coordinate| coordinate.limits).collect();
    assert_eq!(limits[..2], [[-0.25, 0.5], [-3.0, 3.0]]);
    assert_eq!(limits[3], [f64::NEG_INFINITY, f64::INFINITY]);
    // The fingers open by the same length to both sides.
    let poses = loaded.robot.poses(&[0.0, 0.0, 0.0, 0.0, 0.03]).unwrap();
    let at = |name: &str| poses[loaded.robot.link(name).unwrap()].translation()[1];
    assert!((at("left_finger") - 0.04).abs() < 1e-15 && (at("right_finger") + 0.04).abs() < 1e-15);
}

#[test]
fn all_joints_and_shapes_are_read_in_any_order() {
    let links = ["<link name='a'/>", "<link name='b'/>", "<link name='c'/>", "<link name='d'/>", "<link name='e'/>"];
    let joint = |name, kind, parent, child, inner| {
        format!("<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{inner}</joint>")
    };
    let shapes = "<link name='f'><visual><geometry><box size='1 1 1'/></geometry></visual>\
        <collision><origin xyz='1 2 3' rpy='0 0 1.5'/><geometry><box size=' 1\n2 3e0 '/></geometry></collision>\
        <collision name='x'><geometry><cylinder radius='.5' length='2'/></geometry></collision>\
        <collision><geometry><sphere radius='1'/></geometry></collision>\
        <collision><geometry><capsule radius='1' length='0'/></geometry></collision>\
        <inertial><mass value='unknown'/></inertial></link>";
    let limit = "<limit lower='-1' upper='2'/>";
    let joints = [
        joint("1", "planar", "a", "b", "<axis xyz='0 1 0'/>"),
        joint("2", "floating", "b", "c", limit),
        joint("3", "revolute", "c", "d", "<limit effort='1'/>"),
        joint("4", "prismatic", "d", "e", limit),
        joint("5", "continuous", "e", "f", limit),
    ];
    let mut elements: Vec<&str> = joints.iter().map(String::as_str).collect();
    elements.extend(["<transmission><joint name='1'/></transmission>", "<gazebo:link name='a'/>", shapes]);
    elements.extend(links);
    let loaded = load(&robot(&elements)).unwrap();
    let kinds: Vec<JointKind> = loaded.robot.joints().iter().map(|joint| joint.kind).collect();
    use JointKind::{Continuous, Floating, Planar, Prismatic, Revolute};
    assert_eq!(kinds, [Planar, Floating, Revolute, Prismatic, Continuous]);
    assert_eq!(loaded.robot.coordinates().len(), 3 + 7 + 3);
    let limits = |at: usize| loaded.robot.joints()[at].limits;
    assert_eq!([limits(2), limits(3), limits(4)], [Some([0.0; 2]), Some([-1.0, 2.0]), None]);
    let shape = loaded.robot.links().iter().find(|link| link.name == "f").unwrap().shape.clone().unwrap();
    let [min, max] = shape.at(Pose::IDENTITY).unwrap().bounds().unwrap();
    assert!(min[2] <= -1.0 && max[2] >= 4.5 && max[2] < 4.5 + 1e-9);
}

#[test]
fn unusual_content_is_a_warning() {
    let loaded = load(&robot(&[
        "<link name='a'><collision><geometry/></collision></link>",
        "<link name='b'><visual><geometry><sphere radius='1'/></geometry></visual></link>",
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint>",
    ]));
    let warnings: Vec<String> = loaded.unwrap().warnings.iter().map(ToString::to_string).collect();
    let ends = [
        "robot.urdf, line 2: link \"a\": an element without a shape, skipped",
        "robot.urdf, line 4: joint \"j\": no limits; URDF requires them",
        "robot.urdf: links without collision geometry, which cannot collide: b",
    ];
    assert_eq!(warnings.len(), ends.len());
    for (warning, end) in warnings.iter().zip(ends) {
        assert!(warning.ends_with(end), "{warning}");
    }
}

#[test]
fn errors_name_the_file_the_line_and_the_link_or_joint() {
    let base = "<link name='a'/><link name='b'/>";
    let joint =
        |inner: &str| format!("<joint name='j' type='revolute'><parent link='a'/><child link='b'/>{inner}</joint>");
    let shape = |inner: &str| format!("<link name='a'><collision>\n<geometry>{inner}</geometry></collision></link>");
    let number = "in the element box of link \"a\", found";
    for (elements, expected) in [
        (vec!["<link/>".to_owned()], "line 2: expected the attribute name in the element link, found nothing"),
        (vec![shape("<box size='1 2'/>")], &format!("line 3: expected 3 numbers as size {number} \"1 2\"")),
        (vec![shape("<box size='1 2 3 4'/>")], &format!("line 3: expected 3 numbers as size {number} \"1 2 3 4\"")),
        (
            vec![shape("<box size='1 nan 3'/>")],
            &format!("line 3: expected finite numbers as size {number} \"1 nan 3\""),
        ),
        (
            vec![shape("<box size='1 ${x} 3'/>")],
            &format!("line 3: expected 3 numbers as size {number} \"1 ${{x}} 3\" (the file is a xacro"),
        ),
        (vec![shape("<box size='1 -2 3'/>")], "line 2: link \"a\": half-extent 1 is negative"),
        (vec![shape("<capsule radius='1' length='-1'/>")], "line 2: link \"a\": half-height 0 is negative"),
        (
            vec![shape("<cone/>")],
            "line 3: expected box, cylinder, sphere, capsule or mesh in the element cone of link \"a\"",
        ),
        (vec![shape("<mesh filename=''/>")], "line 3: expected a name as filename in the element mesh of link \"a\""),
        (
            vec![shape("<mesh filename='a.stl' scale='1 0 1'/>")],
            "line 2: link \"a\": a factor of the scale of a mesh is zero",
        ),
        (vec![shape("<mesh filename='http://a/b.stl'/>")], "line 2: needs the mesh \"http://a/b.stl\" from a server"),
        (vec![base.to_owned(), joint("<axis xyz='0 0 0'/>")], "line 3: joint \"j\": its axis has no direction"),
        (
            vec![base.to_owned(), joint("<limit lower='2' upper='1'/>")],
            "line 3: joint \"j\": invalid limits: lower 2, upper 1",
        ),
        (
            vec![base.to_owned(), joint("<limit lower='nan' upper='1'/>")],
            "line 3: joint \"j\": invalid limits: lower NaN",
        ),
        (
            vec![base.to_owned(), joint("<limit lower='low'/>")],
            "line 3: expected a number as lower in the element limit of joint \"j\"",
        ),
        (
            vec![base.to_owned(), joint("<origin rpy='0 0 1e9'/>")],
            "line 3: expected numbers below 2^20 in the element origin",
        ),
        (vec![base.to_owned(), joint("<mimic joint='k'/>")], "line 3: joint \"j\": it follows the joint \"k\""),
        (
            vec![base.to_owned(), joint("").replace("revolute", "ball")],
            "line 3: expected fixed, revolute, continuous, prismatic",
        ),
        (
            vec![base.to_owned(), joint("").replace("<child link='b'/>", "")],
            "line 3: expected the element child in the element joint",
        ),
        (vec![base.to_owned(), joint("").replace("'b'", "'c'")], "line 3: joint \"j\": there is no link \"c\""),
        (vec![base.to_owned()], "2 links have no parent: \"a\", \"b\""),
        (vec![base.to_owned(), "<link name='a'/>".to_owned()], "line 3: link \"a\": another link has the same name"),
        (vec![], "the robot has no links"),
        (
            vec!["<xacro:macro name='m'/>".to_owned()],
            "line 2: needs the xacro preprocessor, which is not supported (run `xacro",
        ),
    ] {
        let text = robot(&elements.iter().map(String::as_str).collect::<Vec<_>>());
        let error = load(&text).unwrap_err();
        let found = message(&error);
        let separator = if expected.starts_with("line") { ", " } else { ": " };
        assert!(found.starts_with(&format!("robot.urdf{separator}{expected}")), "{found}\n{expected}");
    }
}

#[test]
fn other_formats_say_what_to_do() {
    for (text, kind, hint) in [
        ("<sdf><model/></sdf>", "unsupported-feature", "sdf2urdf.py"),
        ("<mujoco/>", "unsupported-feature", "load the URDF"),
        ("<html/>", "syntax", ""),
        ("", "empty", ""),
        ("no XML", "syntax", ""),
        ("<robot>", "syntax", "cut off"),
    ] {
        let error = load(text).unwrap_err();
        assert_eq!(error.kind().name(), kind, "{text}");
        assert!(error.hint().unwrap_or_default().contains(hint), "{error}");
    }
    let missing = load_robot("no such file.urdf", &RobotOptions::default()).unwrap_err();
    assert!(matches!(missing.kind(), LoadErrorKind::Io { .. }));
}

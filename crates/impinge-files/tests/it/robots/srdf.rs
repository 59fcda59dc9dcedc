//! Groups, states and pairs of links of SRDF files.

use impinge::robot::IgnoredReason;
use impinge_files::{LoadError, LoadedRobot, RobotOptions, load_robot};

use super::{Folder, data, robot};

/// Loads a chain of five links, `a` to `e`, with the revolute joints `1` to `4`, and an SRDF file.
fn load(semantics: &[&str]) -> Result<LoadedRobot, LoadError> {
    let ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
    let mut elements: Vec<String> =
        ["a", "b", "c", "d", "e"].iter().map(|name| format!("<link name='{name}'>{ball}</link>")).collect();
    for (at, ends) in ["ab", "bc", "cd", "de"].iter().enumerate() {
        let (name, [parent, child]) = (at + 1, [&ends[..1], &ends[1..]]);
        elements.push(format!(
            "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/></joint>"
        ));
    }
    let text = robot(&elements.iter().map(String::as_str).collect::<Vec<_>>());
    let folder = Folder::new(&[("robot.urdf", &text), ("robot.srdf", &robot(semantics))]);
    folder.load(&RobotOptions { srdf: Some(folder.path("robot.srdf")), ..RobotOptions::default() })
}

#[test]
fn the_srdf_of_the_robot_of_primitives_is_read() {
    let options = RobotOptions { srdf: Some(data().join("gantry.srdf")), ..RobotOptions::default() };
    let loaded = load_robot(data().join("gantry.urdf"), &options).unwrap();
    let groups: Vec<(&str, usize)> =
        loaded.groups.iter().map(|group| (group.name.as_str(), group.joints.len())).collect();
    assert_eq!(groups, [("arm", 4), ("hand", 1), ("all", 5)]);
    assert_eq!((loaded.warnings.len(), loaded.states.len(), loaded.robot.pairs().len()), (0, 1, 11));
}

#[test]
fn groups_join_joints_links_chains_and_other_groups() {
    let loaded = load(&[
        "<group name='x'><joint name='3'/><joint name='1'/></group>",
        "<group name='y'><link name='c'/><link name='a'/></group>",
        "<group name='z'><chain base_link='b' tip_link='e'/></group>",
        "<group name='both'><group name='x'/><group name='y'/><group name='both'/></group>",
        "<group name='loop'><group name='pool'/></group><group name='pool'><group name='loop'/><joint name='4'/></group>",
    ]);
    let groups = loaded.unwrap().groups;
    let joints: Vec<String> = groups.iter().map(|group| group.joints.concat()).collect();
    assert_eq!(joints, ["13", "2", "234", "123", "4", "4"]);
}

#[test]
fn defaults_are_replaced_by_enabled_pairs() {
    let loaded = load(&[
        "<disable_default_collisions link='a'/>",
        "<enable_collisions link1='d' link2='a'/>",
        "<disable_collisions link1='b' link2='e' reason='Never'/>",
        "<disable_collisions link1='c' link2='e'/>",
    ]);
    let robot = loaded.unwrap().robot;
    assert_eq!(robot.pairs(), [[0, 3], [1, 3]]);
    assert_eq!(robot.ignored_reason(4, 1), Some(IgnoredReason::Disabled("Never".to_owned())));
    assert_eq!(robot.ignored_reason(4, 0), Some(IgnoredReason::Disabled("Default".to_owned())));
}

#[test]
fn unknown_names_are_warnings_and_other_tags_are_skipped() {
    let loaded = load(&[
        "<group name='g'><joint name='9'/><link name='x'/><chain base_link='e' tip_link='a'/><group name='h'/></group>",
        "<group_state name='s' group='q'><joint name='1' value='0.5 1'/><joint name='8' value='0'/></group_state>",
        "<disable_collisions link1='a' link2='y'/><disable_collisions link1='a' link2='a'/>",
        "<virtual_joint name='v' type='floating' parent_frame='world' child_link='a'/><end_effector/><link_sphere_approximation/>",
    ])
    .unwrap();
    let warnings: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
    let expected = [
        "line 2: there is no joint \"9\" in the URDF, skipped",
        "line 2: there is no link \"x\" in the URDF, skipped",
        "line 2: the link \"e\" is not above \"a\", so the chain is skipped",
        "line 2: there is no group \"h\", skipped",
        "line 3: there is no group \"q\"",
        "line 3: there is no joint \"8\" in the URDF, skipped",
        "line 4: there is no link \"y\" in the URDF, skipped",
        "line 4: the pair of the link \"a\" with itself, skipped",
    ];
    assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
    for (warning, end) in warnings.iter().zip(expected) {
        assert!(warning.ends_with(&format!("robot.srdf, {end}")), "{warning}");
    }
    assert_eq!(loaded.states[0].values, [("1".to_owned(), vec![0.5, 1.0])]);
}

#[test]
fn errors_name_the_srdf_file_and_the_line() {
    for (element, expected) in [
        ("<group/>", "line 2: expected the attribute name in the element group"),
        ("<group name='a'/><group name='a'/>", "line 2: expected groups of different names, found \"a\""),
        (
            "<group_state name='s' group='g'><joint name='1' value='nan'/></group_state>",
            "line 2: expected finite numbers as value",
        ),
        ("<disable_collisions link1='a'/>", "line 2: expected the attribute link2"),
    ] {
        let found = load(&[element]).unwrap_err().to_string();
        assert!(found.contains(&format!("robot.srdf, {expected}")), "{found}");
    }
}

//! URDF: the links and joints of a robot as they are written in the file.

use impinge::robot::{Joint, JointKind, Mimic};

use super::{attributes::Element, geometry};
use crate::{
    error::LoadError,
    pieces::{Notes, Piece},
    xml_tree::{Id, Tree},
};

/// A robot as it is written in a file.
pub(super) struct Description {
    pub(super) name: String,
    pub(super) links: Vec<LinkText>,
    pub(super) joints: Vec<Joint>,
    /// Element of each joint.
    pub(super) joint_elements: Vec<Id>,
}

/// A link as it is written in a file.
pub(super) struct LinkText {
    pub(super) name: String,
    pub(super) element: Id,
    pub(super) visual: Vec<Piece>,
    pub(super) collision: Vec<Piece>,
}

/// Reads the elements of a URDF file.
pub(super) fn read(tree: &Tree<'_>, notes: &mut Notes<'_>) -> Result<Description, LoadError> {
    let root = root(tree)?;
    let mut robot = Description {
        name: tree.attribute(root, "name").unwrap_or_default().into_owned(),
        links: Vec::new(),
        joints: Vec::new(),
        joint_elements: Vec::new(),
    };
    for id in tree.children(root) {
        match tree.prefix(id) {
            None => {}
            Some("xacro") => {
                let error = LoadError::unsupported("the xacro preprocessor").at(tree.place(id));
                return Err(error.with_hint("run `xacro FILE.xacro > FILE.urdf` and load the result"));
            }
            Some(_) => continue,
        }
        let name = || Element { tree, id, subject: "" }.name("name");
        match tree.name(id) {
            "link" => {
                let name = name()?;
                let subject = format!("link {name:?}");
                let link = Element { tree, id, subject: &subject };
                let (visual, collision) = (pieces(link, "visual", notes)?, pieces(link, "collision", notes)?);
                robot.links.push(LinkText { name, element: id, visual, collision });
            }
            "joint" => {
                let name = name()?;
                let subject = format!("joint {name:?}");
                robot.joints.push(joint(Element { tree, id, subject: &subject }, name, notes)?);
                robot.joint_elements.push(id);
            }
            _ => {}
        }
    }
    Ok(robot)
}

/// Returns the element `robot`.
fn root(tree: &Tree<'_>) -> Result<Id, LoadError> {
    let Some(root) = tree.root() else { return Err(LoadError::syntax("the element robot of a URDF file", b"")) };
    let (name, place) = (tree.name(root), tree.place(root));
    let hint = match name {
        "robot" => return Ok(root),
        "sdf" => "write a URDF of the model, for example by `sdf2urdf.py MODEL.sdf MODEL.urdf` of the package pysdf",
        "mujoco" => "load the URDF of the robot instead of its MJCF",
        _ => return Err(LoadError::syntax("the element robot of a URDF file", name.as_bytes()).at(place)),
    };
    Err(LoadError::unsupported(format!("the format of the element {name}")).at(place).with_hint(hint))
}

fn pieces(link: Element<'_, '_>, name: &str, notes: &mut Notes<'_>) -> Result<Vec<Piece>, LoadError> {
    let mut pieces = Vec::new();
    for id in link.tree.children_named(link.id, name) {
        pieces.extend(geometry::read(Element { id, ..link }, notes)?);
    }
    Ok(pieces)
}

fn joint(element: Element<'_, '_>, name: String, notes: &mut Notes<'_>) -> Result<Joint, LoadError> {
    let kind = match element.text("type")?.as_str() {
        "fixed" => JointKind::Fixed,
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        "planar" => JointKind::Planar,
        "floating" => JointKind::Floating,
        other => {
            let known = "fixed, revolute, continuous, prismatic, planar or floating as type";
            return Err(element.expected(known, other));
        }
    };
    let link = |role: &str| match element.child(role) {
        Some(end) => end.name("link"),
        None => Err(element.expected(&format!("the element {role}"), "")),
    };
    let axis = match element.child("axis") {
        Some(axis) => axis.any_numbers("xyz", Some([1.0, 0.0, 0.0]))?,
        None => [1.0, 0.0, 0.0],
    };
    let mut limits = None;
    if matches!(kind, JointKind::Revolute | JointKind::Prismatic) {
        match element.child("limit") {
            Some(limit) => {
                let bound = |attribute| limit.any_numbers::<1>(attribute, Some([0.0])).map(|[x]| x);
                limits = Some([bound("lower")?, bound("upper")?]);
            }
            None => {
                notes.add(
                    || element.tree.place(element.id),
                    format!("{}: no limits; URDF requires them", element.subject),
                );
            }
        }
    }
    // Reduced models keep the rules of joints that they fixed.
    let mimic = match element.child("mimic").filter(|_| kind != JointKind::Fixed) {
        Some(mimic) => Some(Mimic {
            joint: mimic.name("joint")?,
            multiplier: mimic.any_numbers("multiplier", Some([1.0]))?[0],
            offset: mimic.any_numbers("offset", Some([0.0]))?[0],
        }),
        None => None,
    };
    let (parent, child) = (link("parent")?, link("child")?);
    Ok(Joint { name, kind, parent, child, parent_from_joint: element.origin()?, axis, limits, mimic })
}

//! SRDF: groups of joints, named states, and the pairs of links that are not checked.

use std::collections::{HashMap, HashSet};

use impinge::robot::Robot;

use super::attributes::Element;
use crate::{
    error::{LoadError, LoadErrorKind},
    pieces::Notes,
    xml_tree::{Id, Tree},
};

/// Maximum number of members of all groups together, with those of the groups in them. Groups of
/// groups multiply their members: without a limit, a short file could have any number of them.
const MAX_MEMBERS: u64 = 1 << 20;

/// A group of joints, in the order of the robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotGroup {
    /// Name of the group.
    pub name: String,
    /// Names of its joints that have coordinates.
    pub joints: Vec<String>,
}

/// A named state of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedState {
    /// Name of the state.
    pub name: String,
    /// Name of the group.
    pub group: String,
    /// Names of joints with the values of their coordinates.
    pub values: Vec<(String, Vec<f64>)>,
}

/// A pair of links with the reason why it is not checked, or `None` if it is.
type Choice = ([usize; 2], Option<String>);

/// Contents of an SRDF file.
pub(super) struct Semantics {
    pub(super) groups: Vec<RobotGroup>,
    pub(super) states: Vec<LoadedState>,
    pub(super) choices: Vec<Choice>,
}

struct Reader<'r, 't, 'a, 'p> {
    tree: &'t Tree<'a>,
    robot: &'r Robot,
    /// Index of each joint, and of the joint above each link.
    joints: HashMap<&'r str, usize>,
    above: HashMap<&'r str, usize>,
    notes: &'r mut Notes<'p>,
    members: u64,
}

/// Reads the elements of an SRDF file about a robot.
pub(super) fn read(tree: &Tree<'_>, robot: &Robot, name: &str, notes: &mut Notes<'_>) -> Result<Semantics, LoadError> {
    let Some(root) = tree.root() else { return Err(LoadError::syntax("the element robot of an SRDF file", b"")) };
    if tree.name(root) != "robot" {
        let error = LoadError::syntax("the element robot of an SRDF file", tree.name(root).as_bytes());
        return Err(error.at(tree.place(root)));
    }
    let own = tree.attribute(root, "name").unwrap_or_default();
    if own.trim() != name.trim() {
        notes.add(|| tree.place(root), format!("the robot is named {:?}, but {name:?} in the URDF", own.trim()));
    }
    let joints = robot.joints().iter().enumerate().map(|(at, joint)| (joint.name.as_str(), at)).collect();
    let above = robot.joints().iter().enumerate().map(|(at, joint)| (joint.child.as_str(), at)).collect();
    let mut reader = Reader { tree, robot, joints, above, notes, members: 0 };
    let groups = reader.groups(root)?;
    let states = reader.states(root, &groups)?;
    let choices = reader.choices(root)?;
    Ok(Semantics { groups, states, choices })
}

impl Reader<'_, '_, '_, '_> {
    fn element<'e>(&'e self, id: Id, subject: &'e str) -> Element<'e, 'e> {
        Element { tree: self.tree, id, subject }
    }

    /// Adds a warning about a name that the URDF lacks.
    fn unknown(&mut self, id: Id, noun: &str, name: &str) {
        self.notes.add(|| self.tree.place(id), format!("there is no {noun} {name:?} in the URDF, skipped"));
    }

    fn groups(&mut self, root: Id) -> Result<Vec<RobotGroup>, LoadError> {
        let mut ids = HashMap::new();
        let mut names = Vec::new();
        for id in self.tree.children_named(root, "group") {
            let name = self.element(id, "").name("name")?;
            if ids.insert(name.clone(), id).is_some() {
                let error = LoadError::syntax("groups of different names", name.as_bytes());
                return Err(error.at(self.tree.place(id)));
            }
            names.push((name, id));
        }
        let mut own = HashMap::new();
        for (name, id) in &names {
            own.insert(name.as_str(), self.members(*id, &ids)?);
        }
        let mut groups = Vec::new();
        for (name, id) in &names {
            let mut joints = HashSet::new();
            let (mut visited, mut open) = (HashSet::from([name.as_str()]), vec![name.as_str()]);
            while let Some(group) = open.pop() {
                let Some((direct, inner)) = own.get(group) else { continue };
                self.members += (direct.len() + inner.len()) as u64;
                if self.members > MAX_MEMBERS {
                    let kind =
                        LoadErrorKind::TooMany { what: "members of groups", count: self.members, limit: MAX_MEMBERS };
                    return Err(LoadError::new(kind).at(self.tree.place(*id)));
                }
                joints.extend(direct);
                open.extend(inner.iter().map(String::as_str).filter(|group| visited.insert(*group)));
            }
            let mut joints: Vec<usize> = joints.into_iter().collect();
            joints.sort_unstable();
            let moves: HashSet<usize> = self.robot.coordinates().iter().map(|coordinate| coordinate.joint).collect();
            let joints = joints.into_iter().filter(|joint| moves.contains(joint));
            let joints = joints.map(|joint| self.robot.joints()[joint].name.clone()).collect();
            groups.push(RobotGroup { name: name.clone(), joints });
        }
        Ok(groups)
    }

    /// Returns the joints that a group names itself, and the groups in it.
    fn members(&mut self, group: Id, ids: &HashMap<String, Id>) -> Result<(Vec<usize>, Vec<String>), LoadError> {
        let (mut joints, mut inner) = (Vec::new(), Vec::new());
        for id in self.tree.children(group) {
            match self.tree.name(id) {
                "joint" => {
                    let name = self.element(id, "").name("name")?;
                    match self.joints.get(name.as_str()) {
                        Some(&joint) => joints.push(joint),
                        None => self.unknown(id, "joint", &name),
                    }
                }
                "link" => {
                    let name = self.element(id, "").name("name")?;
                    if self.robot.link(&name).is_none() {
                        self.unknown(id, "link", &name);
                    }
                    joints.extend(self.above.get(name.as_str()));
                }
                "chain" => {
                    let [base, tip] = ["base_link", "tip_link"].map(|end| self.element(id, "").name(end));
                    joints.extend(self.chain(id, &base?, &tip?)?);
                }
                "group" => {
                    let name = self.element(id, "").name("name")?;
                    if ids.contains_key(&name) {
                        inner.push(name);
                    } else {
                        self.notes.add(|| self.tree.place(id), format!("there is no group {name:?}, skipped"));
                    }
                }
                _ => {}
            }
        }
        Ok((joints, inner))
    }

    /// Returns the joints between two links of a chain.
    fn chain(&mut self, id: Id, base: &str, tip: &str) -> Result<Vec<usize>, LoadError> {
        for link in [base, tip] {
            if self.robot.link(link).is_none() {
                self.unknown(id, "link", link);
                return Ok(Vec::new());
            }
        }
        let (mut joints, mut link) = (Vec::new(), tip);
        while link != base {
            let Some(&joint) = self.above.get(link) else {
                let message = format!("the link {base:?} is not above {tip:?}, so the chain is skipped");
                self.notes.add(|| self.tree.place(id), message);
                return Ok(Vec::new());
            };
            joints.push(joint);
            link = &self.robot.joints()[joint].parent;
        }
        self.members += joints.len() as u64;
        if self.members > MAX_MEMBERS {
            let kind = LoadErrorKind::TooMany { what: "members of groups", count: self.members, limit: MAX_MEMBERS };
            return Err(LoadError::new(kind).at(self.tree.place(id)));
        }
        Ok(joints)
    }

    fn states(&mut self, root: Id, groups: &[RobotGroup]) -> Result<Vec<LoadedState>, LoadError> {
        let known: HashSet<&str> = groups.iter().map(|group| group.name.as_str()).collect();
        let mut states = Vec::new();
        for id in self.tree.children_named(root, "group_state") {
            let element = self.element(id, "");
            let (name, group) = (element.name("name")?, element.name("group")?);
            if !known.contains(group.as_str()) {
                self.notes.add(|| self.tree.place(id), format!("there is no group {group:?}"));
            }
            let subject = format!("state {name:?}");
            let mut values = Vec::new();
            for joint in self.tree.children_named(id, "joint") {
                let element = self.element(joint, &subject);
                let (name, text) = (element.name("name")?, element.text("value")?);
                let value = text.split_ascii_whitespace().map(|token| crate::text::number(token.as_bytes()));
                let value: Option<Vec<f64>> = value.map(|x| x.filter(|x| x.is_finite())).collect();
                let Some(value) = value else { return Err(element.expected("finite numbers as value", &text)) };
                if self.joints.contains_key(name.as_str()) {
                    values.push((name, value));
                } else {
                    self.unknown(joint, "joint", &name);
                }
            }
            states.push(LoadedState { name, group, values });
        }
        Ok(states)
    }

    /// Returns the pairs of links that are not checked by default, then those that are disabled,
    /// then those that are enabled.
    fn choices(&mut self, root: Id) -> Result<Vec<Choice>, LoadError> {
        let mut choices = Vec::new();
        let solid: Vec<usize> =
            (0..self.robot.links().len()).filter(|&link| self.robot.links()[link].shape.is_some()).collect();
        let mut defaults = HashSet::new();
        for id in self.tree.children_named(root, "disable_default_collisions") {
            let name = self.element(id, "").name("link")?;
            match self.robot.link(&name) {
                Some(link) if defaults.insert(link) && self.robot.links()[link].shape.is_some() => {
                    let pairs = solid.iter().filter(|&&other| other != link).map(|&other| [link, other]);
                    choices.extend(pairs.map(|pair| (pair, Some("Default".to_owned()))));
                }
                Some(_) => {}
                None => self.unknown(id, "link", &name),
            }
        }
        for (tag, is_disabled) in [("disable_collisions", true), ("enable_collisions", false)] {
            for id in self.tree.children_named(root, tag) {
                let element = self.element(id, "");
                let names = [element.name("link1")?, element.name("link2")?];
                let reason = self.tree.attribute(id, "reason").unwrap_or_default().into_owned();
                match [self.robot.link(&names[0]), self.robot.link(&names[1])] {
                    [Some(a), Some(b)] if a == b => {
                        let message = format!("the pair of the link {:?} with itself, skipped", names[0]);
                        self.notes.add(|| self.tree.place(id), message);
                    }
                    [Some(a), Some(b)] => choices.push(([a, b], is_disabled.then_some(reason))),
                    [a, b] => {
                        for (name, _) in names.iter().zip([a, b]).filter(|(_, found)| found.is_none()) {
                            self.unknown(id, "link", name);
                        }
                    }
                }
            }
        }
        Ok(choices)
    }
}

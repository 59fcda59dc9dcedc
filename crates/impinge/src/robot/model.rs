//! A robot: links with shapes, joints, and the pairs of links that are checked.

use std::collections::HashMap;
use std::sync::Arc;

use super::error::{ConfigurationError, RobotError};
use super::frame::Frame;
use super::joint::{InvalidValue, Joint};
use super::proxy::Proxy;
use super::tree::{Step, Tree};
use crate::math::Pose;
use crate::shape::Shape;

/// Maximum number of links with a shape. All their pairs are stored, so more links would take more
/// memory than a file of their size suggests.
const MAX_SHAPES: usize = 1 << 10;

/// A link of a robot.
#[derive(Clone, Debug)]
pub struct Link {
    /// Name, which no other link of the robot has.
    pub name: String,
    /// Shape in the frame of the link; a [compound](Shape::compound) if the link has several
    /// parts. `None` for a link that cannot collide.
    pub shape: Option<Shape>,
}

/// A coordinate of the configurations of a robot: a column of their array.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Name of the joint, for a joint of several coordinates followed by the name of the
    /// coordinate: `base/theta`.
    pub name: String,
    /// Index of the joint.
    pub joint: usize,
    /// Lower and upper limit, in radians or units of length; infinite without a limit.
    pub limits: [f64; 2],
}

/// Reason why a pair of links is not checked.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum IgnoredReason {
    /// Only fixed joints connect the links, so no configuration changes their distance.
    Rigid,
    /// A joint connects the links.
    Adjacent,
    /// The pair was disabled, for the given reason.
    Disabled(String),
}

/// A kinematic tree of links with shapes.
///
/// The frame of the root link is the world frame. See the [module](crate::robot) for an example.
#[derive(Clone, Debug)]
pub struct Robot {
    links: Vec<Link>,
    joints: Vec<Joint>,
    tree: Tree,
    coordinates: Vec<Coordinate>,
    by_name: HashMap<String, usize>,
    /// Pairs of links, the smaller index first, that the user disabled for a reason or enabled.
    choices: HashMap<[usize; 2], Option<String>>,
    pairs: Vec<[usize; 2]>,
    /// Volumes about the shape of each link.
    proxies: Arc<[Proxy]>,
}

impl Robot {
    /// Returns the robot of some links and joints. Its coordinates have the order of the joints.
    ///
    /// All pairs of links with shapes are checked, except for those that a joint connects, and for
    /// those that only fixed joints connect. [`choose`](Self::choose) changes
    /// that.
    ///
    /// # Errors
    /// Returns an error that names the link or the joint if the joints do not form one tree of all
    /// links, or if a number of a joint is invalid.
    pub fn new(links: Vec<Link>, joints: Vec<Joint>) -> Result<Self, RobotError> {
        Self::with_proxies(links, joints, &[])
    }

    /// Returns the robot of some links and joints, given the volumes about the first links that are
    /// known.
    fn with_proxies(links: Vec<Link>, joints: Vec<Joint>, known: &[Proxy]) -> Result<Self, RobotError> {
        if links.iter().filter(|link| link.shape.is_some()).count() > MAX_SHAPES {
            return Err(RobotError::TooManyShapes { limit: MAX_SHAPES });
        }
        let names: Vec<&str> = links.iter().map(|link| link.name.as_str()).collect();
        let tree = Tree::new(&names, &joints)?;
        let by_name = links.iter().enumerate().map(|(at, link)| (link.name.clone(), at)).collect();
        let coordinate = |(name, joint, index): &(String, usize, usize)| {
            let of: &Joint = &joints[*joint];
            let limits = match of.limits {
                Some(limits) if of.kind.has_limits() && *index == 0 => limits,
                _ => of.kind.range(*index),
            };
            Coordinate { name: name.clone(), joint: *joint, limits }
        };
        let coordinates = tree.coordinates.iter().map(coordinate).collect();
        let stretches = tree.stretches();
        let new = links.iter().zip(stretches).skip(known.len());
        let new = new.map(|(link, stretch)| Proxy::of(link.shape.as_ref(), stretch));
        let proxies = known.iter().cloned().chain(new).collect();
        let (choices, pairs) = (HashMap::new(), Vec::new());
        let mut robot = Self { links, joints, tree, coordinates, by_name, choices, pairs, proxies };
        robot.pairs = robot.all_pairs().filter(|&[a, b]| robot.ignored_reason(a, b).is_none()).collect();
        Ok(robot)
    }

    /// Returns a robot that also has an object attached to one of its links, such as a part in its
    /// gripper. The object becomes the last link, with its own name, and shares its configurations
    /// and the shapes and choices of this robot.
    ///
    /// The object is checked against all links, except for the link that holds it, for those that
    /// only fixed joints connect with that link, and for those in `touch`. `pose` is the pose of
    /// the object in the frame of the link.
    ///
    /// # Errors
    /// Returns an error if a link has the name, if a joint has the name of the object followed by
    /// `/attached`, or if the robot has too many shapes.
    ///
    /// # Panics
    /// Panics if there is no link with one of the indices.
    ///
    /// ```
    /// use impinge::robot::{Joint, JointKind, Link, Robot};
    /// use impinge::{Pose, Shape};
    ///
    /// let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.0625)?;
    /// let links = vec![
    ///     Link { name: "base".into(), shape: Some(rod.clone()) },
    ///     Link { name: "arm".into(), shape: Some(rod) },
    /// ];
    /// let at_tip = Pose::from_translation([1.0, 0.0, 0.0])?;
    /// let turn = Joint::fixed("turn", "base", "arm", at_tip).moving(JointKind::Revolute, [0.0, 0.0, 1.0]);
    /// let robot = Robot::new(links, vec![turn])?;
    /// let holding = robot.attached("part", Shape::sphere([0.0; 3], 0.25)?, 1, at_tip, &[])?;
    /// assert_eq!(holding.pairs(), [[0, 2]]);
    /// assert_eq!(holding.coordinates(), robot.coordinates());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn attached(
        &self,
        name: impl Into<String>,
        shape: Shape,
        link: usize,
        pose: Pose,
        touch: &[usize],
    ) -> Result<Self, RobotError> {
        let (name, place) = (name.into(), self.links.len());
        let mut links = self.links.clone();
        let mut joints = self.joints.clone();
        joints.push(Joint::fixed(format!("{name}/attached"), links[link].name.clone(), name.clone(), pose));
        links.push(Link { name, shape: Some(shape) });
        let mut robot = Self::with_proxies(links, joints, &self.proxies)?;
        robot.choices.clone_from(&self.choices);
        robot.choose(touch.iter().map(|&other| ([other, place], Some("touch".to_owned()))));
        Ok(robot)
    }

    /// Returns the links, in the order in which they were given. Other methods name a link by its
    /// index here.
    #[must_use]
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Returns the joints, in the order in which they were given.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the index of the link without a parent.
    #[must_use]
    pub fn root(&self) -> usize {
        self.tree.root
    }

    /// Returns the index of the link with this name, or `None`.
    #[must_use]
    pub fn link(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Returns the coordinates of a configuration.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Returns the pairs of links that are checked: pairs of indices, the smaller one first,
    /// sorted.
    #[must_use]
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// Returns the pairs of links with shapes that are not checked, with the reason, sorted.
    ///
    /// # Complexity
    /// Quadratic in the number of links with shapes.
    #[must_use]
    pub fn ignored(&self) -> Vec<([usize; 2], IgnoredReason)> {
        self.all_pairs().filter_map(|[a, b]| Some(([a, b], self.ignored_reason(a, b)?))).collect()
    }

    /// Returns the reason why a pair of different links is not checked, or `None` if it is.
    ///
    /// # Panics
    /// Panics if there is no link with one of the indices.
    #[must_use]
    pub fn ignored_reason(&self, a: usize, b: usize) -> Option<IgnoredReason> {
        match self.choices.get(&[a.min(b), a.max(b)]) {
            Some(Some(reason)) => Some(IgnoredReason::Disabled(reason.clone())),
            Some(None) => None,
            None => self.connection(a, b),
        }
    }

    /// Returns how joints connect two links so that the pair is not checked by default.
    pub(super) fn connection(&self, a: usize, b: usize) -> Option<IgnoredReason> {
        let Tree { bodies, parents, .. } = &self.tree;
        if bodies[a] == bodies[b] {
            return Some(IgnoredReason::Rigid);
        }
        (parents[a] == Some(b) || parents[b] == Some(a)).then_some(IgnoredReason::Adjacent)
    }

    /// Changes which pairs of links are checked. Each item is a pair of different links, in either
    /// order, and the reason why it is not checked, or `None` if it is to be checked. Later items
    /// replace earlier ones.
    ///
    /// # Panics
    /// Panics if there is no link with one of the indices.
    ///
    /// # Complexity
    /// Quadratic in the number of links with shapes.
    pub fn choose(&mut self, choices: impl IntoIterator<Item = ([usize; 2], Option<String>)>) {
        for ([a, b], reason) in choices {
            assert!(a.max(b) < self.links.len(), "the robot has no link {}", a.max(b));
            self.choices.insert([a.min(b), a.max(b)], reason);
        }
        self.pairs = self.all_pairs().filter(|&[a, b]| self.ignored_reason(a, b).is_none()).collect();
    }

    /// Returns for each link its pose in the world in a configuration.
    ///
    /// # Accuracy
    /// The poses have the same bits on every platform. Each joint adds a rounding error of a few
    /// units of 2^-53 to the rotation, and as much, times the lengths of the chain, to the
    /// translation.
    ///
    /// # Errors
    /// Returns an error if the number of values is not that of the coordinates, or if a value is
    /// NaN, infinite or out of range.
    pub fn poses(&self, configuration: &[f64]) -> Result<Vec<Pose>, ConfigurationError> {
        self.check_rows(configuration)?;
        let (count, coordinates) = (configuration.len(), self.coordinates.len());
        if count != coordinates {
            return Err(ConfigurationError::Count { count, coordinates });
        }
        let mut frames = Vec::new();
        self.place(configuration, &mut frames);
        let pose = |frame: &Frame| frame.pose().ok_or(ConfigurationError::OutOfRange { row: 0, coordinate: 0 });
        frames.iter().map(pose).collect()
    }

    /// Returns the number of configurations in a list of values, after it validates the values.
    ///
    /// # Errors
    /// As for [`poses`](Self::poses); the number of values must be a multiple of the number of
    /// coordinates.
    pub fn check_rows(&self, configurations: &[f64]) -> Result<usize, ConfigurationError> {
        let coordinates = self.coordinates.len();
        let count = configurations.len();
        if coordinates == 0 {
            return if count == 0 { Ok(1) } else { Err(ConfigurationError::Count { count, coordinates }) };
        }
        if !count.is_multiple_of(coordinates) {
            return Err(ConfigurationError::Count { count, coordinates });
        }
        let mut followed = 0.0;
        for (row, configuration) in configurations.chunks_exact(coordinates).enumerate() {
            for step in &self.tree.steps {
                let values = step.source.values(configuration, &mut followed);
                step.motion.check(values).map_err(|(at, invalid)| {
                    let coordinate = step.source.first + at;
                    match invalid {
                        InvalidValue::NonFinite => ConfigurationError::NonFinite { row, coordinate },
                        InvalidValue::OutOfRange => ConfigurationError::OutOfRange { row, coordinate },
                        InvalidValue::ZeroQuaternion => ConfigurationError::ZeroQuaternion { row, coordinate },
                    }
                })?;
            }
        }
        Ok(count / coordinates)
    }

    /// Computes the frame of each link in a valid configuration.
    pub(super) fn place(&self, configuration: &[f64], frames: &mut Vec<Frame>) {
        frames.resize(self.links.len(), Frame::IDENTITY);
        let mut followed = 0.0;
        for step in &self.tree.steps {
            let values = step.source.values(configuration, &mut followed);
            frames[step.child] = frames[step.parent].after(&step.motion.parent_from_child(values));
        }
    }

    /// Returns volumes about the shape of each link.
    pub(super) fn proxies(&self) -> &[Proxy] {
        &self.proxies
    }

    /// Returns the steps of the kinematics, parents first.
    pub(super) fn steps(&self) -> &[Step] {
        &self.tree.steps
    }

    /// Returns for each link a bound on the factor by which its pose stretches any length.
    pub(super) fn stretches(&self) -> Vec<f64> {
        self.tree.stretches()
    }

    /// Returns all pairs of links with shapes, sorted.
    pub(super) fn all_pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        let has_shape = |link: &usize| self.links[*link].shape.is_some();
        let links = 0..self.links.len();
        links.clone().filter(has_shape).flat_map(move |a| (a + 1..links.end).filter(has_shape).map(move |b| [a, b]))
    }
}

//! The tree of links and joints: which link is moved by which joint, and by which coordinates.

use std::collections::HashMap;

use super::error::RobotError;
use super::joint::{Joint, Motion};
use crate::volume::stretch;

/// Coordinates that move a joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    /// Index of the first coordinate of the joint, or of the joint that it follows.
    pub(super) first: usize,
    /// Number of coordinates.
    pub(super) count: usize,
    /// Factor and offset of the coordinate of a joint that follows another.
    pub(super) rule: Option<[f64; 2]>,
}

impl Source {
    /// Returns the values of the joint's coordinates in a configuration. The value of a joint that
    /// follows another is stored in `own`.
    pub(super) fn values<'v>(&self, configuration: &'v [f64], own: &'v mut f64) -> &'v [f64] {
        match self.rule {
            Some([multiplier, offset]) => {
                *own = multiplier * configuration[self.first] + offset;
                std::slice::from_ref(own)
            }
            None => &configuration[self.first..self.first + self.count],
        }
    }
}

/// The step of the kinematics that places one link.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) parent: usize,
    pub(super) child: usize,
    pub(super) motion: Motion,
    pub(super) source: Source,
    /// Bound on the factor by which the origin of the joint stretches lengths.
    pub(super) stretch: f64,
}

/// A tree of links.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// Index of the link without a parent.
    pub(super) root: usize,
    /// A step for each other link, parents first.
    pub(super) steps: Vec<Step>,
    /// For each link, the number of its rigid body. Links that only fixed joints connect are one
    /// body.
    pub(super) bodies: Vec<usize>,
    /// For each link, the index of its parent link, or `None` for the root.
    pub(super) parents: Vec<Option<usize>>,
    /// Names of the coordinates, and for each the index of its joint and its index in the joint.
    pub(super) coordinates: Vec<(String, usize, usize)>,
}

impl Tree {
    /// Returns the tree of links, given by their names, and joints.
    pub(super) fn new(links: &[&str], joints: &[Joint]) -> Result<Self, RobotError> {
        let link_of = indices(links.iter().copied()).map_err(|link| RobotError::LinkNameTaken { link })?;
        let joint_of = indices(joints.iter().map(|joint| joint.name.as_str()))
            .map_err(|joint| RobotError::JointNameTaken { joint })?;
        let mut above: Vec<Option<usize>> = vec![None; links.len()];
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
        for (at, joint) in joints.iter().enumerate() {
            let find = |link: &str| {
                let unknown = || RobotError::UnknownLink { joint: joint.name.clone(), link: link.to_owned() };
                link_of.get(link).copied().ok_or_else(unknown)
            };
            let (parent, child) = (find(&joint.parent)?, find(&joint.child)?);
            if let Some(other) = above[child].replace(at) {
                let names = [&joints[other].name, &joint.name].map(Clone::clone);
                return Err(RobotError::TwoParents { link: joint.child.clone(), joints: names });
            }
            children[parent].push(at);
        }
        let roots: Vec<usize> = (0..links.len()).filter(|&link| above[link].is_none()).collect();
        let root = match roots[..] {
            [root] => root,
            [] if links.is_empty() => return Err(RobotError::NoLinks),
            [] => return Err(RobotError::Cycle { link: links[0].to_owned() }),
            _ => {
                let links = roots.iter().map(|&link| links[link].to_owned()).collect();
                return Err(RobotError::SeveralRoots { links });
            }
        };
        let mut coordinates = Vec::new();
        let mut first = vec![0; joints.len()];
        for (at, joint) in joints.iter().enumerate() {
            first[at] = coordinates.len();
            if joint.mimic.is_none() {
                let names = joint.kind.coordinates().iter().enumerate();
                coordinates.extend(names.map(|(index, suffix)| (format!("{}{suffix}", joint.name), at, index)));
            }
        }
        let sources = sources(joints, &joint_of, &first)?;
        let mut tree = Self {
            root,
            steps: Vec::new(),
            bodies: vec![0; links.len()],
            parents: vec![None; links.len()],
            coordinates,
        };
        let (mut placed, mut bodies) = (vec![root], 1);
        while let Some(parent) = placed.pop() {
            for &at in &children[parent] {
                let joint = &joints[at];
                let stretch = check(joint)?;
                let child = link_of[joint.child.as_str()];
                let motion = Motion::of(joint).ok_or_else(|| RobotError::Axis { joint: joint.name.clone() })?;
                let source = sources[at];
                tree.parents[child] = Some(parent);
                tree.bodies[child] = if source.count == 0 { tree.bodies[parent] } else { bodies };
                bodies += usize::from(source.count > 0);
                tree.steps.push(Step { parent, child, motion, source, stretch });
                placed.push(child);
            }
        }
        match (0..links.len()).find(|&link| link != root && tree.parents[link].is_none()) {
            Some(link) => Err(RobotError::Cycle { link: links[link].to_owned() }),
            None => Ok(tree),
        }
    }

    /// Returns for each link a bound on the factor by which its pose stretches any length.
    ///
    /// Each joint multiplies it by the stretch of its origin. Its rotation and the rounding of the
    /// product add a few units of 2^-53, which [`ROUNDING`](Self::ROUNDING) covers.
    pub(super) fn stretches(&self) -> Vec<f64> {
        let mut stretches = vec![1.0 + Self::ROUNDING; self.bodies.len()];
        for step in &self.steps {
            stretches[step.child] = stretches[step.parent] * step.stretch * (1.0 + Self::ROUNDING);
        }
        stretches
    }

    /// Bound on what a rotation, its product and the rounding here add to a stretch, 2^-44.
    const ROUNDING: f64 = 256.0 * f64::EPSILON;
}

/// Returns the index of each name, or a name that occurs twice.
fn indices<'a>(names: impl Iterator<Item = &'a str>) -> Result<HashMap<&'a str, usize>, String> {
    let mut found = HashMap::new();
    for (at, name) in names.enumerate() {
        if found.insert(name, at).is_some() {
            return Err(name.to_owned());
        }
    }
    Ok(found)
}

/// Validates the numbers of a joint. Returns a bound on the stretch of its origin.
fn check(joint: &Joint) -> Result<f64, RobotError> {
    let name = || joint.name.clone();
    if let Some(limits @ [lower, upper]) = joint.limits
        && (lower.is_nan() || upper.is_nan() || lower > upper)
    {
        return Err(RobotError::Limits { joint: name(), limits });
    }
    if let Some(mimic) = &joint.mimic
        && !(mimic.multiplier.is_finite() && mimic.offset.is_finite())
    {
        return Err(RobotError::MimicNumber { joint: name() });
    }
    stretch(&joint.parent_from_joint).map_err(|error| RobotError::Origin { joint: name(), error })
}

/// Returns the coordinates that move each joint. A joint that follows others has one rule for the
/// whole chain.
///
/// # Complexity
/// Linear, because the rule of each joint is computed from the rule of the joint that it follows.
fn sources(joints: &[Joint], joint_of: &HashMap<&str, usize>, first: &[usize]) -> Result<Vec<Source>, RobotError> {
    let mut sources: Vec<Option<Source>> = joints
        .iter()
        .enumerate()
        .map(|(at, joint)| {
            let count = joint.kind.coordinates().len();
            joint.mimic.is_none().then_some(Source { first: first[at], count, rule: None })
        })
        .collect();
    for start in 0..joints.len() {
        // The joints from this one to the first whose rule is known.
        let (mut chain, mut at) = (Vec::new(), start);
        let mut source = loop {
            if let Some(source) = sources[at] {
                break source;
            }
            let joint = &joints[at];
            if joint.kind.coordinates().len() != 1 {
                return Err(RobotError::MimicKind { joint: joint.name.clone() });
            }
            if chain.len() == joints.len() {
                return Err(RobotError::MimicCycle { joint: joints[start].name.clone() });
            }
            chain.push(at);
            let followed = joint.mimic.iter().map(|mimic| mimic.joint.as_str()).next().unwrap_or_default();
            at = *joint_of
                .get(followed)
                .ok_or_else(|| RobotError::UnknownMimic { joint: joint.name.clone(), followed: followed.to_owned() })?;
        };
        if !chain.is_empty() && source.count != 1 {
            return Err(RobotError::MimicKind { joint: joints[at].name.clone() });
        }
        for at in chain.into_iter().rev() {
            if let Some(mimic) = &joints[at].mimic {
                let [multiplier, offset] = source.rule.unwrap_or([1.0, 0.0]);
                source.rule = Some([mimic.multiplier * multiplier, mimic.multiplier * offset + mimic.offset]);
            }
            sources[at] = Some(source);
        }
    }
    Ok(sources.into_iter().flatten().collect())
}

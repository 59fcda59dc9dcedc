//! Which pairs of links can collide at all: by samples, and by proofs about all configurations.
//!
//! Guarded by `tests/it/robots/audits.rs` and lemma L44 of the proofs.

use std::collections::HashMap;

use super::check::{CheckError, CheckOptions, Other};
use super::interval::{Answer, Scan, State, Subject, Wish};
use super::joint::JointKind;
use super::model::Robot;
use crate::budget::Budget;
use crate::query::batch::{Answers, Execution};
use crate::scene::Stop;

/// Options of [`Robot::audit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AuditOptions {
    /// Number of random configurations that are checked for collisions.
    pub samples: usize,
    /// Start of the random numbers. The same seed gives the same configurations on every machine.
    pub seed: u64,
    /// Maximum number of boxes of configurations that the proof about one pair examines.
    pub max_boxes: usize,
}

impl Default for AuditOptions {
    /// Returns the options of an audit with 10,000 samples and at most 4,096 boxes for each pair.
    fn default() -> Self {
        Self { samples: 10_000, seed: 0, max_boxes: 1 << 12 }
    }
}

/// Knowledge about the collisions of a pair of links within the limits of the joints.
#[derive(Clone, Debug, PartialEq)]
pub enum PairFinding {
    /// A joint connects the links, or only fixed joints do.
    Adjacent,
    /// It is proved that the links collide in no configuration.
    ProvedNever,
    /// The links collide in this configuration, but not in all samples.
    Witness(Vec<f64>),
    /// The links collide in every sample, such as this. That they always do is not proved.
    Always(Vec<f64>),
    /// No sample collides, and nothing is proved.
    Open,
}

/// Result of an audit about a pair of links with shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditedPair {
    /// Indices of the links, the smaller one first.
    pub links: [usize; 2],
    /// The finding.
    pub finding: PairFinding,
    /// Whether the robot [checks](Robot::pairs) the pair.
    pub is_checked: bool,
}

/// For each pair that collides in a sample, the number of samples in which it does, and the first.
type Samples = HashMap<[usize; 2], (usize, Vec<f64>)>;

impl Robot {
    /// Returns for each pair of links with shapes whether it can collide, whether the robot checks
    /// it or not, sorted.
    ///
    /// Random configurations within the limits of the joints are checked. For each pair that never
    /// collides there, boxes of configurations are examined and halved, until bounds on how far the
    /// links move prove that no configuration collides, or until the limit of boxes is reached.
    /// Angles without limits take all values. Nothing is proved about a pair if a translation
    /// between its links has no limits, or if a floating joint is between them.
    ///
    /// # Errors
    /// Returns an error if a limit of a joint is too large, or if a limit of the budget of
    /// `execution` was reached.
    ///
    /// # Complexity
    /// One check of all pairs for each sample, and about as much for each box.
    ///
    /// ```
    /// use impinge::query::batch::Execution;
    /// use impinge::robot::{AuditOptions, Joint, JointKind, Link, PairFinding, Robot};
    /// use impinge::{Pose, Shape};
    ///
    /// let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.0625)?;
    /// let link = |name: &str| Link { name: name.into(), shape: Some(rod.clone()) };
    /// let at_tip = Pose::from_translation([1.0, 0.0, 0.0])?;
    /// let joint = |name: &str, parent: &str, child: &str, limit: f64| {
    ///     let joint = Joint::fixed(name, parent, child, at_tip);
    ///     joint.moving(JointKind::Revolute, [0.0, 0.0, 1.0]).limited(-limit, limit)
    /// };
    /// let links = || vec![link("upper"), link("fore"), link("hand")];
    /// let audit = |limit| -> Result<_, Box<dyn std::error::Error>> {
    ///     let joints = vec![joint("elbow", "upper", "fore", limit), joint("wrist", "fore", "hand", limit)];
    ///     let robot = Robot::new(links(), joints)?;
    ///     Ok(robot.audit(&AuditOptions::default(), Execution::default())?.swap_remove(1))
    /// };
    /// assert_eq!(audit(1.0)?.finding, PairFinding::ProvedNever);
    /// assert!(matches!(audit(2.5)?.finding, PairFinding::Witness(_)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn audit(&self, options: &AuditOptions, execution: Execution<'_>) -> Result<Vec<AuditedPair>, CheckError> {
        let is_connected = |&[a, b]: &[usize; 2]| self.connection(a, b).is_some();
        let all: Vec<[usize; 2]> = self.all_pairs().collect();
        let mut robot = self.clone();
        let choice = |pair: &[usize; 2]| (*pair, is_connected(pair).then(String::new));
        robot.choose(all.iter().map(choice));
        let ranges = robot.ranges();
        let found = robot.sampled(&ranges, options, execution)?;
        let check = CheckOptions::default();
        let scan = Scan::new(&robot, &check);
        let subjects = scan.subjects();
        let decide = |state: &mut State, at: usize| {
            let subject = subjects[at];
            match found.get(&robot.pairs()[at]) {
                Some((hits, sample)) if *hits == options.samples => PairFinding::Always(sample.clone()),
                Some((_, sample)) => PairFinding::Witness(sample.clone()),
                None => scan.prove(state, (at, subject), (&ranges, options.max_boxes), execution.budget()),
            }
        };
        let findings = execution.rows(subjects.len(), || scan.state(), decide).map_err(CheckError::Stopped)?;
        let mut findings = findings.into_iter();
        let audited = |links: [usize; 2]| {
            let known = if is_connected(&links) { None } else { findings.next() };
            let is_checked = self.ignored_reason(links[0], links[1]).is_none();
            AuditedPair { links, finding: known.unwrap_or(PairFinding::Adjacent), is_checked }
        };
        Ok(all.into_iter().map(audited).collect())
    }

    /// Returns for each coordinate an interval of values that stand for all, or `None` if there is
    /// no such interval.
    fn ranges(&self) -> Vec<Option<[f64; 2]>> {
        let is_followed = |joint: usize| {
            self.joints().iter().flat_map(|joint| &joint.mimic).any(|mimic| mimic.joint == self.joints()[joint].name)
        };
        let range = |coordinate: &super::model::Coordinate| {
            let joint = &self.joints()[coordinate.joint];
            let is_angle = match joint.kind {
                JointKind::Revolute | JointKind::Continuous => true,
                JointKind::Planar => coordinate.name.ends_with("/theta"),
                _ => false,
            };
            let is_limited = coordinate.limits.iter().all(|limit| limit.is_finite());
            // A joint that follows an angle need not repeat with it.
            let is_periodic = is_angle && !is_followed(coordinate.joint);
            match joint.kind {
                JointKind::Floating => None,
                _ if is_limited => Some(coordinate.limits),
                // A whole turn, and a little more than that.
                _ => is_periodic.then_some([-3.2, 3.2]),
            }
        };
        self.coordinates().iter().map(range).collect()
    }

    /// Returns for each pair that collides in a sample the number of samples and the first one.
    fn sampled(
        &self,
        ranges: &[Option<[f64; 2]>],
        options: &AuditOptions,
        execution: Execution<'_>,
    ) -> Result<Samples, CheckError> {
        let mut random = options.seed;
        let mut value = |range: &Option<[f64; 2]>| {
            let [low, high] = range.unwrap_or([-1.0, 1.0]);
            (low + (high - low) * uniform(&mut random)).min(high)
        };
        let columns = ranges.len();
        let values: Vec<f64> =
            (0..options.samples).flat_map(|_| ranges.iter().map(&mut value).collect::<Vec<_>>()).collect();
        let check = CheckOptions { stop: Stop::All, ..CheckOptions::default() };
        let Answers { values: found, .. } = self.check(&values, &check, execution)?;
        let mut hits = HashMap::new();
        for (row, collisions) in found.iter().enumerate() {
            for collision in collisions.iter().filter(|collision| !collision.is_undecided) {
                if let Other::Link(other) = collision.other {
                    let sample = || (0, values[row * columns..(row + 1) * columns].to_vec());
                    hits.entry([collision.link, other]).or_insert_with(sample).0 += 1;
                }
            }
        }
        Ok(hits)
    }
}

impl Scan<'_> {
    /// Proves that a pair never collides, or finds a configuration in which it does.
    ///
    /// A box of configurations is treated as the motion between two of its corners: the bounds on
    /// that motion hold for every configuration of the box.
    fn prove(
        &self,
        state: &mut State,
        (at, subject): (usize, Subject),
        (ranges, max_boxes): (&[Option<[f64; 2]>], usize),
        budget: &Budget<'_>,
    ) -> PairFinding {
        let moving = self.coordinates_between(at);
        let mut whole = [vec![0.0; ranges.len()], vec![0.0; ranges.len()]];
        for (coordinate, range) in ranges.iter().enumerate() {
            let [low, high] = match range {
                Some(range) => *range,
                None if moving.contains(&coordinate) => return PairFinding::Open,
                None => [0.0; 2],
            };
            let middle = 0.5 * low + 0.5 * high;
            let is_moving = moving.contains(&coordinate);
            (whole[0][coordinate], whole[1][coordinate]) = if is_moving { (low, high) } else { (middle, middle) };
        }
        let mut stack = vec![whole];
        self.forget(state);
        for _ in 0..max_boxes {
            let Some(corners) = stack.pop() else { return PairFinding::ProvedNever };
            // The caller discards the result if the budget is spent.
            if budget.is_spent() {
                return PairFinding::Open;
            }
            self.move_between(state, &corners);
            self.move_to(state, 0.5);
            let half = match self.examine(state, subject, Wish { half: 0.5, is_exact: true }, budget) {
                Answer::Free(half) => half,
                Answer::Hit(_) => return PairFinding::Witness(super::interval::between(&corners[0], &corners[1], 0.5)),
            };
            if half >= 0.5 {
                continue;
            }
            let Some(coordinate) = self.widest(state, at) else { return PairFinding::Open };
            let middle = 0.5 * corners[0][coordinate] + 0.5 * corners[1][coordinate];
            let mut upper = corners.clone();
            upper[0][coordinate] = middle;
            stack.push(upper);
            let mut lower = corners;
            lower[1][coordinate] = middle;
            stack.push(lower);
        }
        if stack.is_empty() { PairFinding::ProvedNever } else { PairFinding::Open }
    }
}

/// Returns the next random number from 0 to 1.
///
/// # Source
/// Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014.
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

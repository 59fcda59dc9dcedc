//! How far the links can move during an interval of a motion.
//!
//! # Source
//! Schwarzer, Saha and Latombe, *Adaptive dynamic collision checking for single and multiple
//! articulated robots in complex environments*, IEEE Transactions on Robotics 21, 2005. Lemma L43
//! of the proofs has the bounds with their rounding.

use super::cull::Limb;
use super::frame::Frame;
use super::joint::JointKind;
use super::model::Robot;
use super::tree::Step;
use crate::math::vec3::{cross, dot, sub};

/// Share of the magnitude of a coordinate that covers its rounding between the ends of a motion,
/// 2^-48.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Factor by which a bound is enlarged for each joint, to cover its own rounding: 1 + 2^-40.
const INFLATION: f64 = 1.0 + 4096.0 * f64::EPSILON;

/// Share of the size of a robot that covers the rounding of the kinematics for each link of a
/// chain, 2^-42.
const KINEMATICS: f64 = 1024.0 * f64::EPSILON;

/// How fast the coordinates of a joint change during a motion, per unit of its time, and the
/// rounding of each.
#[derive(Clone, Copy, Debug, Default)]
struct Rate {
    /// Change of the angle, in radians.
    turn: [f64; 2],
    /// Change of the translation, as a sum of magnitudes.
    slide: [f64; 2],
    /// Change of the quaternion of a floating joint, as a sum of magnitudes.
    quaternion: [f64; 2],
}

/// The joints that move each link.
#[derive(Clone, Debug)]
pub(super) struct Chains {
    /// For each link the indices of the steps of the kinematics that move it, from the link to the
    /// root.
    of: Vec<Vec<usize>>,
    /// For each link a factor that covers that its pose is not exactly rigid.
    stretch: Vec<f64>,
    /// Maximum number of joints between a link and the root.
    depth: usize,
}

/// The rates of the joints during a motion.
#[derive(Clone, Debug)]
pub(super) struct Rates(Vec<Rate>);

/// Bounds on how far links move within an interval of time.
#[derive(Clone, Debug, Default)]
pub(super) struct Reach {
    /// For each link, the bound relative to the parent of each of its moving joints, from the link
    /// to the root. The first bound, relative to the link itself, is zero.
    bounds: Vec<Vec<f64>>,
    /// Distance that covers the rounding of the kinematics.
    rounding: f64,
}

impl Chains {
    pub(super) fn new(robot: &Robot) -> Self {
        let mut of = vec![Vec::new(); robot.links().len()];
        let mut depths = vec![0_usize; robot.links().len()];
        for (at, step) in robot.steps().iter().enumerate() {
            let mut chain = of[step.parent].clone();
            if step.source.count > 0 {
                chain.insert(0, at);
            }
            of[step.child] = chain;
            depths[step.child] = depths[step.parent] + 1;
        }
        let stretch = robot.stretches().iter().map(|stretch| 1.0 + 8.0 * (stretch - 1.0)).collect();
        Self { of, stretch, depth: depths.into_iter().max().unwrap_or(0) }
    }

    /// Returns for each of two links the number of joints between it and the last link that no
    /// joint between them moves.
    pub(super) fn between(&self, [a, b]: [usize; 2]) -> [usize; 2] {
        let common = self.of[a].iter().rev().zip(self.of[b].iter().rev()).take_while(|(s, t)| s == t).count();
        [self.of[a].len() - common, self.of[b].len() - common]
    }

    /// Returns the number of joints between a link and the root.
    pub(super) fn length(&self, link: usize) -> usize {
        self.of[link].len()
    }
}

impl Rates {
    /// Returns the rates of a motion between two configurations.
    pub(super) fn new(robot: &Robot, [start, end]: [&[f64]; 2]) -> Self {
        let rate = |step: &Step| {
            let (first, count) = (step.source.first, step.source.count);
            let [multiplier, offset] = step.source.rule.unwrap_or([1.0, 0.0]);
            let change = |at: usize| {
                let (p, q) = (start[first + at], end[first + at]);
                let size = (p.abs() + q.abs()) * multiplier.abs() + offset.abs();
                [(q - p).abs() * multiplier.abs() * INFLATION, size * ROUNDING]
            };
            let sum = |from: usize, to: usize| {
                (from..to).map(change).fold([0.0; 2], |[a, b], [c, d]| [(a + c) * INFLATION, (b + d) * INFLATION])
            };
            let mut rate = Rate::default();
            match step.motion.kind {
                JointKind::Fixed => {}
                JointKind::Revolute | JointKind::Continuous => rate.turn = sum(0, count),
                JointKind::Prismatic => rate.slide = sum(0, count),
                JointKind::Planar => (rate.slide, rate.turn) = (sum(0, 2), sum(2, 3)),
                JointKind::Floating => (rate.slide, rate.quaternion) = (sum(0, 3), sum(3, 7)),
            }
            rate
        };
        Self(robot.steps().iter().map(rate).collect())
    }
}

impl Reach {
    /// Computes the bounds for all times within `half` of the time of a configuration.
    ///
    /// `limbs` returns the capsules about a link, or `None` if nothing is known about its shape.
    /// `size` is a bound on the magnitude of the coordinates of all volumes in the world.
    pub(super) fn compute<'l>(
        &mut self,
        robot: &Robot,
        (chains, rates): (&Chains, &Rates),
        (configuration, frames): (&[f64], &[Frame]),
        half: f64,
        size: f64,
        mut limbs: impl FnMut(usize) -> Option<&'l [Limb]>,
    ) {
        self.rounding = KINEMATICS * (chains.depth + 1) as f64 * size;
        self.bounds.resize(chains.of.len(), Vec::new());
        for (link, bounds) in self.bounds.iter_mut().enumerate() {
            bounds.clear();
            bounds.push(0.0);
            if robot.links()[link].shape.is_none() {
                continue;
            }
            let (limbs, factor) = (limbs(link), chains.stretch[link] * INFLATION);
            let mut moved = 0.0;
            for &at in &chains.of[link] {
                let step = &robot.steps()[at];
                let rate = &rates.0[at];
                let change = |[rate, rounding]: [f64; 2]| rate * half + rounding;
                let lever = limbs.map_or(f64::INFINITY, |limbs| lever(step, &frames[step.child], limbs));
                let turn = match step.motion.kind {
                    JointKind::Floating => turn_of_quaternion(change(rate.quaternion), step, configuration),
                    _ => change(rate.turn),
                };
                // The chord of any turn is at most twice the lever.
                let turned = if turn > 0.0 { turn.min(2.0) * (lever * factor + moved) } else { 0.0 };
                moved = (moved + change(rate.slide) + turned) * factor;
                bounds.push(moved);
            }
        }
    }

    /// Returns a distance at which two links must be so that they keep a clearance. `joints` are
    /// the numbers of joints between each link and the last link that none of these moves.
    pub(super) fn needed(&self, links: [usize; 2], joints: [usize; 2], clearance: f64, chains: &Chains) -> f64 {
        let moved = self.bounds[links[0]][joints[0]] + self.bounds[links[1]][joints[1]];
        let factor = chains.stretch[links[0]].max(chains.stretch[links[1]]) * INFLATION;
        (moved + clearance) * factor + self.rounding
    }

    /// Returns a distance at which a link must be from obstacles so that it keeps a clearance.
    pub(super) fn needed_of_obstacles(&self, link: usize, clearance: f64, chains: &Chains) -> f64 {
        let moved = self.bounds[link][chains.length(link)];
        (moved + clearance) * chains.stretch[link] * INFLATION + self.rounding
    }

    /// Returns the distance that covers the rounding of the kinematics.
    pub(super) fn rounding(&self) -> f64 {
        self.rounding
    }
}

/// Returns the greatest distance of capsules from the axis of a joint, or from the origin of its
/// child if the joint has no axis.
fn lever(step: &Step, child: &Frame, limbs: &[Limb]) -> f64 {
    let origin = child.0.map(|row| row[3]);
    let axis = child.0.map(|[x, y, z, _]| dot(&[x, y, z], &step.motion.axis));
    let distance = |end: &[f64; 3]| {
        let arm = sub(end, &origin);
        let across = if step.motion.kind == JointKind::Floating { arm } else { cross(&arm, &axis) };
        dot(&across, &across).sqrt()
    };
    limbs.iter().map(|limb| distance(&limb.ends[0]).max(distance(&limb.ends[1])) + limb.radius).fold(0.0, f64::max)
}

/// Returns a bound on the angle of a rotation if its quaternion changes by at most `change` and is
/// normalized.
fn turn_of_quaternion(change: f64, step: &Step, configuration: &[f64]) -> f64 {
    let quaternion = &configuration[step.source.first + 3..step.source.first + 7];
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt() / INFLATION;
    // The angle between two quaternions is at most π/2 times its sine, and half of the angle of the
    // rotation.
    if change < 0.5 * length { std::f64::consts::PI * change / (length - change) * INFLATION } else { 2.0 }
}

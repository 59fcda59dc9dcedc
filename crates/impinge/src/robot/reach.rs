//! How far the links can move during an interval of a motion.
//!
//! # Source
//! Schwarzer, Saha and Latombe, *Adaptive dynamic collision checking for single and multiple
//! articulated robots in complex environments*, IEEE Transactions on Robotics 21, 2005. Lemma L43
//! of the proofs has the bounds with their rounding.

use super::cull::{Culling, Limb};
use super::frame::Frame;
use super::joint::JointKind;
use super::model::Robot;
use super::tree::Step;
use crate::math::vec3::{cross, dot, sub};

/// Share of the magnitude of a coordinate that covers its rounding between the ends of a motion,
/// 2^-48.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Factor by which a bound is enlarged, to cover its own rounding: 1 + 2^-40.
const INFLATION: f64 = 1.0 + 4096.0 * f64::EPSILON;

/// Share of the size of a robot that covers the rounding of the kinematics for each link of a
/// chain, 2^-42.
const KINEMATICS: f64 = 1024.0 * f64::EPSILON;

/// Times of a motion and lengths of intervals are multiples of this number, 2^-50, so that the ends
/// of intervals are exact.
pub(super) const QUANTUM: f64 = 1.0 / (1_u64 << 50) as f64;

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
#[derive(Clone, Debug, Default)]
pub(super) struct Rates(Vec<Rate>);

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

    /// Returns the joints on the way from one link to another, as steps of the kinematics.
    pub(super) fn between(&self, [a, b]: [usize; 2]) -> Vec<usize> {
        let [up, down] = [&self.of[a], &self.of[b]];
        let common = up.iter().rev().zip(down.iter().rev()).take_while(|(s, t)| s == t).count();
        up[..up.len() - common].iter().chain(down[..down.len() - common].iter().rev()).copied().collect()
    }

    /// Returns the joints on the way from a link to the root.
    pub(super) fn to_root(&self, link: usize) -> &[usize] {
        &self.of[link]
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

/// The links at a time of a motion.
pub(super) struct Moment<'m> {
    pub(super) robot: &'m Robot,
    pub(super) chains: &'m Chains,
    pub(super) rates: &'m Rates,
    pub(super) configuration: &'m [f64],
    pub(super) frames: &'m [Frame],
}

/// Distance of links from the axes of joints at a time of a motion. Each is computed when it is
/// first needed.
#[derive(Clone, Debug, Default)]
pub(super) struct Levers {
    /// For each link and each step the distance, or NaN if it was not computed.
    known: Vec<f64>,
    steps: usize,
    /// Distance that covers the rounding of the kinematics.
    rounding: f64,
}

/// Bound on how far two links, or a link and the obstacles, move relative to each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Reach {
    /// Rate and lever of each joint between them, and the length of the quaternion of a floating
    /// joint.
    terms: Vec<(Rate, f64, Option<f64>)>,
    /// Distance that the pair must keep.
    clearance: f64,
    /// Factor that covers that poses are not exactly rigid, and the rounding of the sum.
    factor: f64,
    rounding: f64,
}

impl Levers {
    /// Starts a time. `size` is a bound on the magnitude of the coordinates of all volumes in the
    /// world.
    pub(super) fn start(&mut self, moment: &Moment<'_>, size: f64) {
        self.steps = moment.robot.steps().len();
        self.known.clear();
        self.known.resize(self.steps * moment.frames.len(), f64::NAN);
        self.rounding = KINEMATICS * (moment.chains.depth + 1) as f64 * size;
    }

    /// Returns the greatest distance of a link from the axis of a joint, infinite if nothing is
    /// known about its shape.
    fn of(&mut self, link: usize, at: usize, moment: &Moment<'_>, culling: &mut Culling) -> f64 {
        let (step, known) = (&moment.robot.steps()[at], &mut self.known[link * self.steps + at]);
        if known.is_nan() {
            let limbs = culling.limbs(link, moment.robot.proxies(), moment.frames);
            *known = limbs.map_or(f64::INFINITY, |(limbs, _)| lever(step, &moment.frames[step.child], limbs));
        }
        *known
    }
}

impl Reach {
    /// Bounds how far two links move relative to each other, given the joints between them.
    ///
    /// Each link between the two has a frame, in which both links move. The bound is the least over
    /// all of these frames.
    pub(super) fn of_pair(
        &mut self,
        [a, b]: [usize; 2],
        (path, clearance): (&[usize], f64),
        moment: &Moment<'_>,
        levers: &mut Levers,
        culling: &mut Culling,
    ) {
        self.start(path, clearance, moment.chains.stretch[a].max(moment.chains.stretch[b]), moment, levers.rounding);
        // Excess of the bound in the frame of each link over that in the frame of the first.
        let (mut excess, mut least, mut split) = (0.0, 0.0, 0);
        for (place, (rate, ..)) in self.terms.iter().enumerate() {
            let speed = rate.turn[0] + rate.quaternion[0];
            if speed > 0.0 {
                let [arm_a, arm_b] = [a, b].map(|link| levers.of(link, path[place], moment, culling));
                excess += speed * (arm_a - arm_b);
            }
            if excess < least {
                (least, split) = (excess, place + 1);
            }
        }
        self.set_levers(path, |place| if place < split { a } else { b }, moment, levers, culling);
    }

    /// Bounds how far a link moves relative to the root.
    pub(super) fn of_link(
        &mut self,
        link: usize,
        clearance: f64,
        moment: &Moment<'_>,
        levers: &mut Levers,
        culling: &mut Culling,
    ) {
        let path = moment.chains.to_root(link);
        self.start(path, clearance, moment.chains.stretch[link], moment, levers.rounding);
        self.set_levers(path, |_| link, moment, levers, culling);
    }

    fn start(&mut self, path: &[usize], clearance: f64, stretch: f64, moment: &Moment<'_>, rounding: f64) {
        (self.clearance, self.factor, self.rounding) = (clearance, stretch * INFLATION, rounding);
        self.terms.clear();
        self.terms.extend(path.iter().map(|&at| (moment.rates.0[at], 0.0, None)));
    }

    /// Sets the lever of each joint to that of the link that it is taken to move.
    fn set_levers(
        &mut self,
        path: &[usize],
        link_of: impl Fn(usize) -> usize,
        moment: &Moment<'_>,
        levers: &mut Levers,
        culling: &mut Culling,
    ) {
        for (place, (_, lever, length)) in self.terms.iter_mut().enumerate() {
            let step = &moment.robot.steps()[path[place]];
            *lever = levers.of(link_of(place), path[place], moment, culling);
            if step.motion.kind == JointKind::Floating {
                *length = Some(length_of_quaternion(step, moment.configuration));
            }
        }
    }

    /// Returns a distance such that the pair keeps its clearance for `half` of the time before and
    /// after if it has that distance now.
    pub(super) fn needed(&self, half: f64) -> f64 {
        (self.moved(half).sum::<f64>() + self.clearance) * self.factor + self.rounding
    }

    /// Returns how far each joint moves the pair within `half` of the time before and after.
    fn moved(&self, half: f64) -> impl Iterator<Item = f64> {
        let change = move |[rate, rounding]: [f64; 2]| rate * half + rounding;
        self.terms.iter().map(move |(rate, lever, length)| {
            let turn = match length {
                Some(length) => turn_of_quaternion(change(rate.quaternion), *length),
                None => change(rate.turn),
            };
            // The chord of any turn is at most twice the lever.
            let turned = if turn > 0.0 { turn.min(2.0) * lever } else { 0.0 };
            change(rate.slide) + turned
        })
    }

    /// Returns the place on the way of the joint that moves the pair the most, if any moves it.
    pub(super) fn widest(&self) -> Option<usize> {
        let rate = |rate: &Rate| rate.turn[0].max(rate.slide[0]);
        let moving = self.moved(0.5).enumerate().filter(|(place, _)| rate(&self.terms[*place].0) > 0.0);
        moving.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(place, _)| place)
    }

    /// Returns the distance that a proof for `half` of the time before and after requires: the
    /// needed distance, and room for the rounding of the distance that verifies a certificate.
    pub(super) fn wanted(&self, half: f64) -> f64 {
        self.needed(half) + self.rounding
    }

    /// Returns how long before and after the current time the pair keeps its clearance, at most
    /// `max`, if it has a distance now. Zero if nothing is known. The result is a multiple of
    /// [`QUANTUM`].
    pub(super) fn half(&self, distance: f64, max: f64) -> f64 {
        let (least, most) = (self.wanted(0.0), self.wanted(max));
        if most < distance {
            return max;
        }
        // Where all terms are linear this is the answer, but for rounding.
        let mut guess = if least < distance { max * ((distance - least) / (most - least)) } else { 0.0 };
        guess *= 1.0 - 1e-9;
        // A guess that is NaN ends the loop.
        while guess >= QUANTUM {
            let half = (guess / QUANTUM).floor() * QUANTUM;
            if self.wanted(half) < distance {
                return half;
            }
            guess *= 0.5;
        }
        0.0
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

/// Returns a lower bound of the length of the quaternion of a floating joint.
fn length_of_quaternion(step: &Step, configuration: &[f64]) -> f64 {
    let quaternion = &configuration[step.source.first + 3..step.source.first + 7];
    quaternion.iter().map(|x| x * x).sum::<f64>().sqrt() / INFLATION
}

/// Returns a bound on the angle of a rotation if its quaternion of a length changes by at most
/// `change` and is normalized.
fn turn_of_quaternion(change: f64, length: f64) -> f64 {
    // The angle between two quaternions is at most π/2 times its sine, and half of the angle of
    // the rotation.
    if change < 0.5 * length { std::f64::consts::PI * change / (length - change) * INFLATION } else { 2.0 }
}

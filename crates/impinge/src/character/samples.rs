//! Poses that represent all motions of a rig. They are so close in time that between two of them no
//! vertex strays from its chord, as seen from its part, by more than a known length.

use super::error::{RigError, RigErrorKind, RigPlace};
use super::motion_bound::{IntervalMotion, Jet, mapped};
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::timeline::Side;
use crate::math::vec3::{Vector, length};

/// Maximum stray between samples, as a share of the character's size. Intervals between keys are
/// halved until vertices stray less. The stray is added to the volumes, so a larger share makes
/// them looser and a smaller one costs time.
const MAX_STRAY: f64 = 1.0 / 512.0;

/// Maximum number of halvings of an interval. The stray that remains is added to the volumes. More
/// halvings cost time, fewer make the volumes larger.
const MAX_HALVINGS: u32 = 5;

/// Maximum number of halvings if there is no bound at all. Splines of quaternions that come near
/// zero need them.
const MAX_HALVINGS_UNBOUNDED: u32 = 14;

/// A pose of a motion: the animation, the time, and the side of a jump. `None` is the rest pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    motion: Option<(usize, f64, Side)>,
}

impl Sample {
    pub(super) fn pose(&self, rig: &Rig, pose: &mut RigPose) -> Result<(), RigError> {
        match self.motion {
            Some((animation, time, side)) => rig.pose_on_side(animation, time, side, None, pose),
            None => {
                *pose = rig.rest_pose()?;
                Ok(())
            }
        }
    }
}

/// The contents of a part: the bone that its volume is fixed to, and the vertices of its faces.
pub(super) struct PartVertices {
    pub(super) anchor: u32,
    pub(super) vertices: Vec<u32>,
}

/// The samples, and a bound on how far the vertices of each part stray between them.
pub(super) struct Samples {
    pub(super) list: Vec<Sample>,
    pub(super) stray: Vec<f64>,
}

impl Samples {
    /// Samples the rest pose and all animations.
    pub(super) fn of(rig: &Rig, parts: &[PartVertices]) -> Result<Self, RigError> {
        let rest = Sample { motion: None };
        let mut samples = Self { list: vec![rest], stray: vec![0.0; parts.len()] };
        let limit = MAX_STRAY * size(rig)?;
        let spans: Vec<Vec<JointSpan>> = parts.iter().map(|part| joint_spans(rig, part)).collect();
        for (index, animation) in rig.animations().iter().enumerate() {
            let times = animation.key_times();
            let Some(&last) = times.last() else { continue };
            for pair in times.windows(2) {
                // Last in, first out: the earlier half is on top.
                let mut pending = vec![([pair[0], pair[1]], 0)];
                while let Some(([start, end], depth)) = pending.pop() {
                    let motion = IntervalMotion::new(rig, animation, [start, end]);
                    let h = end - start;
                    let strays: Vec<f64> = parts
                        .iter()
                        .zip(&spans)
                        .map(|(part, spans)| h * h / 8.0 * acceleration(rig, part, spans, &motion))
                        .collect();
                    let most = strays.iter().copied().fold(0.0, f64::max);
                    let middle = 0.5 * start + 0.5 * end;
                    let max_halvings = if most.is_finite() { MAX_HALVINGS } else { MAX_HALVINGS_UNBOUNDED };
                    if most > limit && depth < max_halvings && start < middle && middle < end {
                        pending.push(([middle, end], depth + 1));
                        pending.push(([start, middle], depth + 1));
                        continue;
                    }
                    if !most.is_finite() {
                        let place = RigPlace::Channel { animation: index, channel: 0 };
                        return Err(RigError::new(RigErrorKind::UnboundedMotion, place));
                    }
                    samples.stray.iter_mut().zip(strays).for_each(|(all, own)| *all = all.max(own));
                    samples.list.push(Sample { motion: Some((index, start, Side::After)) });
                    if end == pair[1] {
                        samples.list.push(Sample { motion: Some((index, end, Side::Before)) });
                    }
                }
            }
            samples.list.push(Sample { motion: Some((index, last, Side::After)) });
        }
        Ok(samples)
    }
}

/// Returns the diagonal of the box around the surface at rest.
fn size(rig: &Rig) -> Result<f64, RigError> {
    let mut vertices = Vec::new();
    rig.skin().skinned(&rig.rest_pose()?, &mut vertices);
    let [low, high] = super::volume::box_of(&vertices);
    let size = length(&[0, 1, 2].map(|k| high[k] - low[k]));
    Ok(if size.is_finite() { size } else { 0.0 })
}

/// A joint that vertices of a part follow, and their maximum distance from its bone.
struct JointSpan {
    joint: u32,
    reach: f64,
    /// For each morph target that moves some of these vertices: its index and its longest offset.
    morphs: Vec<(usize, f64)>,
}

fn joint_spans(rig: &Rig, part: &PartVertices) -> Vec<JointSpan> {
    let skin = rig.skin();
    let mut spans: Vec<JointSpan> = Vec::new();
    let mut of_joint = vec![None; skin.joints().len()];
    let mut is_held = vec![false; skin.positions().len()];
    for &vertex in &part.vertices {
        is_held[vertex as usize] = true;
        for influence in skin.influences(vertex) {
            let at = *of_joint[influence.joint as usize].get_or_insert_with(|| {
                spans.push(JointSpan { joint: influence.joint, reach: 0.0, morphs: Vec::new() });
                spans.len() - 1
            });
            let bind = &skin.joints()[influence.joint as usize].inverse_bind;
            spans[at].reach = spans[at].reach.max(length(&mapped(bind, skin.positions()[vertex as usize])));
        }
    }
    for (morph, target) in skin.morphs().iter().enumerate() {
        for &(vertex, offset) in target.offsets.iter().filter(|(vertex, _)| is_held[*vertex as usize]) {
            for influence in skin.influences(vertex) {
                let Some(at) = of_joint[influence.joint as usize] else { continue };
                let bind = &skin.joints()[influence.joint as usize].inverse_bind;
                let moved = length(&bind.map(|[x, y, z, _]| x * offset[0] + y * offset[1] + z * offset[2]));
                let span: &mut JointSpan = &mut spans[at];
                match span.morphs.last_mut().filter(|last| last.0 == morph) {
                    Some(last) => last.1 = last.1.max(moved),
                    None => span.morphs.push((morph, moved)),
                }
            }
        }
    }
    spans
}

/// Returns a bound on the largest second derivative of a vertex of a part, as seen from the part.
fn acceleration(rig: &Rig, part: &PartVertices, spans: &[JointSpan], motion: &IntervalMotion<'_>) -> f64 {
    let skin = rig.skin();
    let mut of_joint = vec![0.0; skin.joints().len()];
    for span in spans {
        let mut point = Jet { value: span.reach, ..Jet::default() };
        for &(morph, offset) in &span.morphs {
            let Jet { value, first, second } = motion.morphs[morph];
            point.value += value * offset;
            point.first += first * offset;
            point.second += second * offset;
        }
        let bone = skin.joints()[span.joint as usize].bone;
        of_joint[span.joint as usize] = motion.acceleration(bone, part.anchor, point);
    }
    let of_vertex = |&vertex: &u32| -> f64 {
        // An infinite bound counts even for a small weight. Weights are positive.
        skin.influences(vertex).iter().map(|i| i.weight * of_joint[i.joint as usize]).sum()
    };
    part.vertices.iter().map(of_vertex).fold(0.0, f64::max)
}

/// Returns a bound on the rounding error of a vertex position in the frame of its part. A position
/// takes as many products and sums as the joint has ancestors. Each has an error of 8 units of
/// 2^-53 of the terms, which are at most `reach`.
pub(super) fn rounding(rig: &Rig, pose: &RigPose) -> f64 {
    let norm = |rows: &[[f64; 3]; 3]| rows.as_flattened().iter().map(|x| x * x).sum::<f64>().sqrt();
    let farthest = rig.skin().positions().iter().map(|&p| length(&p)).fold(0.0, f64::max);
    let offset = |weights: &[f64]| -> f64 {
        let longest = |at: usize| rig.skin().morphs()[at].offsets.iter().map(|o| length(&o.1)).fold(0.0, f64::max);
        weights.iter().enumerate().filter(|w| *w.1 != 0.0).map(|(at, weight)| weight.abs() * longest(at)).sum()
    };
    let farthest = farthest + offset(pose.morph_weights());
    let mut worst = 0.0_f64;
    for joint in rig.skin().joints() {
        let bone = &pose.bones()[joint.bone as usize];
        let bind: Vector = joint.inverse_bind.map(|[.., t]| t);
        let linear = joint.inverse_bind.map(|[x, y, z, _]| [x, y, z]);
        let along: f64 = rig
            .skeleton()
            .ancestry(joint.bone)
            .map(|above| length(&pose.bones()[above as usize].origin()))
            .fold(0.0, f64::max);
        let reach = norm(&bone.linear()) * (norm(&linear) * farthest + length(&bind)) + 2.0 * along;
        let depth = f64::from(rig.skeleton().depth(joint.bone));
        worst = worst.max((depth + 4.0) * 32.0 * f64::EPSILON * reach);
    }
    worst
}

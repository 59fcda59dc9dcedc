//! Poses that represent all motions of a rig. They are so close in time that between two of them no
//! vertex strays from its chord, as seen from its part, by more than a known length.

use super::error::{RigError, RigErrorKind, RigPlace};
use super::motion_bound::{IntervalMotion, Jet, mapped};
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::skin_tree::offsets_by_vertex;
use super::timeline::Side;
use super::work::Work;
use crate::math::vec3::{Vector, length};

/// Maximum stray between samples, as a share of the character's size. Intervals between keys are
/// halved until vertices stray less. The stray is added to the volumes, so a larger share makes
/// them looser and a smaller one costs time.
const MAX_STRAY: f64 = 1.0 / 512.0;

/// Maximum number of halvings of an interval. The stray that remains is added to the volumes. More
/// halvings cost time, fewer make the volumes larger. Intervals are halved less often if the work
/// for the rig is nearly spent.
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
    ///
    /// # Errors
    /// Returns an error if a pose is out of range, if the speed of a motion has no bound, or if
    /// there are too many keys and vertices for the [`Work`] of this rig.
    pub(super) fn of(rig: &Rig, parts: &[PartVertices]) -> Result<Self, RigError> {
        let rest = Sample { motion: None };
        let mut samples = Self { list: vec![rest], stray: vec![0.0; parts.len()] };
        let limit = MAX_STRAY * size(rig)?;
        let spans = joint_spans(rig, parts);
        let times_of: Vec<Vec<f64>> = rig.animations().iter().map(|animation| animation.key_times()).collect();
        let of_interval = steps(rig, parts, &spans);
        let mut work = Work::for_rig(rig);
        for (animation, times) in rig.animations().iter().zip(&times_of) {
            // One more for each key, because both sides of a jump are sampled.
            work.take((of_interval + animation.tracks().len() as u64).saturating_mul(2 * times.len() as u64))?;
        }
        let mut of_joint = vec![0.0; rig.skin().joints().len()];
        for (index, (animation, times)) in rig.animations().iter().zip(&times_of).enumerate() {
            let Some(&last) = times.last() else { continue };
            let of_halving = of_interval + animation.tracks().len() as u64;
            for pair in times.windows(2) {
                // Last in, first out: the earlier half is on top.
                let mut pending = vec![([pair[0], pair[1]], 0)];
                while let Some(([start, end], depth)) = pending.pop() {
                    let motion = IntervalMotion::new(rig, animation, [start, end]);
                    let h = end - start;
                    let strays: Vec<f64> = parts
                        .iter()
                        .zip(&spans)
                        .map(|(part, spans)| h * h / 8.0 * acceleration(rig, part, spans, &motion, &mut of_joint))
                        .collect();
                    let most = strays.iter().copied().fold(0.0, f64::max);
                    let middle = 0.5 * start + 0.5 * end;
                    let max_halvings = if most.is_finite() { MAX_HALVINGS } else { MAX_HALVINGS_UNBOUNDED };
                    let is_divisible = depth < max_halvings && start < middle && middle < end;
                    if most > limit && is_divisible && work.has(of_halving) {
                        work.take(of_halving)?;
                        pending.push(([middle, end], depth + 1));
                        pending.push(([start, middle], depth + 1));
                        continue;
                    }
                    if !most.is_finite() {
                        if is_divisible {
                            work.take(of_halving)?;
                        }
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

/// Returns the number of steps of [`Work`] for one interval and its sample.
fn steps(rig: &Rig, parts: &[PartVertices], spans: &[Vec<JointSpan>]) -> u64 {
    let (skin, skeleton) = (rig.skin(), rig.skeleton());
    let offsets: usize = skin.morphs().iter().map(|morph| morph.offsets.len()).sum();
    let influences =
        |part: &PartVertices| -> usize { part.vertices.iter().map(|&vertex| skin.influences(vertex).len()).sum() };
    let paths = |(part, spans): (&PartVertices, &Vec<JointSpan>)| -> u64 {
        let depth = |span: &JointSpan| u64::from(skeleton.depth(skin.joints()[span.joint as usize].bone));
        spans.iter().map(|span| depth(span) + u64::from(skeleton.depth(part.anchor))).sum()
    };
    let held: usize = parts.iter().map(|part| part.vertices.len()).sum();
    // Copying a vertex, moving it by a morph target or following a joint takes about an eighth of a
    // step.
    let eighths = skin.positions().len() + offsets + parts.iter().map(influences).sum::<usize>();
    let of_pose = skeleton.bones().len() + skin.joints().len() + held + eighths / 8;
    of_pose as u64 + parts.iter().zip(spans).map(paths).sum::<u64>()
}

/// Returns the joints that the vertices of each part follow.
fn joint_spans(rig: &Rig, parts: &[PartVertices]) -> Vec<Vec<JointSpan>> {
    let skin = rig.skin();
    let (offsets, first) = offsets_by_vertex(skin);
    let mut of_joint = vec![None; skin.joints().len()];
    let of_part = |part: &PartVertices| {
        let mut spans: Vec<JointSpan> = Vec::new();
        // For each span that a morph target moves: the span, the target, and the length.
        let mut moves: Vec<(usize, u32, f64)> = Vec::new();
        for &vertex in &part.vertices {
            let offsets = &offsets[first[vertex as usize] as usize..first[vertex as usize + 1] as usize];
            for influence in skin.influences(vertex) {
                let at = *of_joint[influence.joint as usize].get_or_insert_with(|| {
                    spans.push(JointSpan { joint: influence.joint, reach: 0.0, morphs: Vec::new() });
                    spans.len() - 1
                });
                let bind = &skin.joints()[influence.joint as usize].inverse_bind;
                spans[at].reach = spans[at].reach.max(length(&mapped(bind, skin.positions()[vertex as usize])));
                let moved = |o: Vector| length(&bind.map(|[x, y, z, _]| x * o[0] + y * o[1] + z * o[2]));
                moves.extend(offsets.iter().map(|&(morph, offset)| (at, morph, moved(offset))));
            }
        }
        moves.sort_by_key(|own| (own.0, own.1));
        for group in moves.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let longest = group.iter().map(|own| own.2).fold(0.0, f64::max);
            spans[group[0].0].morphs.push((group[0].1 as usize, longest));
        }
        spans.iter().for_each(|span| of_joint[span.joint as usize] = None);
        spans
    };
    parts.iter().map(of_part).collect()
}

/// Returns a bound on the largest second derivative of a vertex of a part, as seen from the part.
/// `of_joint` has an entry for each joint, of any value.
fn acceleration(
    rig: &Rig,
    part: &PartVertices,
    spans: &[JointSpan],
    motion: &IntervalMotion<'_>,
    of_joint: &mut [f64],
) -> f64 {
    let skin = rig.skin();
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
    // For each bone, the largest distance of its origin and those of its ancestors.
    let mut along = vec![0.0_f64; pose.bones().len()];
    for &bone in rig.skeleton().order() {
        let above = rig.skeleton().bones()[bone as usize].parent.map_or(0.0, |parent| along[parent as usize]);
        along[bone as usize] = above.max(length(&pose.bones()[bone as usize].origin()));
    }
    let mut worst = 0.0_f64;
    for joint in rig.skin().joints() {
        let bone = &pose.bones()[joint.bone as usize];
        let bind: Vector = joint.inverse_bind.map(|[.., t]| t);
        let linear = joint.inverse_bind.map(|[x, y, z, _]| [x, y, z]);
        let reach =
            norm(&bone.linear()) * (norm(&linear) * farthest + length(&bind)) + 2.0 * along[joint.bone as usize];
        let depth = f64::from(rig.skeleton().depth(joint.bone));
        worst = worst.max((depth + 4.0) * 32.0 * f64::EPSILON * reach);
    }
    worst
}

//! Fits volumes of each kind to the parts of a plan, and chooses the best kind.

use std::collections::{BTreeMap, HashSet};

use rayon::prelude::*;

use crate::hull::Hull;
use crate::input::InputError;
use crate::volume::{BoundingSphere, BoundingVolume, Capsule, Lozenge, Obb};

use super::candidates::{Candidates, Needs, farther, middle};
use super::error::{RigError, RigErrorKind, RigPlace};
use super::plan::{Plan, bones_of_faces, sample_poses};
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::samples::{PartVertices, Sample, Samples, rounding};
use super::visit::visit_positions;
use super::volume::{HitHull, HitVolume, VolumeKind, box_of};
use crate::math::vec3::{Vector, add, dot, length, scale, sub};

/// How tightly volumes are fitted: whether they enclose every vertex or leave out the outermost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// No point of the skinned surface is ever outside, at rest and at every time of every
    /// animation of the rig.
    Conservative,
    /// The outermost 5 % of the vertices of a part may stick out, so that strikes look right.
    Snug,
}

/// Share of the vertices of a part that a snug volume may leave out.
const TRIMMED_SHARE: f64 = 0.05;

/// Number of poses from which snug volumes are fitted, and from which conservative fits take their
/// first extremes. More poses cost time; fewer make the first fits less representative.
const POSES: usize = 96;

/// A part of a character, with a volume in the rigid frame of a bone.
#[derive(Clone, Debug)]
pub struct HitPart {
    /// The name of the part.
    pub name: String,
    /// The indices of the bones whose faces belong to the part.
    pub bones: Vec<u32>,
    /// The index of the bone that the volume is fixed to.
    pub anchor: u32,
    pub(super) volume: HitVolume,
    /// Surface area of the volume divided by that of the convex hull of the points it was fitted
    /// to. A value of 1 is as tight as a convex volume can be.
    pub looseness: f64,
    /// A sphere around the volume: center and radius.
    pub(super) sphere: (Vector, f64),
}

impl HitPart {
    /// Builds a part with an existing volume, given in the frame of bone `anchor`.
    #[must_use]
    pub fn new(name: String, bones: Vec<u32>, anchor: u32, volume: HitVolume, looseness: f64) -> Self {
        let sphere = volume.bounding_sphere();
        Self { name, bones, anchor, volume, looseness, sphere }
    }

    /// Returns the volume, in the frame of the bone that it is fixed to.
    #[must_use]
    pub fn volume(&self) -> &HitVolume {
        &self.volume
    }
}

/// Fits one volume to each part of a plan that has faces. Returns the parts, and the part of each
/// face.
pub(super) fn parts(rig: &Rig, plan: &Plan, mode: Mode) -> Result<(Vec<HitPart>, Vec<u32>), RigError> {
    let part_of_bone = plan.part_of_bones(rig)?;
    let mut part_of_face: Vec<u32> = bones_of_faces(rig).into_iter().map(|bone| part_of_bone[bone as usize]).collect();
    if part_of_face.is_empty() {
        return Err(RigError::new(RigErrorKind::Empty, RigPlace::Rig));
    }
    let mut number = vec![u32::MAX; plan.parts.len()];
    let mut has_faces = vec![false; plan.parts.len()];
    part_of_face.iter().for_each(|&part| has_faces[part as usize] = true);
    let mut kept = Vec::new();
    for (part, planned) in plan.parts.iter().enumerate() {
        if has_faces[part] {
            number[part] = kept.len() as u32;
            kept.push(planned);
        }
    }
    part_of_face.iter_mut().for_each(|part| *part = number[*part as usize]);
    let held = part_vertices(rig, &part_of_face, &kept.iter().map(|planned| planned.anchor).collect::<Vec<_>>());
    let clouds = match mode {
        Mode::Conservative => conservative(rig, &held)?,
        Mode::Snug => snug(rig, &held, &part_of_bone, &number)?,
    };
    let mut parts = Vec::new();
    for (planned, candidates) in kept.into_iter().zip(clouds) {
        let best = candidates.best(planned.kind);
        let looseness = candidates.looseness(&best);
        let (bones, anchor) = (planned.bones.clone(), planned.anchor);
        parts.push(HitPart::new(planned.name.clone(), bones, anchor, best, looseness));
    }
    Ok((parts, part_of_face))
}

/// A convex piece of a part's surface. Pieces refine the part's volume for rays.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) part: u32,
    pub(super) anchor: u32,
    pub(super) volume: HitVolume,
}

/// Builds hulls around groups of at most `faces` faces that follow the same bone. They are
/// conservative, because every face of a part is in some piece.
pub(super) fn pieces(rig: &Rig, part_of_face: &[u32], faces: usize) -> Result<Vec<Piece>, RigError> {
    let mut vertices = Vec::new();
    rig.skin().skinned(&rig.rest_pose()?, &mut vertices);
    let middle = |face: &u32| {
        let corners = rig.skin().faces()[*face as usize];
        corners.iter().fold([0.0; 3], |sum, &corner| add(&sum, &vertices[corner as usize]))
    };
    let mut groups: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
    for ((face, bone), &part) in (0..).zip(bones_of_faces(rig)).zip(part_of_face) {
        groups.entry((part, bone)).or_default().push(face);
    }
    let (mut owners, mut held) = (Vec::new(), Vec::new());
    let mut pending: Vec<((u32, u32), Vec<u32>)> = groups.into_iter().rev().collect();
    while let Some((owner, mut group)) = pending.pop() {
        if group.len() > faces.max(1) {
            // Halves along the longest axis, by rank, so the recursion ends.
            let [low, high] = box_of(&group.iter().map(middle).collect::<Vec<_>>());
            let axis = (0..3).max_by(|&i, &j| (high[i] - low[i]).total_cmp(&(high[j] - low[j]))).unwrap_or(0);
            group.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(b)));
            let upper = group.split_off(group.len() / 2);
            pending.push((owner, upper));
            pending.push((owner, group));
            continue;
        }
        let mut vertices: Vec<u32> = group.iter().flat_map(|&face| rig.skin().faces()[face as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        remove_coincident(rig, &mut vertices);
        owners.push(owner.0);
        held.push(PartVertices { anchor: owner.1, vertices });
    }
    let fitted = conservative(rig, &held)?;
    let piece = |((part, held), candidates): ((u32, &PartVertices), Candidates)| Piece {
        part,
        anchor: held.anchor,
        volume: candidates.best(Some(VolumeKind::Hull)),
    };
    Ok(owners.into_iter().zip(&held).zip(fitted).map(piece).collect())
}

fn part_vertices(rig: &Rig, part_of_face: &[u32], anchors: &[u32]) -> Vec<PartVertices> {
    let mut held: Vec<PartVertices> =
        anchors.iter().map(|&anchor| PartVertices { anchor, vertices: Vec::new() }).collect();
    for (face, &part) in rig.skin().faces().iter().zip(part_of_face) {
        held[part as usize].vertices.extend(face);
    }
    for part in &mut held {
        part.vertices.sort_unstable();
        part.vertices.dedup();
        remove_coincident(rig, &mut part.vertices);
    }
    held
}

/// Removes vertices that always coincide with another one, such as those along texture seams.
fn remove_coincident(rig: &Rig, vertices: &mut Vec<u32>) {
    let skin = rig.skin();
    if !skin.morphs().is_empty() {
        return;
    }
    let mut seen = HashSet::new();
    vertices.retain(|&vertex| {
        let influences = skin.influences(vertex).iter().map(|i| (i.joint, i.weight.to_bits()));
        seen.insert((skin.positions()[vertex as usize].map(f64::to_bits), influences.collect::<Vec<_>>()))
    });
}

/// Fits volumes that enclose every vertex of a part at every time.
fn conservative(rig: &Rig, held: &[PartVertices]) -> Result<Vec<Candidates>, RigError> {
    let samples = Samples::of(rig, held)?;
    let extremes = extremes(rig, held, &samples.list)?;
    let validated = |e: InputError| out_of_range(&e);
    let mut candidates = Vec::new();
    for of_part in &extremes {
        let points: Vec<Vector> = of_part.iter().map(|&(_, point)| point).collect();
        let few: Vec<Vector> = COARSE.iter().map(|&at| of_part[at].1).collect();
        candidates.push(Candidates::about(&points, &few).map_err(validated)?);
    }
    let (needs, rounding) = needs(rig, held, &samples.list, &candidates)?;
    for ((candidates, needs), stray) in candidates.iter_mut().zip(&needs).zip(&samples.stray) {
        let margin = stray * (1.0 + 1e-9) + rounding;
        candidates.grow(needs, margin).map_err(validated)?;
    }
    let gauges = gauges(rig, held, &samples.list, &candidates)?;
    for ((candidates, gauge), stray) in candidates.iter_mut().zip(gauges).zip(&samples.stray) {
        candidates.grow_hull(gauge, stray * (1.0 + 1e-9) + rounding).map_err(validated)?;
    }
    Ok(candidates)
}

/// Returns the error for a part beyond the range of volumes. Poses are within 2^100.
fn out_of_range(_: &InputError) -> RigError {
    RigError::new(RigErrorKind::OutOfRange { what: "part" }, RigPlace::Rig)
}

/// Number of samples per parallel task.
const CHUNK: usize = 32;

/// Processes all samples on all cores. The result does not depend on the number of cores if `merge`
/// does not depend on the order.
fn over_samples<T: Send>(
    rig: &Rig,
    samples: &[Sample],
    start: impl Fn() -> T + Sync,
    show: impl Fn(&mut T, &RigPose) + Sync,
    merge: impl Fn(T, T) -> T + Sync + Send,
) -> Result<T, RigError> {
    let of_chunk = |chunk: &[Sample]| {
        let (mut found, mut pose) = (start(), RigPose::default());
        for sample in chunk {
            sample.pose(rig, &mut pose)?;
            show(&mut found, &pose);
        }
        Ok(found)
    };
    samples.par_chunks(CHUNK).map(of_chunk).try_reduce(&start, |a, b| Ok(merge(a, b)))
}

/// Returns, for each part, the vertices that are farthest along fixed directions, at any time of
/// some samples.
fn extremes(rig: &Rig, held: &[PartVertices], samples: &[Sample]) -> Result<Vec<Vec<(f64, Vector)>>, RigError> {
    let directions = directions();
    // A subset of the samples is enough: the volumes are later grown to enclose all.
    let some: Vec<Sample> = samples.iter().step_by(samples.len().div_ceil(POSES)).copied().collect();
    over_samples(
        rig,
        &some,
        || vec![vec![(f64::NEG_INFINITY, [0.0; 3]); directions.len()]; held.len()],
        |found, pose| {
            visit_positions(rig, pose, held, |part, _, point| {
                for (best, &direction) in found[part].iter_mut().zip(&directions) {
                    let along = dot(&direction, &point);
                    if along >= best.0 {
                        *best = farther(*best, (along, point));
                    }
                }
            });
        },
        |mut a, b| {
            a.iter_mut().flatten().zip(b.into_iter().flatten()).for_each(|(a, b)| *a = farther(*a, b));
            a
        },
    )
}

/// Returns all directions with integer entries from -2 to 2, except zero.
fn directions() -> Vec<Vector> {
    let entry = |i: usize| i as f64 - 2.0;
    let all = (0..125).map(|i| [entry(i % 5), entry(i / 5 % 5), entry(i / 25)]);
    all.filter(|d| *d != [0.0; 3]).collect()
}

/// Indices of the 26 directions without an entry of ±1, for hulls with few corners.
static COARSE: std::sync::LazyLock<Vec<usize>> = std::sync::LazyLock::new(|| {
    let is_coarse = |d: &Vector| d.iter().all(|x| x.abs() != 1.0);
    directions().iter().enumerate().filter(|(_, d)| is_coarse(d)).map(|(at, _)| at).collect()
});

/// Returns the needs of each part, and a bound on the rounding of the vertices.
fn needs(
    rig: &Rig,
    held: &[PartVertices],
    samples: &[Sample],
    candidates: &[Candidates],
) -> Result<(Vec<Needs>, f64), RigError> {
    let kinds = [VolumeKind::Sphere, VolumeKind::Capsule, VolumeKind::Lozenge];
    let volumes: Vec<[HitVolume; 3]> = candidates.iter().map(|c| kinds.map(|kind| c.volume(kind))).collect();
    over_samples(
        rig,
        samples,
        || (candidates.iter().map(Needs::new).collect::<Vec<_>>(), 0.0_f64),
        |(needs, worst), pose| {
            *worst = worst.max(rounding(rig, pose));
            visit_positions(rig, pose, held, |part, _, point| {
                needs[part].include(&candidates[part], &volumes[part], point)
            });
        },
        |(a, x), (b, y)| (a.into_iter().zip(&b).map(|(a, b)| a.merged(b)).collect(), x.max(y)),
    )
}

/// Returns the factor by which each hull must be enlarged around its middle to enclose all
/// vertices, at least 1.
fn gauges(rig: &Rig, held: &[PartVertices], samples: &[Sample], all: &[Candidates]) -> Result<Vec<f64>, RigError> {
    let of_part = |candidates: &Candidates| {
        let middle = middle(candidates.hull.hull());
        let planes = candidates.hull.planes().iter();
        let slopes = planes.map(|&(normal, level)| scale(&normal, 1.0 / (level - dot(&normal, &middle))));
        (middle, slopes.collect::<Vec<_>>())
    };
    let gauges: Vec<(Vector, Vec<Vector>)> = all.iter().map(of_part).collect();
    over_samples(
        rig,
        samples,
        || vec![1.0_f64; held.len()],
        |found, pose| {
            visit_positions(rig, pose, held, |part, _, point| {
                let (middle, slopes) = &gauges[part];
                let offset = sub(&point, middle);
                found[part] = slopes.iter().map(|&slope| dot(&slope, &offset)).fold(found[part], f64::max);
            });
        },
        |a, b| a.iter().zip(&b).map(|(a, b)| a.max(*b)).collect(),
    )
}

/// Fits volumes to most of the vertices that follow the bones of a part more than others.
fn snug(rig: &Rig, held: &[PartVertices], part_of_bone: &[u32], number: &[u32]) -> Result<Vec<Candidates>, RigError> {
    let skin = rig.skin();
    let own: Vec<PartVertices> = (0..)
        .zip(held)
        .map(|(part, all)| {
            let follows = |&vertex: &u32| {
                let most = skin.influences(vertex).iter().max_by(|a, b| a.weight.total_cmp(&b.weight));
                most.is_some_and(|i| {
                    number[part_of_bone[skin.joints()[i.joint as usize].bone as usize] as usize] == part
                })
            };
            let vertices: Vec<u32> = all.vertices.iter().copied().filter(follows).collect();
            let vertices = if vertices.is_empty() { all.vertices.clone() } else { vertices };
            PartVertices { anchor: all.anchor, vertices }
        })
        .collect();
    let mut points = vec![Vec::new(); held.len()];
    for pose in sample_poses(rig, POSES)? {
        visit_positions(rig, &pose, &own, |part, _, point| points[part].push(point));
    }
    points.iter().map(|points| trimmed(points).map_err(|e| out_of_range(&e))).collect()
}

/// Fits volumes to all but the outermost of the points.
fn trimmed(points: &[Vector]) -> Result<Candidates, InputError> {
    let hull = Hull::new(points)?;
    let mut candidates = Candidates::about(hull.positions(), hull.positions())?;
    let quantile = |mut values: Vec<f64>, share: f64| {
        let at = ((values.len() - 1) as f64 * share) as usize;
        *values.select_nth_unstable_by(at, f64::total_cmp).1
    };
    let reach = |volume: &HitVolume| {
        let distances = points.iter().map(|&p| length(&sub(&p, &volume.closest_on_core(p)))).collect();
        quantile(distances, 1.0 - TRIMMED_SHARE)
    };
    let along = |axis: Vector, share: f64| quantile(points.iter().map(|&p| dot(&axis, &p)).collect(), share);
    let radii = [VolumeKind::Sphere, VolumeKind::Capsule, VolumeKind::Lozenge].map(|k| reach(&candidates.volume(k)));
    candidates.sphere = BoundingSphere::new(candidates.sphere.center(), radii[0])?;
    let [from, to] = candidates.capsule.ends();
    candidates.capsule = Capsule::new(from, to, radii[1])?;
    candidates.lozenge = Lozenge::new(candidates.lozenge.corner(), candidates.lozenge.edges(), radii[2])?;
    let axes = candidates.obb.axes();
    // One sixth of the share on each of the six sides.
    let ranges = axes.map(|axis| [along(axis, TRIMMED_SHARE / 6.0), along(axis, 1.0 - TRIMMED_SHARE / 6.0)]);
    let center = (0..3).fold([0.0; 3], |at, k| add(&at, &scale(&axes[k], 0.5 * (ranges[k][0] + ranges[k][1]))));
    candidates.obb = Obb::new(center, axes, ranges.map(|[low, high]| 0.5 * (high - low)))?;
    let inside: Vec<Vector> = points.iter().copied().filter(|&p| candidates.obb.contains(p)).collect();
    if !inside.is_empty() {
        candidates.hull = HitHull::new(&inside)?;
    }
    Ok(candidates)
}

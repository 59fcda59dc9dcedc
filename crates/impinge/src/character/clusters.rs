//! Groups bones into parts: every face goes with the bone that its corners follow most, and parts
//! are merged in pairs until their number is small enough.

use super::error::{RigError, RigErrorKind, RigPlace};
use super::frame::Frame;
use super::names;
use super::plan::{PartPlan, Plan, bones_of_faces, sample_poses};
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::skin::blended;
use crate::math::vec3::Vector;
use crate::volume::{BoundingVolume, fit};

/// Number of poses used to find bones that move together.
const POSES: usize = 48;

/// Maximum number of bones with faces. The time for grouping grows with its square. Characters have
/// at most a few hundred.
const MAX_BONES: usize = 2048;

/// Number of nearest other parts with which merging is tried. A bone rarely touches more bones than
/// this.
const MAX_NEIGHBORS: usize = 8;

impl Plan {
    /// Groups the bones with faces into at most `volumes` parts, and at least one.
    ///
    /// Repeatedly merges the two parts for which the merged bounding box over all their motion adds
    /// the least surface area. The larger the area of a volume, the more rays hit it and miss the
    /// bone. Bones whose names belong to different limbs are merged last. The merged part is fixed
    /// to that of the two bones in whose frame the box is smaller.
    ///
    /// # Errors
    /// Returns an error if the rig has no faces, an animation leaves the range of poses, or more
    /// than 2,048 bones have faces.
    ///
    /// # Complexity
    /// About a thousand boxes, each over 50 poses of a few vertices for each bone with faces.
    pub fn automatic(rig: &Rig, volumes: usize) -> Result<Self, RigError> {
        let mut clusters = Clusters::of(rig)?;
        clusters.merge_to(volumes.max(1));
        let mut parts = clusters.list.into_iter().flatten().collect::<Vec<_>>();
        parts.sort_by_key(|part| part.bones.iter().min().copied());
        let mut plan = Self {
            parts: parts
                .into_iter()
                .map(|part| PartPlan { name: String::new(), bones: part.bones, anchor: part.anchor, kind: None })
                .collect(),
        };
        names::name(rig, &mut plan)?;
        Ok(plan)
    }
}

/// Bones that are grouped into one part so far.
#[derive(Clone, Debug)]
struct Cluster {
    bones: Vec<u32>,
    anchor: u32,
    /// Vertices that are extreme in some direction at rest. They represent all vertices.
    vertices: Vec<u32>,
    /// Surface area of a box around these vertices in all poses.
    area: f64,
    /// Middle of these vertices at rest.
    middle: Vector,
    /// The limb that all of its bones belong to by their names, or `None` if unknown.
    limb: Option<usize>,
}

struct Clusters {
    list: Vec<Option<Cluster>>,
    /// Position of each vertex of some cluster, for each pose. Other vertices are at the origin.
    places: Vec<Vec<Vector>>,
    /// The frames of all bones, for each pose.
    frames: Vec<Vec<Frame>>,
}

impl Clusters {
    fn of(rig: &Rig) -> Result<Self, RigError> {
        let poses = sample_poses(rig, POSES)?;
        let frame = |pose: &RigPose| {
            pose.bones().iter().map(|bone| Frame::new(bone.rotation_wxyz, bone.origin())).collect::<Vec<_>>()
        };
        let frames: Vec<Vec<Frame>> = poses.iter().map(frame).collect();
        let bones = bones_of_faces(rig);
        if bones.is_empty() {
            return Err(RigError::new(RigErrorKind::Empty, RigPlace::Rig));
        }
        let mut rest = Vec::new();
        rig.skin().skinned(&poses[0], &mut rest);
        let mut vertices_of_bone = vec![Vec::new(); rig.skeleton().bones().len()];
        for (face, &bone) in rig.skin().faces().iter().zip(&bones) {
            vertices_of_bone[bone as usize].extend_from_slice(face);
        }
        let count = vertices_of_bone.iter().filter(|vertices| !vertices.is_empty()).count();
        if count > MAX_BONES {
            let (count, limit) = (count as u64, MAX_BONES as u64);
            let kind = RigErrorKind::TooMany { what: "bones with faces", count, limit };
            return Err(RigError::new(kind, RigPlace::Rig));
        }
        let mut clusters = Self { list: Vec::new(), places: Vec::new(), frames };
        let mut needed = vec![false; rest.len()];
        for (bone, vertices) in vertices_of_bone.iter().enumerate().filter(|(_, vertices)| !vertices.is_empty()) {
            let vertices = extreme(vertices, &rest);
            vertices.iter().for_each(|&vertex| needed[vertex as usize] = true);
            let anchor = bone as u32;
            let limb = names::limb(&rig.skeleton().bones()[bone].name);
            clusters.list.push(Some(Cluster {
                bones: vec![anchor],
                anchor,
                vertices,
                area: 0.0,
                middle: [0.0; 3],
                limb,
            }));
        }
        let mut morphed = Vec::new();
        for pose in &poses {
            let palette = rig.skin().palette(pose.bones());
            rig.skin().morphed(pose.morph_weights(), &mut morphed);
            for (vertex, point) in morphed.iter_mut().enumerate() {
                let influences = rig.skin().influences(vertex as u32);
                *point = if needed[vertex] { blended(&palette, influences, *point) } else { [0.0; 3] };
            }
            clusters.places.push(morphed.clone());
        }
        for at in 0..clusters.list.len() {
            let Some(cluster) = &clusters.list[at] else { continue };
            let (area, middle) = (clusters.area(cluster.anchor, &[cluster]), clusters.middle(&cluster.vertices));
            if let Some(cluster) = &mut clusters.list[at] {
                (cluster.area, cluster.middle) = (area, middle);
            }
        }
        Ok(clusters)
    }

    fn middle(&self, vertices: &[u32]) -> Vector {
        let [low, high] =
            super::volume::box_of(&vertices.iter().map(|&vertex| self.places[0][vertex as usize]).collect::<Vec<_>>());
        [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]))
    }

    /// Returns the surface area of a box around all poses of the clusters, in the frame of a bone.
    fn area(&self, anchor: u32, clusters: &[&Cluster]) -> f64 {
        let mut points = Vec::new();
        for (places, frames) in self.places.iter().zip(&self.frames) {
            let frame = &frames[anchor as usize];
            let vertices = clusters.iter().flat_map(|cluster| &cluster.vertices);
            points.extend(vertices.map(|&vertex| frame.local(places[vertex as usize])));
        }
        fit::principal_obb(&points).map_or(f64::INFINITY, |obb| obb.surface_area())
    }

    /// Returns the surface area that merging two clusters adds, and the better bone to fix them to.
    fn cost(&self, a: &Cluster, b: &Cluster) -> (f64, u32) {
        // Parts of different limbs, by their names, get a higher cost, so they are merged last.
        let apart = a.limb.is_some() && b.limb.is_some() && a.limb != b.limb;
        let kept = if apart { 0.0 } else { a.area + b.area };
        let of = |anchor: u32| (self.area(anchor, &[a, b]) - kept, anchor);
        let (first, second) = (of(a.anchor), of(b.anchor));
        if first.0 <= second.0 { first } else { second }
    }

    fn merge_to(&mut self, volumes: usize) {
        let mut costs: Vec<(f64, u32, usize, usize)> = Vec::new();
        for at in 0..self.list.len() {
            self.add_costs(at, &mut costs);
        }
        let mut left = self.list.len();
        while left > volumes {
            let least = costs.iter().min_by(|x, y| x.0.total_cmp(&y.0).then((x.2, x.3).cmp(&(y.2, y.3)))).copied();
            let Some((_, anchor, a, b)) = least else { break };
            let (Some(first), Some(second)) = (self.list[a].take(), self.list[b].take()) else { break };
            let mut cluster = Cluster { anchor, ..first.clone() };
            cluster.bones.extend(&second.bones);
            cluster.vertices.extend(&second.vertices);
            cluster.area = self.area(anchor, &[&first, &second]);
            cluster.middle = self.middle(&cluster.vertices);
            cluster.limb = first.limb.filter(|_| first.limb == second.limb);
            self.list[a] = Some(cluster);
            costs.retain(|cost| ![cost.2, cost.3].iter().any(|at| *at == a || *at == b));
            self.add_costs(a, &mut costs);
            left -= 1;
        }
    }

    /// Adds the costs of merging a cluster with its nearest neighbors, unless they are known.
    fn add_costs(&self, at: usize, costs: &mut Vec<(f64, u32, usize, usize)>) {
        let Some(cluster) = &self.list[at] else { return };
        let squared = |other: &Cluster| (0..3).map(|k| (other.middle[k] - cluster.middle[k]).powi(2)).sum::<f64>();
        let others = self.list.iter().enumerate().filter(|(other, _)| *other != at);
        let mut near: Vec<(f64, usize)> =
            others.filter_map(|(other, found)| found.as_ref().map(|found| (squared(found), other))).collect();
        near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        for (_, other) in near.into_iter().take(MAX_NEIGHBORS) {
            let pair = (at.min(other), at.max(other));
            if costs.iter().any(|cost| (cost.2, cost.3) == pair) {
                continue;
            }
            if let (Some(a), Some(b)) = (&self.list[pair.0], &self.list[pair.1]) {
                let (cost, anchor) = self.cost(a, b);
                costs.push((cost, anchor, pair.0, pair.1));
            }
        }
    }
}

/// Returns the vertices that are farthest in one of 26 directions.
fn extreme(vertices: &[u32], places: &[Vector]) -> Vec<u32> {
    let directions = (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).filter(|d| *d != [0; 3]);
    let mut found: Vec<u32> = directions
        .filter_map(|d| {
            let along = |&vertex: &u32| (0..3).map(|k| f64::from(d[k]) * places[vertex as usize][k]).sum::<f64>();
            vertices.iter().copied().max_by(|a, b| along(a).total_cmp(&along(b)).then(b.cmp(a)))
        })
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

//! Vertices that follow joints by weights: linear blend skinning in double precision.

use super::error::{RigError, RigErrorKind, RigPlace, check_numbers};
use super::rig_pose::RigPose;
use super::skeleton::PlacedBone;
use super::transform::{Matrix, apply, times};
use crate::math::vec3::Vector;

/// A bone that vertices follow, and the map from the vertices' frame to that of the bone at the
/// time of binding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Index of the bone.
    pub bone: u32,
    /// Rows of the inverse bind matrix: in each row three entries of the linear part, and last that
    /// of the translation.
    pub inverse_bind: [[f64; 4]; 3],
}

/// A joint that moves a vertex, with its skinning weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// Index of the joint.
    pub joint: u32,
    /// The weight. The weights of a vertex sum to one.
    pub weight: f64,
}

/// A morph target: offsets that are multiplied by a weight and added to vertices before skinning.
#[derive(Clone, Debug, PartialEq)]
pub struct Morph {
    /// The weight at rest.
    pub weight: f64,
    /// The index of each vertex that moves, and its offset in the frame of the skin's positions.
    pub offsets: Vec<(u32, [f64; 3])>,
}

/// A surface over joints. A vertex goes to `Σ weight · bone · inverse_bind · (position + Σ morph
/// weight · offset)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    positions: Vec<Vector>,
    faces: Vec<[u32; 3]>,
    joints: Vec<Joint>,
    /// The influences of vertex `i` are those from `first[i]` to `first[i + 1]`.
    first: Vec<u32>,
    influences: Vec<Influence>,
    morphs: Vec<Morph>,
}

/// Maximum deviation of a sum of weights from one. Weights within it count as rounded, for example
/// four of eight bits, and are divided by their sum.
const WEIGHT_TOLERANCE: f64 = 0.01;

impl Skin {
    /// Validates a skin. `influences` has one list for each position. Influences of weight zero are
    /// dropped, and the other weights of a vertex are divided by their sum.
    ///
    /// # Errors
    /// Returns an error that names the vertex, joint, face or morph target if a number is not
    /// finite or out of range, a weight is negative, the weights of a vertex do not sum to one
    /// within 1 %, or a joint or vertex does not exist. [`Rig::new`](super::Rig::new) validates the
    /// bones.
    pub fn new(
        positions: Vec<[f64; 3]>,
        faces: Vec<[u32; 3]>,
        joints: Vec<Joint>,
        influences: &[Vec<Influence>],
        morphs: Vec<Morph>,
    ) -> Result<Self, RigError> {
        let len = positions.len();
        if influences.len() != len {
            let kind = RigErrorKind::OtherCount { what: "lists of weights", count: influences.len(), expected: len };
            return Err(RigError::new(kind, RigPlace::Rig));
        }
        for (i, position) in positions.iter().enumerate() {
            check_numbers(position, "position", RigPlace::Vertex(i))?;
        }
        let missing = |index: u32| RigErrorKind::Missing { what: "vertex", index: index as usize, len };
        for (i, face) in faces.iter().enumerate() {
            if let Some(&corner) = face.iter().find(|&&corner| corner as usize >= len) {
                return Err(RigError::new(missing(corner), RigPlace::Face(i)));
            }
        }
        for (i, joint) in joints.iter().enumerate() {
            check_numbers(joint.inverse_bind.as_flattened(), "inverse bind matrix", RigPlace::Joint(i))?;
        }
        for (i, morph) in morphs.iter().enumerate() {
            check_numbers(&[morph.weight], "weight", RigPlace::Morph(i))?;
            for (vertex, offset) in &morph.offsets {
                check_numbers(offset, "offset", RigPlace::Morph(i))?;
                if *vertex as usize >= len {
                    return Err(RigError::new(missing(*vertex), RigPlace::Morph(i)));
                }
            }
        }
        let mut skin = Self { positions, faces, joints, first: vec![0], influences: Vec::new(), morphs };
        for (vertex, list) in influences.iter().enumerate() {
            skin.add_influences(list, RigPlace::Vertex(vertex))?;
        }
        Ok(skin)
    }

    /// Validates and adds the influences of the next vertex.
    fn add_influences(&mut self, list: &[Influence], place: RigPlace) -> Result<(), RigError> {
        let mut sum = 0.0;
        for influence in list {
            check_numbers(&[influence.weight], "weight", place)?;
            if influence.weight < 0.0 {
                return Err(RigError::new(RigErrorKind::NegativeWeight, place));
            }
            if influence.weight > 0.0 && influence.joint as usize >= self.joints.len() {
                let (index, len) = (influence.joint as usize, self.joints.len());
                return Err(RigError::new(RigErrorKind::Missing { what: "joint", index, len }, place));
            }
            sum += influence.weight;
        }
        if (sum - 1.0).abs() > WEIGHT_TOLERANCE {
            return Err(RigError::new(RigErrorKind::WeightSum { sum }, place));
        }
        let used = list.iter().filter(|influence| influence.weight > 0.0);
        self.influences.extend(used.map(|i| Influence { weight: i.weight / sum, ..*i }));
        self.first.push(self.influences.len() as u32);
        Ok(())
    }

    /// Returns the vertices before any bone or morph target moves them, in the frame that
    /// [`Joint::inverse_bind`] maps from.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Returns the faces, each as three vertex indices.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Returns the joints.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the joints that move a vertex, with their weights, which are positive and sum to
    /// one.
    ///
    /// # Panics
    /// If the vertex does not exist.
    #[must_use]
    pub fn influences(&self, vertex: u32) -> &[Influence] {
        let at = vertex as usize;
        &self.influences[self.first[at] as usize..self.first[at + 1] as usize]
    }

    /// Returns the number of influences of all vertices.
    pub(super) fn influence_count(&self) -> usize {
        self.influences.len()
    }

    /// Returns the morph targets.
    #[must_use]
    pub fn morphs(&self) -> &[Morph] {
        &self.morphs
    }

    /// Computes the positions of all vertices in the world, for a pose of the rig, rounded. They
    /// replace the contents of `vertices`.
    ///
    /// # Complexity
    /// Linear in vertices and influences.
    ///
    /// # Panics
    /// If the pose lacks the bone of a joint.
    pub fn skinned(&self, pose: &RigPose, vertices: &mut Vec<[f64; 3]>) {
        let palette = self.palette(pose.bones());
        self.morphed(pose.morph_weights(), vertices);
        for (vertex, point) in vertices.iter_mut().enumerate() {
            *point = blended(&palette, self.influences(vertex as u32), *point);
        }
    }

    /// Computes the positions with morph targets applied.
    pub(super) fn morphed(&self, weights: &[f64], vertices: &mut Vec<Vector>) {
        vertices.clear();
        vertices.extend_from_slice(&self.positions);
        for (morph, &weight) in self.morphs.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            for &(vertex, offset) in &morph.offsets {
                let point = &mut vertices[vertex as usize];
                *point = [0, 1, 2].map(|k| point[k] + weight * offset[k]);
            }
        }
    }

    /// Returns the maps from the vertices' frame to the world, one per joint.
    pub(super) fn palette(&self, bones: &[PlacedBone]) -> Vec<(Matrix, Vector)> {
        let entry = |joint: &Joint| {
            let bone = &bones[joint.bone as usize];
            let bind = joint.inverse_bind;
            let linear = times(&bone.linear(), &bind.map(|[x, y, z, _]| [x, y, z]));
            (linear, bone.apply(bind.map(|[.., t]| t)))
        };
        self.joints.iter().map(entry).collect()
    }
}

/// Returns the blended image of a point under the joints of its vertex.
#[inline(always)]
pub(super) fn blended(palette: &[(Matrix, Vector)], influences: &[Influence], point: Vector) -> Vector {
    let mut sum = [0.0; 3];
    for influence in influences {
        let (linear, offset) = &palette[influence.joint as usize];
        let image = apply(linear, point);
        sum = [0, 1, 2].map(|k| sum[k] + influence.weight * (image[k] + offset[k]));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    const BIND: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    fn skin(weights: &[Influence], morphs: Vec<Morph>) -> Result<Skin, RigError> {
        let joints = vec![Joint { bone: 0, inverse_bind: BIND }; 2];
        Skin::new(vec![[1.0, 0.0, 0.0]], vec![[0; 3]], joints, &[weights.to_vec()], morphs)
    }

    fn weight(joint: u32, weight: f64) -> Influence {
        Influence { joint, weight }
    }

    #[test]
    fn weights_are_validated_and_divided_by_their_sum() {
        let halves = skin(&[weight(0, 0.5), weight(1, 0.504), weight(99, 0.0)], vec![]).unwrap();
        let sum: f64 = halves.influences(0).iter().map(|i| i.weight).sum();
        assert!(halves.influences(0).len() == 2 && (sum - 1.0).abs() < 1e-15);
        let kind = |weights: &[Influence]| skin(weights, vec![]).unwrap_err().kind().clone();
        assert_eq!(kind(&[weight(0, 0.5)]), RigErrorKind::WeightSum { sum: 0.5 });
        assert_eq!(kind(&[]), RigErrorKind::WeightSum { sum: 0.0 });
        assert_eq!(kind(&[weight(0, 1.5), weight(1, -0.5)]), RigErrorKind::NegativeWeight);
        assert_eq!(kind(&[weight(2, 1.0)]), RigErrorKind::Missing { what: "joint", index: 2, len: 2 });
        assert_eq!(kind(&[weight(0, f64::NAN)]), RigErrorKind::NonFinite { what: "weight" });
    }

    #[test]
    fn morphs_are_validated() {
        let morph = |vertex, x| skin(&[weight(0, 1.0)], vec![Morph { weight: 0.0, offsets: vec![(vertex, [x; 3])] }]);
        assert!(morph(0, 1.0).is_ok());
        assert_eq!(morph(1, 1.0).unwrap_err().place(), RigPlace::Morph(0));
        assert_eq!(morph(0, f64::INFINITY).unwrap_err().kind(), &RigErrorKind::NonFinite { what: "offset" });
    }
}

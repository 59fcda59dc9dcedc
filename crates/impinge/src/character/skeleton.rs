//! Bones that hang on each other, and where a pose puts them.

use super::error::{RigError, RigErrorKind, RigPlace};
use super::transform::{Transform, Vector, apply, matrix, nearly_unit, product, times};

/// A bone: a node of the skeleton, whether vertices follow it or not.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    /// The name; empty where the rig has none.
    pub name: String,
    /// The bone that it hangs on; none for a root.
    pub parent: Option<u32>,
    /// Where it stands at rest, relative to its parent.
    pub rest: Transform,
}

/// Some bones of a skeleton and all that these hang on: what a pose need not go beyond where nothing else is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneSet {
    /// Parents before children.
    pub(super) order: Vec<u32>,
    pub(super) is_in: Vec<bool>,
}

/// Bones without cycles. Several may be roots.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    bones: Vec<Bone>,
    /// The bones, parents before children.
    order: Vec<u32>,
    /// How many bones lie above each, itself included.
    depths: Vec<u32>,
}

impl Skeleton {
    /// Judges bones in any order.
    ///
    /// # Errors
    /// A parent that does not exist, a cycle, a transform that is not finite, out of range or singular; each names the bone.
    pub fn new(mut bones: Vec<Bone>) -> Result<Self, RigError> {
        let len = bones.len();
        for (index, bone) in bones.iter_mut().enumerate() {
            let place = RigPlace::Bone(index);
            bone.rest = bone.rest.judged(place)?;
            if let Some(parent) = bone.parent.filter(|&parent| parent as usize >= len) {
                let kind = RigErrorKind::Missing { what: "bone", index: parent as usize, len };
                return Err(RigError::new(kind, place));
            }
        }
        let (order, depths) = parents_first(&bones)?;
        Ok(Self { bones, order, depths })
    }

    /// The bones as given, their quaternions of length 1.
    #[must_use]
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// Some bones and all that they hang on; numbers that no bone has are left out.
    #[must_use]
    pub fn bone_set(&self, bones: impl IntoIterator<Item = u32>) -> BoneSet {
        let mut is_in = vec![false; self.bones.len()];
        for bone in bones.into_iter().filter(|&bone| (bone as usize) < self.bones.len()) {
            self.ancestry(bone).for_each(|above| is_in[above as usize] = true);
        }
        BoneSet { order: self.order.iter().copied().filter(|&bone| is_in[bone as usize]).collect(), is_in }
    }

    /// How many bones lie above a bone, itself included.
    pub(super) fn depth(&self, bone: u32) -> u32 {
        self.depths[bone as usize]
    }

    /// The path from a bone up to the root, the bone first.
    pub(super) fn ancestry(&self, bone: u32) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(Some(bone), |&bone| self.bones[bone as usize].parent)
    }

    /// The last bone that two have above them, themselves included; none where they hang on different roots.
    pub(super) fn common_ancestor(&self, a: u32, b: u32) -> Option<u32> {
        let (mut a, mut b) = (Some(a), Some(b));
        while let (Some(x), Some(y)) = (a, b) {
            if x == y {
                return Some(x);
            }
            let above = |bone: u32| self.bones[bone as usize].parent;
            let (depth_x, depth_y) = (self.depth(x), self.depth(y));
            if depth_x >= depth_y {
                a = above(x);
            }
            if depth_y >= depth_x {
                b = above(y);
            }
        }
        None
    }

    /// Where all bones are, or those of a set, their transforms being given.
    ///
    /// # Errors
    /// Where composing leaves the range: scales of scales beyond 2^100.
    ///
    /// # Complexity
    /// Linear.
    pub(super) fn place(
        &self,
        locals: &[Transform],
        set: Option<&BoneSet>,
        placed: &mut Vec<PlacedBone>,
    ) -> Result<(), RigError> {
        const LIMIT: f64 = (1_u128 << 100) as f64;
        placed.resize(self.bones.len(), PlacedBone::ORIGIN);
        for &at in set.map_or(&self.order, |set| &set.order) {
            let at = at as usize;
            let own = PlacedBone::of(&locals[at]);
            let bone = match self.bones[at].parent {
                Some(parent) => placed[parent as usize].with(&own),
                None => own,
            };
            // Written so that NaN is refused.
            let within = |x: &f64| x.abs() <= LIMIT;
            if !(bone.linear.as_flattened().iter().all(within) && bone.origin.iter().all(within)) {
                return Err(RigError::new(RigErrorKind::OutOfRange { what: "pose" }, RigPlace::Bone(at)));
            }
            placed[at] = bone;
        }
        Ok(())
    }
}

fn parents_first(bones: &[Bone]) -> Result<(Vec<u32>, Vec<u32>), RigError> {
    let (mut order, mut depths) = (Vec::with_capacity(bones.len()), vec![0_u32; bones.len()]);
    let mut path = Vec::new();
    for start in 0..bones.len() {
        // Up to what is known, then down again. A path longer than there are bones has met one twice.
        let mut next = Some(start as u32);
        while let Some(bone) = next.filter(|&bone| depths[bone as usize] == 0) {
            if path.len() > bones.len() {
                return Err(RigError::new(RigErrorKind::Cyclic, RigPlace::Bone(bone as usize)));
            }
            path.push(bone);
            next = bones[bone as usize].parent;
        }
        while let Some(bone) = path.pop() {
            depths[bone as usize] = 1 + bones[bone as usize].parent.map_or(0, |parent| depths[parent as usize]);
            order.push(bone);
        }
    }
    Ok((order, depths))
}

/// A bone in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedBone {
    /// Maps the bone's own frame to the world, with all scales; rows first.
    pub linear: [[f64; 3]; 3],
    /// Where the bone's origin is in the world.
    pub origin: [f64; 3],
    /// The product of the rotations of the bone and all above it, without their scales: with the origin, the rigid frame that
    /// hit volumes are fixed to.
    pub rotation_wxyz: [f64; 4],
}

impl PlacedBone {
    const ORIGIN: Self = Self {
        linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        origin: [0.0; 3],
        rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
    };

    fn of(local: &Transform) -> Self {
        let scaled = matrix(local.rotation_wxyz).map(|row| [0, 1, 2].map(|k| row[k] * local.scale[k]));
        Self { linear: scaled, origin: local.translation, rotation_wxyz: local.rotation_wxyz }
    }

    /// A child that stands so relative to this bone.
    fn with(&self, child: &Self) -> Self {
        let offset = apply(&self.linear, child.origin);
        let turned = product(self.rotation_wxyz, child.rotation_wxyz);
        Self {
            linear: times(&self.linear, &child.linear),
            origin: [0, 1, 2].map(|k| self.origin[k] + offset[k]),
            rotation_wxyz: nearly_unit(turned),
        }
    }

    /// Where a point of the bone's own frame is in the world, scales included.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let image: Vector = apply(&self.linear, point);
        [0, 1, 2].map(|k| image[k] + self.origin[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bone(parent: Option<u32>, translation: [f64; 3]) -> Bone {
        Bone { name: String::new(), parent, rest: Transform { translation, ..Transform::IDENTITY } }
    }

    #[test]
    fn children_may_come_first() {
        let skeleton = Skeleton::new(vec![
            bone(Some(2), [0.0, 0.0, 1.0]),
            bone(Some(0), [1.0, 0.0, 0.0]),
            bone(None, [0.0, 5.0, 0.0]),
            bone(Some(2), [0.0; 3]),
        ])
        .unwrap();
        let mut placed = Vec::new();
        let locals: Vec<Transform> = skeleton.bones().iter().map(|b| b.rest).collect();
        skeleton.place(&locals, None, &mut placed).unwrap();
        assert_eq!(placed[1].apply([0.0, 0.0, 1.0]), [1.0, 5.0, 2.0]);
        assert_eq!(skeleton.ancestry(1).collect::<Vec<_>>(), [1, 0, 2]);
        assert_eq!((skeleton.common_ancestor(1, 3), skeleton.common_ancestor(1, 0)), (Some(2), Some(0)));
        let two = Skeleton::new(vec![bone(None, [0.0; 3]), bone(None, [0.0; 3])]).unwrap();
        assert_eq!(two.common_ancestor(0, 1), None);
    }

    #[test]
    fn what_is_broken_is_named() {
        let kind = |bones: Vec<Bone>| {
            let error = Skeleton::new(bones).unwrap_err();
            (error.place(), error.kind().clone())
        };
        let missing = RigErrorKind::Missing { what: "bone", index: 7, len: 1 };
        assert_eq!(kind(vec![bone(Some(7), [0.0; 3])]), (RigPlace::Bone(0), missing));
        let (place, cyclic) = kind(vec![bone(None, [0.0; 3]), bone(Some(2), [0.0; 3]), bone(Some(1), [0.0; 3])]);
        assert!(cyclic == RigErrorKind::Cyclic && place != RigPlace::Bone(0));
        assert_eq!(kind(vec![bone(Some(0), [0.0; 3])]).1, RigErrorKind::Cyclic);
        let nan = kind(vec![bone(None, [0.0; 3]), bone(None, [0.0, f64::NAN, 0.0])]);
        assert_eq!(nan, (RigPlace::Bone(1), RigErrorKind::NonFinite { what: "translation" }));
        let with = |rest: Transform| kind(vec![Bone { name: String::new(), parent: None, rest }]).1;
        assert_eq!(with(Transform { scale: [1.0, 0.0, 1.0], ..Transform::IDENTITY }), RigErrorKind::ZeroScale);
        assert_eq!(with(Transform { rotation_wxyz: [0.0; 4], ..Transform::IDENTITY }), RigErrorKind::ZeroRotation);
    }

    #[test]
    fn scales_that_multiply_without_end_are_refused() {
        let scaled =
            |parent| Bone { name: String::new(), parent, rest: Transform { scale: [1e18; 3], ..Transform::IDENTITY } };
        let bones: Vec<Bone> = (0..3_u32).map(|i| scaled(i.checked_sub(1))).collect();
        let skeleton = Skeleton::new(bones).unwrap();
        let locals: Vec<Transform> = skeleton.bones().iter().map(|b| b.rest).collect();
        let error = skeleton.place(&locals, None, &mut Vec::new()).unwrap_err();
        assert_eq!(error, RigError::new(RigErrorKind::OutOfRange { what: "pose" }, RigPlace::Bone(1)));
    }
}

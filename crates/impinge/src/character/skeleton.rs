//! Bones with parents, and their placement by a pose.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use crate::simd::{best_level, by_axis, dispatch};

use super::error::{RigError, RigErrorKind, RigPlace};
use super::transform::{Transform, matrix, nearly_unit, product};
use crate::math::vec3::Vector;

/// A bone: a node of the skeleton, with or without vertices that follow it.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    /// The name. It is empty if the rig has none.
    pub name: String,
    /// The index of the parent bone, or `None` for a root.
    pub parent: Option<u32>,
    /// The transform at rest, relative to the parent.
    pub rest: Transform,
}

/// Some bones of a skeleton and all their ancestors: the bones that a pose must compute if nothing
/// else is queried.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneSet {
    /// The bones of the set, parents before children.
    pub(super) order: Vec<u32>,
    pub(super) is_in: Vec<bool>,
}

/// The bones of a rig, each a root or with a parent, without cycles. There may be several roots.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    bones: Vec<Bone>,
    /// All bones, parents before children.
    order: Vec<u32>,
    /// Number of ancestors of each bone, including itself.
    depths: Vec<u32>,
}

impl Skeleton {
    /// Returns the skeleton of these bones, which may come in any order and keep their indices.
    /// Quaternions are normalized.
    ///
    /// # Errors
    /// Returns an error that names the bone if a parent does not exist, there is a cycle, or a
    /// transform is not finite, out of range or singular.
    pub fn new(mut bones: Vec<Bone>) -> Result<Self, RigError> {
        let len = bones.len();
        for (index, bone) in bones.iter_mut().enumerate() {
            let place = RigPlace::Bone(index);
            bone.rest = bone.rest.validated(place)?;
            if let Some(parent) = bone.parent.filter(|&parent| parent as usize >= len) {
                let kind = RigErrorKind::Missing { what: "bone", index: parent as usize, len };
                return Err(RigError::new(kind, place));
            }
        }
        let (order, depths) = parents_first(&bones)?;
        Ok(Self { bones, order, depths })
    }

    /// Returns the bones as given, with their quaternions normalized.
    #[must_use]
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// Returns a set with the given bones and all their ancestors. Indices without a bone are
    /// ignored.
    #[must_use]
    pub fn bone_set(&self, bones: impl IntoIterator<Item = u32>) -> BoneSet {
        let mut is_in = vec![false; self.bones.len()];
        for bone in bones.into_iter().filter(|&bone| (bone as usize) < self.bones.len()) {
            // The ancestors of a bone in the set are in the set too.
            for above in self.ancestry(bone) {
                if std::mem::replace(&mut is_in[above as usize], true) {
                    break;
                }
            }
        }
        BoneSet { order: self.order.iter().copied().filter(|&bone| is_in[bone as usize]).collect(), is_in }
    }

    /// Returns all bones, parents before children.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Returns the number of ancestors of a bone, including itself.
    pub(super) fn depth(&self, bone: u32) -> u32 {
        self.depths[bone as usize]
    }

    /// Returns the path from a bone up to its root, the bone first.
    pub(super) fn ancestry(&self, bone: u32) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(Some(bone), |&bone| self.bones[bone as usize].parent)
    }

    /// Returns the lowest common ancestor of two bones, which may be one of them. Returns `None` if
    /// they have different roots.
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

    /// Places all bones, or only those of a set, in the world. `locals` are their transforms
    /// relative to their parents.
    ///
    /// # Errors
    /// Returns an error if the result is out of range, because scales multiply beyond 2^100.
    ///
    /// # Complexity
    /// Linear.
    pub(super) fn place(
        &self,
        locals: &[Transform],
        set: Option<&BoneSet>,
        placed: &mut Vec<PlacedBone>,
    ) -> Result<(), RigError> {
        placed.resize(self.bones.len(), PlacedBone::ORIGIN);
        let order = set.map_or(&self.order, |set| &set.order);
        if dispatch!(best_level(), simd => self.chain(simd, locals, order, placed)) {
            return Ok(());
        }
        let beyond = order.iter().find(|&&at| !placed[at as usize].is_within_range());
        let at = beyond.map_or(0, |&at| at as usize);
        Err(RigError::new(RigErrorKind::OutOfRange { what: "pose" }, RigPlace::Bone(at)))
    }

    /// Places the bones of `order` in the world. Returns whether all of them are in range.
    #[inline(always)]
    fn chain<S: Simd>(&self, simd: S, locals: &[Transform], order: &[u32], placed: &mut [PlacedBone]) -> bool {
        // All local matrices first, so that no vector is loaded while its numbers are still being
        // stored.
        for &at in order {
            placed[at as usize] = PlacedBone::of(&locals[at as usize]);
        }
        let limit = f64x4::splat(simd, LIMIT);
        let mut is_within = limit.simd_eq(limit);
        for &at in order {
            let own = &placed[at as usize];
            let mut rows: [f64x4<S>; 3] = by_axis!(i => f64x4::from_slice(simd, &own.rows[i]));
            if let Some(parent) = self.bones[at as usize].parent {
                let above = &placed[parent as usize];
                let rotation_wxyz = nearly_unit(product(above.rotation_wxyz, own.rotation_wxyz));
                rows = by_axis!(i => {
                    let [x, y, z, origin] = above.rows[i];
                    rows[0] * x + rows[1] * y + rows[2] * z + f64x4::from_slice(simd, &[0.0, 0.0, 0.0, origin])
                });
                let own = &mut placed[at as usize];
                by_axis!(i => rows[i].store_slice(&mut own.rows[i]));
                own.rotation_wxyz = rotation_wxyz;
            }
            // NaN fails this comparison.
            let [x, y, z] = by_axis!(i => rows[i].abs().simd_le(limit));
            is_within = is_within & x & y & z;
        }
        is_within.all_true()
    }
}

/// Maximum magnitude of the numbers of a placed bone: 2^100.
const LIMIT: f64 = (1_u128 << 100) as f64;

fn parents_first(bones: &[Bone]) -> Result<(Vec<u32>, Vec<u32>), RigError> {
    let (mut order, mut depths) = (Vec::with_capacity(bones.len()), vec![0_u32; bones.len()]);
    let mut path = Vec::new();
    for start in 0..bones.len() {
        // Climbs to a known bone, then returns. A path longer than the number of bones is a cycle.
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

/// The placement of a bone in the world: its origin, its rotation, and its linear map with all
/// scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedBone {
    /// Rows of the map from the bone's own frame to the world, including all scales. The last entry
    /// of each row is that of the origin.
    rows: [[f64; 4]; 3],
    /// Quaternion (w, x, y, z) from the bone's frame to the world: the product of the rotations of
    /// the bone and all its ancestors, without scales. With the origin it gives the rigid frame
    /// that hit volumes are fixed to.
    pub rotation_wxyz: [f64; 4],
}

impl PlacedBone {
    const ORIGIN: Self = Self {
        rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
    };

    /// Builds a root bone from its transform.
    #[inline(always)]
    fn of(local: &Transform) -> Self {
        let ([x, y, z], [a, b, c]) = (matrix(local.rotation_wxyz), local.translation);
        let [u, v, w] = local.scale;
        let row = |row: Vector, origin: f64| [row[0] * u, row[1] * v, row[2] * w, origin];
        Self { rows: [row(x, a), row(y, b), row(z, c)], rotation_wxyz: local.rotation_wxyz }
    }

    /// Returns the linear part of the map from the bone's own frame to the world, including all
    /// scales, by rows.
    #[must_use]
    pub fn linear(&self) -> [[f64; 3]; 3] {
        self.rows.map(|[x, y, z, _]| [x, y, z])
    }

    /// Returns the bone's origin, in the world frame.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.rows.map(|row| row[3])
    }

    fn is_within_range(&self) -> bool {
        // NaN fails this comparison.
        self.rows.as_flattened().iter().all(|x| x.abs() <= LIMIT)
    }

    /// Maps a point from the bone's own frame to the world, including all scales, rounded.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        self.rows.map(|[x, y, z, origin]| x * point[0] + y * point[1] + z * point[2] + origin)
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
    fn invalid_bones_are_named_in_errors() {
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
    fn scales_that_multiply_out_of_range_are_rejected() {
        let scaled =
            |parent| Bone { name: String::new(), parent, rest: Transform { scale: [1e18; 3], ..Transform::IDENTITY } };
        let bones: Vec<Bone> = (0..3_u32).map(|i| scaled(i.checked_sub(1))).collect();
        let skeleton = Skeleton::new(bones).unwrap();
        let locals: Vec<Transform> = skeleton.bones().iter().map(|b| b.rest).collect();
        let error = skeleton.place(&locals, None, &mut Vec::new()).unwrap_err();
        assert_eq!(error, RigError::new(RigErrorKind::OutOfRange { what: "pose" }, RigPlace::Bone(1)));
    }
}

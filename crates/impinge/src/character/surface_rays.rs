//! Rays against the skinned surface, which skin only the faces near the ray.
//!
//! Tests: `impinge-files/tests/it/characters/surface.rs`. Benchmark: `characters`.

use std::cmp::Ordering;

use crate::mesh::Ray;
use crate::primitive::{RayCrossing, ray_triangle};

use super::body::Character;
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::skin_tree::{Children, MAX_LEAF_VERTICES, SkinPose};
use super::surface::SurfaceHit;
use crate::math::vec3::{Vector, dot, length, scale, sub};

/// Casts rays at the skinned surface of a character in one pose, to find the part that a bullet
/// truly struck. Rays and hits are in the world frame; hit points are rounded.
///
/// It gives the same answers as [`Surface`](super::Surface) but skins only the faces near a ray. It
/// needs neither animations nor volumes, and works for any pose of the rig.
///
/// ```no_run
/// # fn f(rig: &impinge::character::Rig, character: &impinge::character::Character) -> Result<(), Box<dyn std::error::Error>> {
/// use impinge::{character::{Posed, SurfaceRays}, mesh::Ray};
///
/// let pose = rig.pose_at(0, 0.5)?;
/// let ray = Ray::new([0.0, 1.6, 5.0], [0.0, 0.0, -1.0])?;
/// // The volumes tell whether the character may be struck, the surface tells the part.
/// if Posed::new(character, &pose).ray_cast(&ray).is_some() {
///     if let Some(hit) = SurfaceRays::new(character, rig, &pose).ray_cast(&ray) {
///         println!("{} at {:?}", character.parts()[hit.part as usize].name, hit.point);
///     }
/// }
/// # Ok(()) }
/// ```
#[derive(Clone, Debug)]
pub struct SurfaceRays<'c> {
    character: &'c Character,
    rig: &'c Rig,
    pose: SkinPose,
    /// A sphere around the faces of each bone, in the world.
    spheres: Vec<(Vector, f64)>,
}

impl<'c> SurfaceRays<'c> {
    /// Builds the surface in a pose of the rig that the character was fitted to. The pose must
    /// include all bones.
    ///
    /// # Complexity
    /// Linear in the number of joints.
    ///
    /// # Panics
    /// If the rig is a different one with fewer vertices, joints or bones.
    #[must_use]
    pub fn new(character: &'c Character, rig: &'c Rig, pose: &RigPose) -> Self {
        let mut rays = Self { character, rig, pose: SkinPose::default(), spheres: Vec::new() };
        rays.set_at(pose, [0.0; 3]);
        rays
    }

    /// Moves the surface to another pose of the rig, with the rig's own origin at `origin` in the
    /// world. Vertices are skinned first, then moved.
    ///
    /// # Complexity
    /// Same as [`new`](Self::new).
    ///
    /// # Panics
    /// Same as [`new`](Self::new).
    pub fn set_at(&mut self, pose: &RigPose, origin: [f64; 3]) {
        self.pose = SkinPose::new(self.rig.skin(), pose, origin);
        let tree = self.character.skin_tree();
        self.spheres.clear();
        self.spheres.extend(tree.roots().iter().map(|&root| tree.sphere(root, &self.pose)));
    }

    /// Returns the first intersection of a ray, given in the world frame, with the surface,
    /// exactly, or `None` if the ray misses it. In a tie the face with the lowest index wins.
    ///
    /// # Accuracy
    /// If the origin is zero, the result has the same bits as that of
    /// [`Surface::ray_cast`](super::Surface::ray_cast)
    /// (`impinge-files/tests/it/characters/surface.rs`). Faces are skipped only if the ray is
    /// proved to miss their sphere.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<SurfaceHit> {
        let line = Line::new(ray);
        let tree = self.character.skin_tree();
        let entered = |(&root, sphere)| Some((line.enters(sphere)?, root));
        let mut tasks: Vec<(f64, u32)> = tree.roots().iter().zip(&self.spheres).filter_map(entered).collect();
        // The last task is processed next.
        tasks.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (mut first, mut last): (Option<FaceHit>, f64) = (None, f64::INFINITY);
        while let Some((entered, node)) = tasks.pop() {
            if entered > last {
                continue;
            }
            match tree.children(node) {
                Children::Nodes(nodes) => {
                    let children = nodes.map(|node| Some((line.enters(&tree.sphere(node, &self.pose))?, node)));
                    let (near, far) = match children {
                        [Some(a), Some(b)] if b.0 < a.0 => (Some(b), Some(a)),
                        [a, b] => (a, b),
                    };
                    tasks.extend(far.into_iter().chain(near));
                }
                Children::Faces { faces, vertices } => {
                    let mut places = [[0.0; 3]; MAX_LEAF_VERTICES];
                    tree.skin(self.rig.skin(), *vertices, &self.pose, &mut places);
                    for own in tree.faces(*faces) {
                        let triangle = own.corners.map(|corner| places[usize::from(corner)]);
                        let Some(crossing) = ray_triangle(&ray.origin(), &ray.direction(), &triangle) else { continue };
                        let hit = FaceHit { face: own.face, bone: tree.bone(node), crossing, triangle };
                        if first.as_ref().is_none_or(|best| hit.compare(best, ray) == Ordering::Less) {
                            last = line.reach(crossing.t + crossing.error);
                            first = Some(hit);
                        }
                    }
                }
            }
        }
        first.map(|FaceHit { face, bone, crossing, .. }| SurfaceHit {
            part: self.character.part_of_face()[face as usize],
            bone,
            face,
            t: crossing.t,
            point: ray.at(crossing.t),
        })
    }
}

/// A face that the ray hits.
struct FaceHit {
    face: u32,
    bone: u32,
    crossing: RayCrossing,
    triangle: [Vector; 3],
}

impl FaceHit {
    /// Compares by true parameter, then by face.
    fn compare(&self, other: &Self, ray: &Ray) -> Ordering {
        let triangles = [&self.triangle, &other.triangle];
        let by_time = self.crossing.compare(&other.crossing, (&ray.origin(), &ray.direction()), triangles);
        by_time.then(self.face.cmp(&other.face))
    }
}

/// A ray with its direction scaled to length 1, however long or short it was.
struct Line {
    origin: Vector,
    direction: Vector,
    /// The length of the direction as given is the product of these two. The first alone may be too
    /// small for a float's full precision.
    lengths: [f64; 2],
}

/// Padding of spheres, relative to the sizes: 2^-48. A projection takes about ten roundings, each
/// of 2^-53 of the sizes.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

impl Line {
    fn new(ray: &Ray) -> Self {
        let largest = ray.direction().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let direction = ray.direction().map(|x| x / largest);
        let rest = length(&direction);
        Self { origin: ray.origin(), direction: scale(&direction, 1.0 / rest), lengths: [largest, rest] }
    }

    /// Returns a distance from the origin before which the ray is proved to be outside a sphere, or
    /// `None` if it is proved to miss the sphere.
    fn enters(&self, &(center, radius): &(Vector, f64)) -> Option<f64> {
        let offset = sub(&center, &self.origin);
        let along = dot(&self.direction, &offset);
        let across = sub(&offset, &scale(&self.direction, along));
        let reach = radius + ROUNDING * (length(&offset) + length(&self.origin) + length(&center));
        let is_missed = dot(&across, &across) > reach * reach * (1.0 + 1e-12) || along < -reach;
        (!is_missed).then_some(along - reach)
    }

    /// Returns an upper bound of the distance from the origin at a parameter.
    fn reach(&self, t: f64) -> f64 {
        t * self.lengths[0] * self.lengths[1] * (1.0 + 1e-12) + f64::MIN_POSITIVE
    }
}

//! Rays at the skinned surface, of which nothing is skinned but what they come near.

use std::cmp::Ordering;

use crate::mesh::Ray;
use crate::primitive::{RayCrossing, ray_triangle};

use super::body::Character;
use super::rig::Rig;
use super::rig_pose::RigPose;
use super::skin_tree::{Below, LEAF_VERTICES, SkinPose};
use super::surface::SurfaceHit;
use crate::math::vec3::{Vector, dot, length, scale, sub};

/// The skinned surface of a character in one pose, for rays: the part that a bullet truly struck.
///
/// What [`Surface`](super::Surface) says, without skinning it: what a ray comes near is skinned when it does. It needs no animation and
/// no volumes, and holds in any pose of the rig.
///
/// ```no_run
/// # fn f(rig: &impinge::character::Rig, character: &impinge::character::Character) -> Result<(), Box<dyn std::error::Error>> {
/// use impinge::{character::{Posed, SurfaceRays}, mesh::Ray};
///
/// let pose = rig.pose_at(0, 0.5)?;
/// let ray = Ray::new([0.0, 1.6, 5.0], [0.0, 0.0, -1.0])?;
/// // The volumes tell who may be struck, and the surface what is.
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
    /// About the faces of each bone, in the world.
    spheres: Vec<(Vector, f64)>,
}

impl<'c> SurfaceRays<'c> {
    /// The surface in a pose of the rig that the character was fitted to, of which all bones are posed.
    ///
    /// # Complexity
    /// Linear in joints.
    ///
    /// # Panics
    /// Where the rig is another one, of fewer vertices, joints or bones.
    #[must_use]
    pub fn new(character: &'c Character, rig: &'c Rig, pose: &RigPose) -> Self {
        let mut rays = Self { character, rig, pose: SkinPose::default(), spheres: Vec::new() };
        rays.set_at(pose, [0.0; 3]);
        rays
    }

    /// Puts the surface into another pose of the rig, whose own origin is somewhere in the world: vertices are skinned, then moved.
    ///
    /// # Complexity
    /// As [`new`](Self::new).
    ///
    /// # Panics
    /// As [`new`](Self::new).
    pub fn set_at(&mut self, pose: &RigPose, origin: [f64; 3]) {
        self.pose = SkinPose::new(self.rig.skin(), pose, origin);
        let tree = self.character.skin_tree();
        self.spheres.clear();
        self.spheres.extend(tree.roots().iter().map(|&root| tree.sphere(root, &self.pose)));
    }

    /// Where a ray first meets the surface, exactly; of several faces at once the first.
    ///
    /// # Accuracy
    /// To the bit what [`Surface::ray_cast`](super::Surface::ray_cast) says where the origin is zero
    /// (`impinge-files/tests/it/characters/surface.rs`). What a sphere about faces leaves out is proved to be missed.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<SurfaceHit> {
        let line = Line::new(ray);
        let tree = self.character.skin_tree();
        let entered = |(&root, sphere)| Some((line.enters(sphere)?, root));
        let mut tasks: Vec<(f64, u32)> = tree.roots().iter().zip(&self.spheres).filter_map(entered).collect();
        // The last is the next.
        tasks.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (mut first, mut last): (Option<Met>, f64) = (None, f64::INFINITY);
        while let Some((entered, node)) = tasks.pop() {
            if entered > last {
                continue;
            }
            match tree.below(node) {
                Below::Nodes(nodes) => {
                    let below = nodes.map(|node| Some((line.enters(&tree.sphere(node, &self.pose))?, node)));
                    let (near, far) = match below {
                        [Some(a), Some(b)] if b.0 < a.0 => (Some(b), Some(a)),
                        [a, b] => (a, b),
                    };
                    tasks.extend(far.into_iter().chain(near));
                }
                Below::Faces { faces, vertices } => {
                    let mut places = [[0.0; 3]; LEAF_VERTICES];
                    tree.skin(self.rig.skin(), *vertices, &self.pose, &mut places);
                    for own in tree.faces(*faces) {
                        let triangle = own.corners.map(|corner| places[usize::from(corner)]);
                        let Some(crossing) = ray_triangle(&ray.origin(), &ray.direction(), &triangle) else { continue };
                        let met = Met { face: own.face, bone: tree.bone(node), crossing, triangle };
                        if first.as_ref().is_none_or(|best| met.compare(best, ray) == Ordering::Less) {
                            last = line.reach(crossing.t + crossing.error);
                            first = Some(met);
                        }
                    }
                }
            }
        }
        first.map(|Met { face, bone, crossing, .. }| SurfaceHit {
            part: self.character.part_of_face()[face as usize],
            bone,
            face,
            t: crossing.t,
            point: ray.at(crossing.t),
        })
    }
}

/// A face that the ray meets.
struct Met {
    face: u32,
    bone: u32,
    crossing: RayCrossing,
    triangle: [Vector; 3],
}

impl Met {
    /// By true parameter, then by face.
    fn compare(&self, other: &Self, ray: &Ray) -> Ordering {
        let triangles = [&self.triangle, &other.triangle];
        let by_time = self.crossing.compare(&other.crossing, (&ray.origin(), &ray.direction()), triangles);
        by_time.then(self.face.cmp(&other.face))
    }
}

/// A ray whose direction has length 1, however long or short it was.
struct Line {
    origin: Vector,
    direction: Vector,
    /// The length of the direction as given is the product of these; the first alone may be too small for a float's full precision.
    lengths: [f64; 2],
}

/// Of the sizes: what spheres are taken as larger by. A projection is some ten roundings, each of 2^-53 of them.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

impl Line {
    fn new(ray: &Ray) -> Self {
        let largest = ray.direction().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let direction = ray.direction().map(|x| x / largest);
        let rest = length(&direction);
        Self { origin: ray.origin(), direction: scale(&direction, 1.0 / rest), lengths: [largest, rest] }
    }

    /// A distance from the origin before which the ray is surely not in a sphere; none where it surely misses it.
    fn enters(&self, &(centre, radius): &(Vector, f64)) -> Option<f64> {
        let offset = sub(&centre, &self.origin);
        let along = dot(&self.direction, &offset);
        let across = sub(&offset, &scale(&self.direction, along));
        let reach = radius + ROUNDING * (length(&offset) + length(&self.origin) + length(&centre));
        let is_missed = dot(&across, &across) > reach * reach * (1.0 + 1e-12) || along < -reach;
        (!is_missed).then_some(along - reach)
    }

    /// No less than the distance from the origin at a parameter.
    fn reach(&self, t: f64) -> f64 {
        t * self.lengths[0] * self.lengths[1] * (1.0 + 1e-12) + f64::MIN_POSITIVE
    }
}

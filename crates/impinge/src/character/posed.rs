//! Questions to a character in one pose: which parts a ray, a shape, a mesh or another character meets.

use crate::input::InputError;
use crate::mesh::{Mesh, PlacedMesh, Positions, Ray};
use crate::query::{self, distance};
use crate::shape::PlacedShape;
use crate::volume::MinMax;

use super::body::Character;
use super::crossing::Crossing;
use super::fit::HitPart;
use super::frame::Frame;
use super::meeting::{Stood, core, meet};
use super::rig_pose::RigPose;
use super::transform::{apply, apply_transposed};
use super::volume::HitVolume;
use crate::math::vec3::{Vector, add, dot, length, scale, sub, unit};

/// A character whose parts are where their bones are.
#[derive(Clone, Debug)]
pub struct Posed<'c> {
    character: &'c Character,
    frames: Vec<Frame>,
    /// About each part, in the world.
    spheres: Vec<(Vector, f64)>,
    /// Of the bones that pieces are fixed to.
    piece_frames: Vec<Frame>,
    /// About all parts.
    outer: [Vector; 2],
}

/// A part that was struck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartHit {
    /// The part.
    pub part: u32,
    /// The bone that its volume is fixed to.
    pub bone: u32,
    /// For a ray where it enters the volume, in units of the direction's length, zero where it starts inside; zero for all else.
    pub t: f64,
    /// Where, in the world frame, rounded.
    pub point: [f64; 3],
    /// Of length 1, in the world frame: out of the part for a ray, and from what struck it into the part for all else.
    pub normal: [f64; 3],
    /// How much of the ray is inside, or how deep the two are in each other; in world units.
    pub depth: f64,
}

/// A part of one character that meets a part of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPair {
    /// The part of the first.
    pub part_a: u32,
    /// The part of the second.
    pub part_b: u32,
    /// Where, in the world frame, rounded.
    pub point: [f64; 3],
    /// From the first to the second, of length 1, in the world frame.
    pub normal: [f64; 3],
    /// How deep they are in each other, in world units.
    pub depth: f64,
}

/// Of the sizes that are added up: what spheres about parts and the box about all are taken as larger by. Three products and
/// sums of numbers of that size, each off by 2^-53 of it.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

impl<'c> Posed<'c> {
    /// A character in a pose of its rig.
    #[must_use]
    pub fn new(character: &'c Character, pose: &RigPose) -> Self {
        let mut posed =
            Self { character, frames: Vec::new(), spheres: Vec::new(), piece_frames: Vec::new(), outer: [[0.0; 3]; 2] };
        posed.set(pose);
        posed
    }

    /// Puts the character into another pose of its rig, in the memory of the last.
    pub fn set(&mut self, pose: &RigPose) {
        self.set_at(pose, [0.0; 3]);
    }

    /// [`set`](Self::set) with the rig's own origin somewhere else in the world.
    pub fn set_at(&mut self, pose: &RigPose, origin: [f64; 3]) {
        self.frames.clear();
        self.spheres.clear();
        let mut outer = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for part in self.character.parts() {
            let bone = &pose.bones()[part.anchor as usize];
            let frame = Frame::new(bone.rotation_wxyz, add(&bone.origin(), &origin));
            let (local, radius) = part.sphere;
            let turned = apply(&frame.rotation, local);
            let centre = add(&turned, &frame.origin);
            let size = length(&local) + radius + length(&frame.origin);
            let radius = radius + ROUNDING * size;
            for k in 0..3 {
                outer[0][k] = outer[0][k].min(centre[k] - radius);
                outer[1][k] = outer[1][k].max(centre[k] + radius);
            }
            self.frames.push(frame);
            self.spheres.push((centre, radius));
        }
        self.outer = outer;
        self.piece_frames.clear();
        self.piece_frames.extend(self.character.piece_anchors.iter().map(|&anchor| {
            let bone = &pose.bones()[anchor as usize];
            Frame::new(bone.rotation_wxyz, add(&bone.origin(), &origin))
        }));
    }

    /// The character.
    #[must_use]
    pub fn character(&self) -> &'c Character {
        self.character
    }

    /// The frames of the parts.
    #[must_use]
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The box about spheres about all parts: the volume that wraps the others.
    #[must_use]
    pub fn outer(&self) -> [[f64; 3]; 2] {
        self.outer
    }

    /// The outer box as one of the volumes of the house.
    ///
    /// # Errors
    /// Where it is out of range, which no pose of a rig is.
    pub fn outer_box(&self) -> Result<MinMax, InputError> {
        MinMax::new(self.outer[0], self.outer[1])
    }

    fn parts(&self) -> impl Iterator<Item = (u32, &'c HitPart, &Frame, &(Vector, f64))> {
        (0..)
            .zip(self.character.parts())
            .zip(self.frames.iter().zip(&self.spheres))
            .map(|((at, part), (frame, sphere))| (at, part, frame, sphere))
    }

    /// The part whose volume a ray enters first; of several at once the first in order.
    ///
    /// ```no_run
    /// # fn f(character: &impinge::character::Character, pose: &impinge::character::RigPose) -> Result<(), impinge::InputError> {
    /// use impinge::{character::Posed, mesh::Ray};
    /// let posed = Posed::new(character, pose);
    /// if let Some(hit) = posed.ray_cast(&Ray::new([0.0, 1.6, 5.0], [0.0, 0.0, -1.0])?) {
    ///     println!("{} at {:?}", character.parts()[hit.part as usize].name, hit.point);
    /// }
    /// # Ok(()) }
    /// ```
    ///
    /// # Accuracy
    /// No volume that the ray meets is missed: volumes are taken as thicker by 2^-46 of their sizes and distances.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<PartHit> {
        let (ray, unit) = &ray.of_unit_size();
        let mut first: Option<PartHit> = None;
        if self.misses_outer(ray) {
            return None;
        }
        for (at, part, frame, sphere) in self.parts() {
            let Some(crossing) = self.crossing(at, part, frame, sphere, ray) else { continue };
            if first.is_none_or(|best| crossing.t[0] < best.t) {
                first = Some(self.hit(at, ray, &crossing));
            }
        }
        first.map(|hit| PartHit { t: (hit.t * unit).min(f64::MAX), ..hit })
    }

    /// All parts whose volumes a ray meets, in the order in which it enters them, then in that of the parts.
    #[must_use]
    pub fn ray_cast_all(&self, ray: &Ray) -> Vec<PartHit> {
        let (ray, unit) = &ray.of_unit_size();
        if self.misses_outer(ray) {
            return Vec::new();
        }
        let hits = self.parts().filter_map(|(at, part, frame, sphere)| {
            self.crossing(at, part, frame, sphere, ray).map(|crossing| self.hit(at, ray, &crossing))
        });
        let mut hits: Vec<PartHit> = hits.collect();
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
        hits.iter_mut().for_each(|hit| hit.t = (hit.t * unit).min(f64::MAX));
        hits
    }

    fn hit(&self, part: u32, ray: &Ray, crossing: &Crossing) -> PartHit {
        let [enter, leave] = crossing.t;
        PartHit {
            part,
            bone: self.character.parts()[part as usize].anchor,
            t: enter,
            point: ray.at(enter),
            normal: crossing.normal,
            depth: (leave - enter) * length(&ray.direction()),
        }
    }

    /// Where a ray is in a part, the normal in the world frame: in its volume, or where that is opened in the first of its pieces.
    fn crossing(&self, at: u32, part: &HitPart, frame: &Frame, sphere: &(Vector, f64), ray: &Ray) -> Option<Crossing> {
        let through = |volume: &HitVolume, frame: &Frame| {
            let direction = apply_transposed(&frame.rotation, ray.direction());
            let crossing = volume.crossing(frame.local(ray.origin()), direction)?;
            Some(Crossing { normal: apply(&frame.rotation, crossing.normal), ..crossing })
        };
        if misses(sphere, ray) {
            return None;
        }
        let whole = through(&part.volume, frame)?;
        let all = &self.character.pieces;
        if all.is_empty() {
            return Some(whole);
        }
        let first = all.partition_point(|piece| piece.part < at);
        let pieces = all[first..].iter().take_while(|piece| piece.part == at);
        let crossings = pieces.filter_map(|piece| {
            let anchor = self.character.piece_anchors.binary_search(&piece.anchor).ok()?;
            through(&piece.volume, &self.piece_frames[anchor])
        });
        crossings.reduce(|best, next| if next.t[0] < best.t[0] { next } else { best })
    }

    /// Whether a ray surely misses the box about all.
    fn misses_outer(&self, ray: &Ray) -> bool {
        let (origin, direction) = (ray.origin(), ray.direction());
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for k in 0..3 {
            let size = self.outer[0][k].abs() + self.outer[1][k].abs() + origin[k].abs();
            let (low, high) = (self.outer[0][k] - ROUNDING * size, self.outer[1][k] + ROUNDING * size);
            if direction[k] == 0.0 {
                if origin[k] < low || origin[k] > high {
                    return true;
                }
                continue;
            }
            let (a, b) = ((low - origin[k]) / direction[k], (high - origin[k]) / direction[k]);
            enter = enter.max(a.min(b) * (1.0 - 1e-14_f64.copysign(a.min(b))));
            leave = leave.min(a.max(b) * (1.0 + 1e-14_f64.copysign(a.max(b))));
        }
        enter > leave
    }

    /// All parts that a shape is not proved apart from, in order.
    ///
    /// # Errors
    /// Parts beyond the range of shapes.
    pub fn struck_by(&self, shape: &PlacedShape) -> Result<Vec<PartHit>, InputError> {
        let mut hits = Vec::new();
        for (at, part, frame, _) in self.parts() {
            let placed = part.volume.placed(frame.pose()?)?;
            if let Some(found) = query::penetration(shape, &placed) {
                let point = scale(&add(&found.point_a, &found.point_b), 0.5);
                hits.push(PartHit {
                    part: at,
                    bone: part.anchor,
                    t: 0.0,
                    point,
                    normal: found.normal,
                    depth: found.upper,
                });
            }
        }
        Ok(hits)
    }

    /// Whether volumes of two characters meet: all pairs of parts that are not proved apart, in order, without depths. What
    /// broad phases ask.
    ///
    /// # Errors
    /// Parts beyond the range of shapes.
    pub fn pairs_with(&self, other: &Posed<'_>, visit: &mut impl FnMut(u32, u32)) -> Result<(), InputError> {
        let overlap = |k: usize| self.outer[0][k] <= other.outer[1][k] && other.outer[0][k] <= self.outer[1][k];
        if !(0..3).all(overlap) {
            return Ok(());
        }
        for (a, part_a, frame_a, sphere_a) in self.parts() {
            let near = |k: usize| {
                sphere_a.0[k] - sphere_a.1 <= other.outer[1][k] && other.outer[0][k] <= sphere_a.0[k] + sphere_a.1
            };
            if !(0..3).all(near) {
                continue;
            }
            for (b, part_b, frame_b, sphere_b) in other.parts() {
                let between = sub(&sphere_b.0, &sphere_a.0);
                let reach = (sphere_a.1 + sphere_b.1) * (1.0 + 1e-14);
                if dot(&between, &between) <= reach * reach
                    && meet(
                        &Stood { volume: &part_a.volume, frame: frame_a, sphere: *sphere_a },
                        &Stood { volume: &part_b.volume, frame: frame_b, sphere: *sphere_b },
                    )?
                {
                    visit(a, b);
                }
            }
        }
        Ok(())
    }

    /// All pairs of parts of two characters that are not proved apart, in order, and how deep they are in each other.
    ///
    /// # Errors
    /// Parts beyond the range of shapes.
    pub fn struck_by_character(&self, other: &Posed<'_>) -> Result<Vec<PartPair>, InputError> {
        let mut pairs = Vec::new();
        self.pairs_with(other, &mut |a, b| pairs.push((a, b)))?;
        let mut found = Vec::new();
        for (part_a, part_b) in pairs {
            let placed = |posed: &Posed<'_>, part: u32| {
                let volume = &posed.character.parts()[part as usize].volume;
                volume.placed(posed.frames[part as usize].pose()?)
            };
            if let Some(depth) = query::penetration(&placed(self, part_a)?, &placed(other, part_b)?) {
                let point = scale(&add(&depth.point_a, &depth.point_b), 0.5);
                found.push(PartPair { part_a, part_b, point, normal: depth.normal, depth: depth.upper });
            }
        }
        Ok(found)
    }

    /// All parts whose volumes, as solids, the surface of a mesh comes into, in order; touching counts. The depth is that of the
    /// nearest point of the surface below the volume's, at most its radius.
    ///
    /// # Errors
    /// Parts beyond the range of meshes.
    ///
    /// # Complexity
    /// A distance of two meshes for each part: that of the point, segment, rectangle, box or hull which a sphere sweeps.
    pub fn struck_by_mesh(&self, mesh: PlacedMesh<'_>) -> Result<Vec<PartHit>, InputError> {
        let mut hits = Vec::new();
        for (at, part, frame, _) in self.parts() {
            let (positions, faces) = core(&part.volume);
            let core = Mesh::new(Positions::F64(positions), faces)?;
            let found = distance(mesh, core.at(frame.pose()?));
            let Some(witness) = found.witness else { continue };
            // A vertex inside of a box or a hull whose surface the mesh does not meet.
            let inside = || {
                let positions = mesh.mesh.positions();
                let first = (!positions.is_empty()).then(|| mesh.world_from_mesh.apply(positions.get(0)));
                first.filter(|&point| part.volume.signed_distance(frame.local(point)) <= 0.0)
            };
            let radius = part.volume.radius();
            let point = if found.lower <= radius * (1.0 + 4.0 * f64::EPSILON) {
                witness.point_a
            } else if let Some(inside) = inside() {
                inside
            } else {
                continue;
            };
            let local = frame.local(point);
            let core_point = part.volume.closest_on_core(local);
            let into = unit(&sub(&core_point, &local)).unwrap_or([0.0, 0.0, -1.0]);
            let normal = apply(&frame.rotation, into);
            let depth = (-part.volume.signed_distance(local)).max(0.0);
            hits.push(PartHit { part: at, bone: part.anchor, t: 0.0, point, normal, depth });
        }
        Ok(hits)
    }
}

/// Whether a ray surely misses a sphere, by the distance of its centre to the line.
fn misses(sphere: &(Vector, f64), ray: &Ray) -> bool {
    let direction = ray.direction();
    let offset = sub(&sphere.0, &ray.origin());
    let squared = dot(&direction, &direction);
    let across = sub(&offset, &scale(&direction, dot(&direction, &offset) / squared));
    let reach = sphere.1 + ROUNDING * (length(&offset) + length(&ray.origin()) + length(&sphere.0));
    // The square of a direction that short has lost its digits.
    const LEAST: f64 = 1e-280;
    squared > LEAST && dot(&across, &across) > reach * reach * (1.0 + 1e-12)
}

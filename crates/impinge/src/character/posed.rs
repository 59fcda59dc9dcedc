//! Queries of a character in one pose: the parts that a ray, a shape, a mesh or another character
//! strikes.
//!
//! Tests: `impinge-files/tests/it/characters`. Benchmark: `characters`.

use crate::input::InputError;
use crate::mesh::{Mesh, PlacedMesh, Positions, Ray};
use crate::query::{self, distance};
use crate::shape::PlacedShape;
use crate::volume::MinMax;

use super::body::Character;
use super::crossing::Crossing;
use super::fit::HitPart;
use super::frame::Frame;
use super::rig_pose::RigPose;
use super::transform::{apply, apply_transposed};
use super::volume::HitVolume;
use super::volume_pair::{PlacedVolume, core, may_overlap};
use crate::math::vec3::{Vector, add, dot, length, scale, sub, unit};

/// A character in a pose: the volume of each part is at its bone in the world.
#[derive(Clone, Debug)]
pub struct Posed<'c> {
    character: &'c Character,
    frames: Vec<Frame>,
    /// A sphere around each part, in the world: center and radius.
    spheres: Vec<(Vector, f64)>,
    /// Frames of the bones that pieces are fixed to, in the order of `piece_anchors`.
    piece_frames: Vec<Frame>,
    /// Axis-aligned box around all spheres, in the world: lower and upper corner.
    outer: [Vector; 2],
}

/// A part of a character that was struck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartHit {
    /// Index of the part.
    pub part: u32,
    /// Index of the bone that its volume is fixed to.
    pub bone: u32,
    /// For a ray: the parameter where it enters the volume, in units of the direction's length, or
    /// 0 if it starts inside. For other queries: 0.
    pub t: f64,
    /// The contact point, in the world frame, rounded.
    pub point: [f64; 3],
    /// Unit normal in the world frame, rounded. For a ray it points out of the part. For other
    /// queries it points from the striking object into the part.
    pub normal: [f64; 3],
    /// Depth in world units. For a ray, its length inside the volume, rounded; for a shape, an
    /// upper bound of the penetration depth; for a mesh, the penetration depth, rounded.
    pub depth: f64,
}

/// A part of one character that overlaps a part of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPair {
    /// Index of the part of the first character.
    pub part_a: u32,
    /// Index of the part of the second character.
    pub part_b: u32,
    /// The contact point, in the world frame, rounded.
    pub point: [f64; 3],
    /// Unit normal from the first to the second part, in the world frame, rounded.
    pub normal: [f64; 3],
    /// Upper bound of the penetration depth, in world units.
    pub depth: f64,
}

/// Padding of the spheres around parts and of the box around all, relative to the sum of the sizes:
/// 2^-48. It covers three products and sums of numbers of that size, each with an error of 2^-53 of
/// it.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

impl<'c> Posed<'c> {
    /// Places a character in a pose of its rig, with the rig's own origin at the origin of the
    /// world.
    ///
    /// # Panics
    /// If the pose lacks a bone that a part is fixed to.
    #[must_use]
    pub fn new(character: &'c Character, pose: &RigPose) -> Self {
        let mut posed =
            Self { character, frames: Vec::new(), spheres: Vec::new(), piece_frames: Vec::new(), outer: [[0.0; 3]; 2] };
        posed.set(pose);
        posed
    }

    /// Moves the character to another pose of its rig and reuses the memory. Panics like
    /// [`new`](Self::new).
    pub fn set(&mut self, pose: &RigPose) {
        self.set_at(pose, [0.0; 3]);
    }

    /// Does the same as [`set`](Self::set), with the rig's own origin at `origin` in the world.
    pub fn set_at(&mut self, pose: &RigPose, origin: [f64; 3]) {
        self.frames.clear();
        self.spheres.clear();
        let mut outer = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for part in self.character.parts() {
            let bone = &pose.bones()[part.anchor as usize];
            let frame = Frame::new(bone.rotation_wxyz, add(&bone.origin(), &origin));
            let (local, radius) = part.sphere;
            let turned = apply(&frame.rotation, local);
            let center = add(&turned, &frame.origin);
            let size = length(&local) + radius + length(&frame.origin);
            let radius = radius + ROUNDING * size;
            for k in 0..3 {
                outer[0][k] = outer[0][k].min(center[k] - radius);
                outer[1][k] = outer[1][k].max(center[k] + radius);
            }
            self.frames.push(frame);
            self.spheres.push((center, radius));
        }
        self.outer = outer;
        self.piece_frames.clear();
        self.piece_frames.extend(self.character.piece_anchors.iter().map(|&anchor| {
            let bone = &pose.bones()[anchor as usize];
            Frame::new(bone.rotation_wxyz, add(&bone.origin(), &origin))
        }));
    }

    /// Returns the character.
    #[must_use]
    pub fn character(&self) -> &'c Character {
        self.character
    }

    /// Returns for each part the rigid frame, in the world, of the bone that its volume is fixed
    /// to. The volume is given in that frame.
    #[must_use]
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Returns the lower and the upper corner of an axis-aligned box, in the world frame, that
    /// encloses the volumes of all parts. It is the box around a bounding sphere of each part.
    #[must_use]
    pub fn outer(&self) -> [[f64; 3]; 2] {
        self.outer
    }

    /// Returns the box of [`outer`](Self::outer), in the world frame, as a [`MinMax`].
    ///
    /// # Errors
    /// Returns an error if the box is out of range, which it never is for poses of a rig.
    pub fn outer_box(&self) -> Result<MinMax, InputError> {
        MinMax::new(self.outer[0], self.outer[1])
    }

    fn parts(&self) -> impl Iterator<Item = (u32, &'c HitPart, &Frame, &(Vector, f64))> {
        (0..)
            .zip(self.character.parts())
            .zip(self.frames.iter().zip(&self.spheres))
            .map(|((at, part), (frame, sphere))| (at, part, frame, sphere))
    }

    /// Returns the part whose volume a ray, given in the world frame, enters first, or `None` if it
    /// misses all. In a tie the part with the lowest index wins.
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
    /// Never misses a volume that the ray hits: volumes are thickened by 2^-46 of their sizes and
    /// distances.
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

    /// Returns all parts whose volumes a ray, given in the world frame, hits. They are sorted by
    /// the parameter where it enters them, then by part. As with [`ray_cast`](Self::ray_cast), no
    /// volume is missed.
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

    /// Returns the interval of a ray inside a part, with the normal in the world frame: inside its
    /// volume, or if that is refined, inside the first of its pieces.
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

    /// Reports whether a ray is proved to miss the box around all parts.
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

    /// Returns all parts that are not proved apart from a shape, which is placed in the world,
    /// sorted by part.
    ///
    /// # Errors
    /// Returns an error if a part exceeds the range of shapes.
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

    /// Calls `visit` with each pair of parts of two characters that is not proved apart: the index
    /// of the part of this character, then of the other, in ascending order. Computes no depths, as
    /// suits a broad phase.
    ///
    /// # Errors
    /// Returns an error if a part exceeds the range of shapes.
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
                    && may_overlap(
                        &PlacedVolume { volume: &part_a.volume, frame: frame_a, sphere: *sphere_a },
                        &PlacedVolume { volume: &part_b.volume, frame: frame_b, sphere: *sphere_b },
                    )?
                {
                    visit(a, b);
                }
            }
        }
        Ok(())
    }

    /// Returns all pairs of parts of two characters that are not proved apart, in ascending order
    /// of their indices, with their depths. This character is the first.
    ///
    /// # Errors
    /// Returns an error if a part exceeds the range of shapes.
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

    /// Returns all parts whose volumes, as solids, touch or overlap the surface of a mesh, which is
    /// placed in the world, sorted by part. The depth is that of the nearest point of the mesh
    /// below the surface of the volume, at most the radius of the volume.
    ///
    /// # Errors
    /// Returns an error if a part exceeds the range of meshes.
    ///
    /// # Complexity
    /// One distance of two meshes per part: the second mesh is the point, segment or rectangle that
    /// a sphere sweeps, or the box or hull.
    pub fn struck_by_mesh(&self, mesh: PlacedMesh<'_>) -> Result<Vec<PartHit>, InputError> {
        let mut hits = Vec::new();
        for (at, part, frame, _) in self.parts() {
            let (positions, faces) = core(&part.volume);
            let core = Mesh::new(Positions::F64(positions), faces)?;
            let found = distance(mesh, core.at(frame.pose()?));
            let Some(witness) = found.witness else { continue };
            // A vertex inside a box or hull whose surface the mesh does not touch.
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

/// Reports whether a ray is proved to miss a sphere, by the distance from its center to the line.
fn misses(sphere: &(Vector, f64), ray: &Ray) -> bool {
    let direction = ray.direction();
    let offset = sub(&sphere.0, &ray.origin());
    let squared = dot(&direction, &direction);
    let across = sub(&offset, &scale(&direction, dot(&direction, &offset) / squared));
    let reach = sphere.1 + ROUNDING * (length(&offset) + length(&ray.origin()) + length(&sphere.0));
    // The squared length of a shorter direction has lost precision.
    const LEAST: f64 = 1e-280;
    squared > LEAST && dot(&across, &across) > reach * reach * (1.0 + 1e-12)
}

//! Computes when a moving volume first strikes the parts of a character that moves between two
//! poses, such as a punch between two frames.
//!
//! # Source
//! Conservative advancement (Mirtich, *Impulse-based Dynamic Simulation of Rigid Body Systems*,
//! 1996, section 2.3): time advances by a proved lower bound of the distance divided by a proved
//! upper bound of the speed, so nothing is passed through.
//!
//! Tests: `impinge-files/tests/it/characters/strikes.rs`.

use crate::input::InputError;
use crate::math::Pose;
use crate::query;
use crate::volume::Proximity;

use super::frame::{Frame, frame_of};
use super::posed::Posed;
use super::transform::slerp;
use super::volume::HitVolume;
use crate::math::vec3::{Vector, add, length, scale, sub, unit};

/// A part that was struck during a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strike {
    /// Index of the part.
    pub part: u32,
    /// Index of the bone that its volume is fixed to.
    pub bone: u32,
    /// Time of the strike, from 0 at the first pose to 1 at the second. The volumes do not touch
    /// before it. At that time their distance is less than 1e-9 of their sizes, unless the maximum
    /// number of steps was reached.
    pub t: f64,
    /// The contact point, in the world frame, rounded.
    pub point: [f64; 3],
    /// Unit normal from the striking volume into the part, in the world frame, rounded.
    pub normal: [f64; 3],
    /// Upper bound of the penetration depth at that time, in world units. It is 0 unless the
    /// volumes overlap from the start.
    pub depth: f64,
}

/// Maximum number of steps for each part.
const MAX_STEPS: usize = 512;

/// Distance, relative to the sizes, below which volumes count as struck.
const TOUCH_TOLERANCE: f64 = 1e-9;

/// A volume in a moving frame. Its origin moves along a line at constant speed, and its rotation
/// takes the smallest angle at constant speed.
struct MovingVolume<'v> {
    volume: &'v HitVolume,
    from: Frame,
    to: Frame,
    /// Upper bound of the speed of any point of the volume, in world units per whole motion.
    speed: f64,
    /// Upper bound of the position error of the placed volume, in world units.
    error: f64,
}

impl<'v> MovingVolume<'v> {
    fn new(volume: &'v HitVolume, from: Frame, to: Frame, off: f64) -> Self {
        let (center, radius) = volume.bounding_sphere();
        let reach = (length(&center) + radius) * (1.0 + 1e-12);
        // On the shorter arc the chord is at most √2. There arcsin x ≤ x + 0.2216 x³, with equality
        // at the end.
        let chord = |sign: f64| {
            let squares = (0..4).map(|k| (to.rotation_wxyz[k] - sign * from.rotation_wxyz[k]).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let x = 0.5 * chord(1.0).min(chord(-1.0));
        let angle = 4.0 * (x + 0.2216 * x * x * x);
        let speed = (length(&sub(&to.origin, &from.origin)) + angle * reach) * (1.0 + 1e-12);
        let size = length(&from.origin) + length(&to.origin) + reach;
        Self { volume, from, to, speed, error: off * reach + 1e-13 * size }
    }

    fn at(&self, t: f64) -> Frame {
        if t <= 0.0 {
            return self.from;
        }
        let between = scale(&sub(&self.to.origin, &self.from.origin), t);
        let rotation = slerp(self.from.rotation_wxyz, self.to.rotation_wxyz, t);
        Frame::new(rotation, add(&self.from.origin, &between))
    }

    /// Returns a sphere around the volume in a frame, in the world.
    fn sphere(&self, frame: &Frame) -> (Vector, f64) {
        let (center, radius) = self.volume.bounding_sphere();
        (frame.apply(center), radius * (1.0 + 1e-12))
    }
}

impl Posed<'_> {
    /// Returns all parts that a volume strikes while it moves from one pose in the world to another
    /// and this character moves to `to`. They are sorted by time, then by part. Each frame moves
    /// along a line and rotates by the smallest angle, both at constant speed. A part that is not
    /// proved apart after 512 steps counts as struck.
    ///
    /// ```no_run
    /// # use impinge::{Pose, character::{HitVolume, Posed}, volume::BoundingSphere};
    /// # fn f(before: &Posed, after: &Posed) -> Result<(), impinge::InputError> {
    /// let fist = HitVolume::Sphere(BoundingSphere::new([0.0; 3], 0.1)?);
    /// let (from, to) = (Pose::from_translation([0.0, 1.5, 3.0])?, Pose::from_translation([0.0, 1.5, -3.0])?);
    /// for strike in before.strikes(after, &fist, &from, &to)? {
    ///     println!("{} at {}", before.character().parts()[strike.part as usize].name, strike.t);
    /// }
    /// # Ok(()) }
    /// ```
    ///
    /// # Errors
    /// Returns [`NotRigid`](crate::input::InputErrorKind::NotRigid) if a pose of the volume is not
    /// a rotation within 1e-4. Returns an error if poses or volumes exceed the range of shapes.
    ///
    /// # Accuracy
    /// Times are never later than the true first contact of the volumes. For conservative volumes
    /// they are never later than that of the surface, if its frames move this way
    /// (`impinge-files/tests/it/characters`).
    ///
    /// # Panics
    /// If `to` is a pose of a character with fewer parts.
    pub fn strikes(
        &self,
        to: &Posed<'_>,
        volume: &HitVolume,
        world_from_volume_t0: &Pose,
        world_from_volume_t1: &Pose,
    ) -> Result<Vec<Strike>, InputError> {
        let ((start, off), (end, off_end)) = (frame_of(world_from_volume_t0)?, frame_of(world_from_volume_t1)?);
        let striker = MovingVolume::new(volume, start, end, off.max(off_end));
        let mut strikes = Vec::new();
        for (at, part) in (0..).zip(self.character().parts()) {
            let moving = MovingVolume::new(&part.volume, self.frames()[at as usize], to.frames()[at as usize], 0.0);
            if let Some(strike) = first_contact(&striker, &moving)? {
                strikes.push(Strike { part: at, bone: part.anchor, ..strike });
            }
        }
        strikes.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
        Ok(strikes)
    }
}

fn first_contact(striker: &MovingVolume<'_>, part: &MovingVolume<'_>) -> Result<Option<Strike>, InputError> {
    let speed = striker.speed + part.speed;
    let error = striker.error + part.error;
    let size = striker.volume.bounding_sphere().1 + part.volume.bounding_sphere().1;
    let mut t = 0.0;
    for _ in 0..MAX_STEPS {
        let (frame_a, frame_b) = (striker.at(t), part.at(t));
        let (a, b) = (striker.sphere(&frame_a), part.sphere(&frame_b));
        let mut gap = length(&sub(&b.0, &a.0)) - a.1 - b.1 - error;
        // Spheres are enough while the volumes are far apart.
        if gap <= 0.25 * size {
            let (placed_a, placed_b) = (striker.volume.placed(frame_a.pose()?)?, part.volume.placed(frame_b.pose()?)?);
            let found = query::distance(&placed_a, &placed_b);
            gap = found.lower - error;
            if found.proximity != Proximity::Apart || gap <= TOUCH_TOLERANCE * size {
                let deep = if t == 0.0 { query::penetration(&placed_a, &placed_b) } else { None };
                let [point_a, point_b] = found.points().unwrap_or([a.0, b.0]);
                let apart = unit(&sub(&point_b, &point_a));
                let normal = deep.map(|deep| deep.normal).or(apart).or(unit(&sub(&b.0, &a.0)));
                let point = scale(&add(&point_a, &point_b), 0.5);
                let (normal, depth) = (normal.unwrap_or([0.0, 0.0, 1.0]), deep.map_or(0.0, |deep| deep.upper));
                return Ok(Some(Strike { part: 0, bone: 0, t, point, normal, depth }));
            }
        }
        if gap > speed * (1.0 - t) * (1.0 + 1e-12) {
            return Ok(None);
        }
        let next = (t + gap / speed * (1.0 - 1e-12)).next_down();
        if next.is_nan() || next <= t {
            break;
        }
        t = next.min(1.0);
    }
    // Without any steps left, volumes that are not proved apart count as struck, at the last proved
    // time.
    let (frame_a, frame_b) = (striker.at(t), part.at(t));
    let (p, q) = (striker.sphere(&frame_a).0, part.sphere(&frame_b).0);
    let normal = unit(&sub(&q, &p)).unwrap_or([0.0, 0.0, 1.0]);
    Ok(Some(Strike { part: 0, bone: 0, t, point: scale(&add(&p, &q), 0.5), normal, depth: 0.0 }))
}

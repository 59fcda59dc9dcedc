//! A box that moves along a line and holds a moving thing at all times.
//!
//! It proves in a few nanoseconds that a sweep cannot touch a resting body before some time. A
//! thing that does not turn is in its first box, moved along. A thing that turns is in a cube about
//! the pivot, because its points keep their distances from the pivot; the matrix D of [`Motion`]
//! adds its norm times the reach of the thing.
//!
//! The test is `carriers_hold_moving_things` below.

use super::ask::TOUCHING;
use super::body::height_error;
use super::motion::Motion;
use crate::math::Pose;
use crate::math::vec3::{Vector, cross, dot, scaled_length, sub};
use crate::partition::Ray;
use crate::shape::PlacedShape;
use crate::volume::{BoundingVolume, MinMax};

/// Factor that makes a computed length larger than the exact one.
const ABOVE: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;

/// Bound on the rounding errors of the times and boxes below, relative to the coordinates: 2^-44.
const ROUNDING: f64 = 1.0 / (1_u64 << 44) as f64;

/// A sweep stops if two things are nearer than their clearance and a few times its resolution and
/// the errors of their motions. This factor is larger than any of these numbers of times.
const RESOLUTIONS: f64 = 16.0;

/// Maximum number of stretches of a path. More stretches leave out more of the space beside the
/// path and visit more boxes twice.
const MAX_STRETCHES: f64 = 64.0;

/// The box of a moving thing and its path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carrier {
    /// Holds the thing at time 0.
    start: MinMax,
    /// Path of the box from time 0 to time 1.
    path: Vector,
    /// Distance from the box within which a sweep may find contact, by rounding.
    slack: f64,
}

impl Carrier {
    /// Returns the carrier of a thing, given at the start of its motion. Returns `None` if the
    /// thing is unbounded or empty, or if no valid box holds it.
    pub(crate) fn of(thing: &PlacedShape, motion: &Motion) -> Option<Self> {
        if thing.is_unbounded() {
            return None;
        }
        let [min, max] = thing.bounds()?;
        let reach = reach(&[min, max], thing.world_from_local());
        let mut start = MinMax::new(min, max).ok()?;
        if motion.turns() {
            let pivot = motion.pivot_at(0.0);
            let farthest = farthest(&[min, max], &pivot) + motion.turn().drift * reach;
            start = MinMax::new(pivot, pivot).ok()?.grown(farthest * ABOVE)?;
        }
        let slack = slack(&start, motion, reach);
        slack.is_finite().then_some(Self { start, path: motion.linear(), slack })
    }

    /// Returns the number of stretches of equal duration into which the path is divided, so that
    /// the boxes around them leave out most of the space beside the path.
    pub(crate) fn stretches(&self) -> u32 {
        let longest = self.path.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let size = (0..3).fold(0.0_f64, |most, k| most.max(self.start.max()[k] - self.start.min()[k]));
        if longest == 0.0 { 1 } else { (longest / size).ceil().clamp(1.0, MAX_STRETCHES) as u32 }
    }

    /// Returns a box that holds everything within the clearance of the thing between two times, or
    /// `None` if no valid box does.
    pub(crate) fn between(&self, times: [f64; 2], clearance: f64) -> Option<MinMax> {
        let (min, max) = (self.start.min(), self.start.max());
        let along = |k: usize| times.map(|t| t * self.path[k]);
        let low = std::array::from_fn(|k| min[k] + along(k)[0].min(along(k)[1]));
        let high = std::array::from_fn(|k| max[k] + along(k)[0].max(along(k)[1]));
        let bounds = MinMax::new(low, high).ok()?;
        bounds.grown(clearance + self.slack + ROUNDING * (largest(&bounds) + scaled_length(&self.path)))
    }

    /// Returns a time from 0 to 1 before which a sweep with the clearance finds no contact with a
    /// resting body in a box, or `None` if it finds none at any time.
    pub(crate) fn enters(&self, bounds: &MinMax, world_from_body: &Pose, clearance: f64) -> Option<f64> {
        let corners = [bounds.min(), bounds.max()];
        let (min, max) = (self.start.min(), self.start.max());
        let center: Vector = std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]);
        let slack = self.slack + slack(bounds, &Motion::resting(*world_from_body), reach(&corners, world_from_body));
        let size = largest(bounds) + largest(&self.start) + scaled_length(&self.path);
        let by = clearance + slack + ROUNDING * size;
        let half = |k: usize| (max[k] - center[k]).max(center[k] - min[k]) + by;
        let low = std::array::from_fn(|k| corners[0][k] - half(k));
        let high = std::array::from_fn(|k| corners[1][k] + half(k));
        // If no valid box or ray exists, nothing is proved.
        let Ok(target) = MinMax::new(low, high) else { return Some(0.0) };
        match Ray::new(center, self.path, 1.0) {
            Ok(ray) => ray.enters(&target),
            Err(_) => {
                target.grown(scaled_length(&self.path)).is_none_or(|target| holds(&target, &center)).then_some(0.0)
            }
        }
    }
}

fn holds(bounds: &MinMax, point: &Vector) -> bool {
    MinMax::new(*point, *point).is_ok_and(|point| bounds.overlaps(&point))
}

/// Returns the distance from a thing, in world units, within which a sweep may find contact by
/// rounding. `bounds` holds the thing at the start.
fn slack(bounds: &MinMax, motion: &Motion, reach: f64) -> f64 {
    RESOLUTIONS * (TOUCHING * reach + height_error(motion, reach)) + ROUNDING * largest(bounds)
}

/// Returns an upper bound on the distance of a corner of the local box of a thing from the origin
/// of its frame, in that frame. `corners` are those of its box in the world.
fn reach(corners: &[Vector; 2], world_from_body: &Pose) -> f64 {
    let [x, y, z] = world_from_body.linear();
    let cofactors = [cross(y, z), cross(z, x), cross(x, y)];
    let inverse = scaled_length(&cofactors.map(|row| scaled_length(&row))) / dot(&cofactors[0], x).abs();
    // The local box is up to √3 times as large as the farthest point.
    2.0 * inverse * farthest(corners, world_from_body.translation()) * ABOVE
}

/// Returns the largest distance of a point of a box from a point.
fn farthest([min, max]: &[Vector; 2], point: &Vector) -> f64 {
    let [low, high] = [sub(min, point), sub(max, point)];
    scaled_length(&std::array::from_fn(|k| low[k].abs().max(high[k].abs()))) * ABOVE
}

fn largest(bounds: &MinMax) -> f64 {
    bounds.min().iter().chain(&bounds.max()).fold(0.0_f64, |most, x| most.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use impinge_testkit::generate::{Rng, poses};

    /// At every time the box of the thing is in the box of the stretch, and no box that the thing
    /// reaches is entered later.
    #[test]
    fn carriers_hold_moving_things() {
        let mut rng = Rng::new(211);
        let (mut turning, mut late, mut missed) = (0, 0, 0);
        for round in 0..600 {
            let turn = poses::rotation(&mut rng);
            let pose = Pose::new(turn.linear, [0; 3].map(|_| rng.integer(-4, 4) as f64)).unwrap();
            let vector = |rng: &mut Rng| [0; 3].map(|_| rng.integer(-8, 8) as f64 / 2.0);
            let (linear, angular) = (vector(&mut rng), if round % 3 == 0 { [0.0; 3] } else { vector(&mut rng) });
            let pivot = rng.one_in(2).then(|| vector(&mut rng));
            let motion = Motion::screw(pose, linear, angular, pivot).unwrap();
            turning += u32::from(motion.turns());
            let shape = Shape::cuboid([1.0, 0.5, 0.25]).unwrap();
            let carrier = Carrier::of(&shape.at(pose).unwrap(), &motion).unwrap();
            let whole = carrier.between([0.0, 1.0], 0.0).unwrap();
            for step in 0..=16 {
                let t = f64::from(step) / 16.0;
                let [min, max] = shape.at(motion.at(t)).unwrap().bounds().unwrap();
                let bounds = MinMax::new(min, max).unwrap();
                assert!(carrier.between([(t - 0.1).max(0.0), t], 0.0).unwrap().encloses(&bounds));
                assert!(whole.encloses(&bounds));
                // A box at a corner of the thing is entered by now.
                let speck = MinMax::new(max, max.map(|x| x + 1.0)).unwrap();
                let enters = carrier.enters(&speck, &Pose::IDENTITY, 0.0);
                assert!(enters.is_some_and(|enters| enters <= t), "{motion:?} {t} {enters:?}");
                late += u32::from(enters.is_some_and(|enters| enters > 0.25));
            }
            let beside = MinMax::new([50.0; 3], [51.0; 3]).unwrap();
            missed += u32::from(carrier.enters(&beside, &Pose::IDENTITY, 0.0).is_none());
        }
        assert!(turning > 300 && late > 1_000 && missed > 500, "{turning} {late} {missed}");
    }
}

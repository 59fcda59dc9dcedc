//! A capsule about points (Ericson 4.5; Eberly, *Geometric Tools*: capsule from a line).

use super::super::{BoundingVolume, Capsule, round};
use super::enclosing::{scaled_offset, unit_scale};
use super::minimal::circle;
use super::moments::principal_axes;
use crate::input::InputError;
use crate::math::vec3::{add, dot, scale, sub};
use crate::volume::points::{Coordinate, judge, widen};

/// The smallest capsule of those about the three principal axes: for each the least radius, that of the minimal circle of
/// the points seen along the axis, and the shortest segment for it.
///
/// ```
/// use impinge::volume::{BoundingVolume, fit};
/// let rod: Vec<[f64; 3]> = (0..8).map(|i| [f64::from(i), f64::from(i % 2), 0.0]).collect();
/// let capsule = fit::capsule(&rod)?;
/// assert!(capsule.radius() < 0.65 && rod.iter().all(|&point| capsule.contains(point)));
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Errors
/// As [`BoundingVolume::of_points`].
///
/// # Complexity
/// Some fifty passes over memory.
///
/// # Source
/// *Notes*, 2.3 (principal axes); Ericson 4.5.3. The line of least squares is not the axis of the thinnest capsule with its
/// direction, so the minimal circle moves it there; the two other axes are tried as well, since a flat disc is thinnest
/// about the shortest one.
pub fn capsule<T: Coordinate>(points: &[[T; 3]]) -> Result<Capsule, InputError> {
    let bounds = judge(points)?;
    let scale_up = unit_scale(&bounds);
    let (min, max) = (bounds.min(), bounds.max());
    let origin: [f64; 3] = std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
    let axes = principal_axes(points, origin, scale_up);
    let candidates = axes.map(|axis| along(points, axis, origin, scale_up));
    let [first, rest @ ..] = candidates;
    Ok(rest.into_iter().fold(first, |best, next| if next.volume() < best.volume() { next } else { best }))
}

/// The capsule with this direction.
fn along<T: Coordinate>(points: &[[T; 3]], axis: [f64; 3], origin: [f64; 3], scale_up: f64) -> Capsule {
    let local = |&point: &[T; 3]| scaled_offset(widen(point), origin, scale_up);
    let flat: Vec<[f64; 3]> = points
        .iter()
        .map(|point| {
            let offset = local(point);
            sub(&offset, &scale(&axis, dot(&axis, &offset)))
        })
        .collect();
    let (centre, squared_radius) = circle(&flat);
    // Each point wants the segment to come within the radius of it; the caps reach out by what the radius leaves.
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (point, seen) in points.iter().zip(&flat) {
        let t = dot(&axis, &local(point));
        let aside = sub(seen, &centre);
        let cap = (squared_radius - dot(&aside, &aside)).max(0.0).sqrt();
        low = low.min(t + cap);
        high = high.max(t - cap);
    }
    if low > high {
        let middle = 0.5 * (low + high);
        (low, high) = (middle, middle);
    }
    let ends = [low, high].map(|t| add(&origin, &scale(&add(&centre, &scale(&axis, t)), 1.0 / scale_up)));
    let core = Capsule::from_valid(ends, 0.0).core();
    let radius = points.iter().map(|&point| round::distance_to_core(widen(point), &core)).fold(0.0, f64::max);
    Capsule::from_valid(ends, radius)
}

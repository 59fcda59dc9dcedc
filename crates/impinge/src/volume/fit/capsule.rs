//! Fits a capsule to points (Ericson 4.5; Eberly, *Geometric Tools*: capsule from a line).

use super::super::{BoundingVolume, Capsule, round};
use super::enclosing::{scaled_offset, unit_scale};
use super::minimal::circle;
use super::moments::principal_axes;
use crate::input::InputError;
use crate::math::vec3::{add, dot, scale, sub};
use crate::volume::points::{Coordinate, validated_bounds, widen};

/// Returns a capsule that encloses all points: the smallest of three, one along each principal
/// axis. Each has the radius of the minimal circle of the points projected along its axis, and the
/// shortest segment for that radius.
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
/// Same as [`BoundingVolume::of_points`].
///
/// # Complexity
/// About 50 passes over memory.
///
/// # Source
/// *Notes*, 2.3 (principal axes); Ericson 4.5.3. The least-squares line is not the axis of the
/// thinnest capsule in its direction, so the minimal circle moves it there. The two other axes are
/// tried as well, because a flat disc is thinnest around its shortest axis.
pub fn capsule<T: Coordinate>(points: &[[T; 3]]) -> Result<Capsule, InputError> {
    let bounds = validated_bounds(points)?;
    let scale_up = unit_scale(&bounds);
    let (min, max) = (bounds.min(), bounds.max());
    let origin: [f64; 3] = std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
    let axes = principal_axes(points, origin, scale_up);
    let candidates = axes.map(|axis| along(points, axis, origin, scale_up));
    let [first, rest @ ..] = candidates;
    Ok(rest.into_iter().fold(first, |best, next| if next.volume() < best.volume() { next } else { best }))
}

/// Returns the capsule with the given direction.
fn along<T: Coordinate>(points: &[[T; 3]], axis: [f64; 3], origin: [f64; 3], scale_up: f64) -> Capsule {
    let local = |&point: &[T; 3]| scaled_offset(widen(point), origin, scale_up);
    let flat: Vec<[f64; 3]> = points
        .iter()
        .map(|point| {
            let offset = local(point);
            sub(&offset, &scale(&axis, dot(&axis, &offset)))
        })
        .collect();
    let (center, squared_radius) = circle(&flat);
    // The segment must come within the radius of each point. The caps extend past its ends, so each
    // point allows a shorter segment.
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (point, seen) in points.iter().zip(&flat) {
        let t = dot(&axis, &local(point));
        let aside = sub(seen, &center);
        let cap = (squared_radius - dot(&aside, &aside)).max(0.0).sqrt();
        low = low.min(t + cap);
        high = high.max(t - cap);
    }
    if low > high {
        let middle = 0.5 * (low + high);
        (low, high) = (middle, middle);
    }
    let ends = [low, high].map(|t| add(&origin, &scale(&add(&center, &scale(&axis, t)), 1.0 / scale_up)));
    let core = Capsule::from_valid(ends, 0.0).core();
    let radius = points.iter().map(|&point| round::distance_to_core(widen(point), &core)).fold(0.0, f64::max);
    Capsule::from_valid(ends, radius)
}

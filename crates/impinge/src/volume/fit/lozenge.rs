//! Fits a lozenge to points (Larsen, Gottschalk, Lin and Manocha 1999, section 3.3; Ericson 4.5).

use super::super::core::Core;
use super::super::{BoundingVolume, Lozenge, round};
use super::enclosing::{scaled_offset, unit_scale};
use super::moments::principal_axes;
use crate::input::InputError;
use crate::math::vec3::{add, dot, scale};
use crate::volume::points::{Coordinate, validated_bounds, widen};

/// Returns a lozenge that encloses all points. It is the smallest by volume of six candidates: a
/// short and a long rectangle for each principal axis as the thickness.
///
/// The short rectangle leaves out points that the rounded rims cover; the long one covers the
/// projections of all points. Finally the radius becomes the greatest distance of a point from the
/// rectangle.
///
/// ```
/// use impinge::volume::{BoundingVolume, fit};
/// let plate: Vec<[f64; 3]> = (0..64).map(|i| [i % 8, i / 8, i % 2].map(f64::from)).collect();
/// let lozenge = fit::lozenge(&plate)?;
/// assert!(plate.iter().all(|&point| lozenge.contains(point)));
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Errors
/// Same as [`BoundingVolume::of_points`].
///
/// # Complexity
/// About 20 passes over memory.
///
/// # Source
/// Larsen et al. 1999, section 3.3. Ours tries all three axes, and a larger radius.
pub fn lozenge<T: Coordinate>(points: &[[T; 3]]) -> Result<Lozenge, InputError> {
    let bounds = validated_bounds(points)?;
    let scale_up = unit_scale(&bounds);
    let (min, max) = (bounds.min(), bounds.max());
    let origin: [f64; 3] = std::array::from_fn(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
    let axes = principal_axes(points, origin, scale_up);
    let frames = [[axes[0], axes[1], axes[2]], [axes[0], axes[2], axes[1]], [axes[1], axes[2], axes[0]]];
    let candidates = frames
        .into_iter()
        .flat_map(|frame| [Sides::Short, Sides::Long].map(|sides| in_frame(points, frame, sides, (origin, scale_up))));
    let smaller = |best: Lozenge, next: Lozenge| if next.volume() < best.volume() { next } else { best };
    Ok(candidates.reduce(smaller).unwrap_or(Lozenge::from_valid(origin, [[0.0; 3]; 2], 0.0)))
}

/// Extent of the rectangle: `Short` leaves out the points that the swept rims hold, corners aside;
/// `Long` covers the projection of every point.
#[derive(Clone, Copy, PartialEq)]
enum Sides {
    Short,
    Long,
}

/// Returns the lozenge whose thickness is along the last axis of the frame.
fn in_frame<T: Coordinate>(
    points: &[[T; 3]],
    frame: [[f64; 3]; 3],
    sides: Sides,
    (origin, scale_up): ([f64; 3], f64),
) -> Lozenge {
    let coordinates = |&point: &[T; 3]| {
        let offset = scaled_offset(widen(point), origin, scale_up);
        frame.map(|axis| dot(&axis, &offset))
    };
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for point in points {
        let [.., t] = coordinates(point);
        (low, high) = (low.min(t), high.max(t));
    }
    let (middle, radius) = (0.5 * (low + high), 0.5 * (high - low));
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for point in points {
        let [s, t, height] = coordinates(point);
        let up = height - middle;
        let rim = if sides == Sides::Short { (radius * radius - up * up).max(0.0).sqrt() } else { 0.0 };
        for (range, x) in ranges.iter_mut().zip([s, t]) {
            *range = [range[0].min(x + rim), range[1].max(x - rim)];
        }
    }
    let ranges = ranges.map(|[low, high]| if low <= high { [low, high] } else { [0.5 * (low + high); 2] });
    let place = |k: usize, t: f64| scale(&frame[k], t / scale_up);
    let corner = add(&add(&add(&origin, &place(0, ranges[0][0])), &place(1, ranges[1][0])), &place(2, middle));
    let edges = [0, 1].map(|k| place(k, ranges[k][1] - ranges[k][0]));
    let core = Core { corner, edges, dimension: 2 };
    let radius = points.iter().map(|&point| round::distance_to_core(widen(point), &core)).fold(0.0, f64::max);
    Lozenge::from_valid(corner, edges, radius)
}

//! When two shapes that move rigidly first touch, by the same advancement as meshes.

use super::impact::Impact;
use super::motion::Motion;
use super::rigid::{Course, TOUCHING, VANISHING, contact_after};
use crate::input::InputError;
use crate::math::Pose;
use crate::query::shapes::{distance, intersects};
use crate::shape::{PlacedShape, Shape};

/// When two shapes, convex ones, half-spaces, meshes, solid or not, or compounds, first touch while each moves rigidly.
///
/// ```
/// use impinge::Pose;
/// use impinge::shape::Shape;
/// use impinge::sweep::{Motion, time_of_impact_of_shapes};
///
/// let (ball, floor) = (Shape::sphere([0.0; 3], 0.5)?, Shape::half_space([0.0, 0.0, 1.0], 0.0)?);
/// let fall = Motion::between(Pose::from_translation([0.0, 0.0, 2.5])?, Pose::from_translation([0.0, 0.0, -1.5])?)?;
/// let impact = time_of_impact_of_shapes(&ball, &floor, &fall, &Motion::default())?;
/// assert!(impact.hit() && impact.t_lower <= 0.5 && impact.t_lower > 0.5 - 1e-9);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// Nothing touches before `t_lower`, where the shapes are nearer to each other than 2^-37 of their sizes, or the steps were
/// spent. `t_upper` is a time at which they intersect, or are not proved apart, where [`Motion::at`] places them. A half-space that turns
/// sweeps everything far out at any speed: such a question is left open from the start on.
///
/// # Errors
/// As [`Shape::at`], for either shape where its motion takes it.
///
/// # Complexity
/// A distance of the shapes for each step, 1024 at most.
///
/// # Source
/// See [`time_of_impact`](super::time_of_impact); docs/proof.md, L24, with the corners of the shape's box for its vertices.
pub fn time_of_impact_of_shapes(
    a: &Shape,
    b: &Shape,
    motion_a: &Motion,
    motion_b: &Motion,
) -> Result<Impact, InputError> {
    let at = |t: f64| -> Result<[PlacedShape; 2], InputError> { Ok([a.at(motion_a.at(t))?, b.at(motion_b.at(t))?]) };
    let [here, there] = at(0.0)?;
    if intersects(&here, &there) {
        return Ok(Impact { t_lower: 0.0, t_upper: 0.0 });
    }
    let (Some(body_a), Some(body_b)) = (Body::of(a, motion_a)?, Body::of(b, motion_b)?) else {
        return Ok(Impact { t_lower: 0.0, t_upper: f64::INFINITY });
    };
    let approach = [0, 1, 2].map(|k| motion_a.linear()[k] - motion_b.linear()[k]);
    let turning = body_a.turning + body_b.turning;
    if turning == 0.0 && approach == [0.0; 3] {
        return Ok(Impact::NEVER);
    }
    let course = Course {
        speed: (approach.iter().map(|x| x * x).sum::<f64>().sqrt() + turning) * (1.0 + 1e-12) + VANISHING,
        error: body_a.error + body_b.error,
        touching: TOUCHING * (body_a.reach + body_b.reach),
    };
    let mut refused = None;
    let found = course.first_contact(|t| match at(t) {
        Ok([a, b]) => distance(&a, &b).lower,
        Err(error) => {
            refused = Some(error);
            f64::NAN
        }
    });
    if let Some(error) = refused {
        return Err(error);
    }
    let Some(t) = found else { return Ok(Impact::NEVER) };
    let meet = |t: f64| at(t).is_ok_and(|[a, b]| intersects(&a, &b));
    Ok(Impact { t_lower: t, t_upper: contact_after(t, meet) })
}

/// What counts of a moving shape.
struct Body {
    reach: f64,
    turning: f64,
    error: f64,
}

impl Body {
    /// None for a half-space that turns.
    fn of(shape: &Shape, motion: &Motion) -> Result<Option<Self>, InputError> {
        let still = shape.at(Pose::IDENTITY)?;
        let corners = match still.bounds() {
            Some(bounds) => (0..8).map(|i| [0, 1, 2].map(|k| bounds[i >> k & 1][k])).collect(),
            None if motion.turning_speed(std::iter::once([0.0; 3])) > 0.0 && still.is_unbounded() => return Ok(None),
            None => vec![[0.0; 3]],
        };
        let squared = corners.iter().map(|corner| corner.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max);
        let reach = squared.sqrt() * (1.0 + 1e-12) + VANISHING;
        // Parts of a compound are placed once more, with eight roundings.
        let placed = 16.0 * f64::EPSILON * reach;
        let turning = motion.turning_speed(corners.into_iter());
        Ok(Some(Self { reach, turning, error: motion.error(reach) + placed }))
    }
}

//! The time at which two rigidly moving things first touch: meshes, or shapes by the same
//! advancement.

use super::impact::Impact;
use super::motion::Motion;
use super::rigid::{Course, TOUCHING, VANISHING, contact_after, of_meshes};
use crate::input::InputError;
use crate::math::Pose;
use crate::query::{distance, intersects};
use crate::shape::{PlacedShape, Shape};

/// Returns the time at which two things first touch when each moves rigidly, as a proved interval.
/// Time 0 is the start of the motions and 1 their end. The things may be meshes (as surfaces or as
/// solids), shapes or compounds.
///
/// The time is 0 if the things touch or overlap at the start, or if one starts inside the other, a
/// solid. Things that pass through each other between the start and the end are found.
///
/// ```
/// use impinge::sweep::{Impact, Motion, time_of_impact};
/// use impinge::{Mesh, Pose, Positions, Shape};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let fall = Motion::between(Pose::from_translation([0.0, 0.0, 3.0])?, Pose::from_translation([0.0, 0.0, -1.0])?)?;
/// let impact = time_of_impact(&mesh, &mesh, &Motion::default(), &fall)?;
/// assert!(impact.hit() && impact.t_lower <= 0.75 && impact.t_lower > 0.75 - 1e-9);
///
/// let sphere = Shape::sphere([0.0; 3], 0.5)?;
/// let impact = time_of_impact(&mesh, &sphere, &Motion::default(), &fall)?;
/// assert!(impact.hit() && impact.t_lower <= 0.625 && impact.t_lower > 0.625 - 1e-9);
///
/// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let part = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let speck = Shape::point([1.0, 1.0, 1.0])?;
/// let rest = Motion::default();
/// assert_eq!(time_of_impact(&part, &speck, &rest, &rest)?, Impact::NEVER);
/// assert_eq!(time_of_impact(part.solid(), &speck, &rest, &rest)?.t_upper, 0.0);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// Nothing touches before `t_lower`. At that time the two are nearer to each other than 2^-37 of
/// their sizes, or the limit on steps was reached. `t_upper` is a time at which they intersect, or
/// are not proved apart, at the poses of [`Motion::at`]. It is infinite if no such time was found,
/// for example if they graze each other.
///
/// If a mesh is open and nothing is proved about its interior, contact at the start is the safe
/// answer. A half-space that turns sweeps distant regions at any speed, so such a query is
/// undecided from the start on.
///
/// # Errors
/// The errors of [`Shape::at`], for either shape at a pose of its motion. Every motion is valid for
/// a mesh.
///
/// # Complexity
/// One distance per step, at most 1024 steps. For meshes each distance starts from the witness of
/// the step before. The vertices of meshes are summed up once.
///
/// # Source
/// Mirtich, *Impulse-based Dynamic Simulation of Rigid Body Systems*, 1996, section 2.3. Ours
/// advances by a proved lower bound on the distance, minus the error of rounded poses, divided by a
/// proved upper bound on the approach speed of any two points (docs/notes/proof.md, L24; for a
/// shape, the corners of its box take the place of the vertices).
pub fn time_of_impact(
    a: impl Into<Shape>,
    b: impl Into<Shape>,
    motion_a: &Motion,
    motion_b: &Motion,
) -> Result<Impact, InputError> {
    let (a, b) = (a.into(), b.into());
    if let (Some((mesh_a, is_solid_a)), Some((mesh_b, is_solid_b))) = (a.as_mesh(), b.as_mesh()) {
        let is_solid = [is_solid_a, is_solid_b];
        return Ok(of_meshes([mesh_a, mesh_b], is_solid, motion_a, motion_b));
    }
    of_shapes(&a, &b, motion_a, motion_b)
}

/// Returns the [`time_of_impact`] of two things of which at least one is not a mesh.
fn of_shapes(a: &Shape, b: &Shape, motion_a: &Motion, motion_b: &Motion) -> Result<Impact, InputError> {
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
    let mut shape_error = None;
    let found = course.first_contact(|t| match at(t) {
        Ok([a, b]) => distance(&a, &b).lower,
        Err(error) => {
            shape_error = Some(error);
            f64::NAN
        }
    });
    if let Some(error) = shape_error {
        return Err(error);
    }
    let Some(t) = found else { return Ok(Impact::NEVER) };
    let intersect = |t: f64| at(t).is_ok_and(|[a, b]| intersects(&a, &b));
    Ok(Impact { t_lower: t, t_upper: contact_after(t, intersect) })
}

/// Bounds on a moving shape.
struct Body {
    reach: f64,
    turning: f64,
    error: f64,
}

impl Body {
    /// Returns the bounds, or `None` for a half-space that turns.
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

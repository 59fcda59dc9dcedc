//! The time at which two rigidly moving things first touch: meshes, or shapes by the same
//! advancement.

use super::ask::Sweep;
use super::impact::Impact;
use super::motion::Motion;
use crate::input::InputError;
use crate::shape::Shape;

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
    Sweep::new().time_of_impact(a, b, motion_a, motion_b)
}

//! The time at which two rigidly moving things first touch: meshes, or shapes.

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
/// their sizes and the rounding error of their poses, or the limit on the work was reached.
/// `t_upper` is a time at which they intersect, or are not proved apart, at the poses of
/// [`Motion::at`]. It is infinite if no such time was found, for example if they graze each other.
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
/// The number of pairs of pieces that are compared, about a microsecond each. Things that keep a
/// gap along one direction take one pair, however far they move along each other. Otherwise the
/// number grows with the faces that come near, and with the root of the angle over the gap. At most
/// 2^21 pairs are compared ([`Sweep::with_max_pairs`]). The vertices of meshes are summed up once.
///
/// # Source
/// The heads of `sweep/interval.rs` and `sweep/search.rs`; the proof is docs/notes/proof.md, L34.
pub fn time_of_impact(
    a: impl Into<Shape>,
    b: impl Into<Shape>,
    motion_a: &Motion,
    motion_b: &Motion,
) -> Result<Impact, InputError> {
    Sweep::new().time_of_impact(a, b, motion_a, motion_b)
}

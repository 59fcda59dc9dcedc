//! When two meshes first touch of which some are solid.

use super::impact::Impact;
use super::motion::Motion;
use super::rigid::time_of_impact;
use crate::mesh::Mesh;
use crate::query::{Solid, intersects_solid};

/// As [`time_of_impact`], with either mesh or both taken as solids: one that starts inside the other one touches at the start.
/// What starts outside meets the surface first.
///
/// ```
/// use impinge::query::Solid;
/// use impinge::sweep::{Impact, Motion, time_of_impact, time_of_impact_of_solids};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let solid = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let speck = Mesh::new(Positions::F32(vec![[1.0, 1.0, 1.0]]), vec![[0, 0, 0]])?;
/// let rest = Motion::default();
/// assert_eq!(time_of_impact(&solid, &speck, &rest, &rest), Impact::NEVER);
/// assert_eq!(time_of_impact_of_solids(&solid, &speck, &rest, &rest, Solid::A).t_upper, 0.0);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// As [`time_of_impact`]. Where a mesh is open and nothing is proved about what it contains, contact at the start is the safe
/// answer.
#[must_use]
pub fn time_of_impact_of_solids(a: &Mesh, b: &Mesh, motion_a: &Motion, motion_b: &Motion, solid: Solid) -> Impact {
    let begins_inside =
        solid != Solid::Neither && intersects_solid(a.at(motion_a.at(0.0)), b.at(motion_b.at(0.0)), solid);
    if begins_inside { Impact { t_lower: 0.0, t_upper: 0.0 } } else { time_of_impact(a, b, motion_a, motion_b) }
}

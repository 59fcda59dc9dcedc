//! Distance of two bodies by the conventions of FCL, and minus their depth if they overlap.

use impinge::budget::Budget;
use impinge::query::{Penetrates, Penetration, Query};
use pyo3::prelude::*;

use crate::arrays::row_array;
use crate::fcl_contacts::deepest;
use crate::fcl_geometry::Body;
use crate::fcl_object::{ObjectBase, Placed};
use crate::fcl_work::about_two;

/// Distance of two bodies if it is not computed because they overlap.
pub(crate) const OVERLAP: f64 = -1.0;

/// Distance of two bodies, or minus their depth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Separation {
    /// Distance, or minus the depth, in world units. [`OVERLAP`] if the depth is not computed.
    pub(crate) value: f64,
    /// Nearest or deepest point of each body in the world frame, rounded. Zero without one.
    pub(crate) points: [[f64; 3]; 2],
    /// Index of the nearest face of each body; -1 without faces.
    pub(crate) faces: [i64; 2],
}

/// Returns the distance of two objects, their faces, and, if `details` is set, their nearest points
/// as an array, (2, 3), otherwise `None`.
#[pyfunction]
pub(crate) fn fcl_distance<'py>(
    a: &Bound<'py, ObjectBase>,
    b: &Bound<'py, ObjectBase>,
    is_signed: bool,
    details: bool,
) -> PyResult<(f64, i64, i64, Option<Bound<'py, PyAny>>)> {
    let py = a.py();
    let [a, b] = [(a, "pose_a"), (b, "pose_b")].map(|(own, name)| own.get().object.placed(name));
    let placed = [a.map_err(|fault| fault.raised(py))?, b.map_err(|fault| fault.raised(py))?];
    let found = about_two(py, placed, true, move |a, b, budget| separation(a, b, is_signed, budget))?;
    let points = if details { Some(row_array(py, found.points.to_vec(), &[2])?) } else { None };
    Ok((found.value, found.faces[0], found.faces[1], points))
}

/// Maximum number of faces of a convex solid whose distance is measured by its hull. Building the
/// hull of more faces takes longer than a search among them.
const MAX_FACES_OF_HULL: u64 = 1 << 8;

/// Returns the distance of two bodies. It is infinite if a body is empty, 0 if two surfaces
/// intersect or two solids only touch, and -1 if two other bodies collide. If `is_signed` is set
/// and both bodies are solid, it is minus their depth instead of -1. Distance and depth are upper
/// bounds.
pub(crate) fn separation(a: &Placed, b: &Placed, is_signed: bool, budget: &Budget<'_>) -> Separation {
    let query = || Query::new().with_budget(budget);
    let are_solids = a.body.is_solid && b.body.is_solid;
    let are_surfaces = !a.body.is_solid && !b.body.is_solid;
    let are_meshes = a.mesh().is_some() && b.mesh().is_some();
    let is_small = |body: &Body| body.weight <= MAX_FACES_OF_HULL;
    let are_few = is_small(&a.body) && is_small(&b.body);
    let by_faces = are_meshes && !(are_solids && are_few && a.body.is_convex() && b.body.is_convex());
    let far = if by_faces { query().distance(&a.shape, &b.shape) } else { query().distance(a.hull(), b.hull()) };
    let points = far.points().unwrap_or_default();
    let faces = far.witness.and_then(|witness| witness.faces).map_or([-1; 2], |faces| faces.map(i64::from));
    let faces = [if a.body.is_solid { -1 } else { faces[0] }, if b.body.is_solid { -1 } else { faces[1] }];
    let value = far.distance();
    if value > 0.0 || are_surfaces {
        return Separation { value, points, faces };
    }
    let overlap = Separation { value: OVERLAP, points: [[0.0; 3]; 2], faces };
    if !are_solids {
        return overlap;
    }
    let touch = Separation { value: 0.0, points, faces };
    let are_convex = a.body.is_convex() && b.body.is_convex();
    if !are_convex && query().penetrates(&a.shape, &b.shape) == Penetrates::No {
        return touch;
    }
    if !are_convex && !is_signed {
        return overlap;
    }
    let Penetration { lower, upper, point_a, point_b, .. } = deepest(a, b, budget);
    let is_proved = !are_convex || lower > 0.0;
    if !is_proved && (upper == 0.0 || (are_meshes && query().penetrates(&a.shape, &b.shape) == Penetrates::No)) {
        return touch;
    }
    match is_signed {
        true => Separation { value: -upper, points: [point_a, point_b], faces },
        // Round bodies that may only touch are not reported to overlap.
        false if !is_proved && !are_meshes => touch,
        false => overlap,
    }
}

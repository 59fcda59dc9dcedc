//! Contacts of two bodies as `impinge.fcl` and `impinge.trimesh` define them: pairs of faces, or one
//! contact without faces, each with a point, a normal and a depth.

use impinge::budget::Budget;
use impinge::query::{self, ContactPatch, Penetration, Query};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::fcl_object::{ObjectBase, Placed};
use crate::fcl_work::about_two;

/// Faces of a contact that has none.
const NO_FACES: [i64; 2] = [-1; 2];

/// Contact of two bodies.
#[derive(Clone)]
pub(crate) struct Contact {
    /// Indices of the two faces, or -1 twice.
    pub(crate) faces: [i64; 2],
    /// Common point of the bodies in the world frame, rounded.
    pub(crate) point: [f64; 3],
    /// Normal of length 1 from the first body to the second, in the world frame.
    pub(crate) normal: [f64; 3],
    /// Depth in world units, at least zero.
    pub(crate) depth: f64,
}

/// Contacts to find.
#[derive(Clone, Copy)]
pub(crate) struct Wanted {
    /// Maximum number of contacts.
    pub(crate) limit: usize,
    /// Whether points, normals and depths are computed. They are zero otherwise.
    pub(crate) details: bool,
}

/// Returns the contacts of two objects, or `None` if there are none: a list with a tuple for
/// each. It has the two faces and, if `details` is set, the point, (3,), normal, (3,), and depth.
#[pyfunction]
pub(crate) fn fcl_collide<'py>(
    a: &Bound<'py, ObjectBase>,
    b: &Bound<'py, ObjectBase>,
    limit: &Bound<'py, PyAny>,
    details: bool,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let py = a.py();
    let wanted = Wanted { limit: whole(limit)?, details };
    let [a, b] = [(a, "pose_a"), (b, "pose_b")].map(|(own, name)| own.get().object.placed(name));
    let [a, b] = [a.map_err(|fault| fault.raised(py))?, b.map_err(|fault| fault.raised(py))?];
    if wanted.limit == 0 || a.is_apart_from(&b) {
        return Ok(None);
    }
    let is_one_thread = wanted.limit == 1 && !details;
    let found = about_two(py, [a, b], is_one_thread, move |a, b, budget| contacts(a, b, wanted, budget))?;
    if found.is_empty() {
        return Ok(None);
    }
    let rows = found.into_iter().map(|Contact { faces: [face_a, face_b], point, normal, depth }| {
        let faces = (face_a, face_b);
        if !details {
            return Ok((faces,).into_pyobject(py)?.into_any());
        }
        let [point, normal] = [point, normal].map(|vector| PyArray1::from_slice(py, &vector));
        Ok((faces, (point, normal, depth)).into_pyobject(py)?.into_any())
    });
    Ok(Some(PyList::new(py, rows.collect::<PyResult<Vec<_>>>()?)?.into_any()))
}

/// Returns a maximum number of contacts.
fn whole(limit: &Bound<'_, PyAny>) -> PyResult<usize> {
    if limit.is_exact_instance_of::<pyo3::types::PyInt>()
        && let Ok(limit) = limit.extract()
    {
        return Ok(limit);
    }
    limit.py().import("impinge._scalars")?.call_method1("whole", (limit, "num_max_contacts"))?.extract()
}

/// Returns the contacts of two bodies: none if and only if they are apart or the limit is zero.
pub(crate) fn contacts(a: &Placed, b: &Placed, wanted: Wanted, budget: &Budget<'_>) -> Vec<Contact> {
    if a.is_apart_from(b) || wanted.limit == 0 {
        return Vec::new();
    }
    let (Some(mesh_a), Some(mesh_b)) = (a.mesh(), b.mesh()) else { return of_shapes(a, b, wanted, budget) };
    let query = || Query::new().with_budget(budget);
    if wanted.details && !(a.body.is_solid && b.body.is_solid) {
        let found = of_patches(a, b, wanted.limit);
        return if found.is_empty() { of_contained(a, b, wanted, budget) } else { found };
    }
    let pairs = match wanted.limit {
        1 => query().any_intersecting_pair(mesh_a, mesh_b).into_iter().collect(),
        usize::MAX => query().intersecting_pairs(mesh_a, mesh_b),
        limit => query().intersecting_pairs_up_to(mesh_a, mesh_b, limit).pairs,
    };
    if pairs.is_empty() {
        return of_contained(a, b, wanted, budget);
    }
    let faces = pairs.iter().map(|pair| pair.map(i64::from));
    if !wanted.details {
        return faces.map(bare).collect();
    }
    let points = query::common_points(mesh_a, mesh_b, &pairs);
    let Penetration { normal, upper: depth, .. } = deepest(a, b, budget);
    faces.zip(points).map(|(faces, point)| Contact { faces, point, normal, depth }).collect()
}

/// Returns a contact without a point and a normal.
fn bare(faces: [i64; 2]) -> Contact {
    Contact { faces, point: [0.0; 3], normal: [0.0; 3], depth: 0.0 }
}

/// Returns the contacts of two surfaces, or of a surface and a solid: pairs of faces with the normal
/// and the depth of the region that they belong to.
fn of_patches(a: &Placed, b: &Placed, limit: usize) -> Vec<Contact> {
    let (Some(mesh_a), Some(mesh_b)) = (a.mesh(), b.mesh()) else { return Vec::new() };
    let patches = query::contact_patches(mesh_a, mesh_b);
    let of_patch = |patch: &ContactPatch| {
        let (normal, depth) = (patch.normal, patch.depth);
        patch.pairs.iter().map(move |&pair| (pair, normal, depth)).collect::<Vec<_>>()
    };
    let mut rows: Vec<_> = patches.iter().flat_map(of_patch).collect();
    rows.sort_unstable_by_key(|(pair, ..)| *pair);
    rows.truncate(limit);
    let pairs: Vec<[u32; 2]> = rows.iter().map(|(pair, ..)| *pair).collect();
    let points = query::common_points(mesh_a, mesh_b, &pairs);
    let of_row = |((pair, normal, depth), point): (([u32; 2], _, _), _)| Contact {
        faces: pair.map(i64::from),
        point,
        normal,
        depth,
    };
    rows.into_iter().zip(points).map(of_row).collect()
}

/// Returns the contact of two meshes whose surfaces are apart, if one is inside the other, a solid.
fn of_contained(a: &Placed, b: &Placed, wanted: Wanted, budget: &Budget<'_>) -> Vec<Contact> {
    let (Some(mesh_a), Some(mesh_b)) = (a.mesh(), b.mesh()) else { return Vec::new() };
    let Some(point) = query::contained_point(mesh_a, mesh_b) else { return Vec::new() };
    if !wanted.details {
        return vec![bare(NO_FACES)];
    }
    let Penetration { normal, upper: depth, .. } = deepest(a, b, budget);
    vec![Contact { faces: NO_FACES, point, normal, depth }]
}

/// Returns the contacts of two bodies, at least one of them without a mesh: the deepest first.
fn of_shapes(a: &Placed, b: &Placed, wanted: Wanted, budget: &Budget<'_>) -> Vec<Contact> {
    let query = || Query::new().with_budget(budget);
    if wanted.limit == 1 && !wanted.details {
        return if query().intersects(a.hull(), b.hull()) { vec![bare(NO_FACES)] } else { Vec::new() };
    }
    let manifolds = query().contacts(a.hull(), b.hull());
    let mut found: Vec<Contact> = Vec::new();
    for manifold in &manifolds {
        found.extend(manifold.points.iter().map(|at| {
            let point = std::array::from_fn(|k| at.point_a[k] / 2.0 + at.point_b[k] / 2.0);
            Contact { faces: NO_FACES, point, normal: manifold.normal, depth: at.upper }
        }));
    }
    found.sort_by(|one, other| other.depth.total_cmp(&one.depth));
    found.truncate(wanted.limit);
    for contact in &mut found {
        contact.depth = contact.depth.max(0.0);
    }
    found
}

/// Returns the penetration of two bodies that intersect. It is zero if their hulls are apart, which
/// rounding may cause.
pub(crate) fn deepest(a: &Placed, b: &Placed, budget: &Budget<'_>) -> Penetration {
    let found = Query::new().with_budget(budget).penetration(a.hull(), b.hull());
    found.unwrap_or(Penetration { upper: 0.0, ..Penetration::UNKNOWN })
}

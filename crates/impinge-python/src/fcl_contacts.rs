//! Contacts of two bodies as `impinge.fcl` and `impinge.trimesh` define them: pairs of faces, or
//! one contact without faces, each with a point, a normal and a depth.

use std::collections::HashMap;

use impinge::budget::Budget;
use impinge::query::{self, ContactPatch, Penetration, Query};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::fcl_object::{ObjectBase, Placed};
use crate::fcl_work::about_two;

/// Indices of the two faces of a contact, or -1 twice if it has no faces.
pub(crate) type Faces = [i64; 2];

/// Faces of a contact that has none.
const NO_FACES: Faces = [-1; 2];

/// Where two bodies are in contact.
#[derive(Clone, Copy, Default)]
pub(crate) struct Detail {
    /// Common point of the bodies in the world frame, rounded.
    pub(crate) point: [f64; 3],
    /// Normal of length 1 from the first body to the second, in the world frame.
    pub(crate) normal: [f64; 3],
    /// Depth in world units, at least zero.
    pub(crate) depth: f64,
}

/// Returns the contacts of two objects, or `None` without contact: a list with a tuple for
/// each. It has the two faces and, if `details` is set, the point, (3,), normal, (3,), and depth.
#[pyfunction]
pub(crate) fn fcl_collide<'py>(
    a: &Bound<'py, ObjectBase>,
    b: &Bound<'py, ObjectBase>,
    limit: &Bound<'py, PyAny>,
    details: bool,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let py = a.py();
    let limit = whole(limit)?;
    let [a, b] = [(a, "pose_a"), (b, "pose_b")].map(|(own, name)| own.get().object.placed(name));
    let [a, b] = [a.map_err(|fault| fault.raised(py))?, b.map_err(|fault| fault.raised(py))?];
    if limit == 0 || a.is_apart_from(&b) {
        return Ok(None);
    }
    let found = about_two(py, [a, b], limit == 1 && !details, move |a, b, budget| {
        if details && !(a.mesh().is_some() && b.mesh().is_some()) {
            let mut found = of_shapes(a, b, budget);
            found.truncate(limit);
            return (vec![NO_FACES; found.len()], found);
        }
        let faces = contacts(a, b, limit, budget);
        let found = if details { details_of(a, b, &faces, budget) } else { Vec::new() };
        (faces, found)
    })?;
    if found.0.is_empty() {
        return Ok(None);
    }
    let faces = found.0.into_iter().map(|[face_a, face_b]| (face_a, face_b));
    if !details {
        return Ok(Some(PyList::new(py, faces.map(|faces| (faces,)).collect::<Vec<_>>())?.into_any()));
    }
    let rows = faces.zip(found.1).map(|(faces, Detail { point, normal, depth })| {
        let [point, normal] = [point, normal].map(|vector| PyArray1::from_slice(py, &vector));
        (faces, (point, normal, depth))
    });
    Ok(Some(PyList::new(py, rows.collect::<Vec<_>>())?.into_any()))
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

/// Returns the faces of at most `limit` contacts of two bodies: none if and only if they are apart.
/// A body without a mesh has no faces, but as many contacts as
/// [`contacts`](impinge::query::contacts) returns. The limit must be at least one.
pub(crate) fn contacts(a: &Placed, b: &Placed, limit: usize, budget: &Budget<'_>) -> Vec<Faces> {
    if a.is_apart_from(b) {
        return Vec::new();
    }
    let query = || Query::new().with_budget(budget);
    let (Some(mesh_a), Some(mesh_b)) = (a.mesh(), b.mesh()) else {
        let count = match limit {
            1 => usize::from(query().intersects(a.hull(), b.hull())),
            limit => of_shapes(a, b, budget).len().min(limit),
        };
        return vec![NO_FACES; count];
    };
    let pairs = match limit {
        1 => query().any_intersecting_pair(mesh_a, mesh_b).into_iter().collect(),
        usize::MAX => query().intersecting_pairs(mesh_a, mesh_b),
        limit => query().intersecting_pairs_up_to(mesh_a, mesh_b, limit).pairs,
    };
    if pairs.is_empty() && query::contained_point(mesh_a, mesh_b).is_some() {
        return vec![NO_FACES];
    }
    pairs.into_iter().map(|pair| pair.map(i64::from)).collect()
}

/// Returns the details of contacts, given their faces, which [`contacts`] returned.
///
/// Two convex solids, or a body inside a solid, have a single normal and depth, the shortest way to
/// separate them. A contact of a body without a mesh has its own normal and depth. Other pairs have
/// those of the region in which the surfaces penetrate each other.
pub(crate) fn details_of(a: &Placed, b: &Placed, faces: &[Faces], budget: &Budget<'_>) -> Vec<Detail> {
    let (Some(mesh_a), Some(mesh_b)) = (a.mesh(), b.mesh()) else {
        let mut details = of_shapes(a, b, budget);
        details.truncate(faces.len());
        return details;
    };
    let solids_detail = || {
        let Penetration { normal, upper: depth, .. } = deepest(a, b, budget);
        Detail { normal, depth, ..Detail::default() }
    };
    if faces == [NO_FACES] {
        return vec![Detail { point: query::contained_point(mesh_a, mesh_b).unwrap_or_default(), ..solids_detail() }];
    }
    let pairs: Vec<[u32; 2]> = faces.iter().map(|faces| faces.map(|face| face as u32)).collect();
    let points = query::common_points(mesh_a, mesh_b, &pairs);
    if a.body.is_solid && b.body.is_solid {
        let common = if pairs.is_empty() { Detail::default() } else { solids_detail() };
        return points.into_iter().map(|point| Detail { point, ..common }).collect();
    }
    let patches = query::contact_patches(mesh_a, mesh_b);
    let of_patch = |patch: &ContactPatch| {
        let found = Detail { normal: patch.normal, depth: patch.depth, ..Detail::default() };
        patch.pairs.iter().map(move |&pair| (pair, found)).collect::<Vec<_>>()
    };
    let found: HashMap<[u32; 2], Detail> = patches.iter().flat_map(of_patch).collect();
    let detail = |(pair, point)| Detail { point, ..found.get(pair).copied().unwrap_or_default() };
    pairs.iter().zip(points).map(detail).collect()
}

/// Returns the contacts of two bodies, at least one of them without a mesh: the deepest first.
fn of_shapes(a: &Placed, b: &Placed, budget: &Budget<'_>) -> Vec<Detail> {
    let mut found: Vec<Detail> = Vec::new();
    for manifold in Query::new().with_budget(budget).contacts(a.hull(), b.hull()) {
        found.extend(manifold.points.iter().map(|at| {
            let point = std::array::from_fn(|k| at.point_a[k] / 2.0 + at.point_b[k] / 2.0);
            Detail { point, normal: manifold.normal, depth: at.upper }
        }));
    }
    found.sort_by(|one, other| other.depth.total_cmp(&one.depth));
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

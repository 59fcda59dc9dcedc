//! Reports about a mesh: its health, its repair, and the quality of its hierarchy.

use impinge::hierarchy::TreeStatistics;
use impinge::mesh::{Health, Repair, RepairOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::array;
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::{MeshBase, mesh_of};
use crate::workers;

/// Computes the health of a mesh, as a dict of the fields of `impinge.Health`.
#[pyfunction]
pub(crate) fn health<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
    let Health {
        degenerate_faces,
        duplicate_faces,
        duplicate_vertices,
        unused_vertices,
        open_edges,
        non_manifold_edges,
        misoriented_edges,
        components,
        double_coordinates,
    } = workers::run(py, move |_| mesh.health())?;
    let counts = [
        ("degenerate_faces", degenerate_faces),
        ("duplicate_faces", duplicate_faces),
        ("duplicate_vertices", duplicate_vertices),
        ("unused_vertices", unused_vertices),
        ("open_edges", open_edges),
        ("non_manifold_edges", non_manifold_edges),
        ("misoriented_edges", misoriented_edges),
        ("components", components),
        ("double_coordinates", double_coordinates),
    ];
    let named = PyDict::new(py);
    counts.iter().try_for_each(|(name, count)| named.set_item(name, count))?;
    Ok(named)
}

/// Returns a tolerance in mesh units at which welding closes the mesh, or `None` if there is none.
#[pyfunction]
pub(crate) fn closing_tolerance(mesh: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
    workers::run(py, move |_| mesh.closing_tolerance())
}

/// Returns the repaired mesh, and a dict of the fields of `impinge.Repair`. `weld` is a distance in
/// mesh units, or `None` for that of `RepairOptions::closing`.
#[pyfunction]
pub(crate) fn repaired<'py>(
    mesh: &Bound<'py, PyAny>,
    weld: Option<f64>,
    orient: bool,
) -> PyResult<(MeshBase, Bound<'py, PyDict>)> {
    let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
    let (mesh, repair) = workers::run(py, move |_| {
        let weld = weld.unwrap_or_else(|| RepairOptions::closing(&mesh).weld);
        mesh.repaired(RepairOptions { weld, orient })
    })?
    .map_err(|error| {
        let (kind, _) = kind_and_place(&error);
        Fault::new(kind, "weld", message(&error)).raised(py)
    })?;
    Ok((MeshBase::of(&mesh), fields_of(py, repair)?))
}

/// Computes the quality of a mesh's hierarchy, as a dict of the fields of `impinge.TreeStatistics`.
#[pyfunction]
pub(crate) fn tree_statistics<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
    let TreeStatistics { inner, leaves, depth, sah, overlap, node_fill, leaf_fill, bytes } =
        workers::run(py, move |_| mesh.tree_statistics())?;
    let named = PyDict::new(py);
    for (name, count) in [("inner", inner), ("leaves", leaves), ("depth", depth), ("bytes", bytes)] {
        named.set_item(name, count)?;
    }
    for (name, share) in [("sah", sah), ("overlap", overlap), ("node_fill", node_fill), ("leaf_fill", leaf_fill)] {
        named.set_item(name, share)?;
    }
    Ok(named)
}

fn fields_of(py: Python<'_>, repair: Repair) -> PyResult<Bound<'_, PyDict>> {
    let Repair { welded_vertices, greatest_move, turned_faces, one_sided_faces, degenerate_faces, duplicate_faces } =
        repair;
    let named = PyDict::new(py);
    named.set_item("greatest_move", greatest_move)?;
    for (name, numbers) in [
        ("welded_vertices", welded_vertices),
        ("turned_faces", turned_faces),
        ("one_sided_faces", one_sided_faces),
        ("degenerate_faces", degenerate_faces),
        ("duplicate_faces", duplicate_faces),
    ] {
        let len = numbers.len();
        named.set_item(name, array(py, numbers, &[len])?)?;
    }
    Ok(named)
}

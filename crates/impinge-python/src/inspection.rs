//! What a mesh may suffer from, and how good its hierarchy is.

use impinge::hierarchy::TreeStatistics;
use impinge::mesh::Health;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::mesh::mesh_of;
use crate::workers;

/// The fields of `impinge.Health`.
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

/// The fields of `impinge.TreeStatistics`.
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

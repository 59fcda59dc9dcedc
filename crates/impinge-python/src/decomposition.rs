//! Division of solids into convex parts.

use impinge::mesh::{ConvexPart, DecompositionOptions};
use pyo3::prelude::*;

use crate::arrays::row_array;
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::mesh_of;
use crate::workers;

/// Vertices and faces of a hull, and the bounds of its concavity.
type Part<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, f64, f64);

/// Returns the convex parts of the solid of a mesh, and whether their concavity is at most the one
/// that was asked for. `None` asks for the default.
#[pyfunction]
pub(crate) fn convex_parts<'py>(
    mesh: &Bound<'py, PyAny>,
    concavity: Option<f64>,
    max_parts: usize,
) -> PyResult<(Vec<Part<'py>>, bool)> {
    let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
    let options = DecompositionOptions { concavity, max_parts };
    let found = workers::run(py, move |budget| mesh.convex_parts(options, budget))?.map_err(|error| {
        let (kind, _) = kind_and_place(&error);
        let argument = match kind {
            "open" | "empty" => "mesh",
            "out-of-range" => "max_parts",
            _ => "concavity",
        };
        Fault::new(kind, argument, message(&error)).hint(error.hint()).raised(py)
    })?;
    let part = |part: &ConvexPart| {
        let (positions, faces) = (part.hull.positions().to_vec(), part.hull.faces().to_vec());
        let counts = [positions.len(), faces.len()];
        let arrays = (row_array(py, positions, &counts[..1])?, row_array(py, faces, &counts[1..])?);
        Ok((arrays.0, arrays.1, part.concavity_lower, part.concavity_upper))
    };
    Ok((found.parts().iter().map(part).collect::<PyResult<_>>()?, found.is_within()))
}

//! Surfaces whose vertices move along lines, and the features that touch on the way.

use std::sync::Arc;

use impinge::budget::Budget;
use impinge::sweep::{Deforming, Features, SweptContact};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::errors::{Fault, kind_and_place, message};
use crate::limits;
use crate::mesh::read_faces;
use crate::points::Points;
use crate::workers;

/// Exponent of the largest magnitude of a coordinate, 2^126.
const EXPONENT: i32 = 126;

/// Contents of `impinge.ccd.Deforming`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct DeformingCore(Arc<Deforming<'static>>);

#[pymethods]
impl DeformingCore {
    /// Makes a surface of faces as `impinge._arrays` makes them, (m, 3), and the positions of its
    /// vertices at both ends of the motion, (n, 3).
    #[new]
    fn new(faces: &Bound<'_, PyAny>, t0: &Bound<'_, PyAny>, t1: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = faces.py();
        let [t0, t1] = [rows(t0, "t0")?, rows(t1, "t1")?];
        if t1.len() != t0.len() {
            let text = format!("has {} vertices, but t0 has {}", t1.len(), t0.len());
            return Err(Fault::new("shape", "t1", text).raised(py));
        }
        let faces = read_faces(faces, t0.len())?;
        let made = workers::run(py, move |_| Deforming::owned(faces, t0, t1))?;
        let made = made.map_err(|error| {
            let (kind, at) = kind_and_place(&error);
            Fault::new(kind, "faces", message(&error)).at(at).hint(error.hint()).raised(py)
        })?;
        Ok(Self(Arc::new(made)))
    }

    /// Returns the contacts with another surface: for each the kind, the vertices or the face of
    /// either surface, and both bounds of the time.
    fn contacts<'py>(&self, other: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, one, other) = (other.py(), self.0.clone(), other.get().0.clone());
        columns(py, move |budget| one.contacts_within(&other, budget))
    }

    /// Returns the contacts of the surface with itself, as `contacts` does.
    fn self_contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let one = self.0.clone();
        columns(py, move |budget| one.self_contacts_within(budget))
    }
}

/// Returns the rows of an array of points, (n, 3).
fn rows(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[f64; 3]>> {
    let Points { shape, rows } = Points::read(value, name, EXPONENT)?;
    if shape.len() != 1 {
        return Err(
            Fault::new("shape", name, "(n, 3) positions are expected, a row for each vertex").raised(value.py())
        );
    }
    Ok(rows)
}

/// Returns contacts as columns: the kind (0 for a vertex and a face, 1 for a face and a vertex, 2
/// for two edges), the features of both surfaces, (n, 2) each, with -1 after a vertex or a face,
/// and both bounds of the time.
fn columns<'py>(
    py: Python<'py>,
    find: impl FnOnce(&Budget<'_>) -> Result<Vec<SweptContact>, impinge::budget::Stopped> + Send + 'static,
) -> PyResult<Bound<'py, PyAny>> {
    let found = workers::run(py, find)?.map_err(limits::raised)?;
    let count = found.len();
    let single = |index: u32| [i64::from(index), -1];
    let features = |contact: &SweptContact| match contact.features {
        Features::VertexFace { vertex, face } => (0_u8, single(vertex), single(face)),
        Features::FaceVertex { face, vertex } => (1, single(face), single(vertex)),
        Features::EdgeEdge { edge_a, edge_b } => (2, edge_a.map(i64::from), edge_b.map(i64::from)),
    };
    let features: Vec<(u8, [i64; 2], [i64; 2])> = found.iter().map(features).collect();
    let columns = (
        array(py, features.iter().map(|row| row.0).collect(), &[count])?,
        row_array(py, features.iter().map(|row| row.1).collect(), &[count])?,
        row_array(py, features.iter().map(|row| row.2).collect(), &[count])?,
        array(py, found.iter().map(|contact| contact.impact.t_lower).collect(), &[count])?,
        array(py, found.iter().map(|contact| contact.impact.t_upper).collect(), &[count])?,
    );
    Ok(columns.into_pyobject(py)?.into_any())
}

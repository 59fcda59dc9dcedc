//! The mesh as Python holds it.

use impinge::{Mesh, Positions};
use numpy::{Element, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::arrays::{read_only, row_array};
use crate::errors::{Fault, kind_and_place, message};
use crate::model::Model;
use crate::workers;

/// What `impinge.Mesh` inherits: the mesh, and its arrays once somebody has asked for them.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct MeshBase {
    mesh: Mesh,
    /// Whether the vertices came in double precision, and are to be shown so.
    is_double: bool,
    vertices: PyOnceLock<Py<PyAny>>,
    faces: PyOnceLock<Py<PyAny>>,
}

#[pymethods]
impl MeshBase {
    /// Of a `Model`, or of arrays as `impinge._arrays` makes them: (n, 3) f32 or f64, and (m, 3) integers.
    #[new]
    fn new(source: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = source.py();
        let (positions, faces, count) = match source.cast::<Model>() {
            Ok(model) => {
                let (positions, faces) = model.get().triangles();
                let count = positions.len();
                (positions, faces, count)
            }
            Err(_) => {
                let positions = read_positions(source)?;
                let count = positions.len();
                (positions, read_faces(faces, count)?, count)
            }
        };
        let is_double = matches!(positions, Positions::F64(_));
        let mesh = workers::run(py, move |_| Mesh::new(positions, faces))?.map_err(|error| {
            let (kind, at) = kind_and_place(&error);
            let names_faces = kind == "index-out-of-bounds" || (kind == "too-many" && count <= u32::MAX as usize);
            let argument = if names_faces { "faces" } else { "vertices" };
            Fault::new(kind, argument, message(&error)).at(at).hint(error.hint()).raised(py)
        })?;
        Ok(Self { mesh, is_double, vertices: PyOnceLock::new(), faces: PyOnceLock::new() })
    }

    /// Read-only; made when first asked for.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let made = self.vertices.get_or_try_init(py, || {
            let lead = [self.mesh.positions().len()];
            let made = match self.mesh.positions() {
                Positions::F32(v) if self.is_double => {
                    row_array(py, v.iter().map(|v| v.map(f64::from)).collect(), &lead)?
                }
                Positions::F32(v) => row_array(py, v.clone(), &lead)?,
                Positions::F64(v) => row_array(py, v.clone(), &lead)?,
            };
            read_only(made)
        })?;
        Ok(made.bind(py).clone())
    }

    /// Read-only; made when first asked for.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let made = self.faces.get_or_try_init(py, || {
            let faces = self.mesh.faces();
            read_only(row_array(py, faces.to_vec(), &[faces.len()])?)
        })?;
        Ok(made.bind(py).clone())
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.mesh.positions().len()
    }

    #[getter]
    fn face_count(&self) -> usize {
        self.mesh.faces().len()
    }

    #[getter]
    fn is_closed(&self, py: Python<'_>) -> PyResult<bool> {
        let mesh = self.mesh.clone();
        workers::run(py, move |_| mesh.is_closed())
    }

    /// Bytes, beside the arrays that were asked for.
    #[getter]
    fn memory(&self) -> usize {
        self.mesh.memory()
    }
}

/// The mesh that an argument is.
///
/// # Errors
/// `InputError` where it is something else.
pub(crate) fn mesh_of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Mesh> {
    match value.cast::<MeshBase>() {
        Ok(base) => Ok(base.get().mesh.clone()),
        Err(_) => {
            let message = format!("must be an impinge.Mesh, not {}", value.get_type().qualname()?);
            let hint = Some("impinge.Mesh(...) makes one of arrays or of a trimesh.Trimesh, once for many questions");
            Err(Fault::new("type", name, message).hint(hint).raised(value.py()))
        }
    }
}

/// Positions of an array as `impinge._arrays` makes them: (n, 3) f32 or f64.
pub(crate) fn read_positions(vertices: &Bound<'_, PyAny>) -> PyResult<Positions> {
    Ok(match vertices.cast::<PyArray2<f32>>() {
        Ok(single) => Positions::F32(triples(&single.readonly())?),
        Err(_) => Positions::F64(triples(&vertices.cast::<PyArray2<f64>>()?.readonly())?),
    })
}

fn triples<T: Element + Copy>(array: &PyReadonlyArray2<'_, T>) -> PyResult<Vec<[T; 3]>> {
    Ok(array.as_slice()?.as_chunks::<3>().0.to_vec())
}

fn read_faces(faces: &Bound<'_, PyAny>, vertices: usize) -> PyResult<Vec<[u32; 3]>> {
    if let Ok(faces) = faces.cast::<PyArray2<u32>>() {
        return triples(&faces.readonly());
    }
    if let Ok(faces) = faces.cast::<PyArray2<i32>>() {
        return narrowed(&faces.readonly(), vertices);
    }
    if let Ok(faces) = faces.cast::<PyArray2<i64>>() {
        return narrowed(&faces.readonly(), vertices);
    }
    narrowed(&faces.cast::<PyArray2<u64>>()?.readonly(), vertices)
}

/// Indices of another width; one that 32 bits cannot hold is named here, as the library could not be told of it.
fn narrowed<T>(faces: &PyReadonlyArray2<'_, T>, vertices: usize) -> PyResult<Vec<[u32; 3]>>
where
    T: Element + Copy + std::fmt::Display + TryInto<u32>,
{
    let py = faces.py();
    let mut narrow = Vec::with_capacity(faces.shape()[0]);
    for (row, face) in faces.as_slice()?.as_chunks::<3>().0.iter().enumerate() {
        let mut corners = [0; 3];
        for (corner, index) in face.iter().enumerate() {
            corners[corner] = (*index).try_into().map_err(|_| {
                let message = format!("face {row} names vertex {index}, but there are {vertices} vertices");
                let hint =
                    index.to_string().starts_with('-').then_some("indices count from zero and do not wrap round");
                Fault::new("index-out-of-bounds", "faces", message).at(vec![row]).hint(hint).raised(py)
            })?;
        }
        narrow.push(corners);
    }
    Ok(narrow)
}

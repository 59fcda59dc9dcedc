//! The mesh in Python.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use impinge::hierarchy::Builder;
use impinge::volume::Proxies;
use impinge::{Mesh, Positions};
use impinge_files::{Baked, LoadError};
use numpy::{Element, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::arrays::{read_only, row_array};
use crate::errors::{Fault, kind_and_place, load_error, message};
use crate::model::{Content, Model};
use crate::workers;

/// Maximum number of faces and of vertices of a mesh that the caller's thread builds. It takes less
/// than a millisecond. Waking other threads pays only for larger meshes.
const MAX_FACES_AT_ONCE: usize = 1 << 12;

/// Base class of `impinge.Mesh`: the current mesh, and the array of its faces once it was
/// requested.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct MeshBase {
    /// Current state. The lock is held only to read or replace it.
    state: Mutex<State>,
    faces: Arc<PyOnceLock<Py<PyAny>>>,
}

/// A mesh with its current vertices.
#[derive(Clone)]
struct State {
    mesh: Mesh,
    /// Whether the vertices were given in double precision and are returned in it.
    is_double: bool,
    /// Array of the vertices, once it was requested.
    vertices: Arc<PyOnceLock<Py<PyAny>>>,
    /// Proxies of the mesh, once they were requested. An empty mesh has no proxies.
    proxies: Arc<OnceLock<Option<Proxies>>>,
    /// Baked file that the mesh comes from, which may hold its proxies. Absent after a change.
    baked: Option<Arc<Baked>>,
    /// Whether a query has computed the values derived from the mesh that decide about points.
    is_prepared: Arc<AtomicBool>,
}

impl State {
    fn new(mesh: Mesh, is_double: bool) -> Self {
        Self {
            mesh,
            is_double,
            vertices: Arc::new(PyOnceLock::new()),
            proxies: Arc::default(),
            baked: None,
            is_prepared: Arc::default(),
        }
    }
}

impl MeshBase {
    /// Returns the base class for a mesh of the library.
    pub(crate) fn of(mesh: &Mesh) -> Self {
        Self::in_precision(mesh, !mesh.is_single_precision())
    }

    /// Returns the base class for a mesh whose vertices were given in double or single precision.
    pub(crate) fn in_precision(mesh: &Mesh, is_double: bool) -> Self {
        Self { state: Mutex::new(State::new(mesh.clone(), is_double)), faces: Arc::new(PyOnceLock::new()) }
    }

    /// Replaces the current mesh, unless `keep` reports that it stays. The old one is dropped after
    /// the lock is released, because it may run code of Python: that of the owner of lent bytes.
    fn replace(&self, state: State, keep: impl FnOnce(&State) -> bool) {
        let mut current = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let old = if keep(&current) { state } else { std::mem::replace(&mut *current, state) };
        drop(current);
        drop(old);
    }

    /// Returns a snapshot of the current mesh. Later changes do not affect the snapshot.
    fn state(&self) -> State {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

#[pymethods]
impl MeshBase {
    /// Makes a mesh from a `Model`; from arrays as `impinge._arrays` makes them, (n, 3) f32 or f64
    /// and (m, 3) integers; from an array of vertices and a mesh whose faces it uses; or from the
    /// current state of a mesh, which is shared.
    #[new]
    fn new(source: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = source.py();
        if let Ok(base) = faces.cast::<Self>() {
            let state = refitted(&base.get().state().mesh, source)?;
            return Ok(Self { state: Mutex::new(state), faces: base.get().faces.clone() });
        }
        if let Ok(base) = source.cast::<Self>() {
            let base = base.get();
            return Ok(Self { state: Mutex::new(base.state()), faces: base.faces.clone() });
        }
        let (positions, faces, count) = match source.cast::<Model>() {
            Ok(model) => match model.get().content() {
                Content::Triangles(positions, faces) => (positions.clone(), faces.clone(), positions.len()),
                Content::Baked(mesh, baked) => {
                    let state =
                        State { baked: Some(baked.clone()), ..State::new(mesh.clone(), !mesh.is_single_precision()) };
                    return Ok(Self { state: Mutex::new(state), faces: Arc::new(PyOnceLock::new()) });
                }
            },
            Err(_) => {
                let positions = read_positions(source)?;
                let count = positions.len();
                (positions, read_faces(faces, count)?, count)
            }
        };
        let is_double = matches!(positions, Positions::F64(_));
        let is_small = count.max(faces.len()) <= MAX_FACES_AT_ONCE;
        let build = move || Mesh::new(positions, faces);
        let mesh = if is_small { workers::at_once(py, build) } else { workers::run(py, move |_| build())? };
        let mesh = mesh.map_err(|error| {
            let (kind, at) = kind_and_place(&error);
            let names_faces = kind == "index-out-of-bounds" || (kind == "too-many" && count <= u32::MAX as usize);
            let argument = if names_faces { "faces" } else { "vertices" };
            Fault::new(kind, argument, message(&error)).at(at).hint(error.hint()).raised(py)
        })?;
        Ok(Self { state: Mutex::new(State::new(mesh, is_double)), faces: Arc::new(PyOnceLock::new()) })
    }

    /// Moves the vertices. A query that runs at the same time uses the mesh as it was before.
    fn move_vertices(&self, vertices: &Bound<'_, PyAny>) -> PyResult<()> {
        let state = refitted(&self.state().mesh, vertices)?;
        self.replace(state, |_| false);
        Ok(())
    }

    /// Rebuilds the hierarchy. If the vertices are moved at the same time, the move wins.
    fn rebuild(&self, py: Python<'_>, builder: &str) -> PyResult<()> {
        let builder = Builder::named(builder).ok_or_else(|| {
            let names: Vec<&str> = [Builder::Auto].into_iter().chain(Builder::ALL).map(Builder::name).collect();
            let message = format!("must be one of {}, not {builder:?}", names.join(", "));
            Fault::new("option", "builder", message).raised(py)
        })?;
        let state = self.state();
        let mut mesh = state.mesh.clone();
        let mesh = workers::run(py, move |_| {
            mesh.rebuild(builder);
            mesh
        })?;
        let vertices = state.vertices.clone();
        self.replace(State { mesh, is_prepared: Arc::default(), ..state }, |current| {
            !Arc::ptr_eq(&current.vertices, &vertices)
        });
        Ok(())
    }

    /// Returns the cost of the hierarchy relative to its cost when it was built.
    #[getter]
    fn aging(&self) -> f64 {
        self.state().mesh.aging().ratio()
    }

    /// Returns the vertices as a read-only array, which is made when it is first requested.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let State { mesh, is_double, vertices, .. } = self.state();
        let made = vertices.get_or_try_init(py, || {
            let lead = [mesh.positions().len()];
            let made = match mesh.positions() {
                Positions::F32(v) if is_double => row_array(py, v.iter().map(|v| v.map(f64::from)).collect(), &lead)?,
                Positions::F32(v) => row_array(py, v.clone(), &lead)?,
                Positions::F64(v) => row_array(py, v.clone(), &lead)?,
            };
            read_only(made)
        })?;
        Ok(made.bind(py).clone())
    }

    /// Returns the faces as a read-only array, which is made when it is first requested.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mesh = self.state().mesh;
        let made = self.faces.get_or_try_init(py, || {
            let faces = mesh.faces();
            read_only(row_array(py, faces.to_vec(), &[faces.len()])?)
        })?;
        Ok(made.bind(py).clone())
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.state().mesh.positions().len()
    }

    #[getter]
    fn face_count(&self) -> usize {
        self.state().mesh.faces().len()
    }

    #[getter]
    fn is_closed(&self, py: Python<'_>) -> PyResult<bool> {
        let mesh = self.state().mesh;
        workers::run(py, move |_| mesh.is_closed())
    }

    /// Returns the number of bytes of the mesh, without the arrays that were requested.
    #[getter]
    fn memory(&self) -> usize {
        self.state().mesh.memory()
    }
}

/// Returns the mesh with its vertices moved to the rows of an array, (n, 3) f32 or f64.
///
/// # Errors
/// `InputError` if the number of vertices differs, or if a vertex is out of range.
fn refitted(mesh: &Mesh, vertices: &Bound<'_, PyAny>) -> PyResult<State> {
    let positions = read_positions(vertices)?;
    let is_double = matches!(positions, Positions::F64(_));
    let mesh = mesh.clone();
    let moved = workers::run(vertices.py(), move |_| mesh.refitted(positions))?.map_err(|error| {
        let (kind, at) = kind_and_place(&error);
        Fault::new(kind, "vertices", message(&error)).at(at).hint(error.hint()).raised(vertices.py())
    })?;
    Ok(State::new(moved, is_double))
}

/// Returns the current mesh and its proxies. The proxies come from its baked file, after they are
/// proved to belong to the mesh, or are made when they are first requested.
///
/// # Errors
/// `InputError` if the value is not a mesh, or if its file holds the proxies of another mesh.
pub(crate) fn proxies_of(mesh: &Bound<'_, PyAny>) -> PyResult<(Mesh, Option<Proxies>)> {
    let py = mesh.py();
    mesh_of(mesh, "mesh")?;
    let State { mesh, proxies, baked, .. } = mesh.cast::<MeshBase>()?.get().state();
    let found = workers::run(py, move |_| {
        if let Some(known) = proxies.get() {
            return Ok((mesh, known.clone()));
        }
        let read = match baked {
            Some(baked) => baked.proxies(&mesh)?,
            None => None,
        };
        let found = proxies.get_or_init(|| read.or_else(|| mesh.proxies())).clone();
        Ok((mesh, found))
    })?;
    found.map_err(|error: LoadError| load_error(py, &error))
}

/// Returns the mesh of an argument.
///
/// # Errors
/// `InputError` if the argument is not an `impinge.Mesh`.
pub(crate) fn mesh_of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Mesh> {
    Ok(state_of(value, name)?.mesh)
}

/// Returns the mesh of a value, and whether the values derived from it that decide about points are
/// known. The caller sets that after a query.
///
/// # Errors
/// As for [`mesh_of`].
pub(crate) fn prepared_mesh_of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Mesh, Arc<AtomicBool>)> {
    let State { mesh, is_prepared, .. } = state_of(value, name)?;
    Ok((mesh, is_prepared))
}

fn state_of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<State> {
    match value.cast::<MeshBase>() {
        Ok(base) => Ok(base.get().state()),
        Err(_) => {
            let message = format!("must be an impinge.Mesh, not {}", value.get_type().qualname()?);
            let hint = Some("impinge.Mesh(...) makes one of arrays or of a trimesh.Trimesh, once for many questions");
            Err(Fault::new("type", name, message).hint(hint).raised(value.py()))
        }
    }
}

/// Returns the positions of an array as `impinge._arrays` makes it, (n, 3) f32 or f64.
pub(crate) fn read_positions(vertices: &Bound<'_, PyAny>) -> PyResult<Positions> {
    Ok(match vertices.cast::<PyArray2<f32>>() {
        Ok(single) => Positions::F32(triples(&single.readonly())?),
        Err(_) => Positions::F64(triples(&vertices.cast::<PyArray2<f64>>()?.readonly())?),
    })
}

fn triples<T: Element + Copy>(array: &PyReadonlyArray2<'_, T>) -> PyResult<Vec<[T; 3]>> {
    let rows = array.as_slice()?.as_chunks::<3>().0;
    let mut copy = reserved(rows.len())?;
    copy.extend_from_slice(rows);
    Ok(copy)
}

/// Returns an empty list with memory for rows of an array.
///
/// # Errors
/// `MemoryError` if the memory cannot be allocated.
fn reserved<T>(rows: usize) -> PyResult<Vec<T>> {
    let mut list = Vec::new();
    let refused = |_| PyMemoryError::new_err(format!("there is not enough memory for {rows} rows"));
    list.try_reserve_exact(rows).map_err(refused)?;
    Ok(list)
}

/// Returns the faces of an array as `impinge._arrays` makes it, (m, 3) integers.
///
/// # Errors
/// `InputError` if an index does not fit in 32 bits.
pub(crate) fn read_faces(faces: &Bound<'_, PyAny>, vertices: usize) -> PyResult<Vec<[u32; 3]>> {
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

/// Converts indices of another width. An index that does not fit in 32 bits is reported here,
/// because the library takes 32-bit indices.
fn narrowed<T>(faces: &PyReadonlyArray2<'_, T>, vertices: usize) -> PyResult<Vec<[u32; 3]>>
where
    T: Element + Copy + std::fmt::Display + TryInto<u32>,
{
    let py = faces.py();
    let mut narrow = reserved(faces.shape()[0])?;
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

//! Transforms, and geometries at a transform, of the drop-in modules `impinge.fcl` and
//! `impinge.trimesh`.
//!
//! An object keeps its placed shape until it is moved. Managers that hold the object notice
//! every move.

use std::collections::HashSet;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

use impinge::Pose;
use impinge::mesh::PlacedMesh;
use impinge::shape::PlacedShape;
use impinge::volume::MinMax;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::array;
use crate::errors::Fault;
use crate::fcl_geometry::{Body, Geometry, GeometryBase};
use crate::poses;

/// Largest magnitude of a coordinate of a box, 2^320.
const LIMIT: f64 = f64::from_bits((1023 + 320) << 52);

/// The first three rows of a pose, world from geometry.
type Rows = [[f64; 4]; 3];

const IDENTITY: Rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// Base class of `impinge.fcl.Transform`.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct TransformBase(Mutex<Rows>);

/// Base class of `impinge.fcl.CollisionObject`.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct ObjectBase {
    /// Geometry in Python.
    geometry: Py<GeometryBase>,
    pub(crate) object: Arc<Object>,
}

/// A geometry with a transform.
pub(crate) struct Object {
    geometry: Arc<Geometry>,
    state: Mutex<State>,
}

struct State {
    rows: Rows,
    /// The body at the transform, once it was requested.
    placed: Option<Arc<Placed>>,
    watchers: Vec<Watcher>,
}

/// A manager that holds an object, and the key of the object there.
struct Watcher {
    moved: Weak<Moved>,
    key: u32,
}

/// Keys of the objects of a manager that were moved since its last query.
#[derive(Default)]
pub(crate) struct Moved(Mutex<HashSet<u32>>);

/// A body at its place in the world.
pub(crate) struct Placed {
    pub(crate) body: Arc<Body>,
    pub(crate) shape: PlacedShape,
    pub(crate) pose: Pose,
    /// Box in the world frame that contains the body. `None` if the body is empty.
    pub(crate) bounds: Option<MinMax>,
    hull: OnceLock<PlacedShape>,
}

#[pymethods]
impl TransformBase {
    /// Makes the identity. The subclass reads the arguments.
    #[new]
    #[pyo3(signature = (*_arguments, **_named))]
    fn new(_arguments: &Bound<'_, PyTuple>, _named: Option<&Bound<'_, PyDict>>) -> Self {
        Self(Mutex::new(IDENTITY))
    }

    /// Reads the arguments if they are another transform, or arrays of doubles in the usual shapes:
    /// (3, 3), (3,), or both. Returns whether they are.
    fn _read(&self, arguments: &Bound<'_, PyTuple>) -> PyResult<bool> {
        let mut rows = IDENTITY;
        let is_read = match &arguments.iter().collect::<Vec<_>>()[..] {
            [] => true,
            [only] => match only.cast::<Self>() {
                Ok(other) => {
                    rows = *other.get().rows();
                    true
                }
                Err(_) => set_translation(&mut rows, plain(only, &[3])) || set_linear(&mut rows, plain(only, &[3, 3])),
            },
            [linear, translation] => {
                set_linear(&mut rows, plain(linear, &[3, 3])) && set_translation(&mut rows, plain(translation, &[3]))
            }
            _ => false,
        };
        if is_read {
            *self.rows() = rows;
        }
        Ok(is_read)
    }

    /// Returns the pose, (4, 4), world from geometry.
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix_of(py, &self.rows())
    }

    /// Sets the linear part, (3, 3).
    fn _set_linear(&self, linear: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
        let linear = numbers(linear, &[3, 3], name)?;
        set_linear(&mut self.rows(), Some(linear));
        Ok(())
    }

    /// Sets the translation, (3,).
    fn _set_translation(&self, translation: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
        let translation = numbers(translation, &[3], name)?;
        set_translation(&mut self.rows(), Some(translation));
        Ok(())
    }
}

impl TransformBase {
    fn rows(&self) -> MutexGuard<'_, Rows> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl ObjectBase {
    /// Makes an object of a geometry and a transform, `None` for the identity.
    #[new]
    #[pyo3(signature = (geom, tf = None))]
    fn new(geom: &Bound<'_, PyAny>, tf: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let py = geom.py();
        let Ok(geometry) = geom.cast::<GeometryBase>() else {
            let message = format!("must be a geometry of impinge.fcl, not {}", geom.get_type().name()?);
            return Err(Fault::new("type", "geom", message).raised(py));
        };
        let rows = match tf {
            None => IDENTITY,
            Some(tf) => rows_of(tf)?,
        };
        let state = Mutex::new(State { rows, placed: None, watchers: Vec::new() });
        let object = Arc::new(Object { geometry: geometry.get().0.clone(), state });
        Ok(Self { geometry: geometry.clone().unbind(), object })
    }

    /// Returns the geometry.
    #[getter]
    fn geometry(&self, py: Python<'_>) -> Py<GeometryBase> {
        self.geometry.clone_ref(py)
    }

    /// Returns the pose, (4, 4), world from geometry.
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix_of(py, &self.object.state().rows)
    }

    /// Returns the lower and the upper corner, (2, 3), of a box in the world frame that contains
    /// the object.
    #[getter]
    fn r#box<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let placed = self.object.placed("transform").map_err(|fault| fault.raised(py))?;
        let corners = placed.bounds.map_or([[f64::NAN; 3]; 2], |bounds| [bounds.min(), bounds.max()]);
        let corners = corners.map(|corner| corner.map(|x| if x.abs() == LIMIT { x * f64::INFINITY } else { x }));
        array(py, corners.into_iter().flatten().collect(), &[2, 3])
    }

    /// Sets the transform.
    fn _set_transform(&self, tf: &Bound<'_, PyAny>) -> PyResult<()> {
        let rows = rows_of(tf)?;
        self.object.move_to(|own| *own = rows);
        Ok(())
    }

    /// Sets the first three rows of the pose to those of a (4, 4) matrix.
    fn _set_matrix(&self, matrix: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
        let [x, y, z, _] = *numbers::<16>(matrix, &[4, 4], name)?.as_chunks::<4>().0 else { return Ok(()) };
        self.object.move_to(|own| *own = [x, y, z]);
        Ok(())
    }

    /// Sets the linear part, (3, 3).
    fn _set_linear(&self, linear: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
        let linear = numbers(linear, &[3, 3], name)?;
        self.object.move_to(|own| _ = set_linear(own, Some(linear)));
        Ok(())
    }

    /// Sets the translation, (3,).
    fn _set_translation(&self, translation: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
        let translation = numbers(translation, &[3], name)?;
        self.object.move_to(|own| _ = set_translation(own, Some(translation)));
        Ok(())
    }
}

impl Object {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the body at the transform. `argument` is the name of the transform in errors.
    ///
    /// # Errors
    /// If the geometry is not complete, or if its body cannot be placed at the transform.
    pub(crate) fn placed(&self, argument: &str) -> Result<Arc<Placed>, Fault> {
        let body = self.geometry.body()?;
        let mut state = self.state();
        if let Some(placed) = state.placed.as_ref().filter(|placed| Arc::ptr_eq(&placed.body, &body)) {
            return Ok(placed.clone());
        }
        let linear = state.rows.map(|[x, y, z, _]| [x, y, z]);
        let placed = Pose::new(linear, state.rows.map(|row| row[3])).and_then(|pose| Placed::new(body, pose));
        let placed = Arc::new(placed.map_err(|error| poses::fault(&error, argument, Vec::new()))?);
        state.placed = Some(placed.clone());
        Ok(placed)
    }

    /// Adds a manager that notices moves.
    pub(crate) fn watch(&self, moved: &Arc<Moved>, key: u32) {
        self.state().watchers.push(Watcher { moved: Arc::downgrade(moved), key });
    }

    /// Removes a manager.
    pub(crate) fn unwatch(&self, moved: &Arc<Moved>, key: u32) {
        let is_other = |own: &Watcher| own.key != key || !std::ptr::eq(own.moved.as_ptr(), Arc::as_ptr(moved));
        self.state().watchers.retain(|own| own.moved.strong_count() > 0 && is_other(own));
    }

    fn move_to(&self, change: impl FnOnce(&mut Rows)) {
        let mut state = self.state();
        change(&mut state.rows);
        state.placed = None;
        for watcher in &state.watchers {
            if let Some(moved) = watcher.moved.upgrade() {
                moved.mark(watcher.key);
            }
        }
    }
}

impl Moved {
    pub(crate) fn mark(&self, key: u32) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(key);
    }

    /// Returns the keys that were marked, and forgets them.
    pub(crate) fn take(&self) -> HashSet<u32> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Placed {
    fn new(body: Arc<Body>, pose: Pose) -> Result<Self, impinge::InputError> {
        let shape = body.shape.at(pose)?;
        let everywhere = || MinMax::new([-LIMIT; 3], [LIMIT; 3]).ok();
        let bounds = match shape.bounds() {
            Some([min, max]) => MinMax::new(min, max).ok().or_else(everywhere),
            None if body.is_empty() => None,
            None => everywhere(),
        };
        Ok(Self { body, shape, pose, bounds, hull: OnceLock::new() })
    }

    /// Returns the mesh at its pose, as its surface or as a solid. `None` if the body has no mesh.
    pub(crate) fn mesh(&self) -> Option<PlacedMesh<'_>> {
        let mesh = self.body.mesh()?;
        Some(PlacedMesh { mesh, world_from_mesh: self.pose, is_solid: self.body.is_solid })
    }

    /// Returns the shape whose penetration is measured.
    pub(crate) fn hull(&self) -> &PlacedShape {
        // A hull can be placed at every pose that its mesh can be placed at.
        self.hull.get_or_init(|| self.body.hull().at(self.pose).unwrap_or_else(|_| self.shape.clone()))
    }

    /// Reports whether the boxes of two bodies are disjoint, so that the bodies are too.
    pub(crate) fn is_apart_from(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (&self.bounds, &other.bounds) else { return true };
        let (a, b) = ([a.min(), a.max()], [b.min(), b.max()]);
        (0..3).any(|axis| a[0][axis] > b[1][axis] || b[0][axis] > a[1][axis])
    }
}

/// Returns the rows of a transform, or of anything else that makes a transform.
fn rows_of(tf: &Bound<'_, PyAny>) -> PyResult<Rows> {
    if let Ok(tf) = tf.cast::<TransformBase>() {
        return Ok(*tf.get().rows());
    }
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let made = CLASS.import(tf.py(), "impinge.fcl._transform", "Transform")?.call1((tf,))?;
    let rows = *made.cast::<TransformBase>()?.get().rows();
    Ok(rows)
}

fn matrix_of<'py>(py: Python<'py>, rows: &Rows) -> PyResult<Bound<'py, PyAny>> {
    let mut entries = Vec::with_capacity(16);
    entries.extend_from_slice(rows.as_flattened());
    entries.extend([0.0, 0.0, 0.0, 1.0]);
    array(py, entries, &[4, 4])
}

/// Sets the linear part, and reports whether there is one.
fn set_linear(rows: &mut Rows, linear: Option<[f64; 9]>) -> bool {
    for (row, linear) in rows.iter_mut().zip(linear.iter().flat_map(|linear| linear.as_chunks::<3>().0)) {
        row[..3].copy_from_slice(linear);
    }
    linear.is_some()
}

/// Sets the translation, and reports whether there is one.
fn set_translation(rows: &mut Rows, translation: Option<[f64; 3]>) -> bool {
    for (row, x) in rows.iter_mut().zip(translation.into_iter().flatten()) {
        row[3] = x;
    }
    translation.is_some()
}

/// Returns the entries of an array of finite doubles in this shape, and `None` for anything else.
fn plain<const N: usize>(value: &Bound<'_, PyAny>, shape: &[usize]) -> Option<[f64; N]> {
    let array = value.cast::<PyArrayDyn<f64>>().ok()?;
    if array.shape() != shape || !array.data().is_aligned() {
        return None;
    }
    let mut entries = [0.0; N];
    entries.iter_mut().zip(array.readonly().as_array().iter()).for_each(|(entry, x)| *entry = *x);
    entries.iter().all(|x| x.is_finite()).then_some(entries)
}

/// Returns real numbers of any type in this shape.
///
/// # Errors
/// `InputError` if the shape is another one, or if a number is not finite.
fn numbers<const N: usize>(value: &Bound<'_, PyAny>, shape: &[usize], name: &str) -> PyResult<[f64; N]> {
    if let Some(entries) = plain(value, shape) {
        return Ok(entries);
    }
    static READER: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = value.py();
    let made = READER.import(py, "impinge._arrays", "plain_shaped")?.call1((value, PyTuple::new(py, shape)?, name))?;
    let made = made.cast_into::<PyArrayDyn<f64>>()?;
    let entries = made.readonly().as_array().iter().copied().collect::<Vec<f64>>();
    <[f64; N]>::try_from(entries).map_err(|_| Fault::new("shape", name, "has another shape").raised(py))
}

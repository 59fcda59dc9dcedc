//! Geometries of the drop-in modules `impinge.fcl` and `impinge.trimesh`: surfaces, and convex
//! solids with or without a mesh.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use impinge::hull::{Hull, HullKind};
use impinge::shape::Shape;
use impinge::{Mesh, Positions};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use crate::errors::Fault;
use crate::shapes::read_shape;

/// Base class of `impinge.fcl.CollisionGeometry`.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct GeometryBase(pub(crate) Arc<Geometry>);

/// A geometry, which may not have a body yet.
pub(crate) struct Geometry {
    /// Name of the class in Python.
    class: String,
    body: Mutex<Option<Arc<Body>>>,
}

/// A surface or a convex solid, in its own frame.
pub(crate) struct Body {
    /// A mesh as its surface or as a solid, or a shape without a mesh.
    pub(crate) shape: Shape,
    pub(crate) is_solid: bool,
    /// Number of pieces that a query compares.
    pub(crate) weight: u64,
    /// Convex hull of a solid mesh, once it was requested.
    hull: OnceLock<SolidHull>,
}

/// Convex hull of a solid mesh.
struct SolidHull {
    shape: Shape,
    /// Whether the solid is its hull, exactly.
    is_solid: bool,
}

#[pymethods]
impl GeometryBase {
    /// Makes a geometry without a body. Subclasses read the arguments.
    #[new]
    #[classmethod]
    #[pyo3(signature = (*_arguments, **_named))]
    fn new(
        class: &Bound<'_, PyType>,
        _arguments: &Bound<'_, PyTuple>,
        _named: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let class = class.name()?.to_string();
        Ok(Self(Arc::new(Geometry { class, body: Mutex::new(None) })))
    }

    /// Sets the body: a mesh, as its surface or as a convex solid, or a shape. `None` removes it.
    fn _set_body(&self, thing: &Bound<'_, PyAny>, is_solid: bool) -> PyResult<()> {
        let body = if thing.is_none() {
            None
        } else {
            let read = read_shape(thing, "geom", is_solid)?;
            let is_solid = is_solid || read.shape.as_mesh().is_none();
            Some(Arc::new(Body { shape: read.shape, is_solid, weight: read.weight, hull: OnceLock::new() }))
        };
        *self.0.body.lock().unwrap_or_else(PoisonError::into_inner) = body;
        Ok(())
    }

    /// Reports whether the body is the mesh of these arrays, doubles and 64-bit integers.
    fn _is_of(&self, vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>, is_solid: bool) -> bool {
        let Ok(body) = self.0.body() else { return false };
        let Some(mesh) = body.mesh().filter(|_| body.is_solid == is_solid) else { return false };
        let Positions::F64(positions) = mesh.positions() else { return false };
        holds(vertices, positions.as_flattened(), |own: &f64, number| own.to_bits() == number.to_bits())
            && holds(faces, mesh.faces().as_flattened(), |own: &i64, number| *own == i64::from(*number))
    }
}

impl Geometry {
    /// Returns the body.
    ///
    /// # Errors
    /// If the geometry is not complete.
    pub(crate) fn body(&self) -> Result<Arc<Body>, Fault> {
        self.body.lock().unwrap_or_else(PoisonError::into_inner).clone().ok_or_else(|| {
            Fault::new("input", "geom", format!("{} is not complete; call endModel() first", self.class))
        })
    }
}

impl Body {
    /// Returns the mesh, or `None` if the body is a shape without a mesh.
    pub(crate) fn mesh(&self) -> Option<&Mesh> {
        self.shape.as_mesh().map(|(mesh, _)| mesh)
    }

    /// Reports whether the body has no points.
    pub(crate) fn is_empty(&self) -> bool {
        self.mesh().is_some_and(|mesh| mesh.faces().is_empty())
    }

    /// Returns the shape whose penetration is measured: the convex hull of a solid mesh, and any
    /// other body as it is.
    pub(crate) fn hull(&self) -> &Shape {
        self.solid_hull().map_or(&self.shape, |hull| &hull.shape)
    }

    /// Reports whether the body is its [`hull`](Self::hull), exactly. This is true of a shape
    /// without a mesh.
    pub(crate) fn is_convex(&self) -> bool {
        match self.solid_hull() {
            Some(hull) => hull.is_solid,
            None => self.mesh().is_none(),
        }
    }

    fn solid_hull(&self) -> Option<&SolidHull> {
        let mesh = self.mesh().filter(|_| self.is_solid)?;
        Some(self.hull.get_or_init(|| {
            match Hull::new(&corners_of(mesh)) {
                Ok(hull) => {
                    let is_solid = mesh.is_hull(&hull);
                    let shape = cuboid_of(&hull).unwrap_or_else(|| Shape::hull(Arc::new(hull)));
                    SolidHull { shape, is_solid }
                }
                // An empty mesh collides with nothing.
                Err(_) => SolidHull { shape: self.shape.clone(), is_solid: false },
            }
        }))
    }
}

/// Returns the vertices that a mesh uses, each once.
fn corners_of(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut is_new = vec![true; mesh.positions().len()];
    let corners = (0..).zip(mesh.faces()).flat_map(|(face, vertices)| vertices.iter().zip(mesh.corners(face)));
    corners.filter(|(vertex, _)| std::mem::take(&mut is_new[**vertex as usize])).map(|(_, corner)| corner).collect()
}

/// Reports whether a value is an array of these numbers, in this order.
fn holds<T: Element, U: Copy>(value: &Bound<'_, PyAny>, numbers: &[U], is_same: impl Fn(&T, &U) -> bool) -> bool {
    let Ok(array) = value.cast::<PyArrayDyn<T>>() else { return false };
    let is_plain = array.is_c_contiguous() && array.data().is_aligned() && array.len() == numbers.len();
    let Ok(array) = array.try_readonly() else { return false };
    is_plain && array.as_slice().is_ok_and(|own| own.iter().zip(numbers).all(|(own, number)| is_same(own, number)))
}

/// Returns a hull as a box, if it is a box around the origin. Boxes have a closed form.
fn cuboid_of(hull: &Hull) -> Option<Shape> {
    let half_extents = hull.positions().first()?.map(f64::abs);
    let is_corner = |position: &[f64; 3]| position.map(f64::abs) == half_extents;
    let is_box = hull.kind() == HullKind::Solid && hull.positions().len() == 8;
    (is_box && hull.positions().iter().all(is_corner)).then(|| Shape::cuboid(half_extents).ok())?
}

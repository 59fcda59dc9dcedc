//! Geometries of the drop-in modules `impinge.fcl` and `impinge.trimesh`: surfaces, and convex
//! solids with or without a mesh.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use impinge::Mesh;
use impinge::hull::Hull;
use impinge::shape::Shape;
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
    hull: OnceLock<Shape>,
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
        let Some(mesh) = self.mesh().filter(|_| self.is_solid) else { return &self.shape };
        self.hull.get_or_init(|| {
            let corners: Vec<[f64; 3]> = (0..mesh.faces().len() as u32).flat_map(|face| mesh.corners(face)).collect();
            // A mesh with faces has a hull. An empty mesh collides with nothing.
            Hull::new(&corners).map_or_else(|_| self.shape.clone(), |hull| Shape::hull(Arc::new(hull)))
        })
    }
}

//! Queries of points against one mesh, in the mesh frame.

use std::sync::atomic::Ordering;

use impinge::mesh::{ClosestPoint, Containment};
use impinge::query::batch::Broadcast;
use impinge::{InputError, Mesh};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;

use crate::arrays::{Plain, numbers, row_array};
use crate::blocks::{self, Length};
use crate::errors::Fault;
use crate::mesh::prepared_mesh_of;

/// Arrays of points.
const PLAIN: Plain = Plain { core: &[3], reader: "plain_points" };

/// Maximum number of points times faces of a call that runs on the caller's thread. It takes about
/// a millisecond, or 100 milliseconds if values derived from the mesh must be computed first.
pub(crate) const MAX_WORK_ON_CALLER: u128 = 1 << 20;

/// The data that a query searches.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Search {
    /// The tree of the mesh, which exists.
    Tree,
    /// Also values derived from the mesh. The first query computes them, which may take long.
    Derived,
}

/// Rows of three numbers with their leading axes.
pub(crate) struct Points {
    /// Lengths of the leading axes. Empty for a single point.
    pub(crate) shape: Vec<usize>,
    /// Points in row-major order.
    pub(crate) rows: Vec<[f64; 3]>,
}

impl Points {
    /// Reads points from an array or nested sequences.
    ///
    /// # Errors
    /// `InputError` if the value is not an array of points, or if a coordinate is not finite or not
    /// below 2^`exponent`.
    pub(crate) fn read(value: &Bound<'_, PyAny>, name: &str, exponent: i32) -> PyResult<Self> {
        let plain = PLAIN.read(value, name)?;
        let shape = plain.shape()[..plain.shape().len() - 1].to_vec();
        let rows = plain.as_slice()?.as_chunks::<3>().0.to_vec();
        let limit = 2_f64.powi(exponent);
        if let Some(row) = rows.iter().position(|row| !row.iter().all(|x| x.abs() < limit)) {
            let fault = if rows[row].iter().all(|x| x.is_finite()) {
                Fault::new("out-of-range", name, format!("a coordinate is not below 2^{exponent} in magnitude"))
            } else {
                Fault::new("non-finite", name, "a coordinate is not finite")
            };
            return Err(fault.at(Broadcast::place(&shape, row)).raised(value.py()));
        }
        Ok(Self { shape, rows })
    }

    /// Returns the results of `ask` for all points, and the leading axes. `ask` gets a block of
    /// points.
    ///
    /// # Errors
    /// The exception of a signal that ends the wait, or `MemoryError`.
    fn ask<T: Send + 'static>(
        self,
        mesh: &Bound<'_, PyAny>,
        search: Search,
        ask: impl Fn(&Mesh, &[[f64; 3]]) -> Result<Vec<T>, InputError> + Send + Sync + 'static,
    ) -> PyResult<(Vec<T>, Vec<usize>)> {
        let (py, (mesh, is_prepared)) = (mesh.py(), prepared_mesh_of(mesh, "mesh")?);
        let Self { shape, rows: points } = self;
        let brief = points.len() as u128 * mesh.faces().len() as u128 <= MAX_WORK_ON_CALLER;
        let length = match search {
            _ if brief => Length::Brief,
            Search::Tree => Length::Quick,
            Search::Derived if is_prepared.load(Ordering::Relaxed) => Length::Quick,
            Search::Derived => Length::Long,
        };
        let prepares = search == Search::Derived && !points.is_empty();
        let answers = blocks::answers(py, points.len(), length, move |rows| ask(&mesh, &points[rows]))?;
        is_prepared.fetch_or(prepares, Ordering::Relaxed);
        Ok((answers, shape))
    }
}

/// Returns the points of the surface nearest to given points, (..., 3), lower and upper bound of
/// the distance, (...), and faces, (...). All are in the mesh frame. If the mesh is empty, faces
/// are -1, points zero and bounds infinite.
#[pyfunction]
pub(crate) fn closest_point<'py>(mesh: &Bound<'py, PyAny>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = mesh.py();
    let (found, shape) = Points::read(points, "points", 300)?.ask(mesh, Search::Tree, Mesh::closest_points)?;
    let of = |value: fn(&ClosestPoint) -> f64| {
        found.iter().map(|found| found.as_ref().map_or(f64::INFINITY, value)).collect::<Vec<_>>()
    };
    let point = found.iter().map(|found| found.map_or([0.0; 3], |found| found.point)).collect();
    let face = found.iter().map(|found| found.map_or(-1, |found| i64::from(found.face))).collect();
    let columns = (
        row_array(py, point, &shape)?,
        numbers(py, of(|found| found.lower), &shape)?,
        numbers(py, of(|found| found.upper), &shape)?,
        numbers(py, face, &shape)?,
    );
    Ok(columns.into_pyobject(py)?.into_any())
}

/// Returns the distances of points from the surface, (...), in mesh units. Magnitudes are upper
/// bounds. A distance is zero on the surface, and negative if the point is inside or undecided. An
/// empty mesh gives infinity.
#[pyfunction]
pub(crate) fn signed_distance<'py>(
    mesh: &Bound<'py, PyAny>,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (signed, shape) = Points::read(points, "points", 128)?.ask(mesh, Search::Derived, |mesh, points| {
        let near =
            mesh.closest_points(points)?.into_iter().map(|found| found.map_or(f64::INFINITY, |found| found.upper));
        let signed = |(distance, containment): (f64, Containment)| match containment {
            Containment::Surface => 0.0,
            Containment::Outside => distance,
            Containment::Inside | Containment::Undecided => -distance,
        };
        Ok(near.zip(mesh.contains(points)?).map(signed).collect())
    })?;
    numbers(mesh.py(), signed, &shape)
}

/// Returns the winding numbers of the mesh about points of the mesh frame, (...), rounded.
#[pyfunction]
pub(crate) fn winding_number<'py>(mesh: &Bound<'py, PyAny>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let (found, shape) = Points::read(points, "points", 128)?.ask(mesh, Search::Derived, Mesh::winding_number)?;
    numbers(mesh.py(), found.iter().map(|number| number.value).collect(), &shape)
}

/// Reports whether the mesh contains each point of the mesh frame, as booleans of shape (...). An
/// undecided point counts as contained.
#[pyfunction]
pub(crate) fn contains<'py>(mesh: &Bound<'py, PyAny>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let (found, shape) = Points::read(points, "points", 128)?.ask(mesh, Search::Derived, Mesh::contains)?;
    numbers(mesh.py(), found.iter().map(|containment| containment.is_contained()).collect(), &shape)
}

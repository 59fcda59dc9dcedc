//! Convex hulls, and bounding volumes fitted to points.

use impinge::hull::{Hull, HullKind};
use impinge::volume::{BoundingSphere, BoundingVolume, Capsule, Kdop, Lozenge, MinMax, Obb, fit};
use impinge::{InputError, Positions};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::{proxies_of, read_positions};
use crate::workers;

/// Returns the indices of the vertices of the hull, (h,), its faces by these indices, (f, 3), and
/// its dimension.
#[pyfunction]
pub(crate) fn convex_hull<'py>(points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let hull = of_points(points, |points| match points {
        Positions::F32(points) => Hull::new(&points),
        Positions::F64(points) => Hull::new(&points),
    })?;
    columns_of_hull(points.py(), &hull)
}

fn columns_of_hull<'py>(py: Python<'py>, hull: &Hull) -> PyResult<Bound<'py, PyAny>> {
    let dimension = match hull.kind() {
        HullKind::Point => 0,
        HullKind::Segment => 1,
        HullKind::Polygon => 2,
        HullKind::Solid => 3,
    };
    let vertices = hull.vertices();
    let faces: Vec<[u32; 3]> = hull.faces().iter().map(|face| face.map(|at| vertices[at as usize])).collect();
    let count = faces.len();
    let columns = (array(py, vertices.to_vec(), &[vertices.len()])?, row_array(py, faces, &[count])?, dimension);
    Ok(columns.into_pyobject(py)?.into_any())
}

/// Volume as rows of three numbers, then single numbers, whose meaning `impinge.fit` knows. The
/// last two numbers are the volume and the surface area.
struct Numbers {
    rows: Vec<[f64; 3]>,
    singles: Vec<f64>,
}

impl Numbers {
    fn of(volume: &impl BoundingVolume, rows: &[[f64; 3]], singles: &[f64]) -> Self {
        Self { rows: rows.to_vec(), singles: [singles, &[volume.volume(), volume.surface_area()]].concat() }
    }

    /// Returns the center, the radius, and a lower bound of the radius of the smallest sphere.
    fn of_sphere(sphere: &BoundingSphere, lower: f64) -> Self {
        Self::of(sphere, &[sphere.center()], &[sphere.radius(), lower])
    }

    fn of_fitted(fitted: fit::FittedSphere) -> Self {
        Self::of_sphere(&fitted.sphere, fitted.lower)
    }

    fn of_box(bounds: &MinMax) -> Self {
        Self::of(bounds, &[bounds.min(), bounds.max()], &[])
    }

    fn of_capsule(capsule: &Capsule) -> Self {
        Self::of(capsule, &capsule.ends(), &[capsule.radius()])
    }

    fn of_lozenge(lozenge: &Lozenge) -> Self {
        let [u, v] = lozenge.edges();
        Self::of(lozenge, &[lozenge.corner(), u, v], &[lozenge.radius()])
    }

    /// Returns the center, axes and half-extents, and a lower bound of the volume of the smallest
    /// box.
    fn of_obb(obb: &Obb, lower: f64) -> Self {
        let [x, y, z] = obb.axes();
        Self::of(obb, &[obb.center(), x, y, z, obb.half_extents()], &[lower])
    }

    /// Returns the directions, the minima along them, then the maxima.
    fn of_kdop<const D: usize>(kdop: &Kdop<D>) -> Self
    where
        Kdop<D>: BoundingVolume,
    {
        Self::of(kdop, &Kdop::<D>::DIRECTIONS, &[kdop.low(), kdop.high()].concat())
    }

    fn columns(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let (rows, singles) = (self.rows.len(), self.singles.len());
        let columns = (row_array(py, self.rows, &[rows])?, array(py, self.singles, &[singles])?);
        Ok(columns.into_pyobject(py)?.into_any())
    }
}

/// Returns the hull of a mesh as [`convex_hull`] does, and its volumes as [`fit_volume`] does: box,
/// sphere, capsule, lozenge, oriented box, and the polytopes of 14, 18 and 26 faces. The lower
/// bounds for the smallest sphere and box are zero.
///
/// # Errors
/// `InputError` if the mesh is empty, or if its file holds the proxies of another mesh.
#[pyfunction]
pub(crate) fn proxies<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = mesh.py();
    let Some(proxies) = proxies_of(mesh)?.1 else {
        return Err(Fault::new("empty", "mesh", "a mesh without faces has no hull and no volumes").raised(py));
    };
    let volumes = [
        Numbers::of_box(&proxies.bounds()),
        Numbers::of_sphere(&proxies.sphere(), 0.0),
        Numbers::of_capsule(&proxies.capsule()),
        Numbers::of_lozenge(&proxies.lozenge()),
        Numbers::of_obb(&proxies.obb(), 0.0),
        Numbers::of_kdop(&proxies.kdop14()),
        Numbers::of_kdop(&proxies.kdop18()),
        Numbers::of_kdop(&proxies.kdop26()),
    ];
    let volumes: Vec<_> = volumes.into_iter().map(|numbers| numbers.columns(py)).collect::<PyResult<_>>()?;
    Ok((columns_of_hull(py, proxies.hull())?, volumes).into_pyobject(py)?.into_any())
}

/// Returns the volume that a construction makes of points.
///
/// # Errors
/// `InputError` if there are no points, if a point is not finite or out of range, or if there is no
/// such construction.
#[pyfunction]
pub(crate) fn fit_volume<'py>(points: &Bound<'py, PyAny>, construction: &str) -> PyResult<Bound<'py, PyAny>> {
    /// Applies a generic construction to points in either precision, and converts its result.
    macro_rules! made {
        ($construct:expr, $read:expr) => {
            of_points(points, |points| match points {
                Positions::F32(points) => $construct(&points[..]).map($read),
                Positions::F64(points) => $construct(&points[..]).map($read),
            })
        };
    }
    let py = points.py();
    let numbers = match construction {
        "minimal sphere" => made!(fit::minimal_sphere, Numbers::of_fitted),
        "mean sphere" => made!(fit::mean_sphere, Numbers::of_fitted),
        "box sphere" => made!(fit::box_sphere, Numbers::of_fitted),
        "ritter sphere" => made!(fit::ritter_sphere, Numbers::of_fitted),
        "principal sphere" => made!(fit::principal_sphere, Numbers::of_fitted),
        "refined sphere" => made!(fit::refined_sphere, Numbers::of_fitted),
        "aabb" => made!(MinMax::of, |bounds: MinMax| Numbers::of_box(&bounds)),
        "capsule" => made!(fit::capsule, |capsule| Numbers::of_capsule(&capsule)),
        "lozenge" => made!(fit::lozenge, |lozenge| Numbers::of_lozenge(&lozenge)),
        "least obb" => made!(fit::obb, |fitted| Numbers::of_obb(&fitted.obb, fitted.volume_lower)),
        "principal obb" => made!(fit::principal_obb, |obb| Numbers::of_obb(&obb, 0.0)),
        "14-dop" => made!(Kdop::<7>::of, |kdop| Numbers::of_kdop(&kdop)),
        "18-dop" => made!(Kdop::<9>::of, |kdop| Numbers::of_kdop(&kdop)),
        "26-dop" => made!(Kdop::<13>::of, |kdop| Numbers::of_kdop(&kdop)),
        _ => Err(Fault::new("option", "construction", format!("there is no {construction:?}")).raised(py)),
    }?;
    numbers.columns(py)
}

/// Returns the result of `make` for (n, 3) points in single or double precision, computed on the
/// pool.
fn of_points<T: Send + 'static>(
    points: &Bound<'_, PyAny>,
    make: impl FnOnce(Positions) -> Result<T, InputError> + Send + 'static,
) -> PyResult<T> {
    let py = points.py();
    let positions = read_positions(points)?;
    workers::run(py, move |_| make(positions))?.map_err(|error| {
        let (kind, at) = kind_and_place(&error);
        Fault::new(kind, "points", message(&error)).at(at).hint(error.hint()).raised(py)
    })
}

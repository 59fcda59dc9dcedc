//! Convex hulls, and bounding volumes fitted to points.

use impinge::hull::{Hull, HullKind};
use impinge::volume::{BoundingVolume, Kdop, MinMax, fit};
use impinge::{InputError, Positions};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::read_positions;
use crate::workers;

/// The numbers of the vertices, (h,), the faces by these numbers, (f, 3), and the dimension.
#[pyfunction]
pub(crate) fn convex_hull<'py>(points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let hull = of_points(points, |points| match points {
        Positions::F32(points) => Hull::new(&points),
        Positions::F64(points) => Hull::new(&points),
    })?;
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

/// A volume as rows of three numbers, then single numbers: what they are, `impinge.fit` knows. The last two are the volume
/// and the area of the surface.
struct Numbers {
    rows: Vec<[f64; 3]>,
    singles: Vec<f64>,
}

impl Numbers {
    fn of(volume: &impl BoundingVolume, rows: &[[f64; 3]], singles: &[f64]) -> Self {
        Self { rows: rows.to_vec(), singles: [singles, &[volume.volume(), volume.surface_area()]].concat() }
    }

    /// Centre; radius, and the lower bound of the least one.
    fn of_sphere(fitted: &fit::FittedSphere) -> Self {
        Self::of(&fitted.sphere, &[fitted.sphere.centre()], &[fitted.sphere.radius(), fitted.lower])
    }

    /// Directions; the least extents along them, then the greatest.
    fn of_kdop<const D: usize>(kdop: &Kdop<D>) -> Self
    where
        Kdop<D>: BoundingVolume,
    {
        Self::of(kdop, &Kdop::<D>::DIRECTIONS, &[kdop.low(), kdop.high()].concat())
    }
}

/// The volume that a construction makes of points.
///
/// # Errors
/// `InputError` without points, where one is not finite or out of range, or where there is no such construction.
#[pyfunction]
pub(crate) fn fit_volume<'py>(points: &Bound<'py, PyAny>, construction: &str) -> PyResult<Bound<'py, PyAny>> {
    /// Of points in either precision, what a generic construction and a reader of its result make of them.
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
        "minimal sphere" => made!(fit::minimal_sphere, |fitted| Numbers::of_sphere(&fitted)),
        "mean sphere" => made!(fit::mean_sphere, |fitted| Numbers::of_sphere(&fitted)),
        "box sphere" => made!(fit::box_sphere, |fitted| Numbers::of_sphere(&fitted)),
        "ritter sphere" => made!(fit::ritter_sphere, |fitted| Numbers::of_sphere(&fitted)),
        "principal sphere" => made!(fit::principal_sphere, |fitted| Numbers::of_sphere(&fitted)),
        "refined sphere" => made!(fit::refined_sphere, |fitted| Numbers::of_sphere(&fitted)),
        "aabb" => made!(MinMax::of, |aabb: MinMax| Numbers::of(&aabb, &[aabb.min(), aabb.max()], &[])),
        "capsule" => made!(fit::capsule, |capsule| {
            let [start, end] = capsule.ends();
            Numbers::of(&capsule, &[start, end], &[capsule.radius()])
        }),
        "lozenge" => made!(fit::lozenge, |lozenge| {
            let [u, v] = lozenge.edges();
            Numbers::of(&lozenge, &[lozenge.corner(), u, v], &[lozenge.radius()])
        }),
        "least obb" => made!(fit::obb, |fitted| {
            let [x, y, z] = fitted.obb.axes();
            let rows = [fitted.obb.centre(), x, y, z, fitted.obb.half_extents()];
            Numbers::of(&fitted.obb, &rows, &[fitted.volume_lower])
        }),
        "principal obb" => made!(fit::principal_obb, |obb| {
            let [x, y, z] = obb.axes();
            Numbers::of(&obb, &[obb.centre(), x, y, z, obb.half_extents()], &[0.0])
        }),
        "14-dop" => made!(Kdop::<7>::of, |kdop| Numbers::of_kdop(&kdop)),
        "18-dop" => made!(Kdop::<9>::of, |kdop| Numbers::of_kdop(&kdop)),
        "26-dop" => made!(Kdop::<13>::of, |kdop| Numbers::of_kdop(&kdop)),
        _ => Err(Fault::new("option", "construction", format!("there is no {construction:?}")).raised(py)),
    }?;
    let (rows, singles) = (numbers.rows.len(), numbers.singles.len());
    let columns = (row_array(py, numbers.rows, &[rows])?, array(py, numbers.singles, &[singles])?);
    Ok(columns.into_pyobject(py)?.into_any())
}

/// What `make` makes of (n, 3) points in single or double precision, on the pool.
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

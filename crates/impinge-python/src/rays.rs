//! Rays against one mesh, in the mesh frame.

use impinge::mesh::{Ray, RayHit};
use impinge::query::batch::Broadcast;
use impinge::{InputError, Mesh};
use pyo3::prelude::*;

use crate::arrays::{array, numbers, ragged, row_array};
use crate::blocks::{self, Length};
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::mesh_of;
use crate::points::{MAX_WORK_ON_CALLER, Points};
use crate::poses;
use crate::workers::{self, Call};
use crate::world_bodies::{self, Handles};

/// Exponent of the magnitude below which coordinates must be, 2^300.
const EXPONENT: i32 = 300;

/// Returns whether each ray hits the mesh, (...), the ray parameter t, (...), the face, (...), and
/// the point, (..., 3), in the mesh frame.
#[pyfunction]
pub(crate) fn ray_cast<'py>(
    mesh: &Bound<'py, PyAny>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, rays) = (mesh.py(), Rays::read(origins, directions)?);
    let (shape, count) = (rays.lead().to_vec(), rays.len());
    let mut hits = Hits::with_capacity(count);
    for block in rays.ask(mesh, |mesh, rays| Hits::of(&mesh.ray_casts(rays)))? {
        hits.append(block);
    }
    hits.first(py, &shape)
}

/// Returns the offsets of the hits of each ray, columns with the hits of all rays, (k,), and the
/// leading axes.
#[pyfunction]
pub(crate) fn ray_cast_all<'py>(
    mesh: &Bound<'py, PyAny>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, rays) = (mesh.py(), Rays::read(origins, directions)?);
    let shape = rays.lead().to_vec();
    let blocks = rays.ask(mesh, Mesh::ray_casts_all)?;
    let (offsets, hits) = ragged(blocks.into_iter().flatten().collect());
    let (places, count) = (offsets.len(), hits.len());
    let hits = Hits::of(&hits.into_iter().map(Some).collect::<Vec<_>>()).columns(py, &[count])?;
    Ok((array(py, offsets, &[places])?, hits, shape).into_pyobject(py)?.into_any())
}

/// Returns the unit normals of faces of a mesh, (n, 3), in the mesh frame. The normal of a face
/// without area is NaN.
///
/// # Errors
/// `InputError` if there is no such face.
#[pyfunction]
pub(crate) fn face_normals<'py>(mesh: &Bound<'py, PyAny>, faces: &Handles<'py>) -> PyResult<Bound<'py, PyAny>> {
    let (py, mesh, faces) = (mesh.py(), mesh_of(mesh, "mesh")?, world_bodies::numbers(faces)?);
    let count = mesh.faces().len();
    if let Some(row) = faces.iter().position(|&face| face >= count as u64) {
        let text = format!("is {}, but the mesh has {count} faces", faces[row]);
        return Err(Fault::new("out-of-range", "faces", text).at(vec![row]).raised(py));
    }
    let rows = faces.len();
    let normal = move |row: usize| mesh.face_normal(faces[row] as u32).unwrap_or([f64::NAN; 3]);
    let call = Call { rows, is_brief: rows as u128 <= MAX_WORK_ON_CALLER, progress: false };
    row_array(py, workers::rows(py, call, normal)?, &[rows])
}

/// Columns of the hits of rays, one row for each: whether there is a hit, the ray parameter t, the
/// face, and the point in the mesh frame. Without a hit they are infinity, -1 and zero.
pub(crate) struct Hits {
    hit: Vec<bool>,
    t: Vec<f64>,
    face: Vec<i64>,
    point: Vec<[f64; 3]>,
}

impl Hits {
    fn with_capacity(rows: usize) -> Self {
        Self {
            hit: Vec::with_capacity(rows),
            t: Vec::with_capacity(rows),
            face: Vec::with_capacity(rows),
            point: Vec::with_capacity(rows),
        }
    }

    pub(crate) fn of(found: &[Option<RayHit>]) -> Self {
        Self {
            hit: found.iter().map(Option::is_some).collect(),
            t: found.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect(),
            face: found.iter().map(|hit| hit.map_or(-1, |hit| i64::from(hit.face))).collect(),
            point: found.iter().map(|hit| hit.map_or([0.0; 3], |hit| hit.point)).collect(),
        }
    }

    fn append(&mut self, mut more: Self) {
        self.hit.append(&mut more.hit);
        self.t.append(&mut more.t);
        self.face.append(&mut more.face);
        self.point.append(&mut more.point);
    }

    /// Returns whether each ray has a hit, (...), and the columns of the hits.
    pub(crate) fn first<'py>(mut self, py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
        let hit = numbers(py, std::mem::take(&mut self.hit), shape)?;
        Ok((hit, self.columns(py, shape)?).into_pyobject(py)?.into_any())
    }

    /// Returns ray parameters, (...), faces, (...), and points, (..., 3).
    fn columns<'py>(self, py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
        let columns = (numbers(py, self.t, shape)?, numbers(py, self.face, shape)?, row_array(py, self.point, shape)?);
        Ok(columns.into_pyobject(py)?.into_any())
    }
}

/// Rays as origins and directions, whose leading axes broadcast.
pub(crate) struct Rays {
    origins: Points,
    directions: Points,
    rows: Broadcast,
}

impl Rays {
    /// Reads the origins and directions of rays.
    ///
    /// # Errors
    /// `InputError` if they are not points, if a direction is zero, or if leading axes do not
    /// broadcast.
    pub(crate) fn read(origins: &Bound<'_, PyAny>, directions: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = origins.py();
        let origins = Points::read(origins, "origins", EXPONENT)?;
        let directions = Points::read(directions, "directions", EXPONENT)?;
        if let Some(row) = directions.rows.iter().position(|&direction| direction == [0.0; 3]) {
            let at = Broadcast::place(&directions.shape, row);
            return Err(Fault::new("zero-direction", "directions", "the direction is zero").at(at).raised(py));
        }
        let rows = poses::broadcast(py, (&origins.shape, "origins"), (&directions.shape, "directions"))?;
        Ok(Self { origins, directions, rows })
    }

    /// Returns the leading axes.
    pub(crate) fn lead(&self) -> &[usize] {
        self.rows.shape()
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.rows()
    }

    /// Returns the origin and the direction of a row.
    pub(crate) fn at(&self, row: usize) -> [[f64; 3]; 2] {
        let [origin, direction] = self.rows.sources(row);
        [self.origins.rows[origin], self.directions.rows[direction]]
    }

    /// Returns the result of `ask` for each block of rays.
    fn ask<B: Send + 'static>(
        self,
        mesh: &Bound<'_, PyAny>,
        ask: impl Fn(&Mesh, &[Ray]) -> B + Send + Sync + 'static,
    ) -> PyResult<Vec<B>> {
        let (py, mesh) = (mesh.py(), mesh_of(mesh, "mesh")?);
        let rows = self.len();
        let brief = rows as u128 * mesh.faces().len() as u128 <= MAX_WORK_ON_CALLER;
        blocks::each(py, rows, if brief { Length::Brief } else { Length::Quick }, move |rows| {
            let ray = |row| {
                let [origin, direction] = self.at(row);
                Ray::new(origin, direction)
            };
            Ok(ask(&mesh, &rows.map(ray).collect::<Result<Vec<Ray>, InputError>>()?))
        })
    }

    /// Returns the results of `ask` for the origin and the direction of each ray. The caller's
    /// thread answers all of them if `brief` is set, or else it starts a call of few rays.
    ///
    /// # Errors
    /// `InputError` for the first ray that is invalid.
    pub(crate) fn ask_each<T: Send + 'static>(
        self,
        py: Python<'_>,
        brief: bool,
        ask: impl Fn([f64; 3], [f64; 3]) -> Result<T, InputError> + Send + Sync + 'static,
    ) -> PyResult<Vec<T>> {
        let (rows, shape) = (self.len(), self.lead().to_vec());
        let answer = move |row| {
            let [origin, direction] = self.at(row);
            ask(origin, direction)
        };
        let answers = if brief {
            workers::rows(py, Call { rows, is_brief: true, progress: false }, answer)?
        } else {
            workers::quick_rows(py, rows, answer)?
        };
        let checked = answers.into_iter().enumerate().map(|(row, answer)| {
            answer.map_err(|error| {
                let at = Broadcast::place(&shape, row);
                Fault::new(kind_and_place(&error).0, "directions", message(&error)).at(at).raised(py)
            })
        });
        checked.collect()
    }
}

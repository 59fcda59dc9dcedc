//! Contents of a mesh file before a mesh is made, and meshes baked to files.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use impinge::storage::{AlignedBytes, SharedBytes};
use impinge::{Mesh, Positions};
use impinge_files::{
    Baked, Format, Limits, LoadError, Provenance, Unit, UnknownUnit, Warning, replace_file, write_baked,
};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{array, row_array};
use crate::errors::{Fault, file_error, load_error};
use crate::lent_bytes::LentBytes;
use crate::mesh::{mesh_of, proxies_of};
use crate::workers;

/// Coordinates must be below this magnitude, 2^128.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// Triangles of a file, and where they come from.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct Model {
    content: Content,
    about: Provenance,
    format: Format,
    warnings: Vec<Warning>,
}

/// Contents that a mesh is made from.
pub(crate) enum Content {
    Triangles(Positions, Vec<[u32; 3]>),
    /// A mesh with its hierarchy in a baked file, and the file for its other sections.
    Baked(Mesh, Arc<Baked>),
}

#[pymethods]
impl Model {
    /// Reads a file and converts the vertices to `unit`, if it is given. `max_bytes` and
    /// `max_triangles` replace the default limits.
    #[new]
    #[pyo3(signature = (path, unit, max_bytes=None, max_triangles=None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        unit: Option<&str>,
        max_bytes: Option<u64>,
        max_triangles: Option<u64>,
    ) -> PyResult<Self> {
        let mut limits = Limits::default();
        (limits.max_bytes, limits.max_triangles) = (max_bytes, max_triangles);
        let wanted = unit_of(py, unit)?;
        let shown = path.display().to_string();
        let model =
            workers::run(py, move |_| Self::read(&path, wanted, &limits))?.map_err(|error| load_error(py, &error))?;
        match model.first_out_of_range() {
            None => Ok(model),
            Some(vertex) => {
                let message = format!("vertex {vertex} is out of range: its magnitude must be below 2^128");
                Err(file_error(py, &shown, "out-of-range", &message))
            }
        }
    }

    /// Opens the bytes that `to_baked` returned, from any object with a buffer of bytes. If they
    /// are constant, read-only and aligned, they are used in place. Otherwise they are copied.
    #[staticmethod]
    fn of_baked(py: Python<'_>, baked: &Bound<'_, PyAny>, is_constant: bool) -> PyResult<Self> {
        let buffer = PyBuffer::<u8>::get(baked)?;
        let lent = if is_constant { LentBytes::of(buffer, Mesh::PARTS_ALIGNMENT) } else { Err(buffer) };
        let bytes: SharedBytes = match lent {
            Ok(lent) => Arc::new(lent),
            Err(buffer) => {
                let mut bytes = AlignedBytes::zeroed(buffer.item_count());
                buffer.copy_to_slice(py, bytes.as_mut())?;
                Arc::new(bytes)
            }
        };
        let opened = workers::run(py, move |_| {
            let baked = Baked::from_bytes(bytes)?;
            Ok((baked.provenance()?, baked.mesh()?, baked))
        })?;
        let (about, mesh, baked) = opened.map_err(|error: LoadError| load_error(py, &error))?;
        Ok(Self { content: Content::Baked(mesh, Arc::new(baked)), about, format: Format::Baked, warnings: Vec::new() })
    }

    #[getter]
    fn format(&self) -> String {
        self.format.to_string()
    }

    #[getter]
    fn unit(&self) -> Option<&'static str> {
        self.about.unit.map(Unit::symbol)
    }

    #[getter]
    fn parts(&self) -> Vec<String> {
        self.about.parts.clone()
    }

    /// Returns the vertices, (n, 3), in the precision of the file.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let positions = match &self.content {
            Content::Triangles(positions, _) => positions,
            Content::Baked(mesh, _) => mesh.positions(),
        };
        match positions {
            Positions::F32(rows) => row_array(py, rows.clone(), &[rows.len()]),
            Positions::F64(rows) => row_array(py, rows.clone(), &[rows.len()]),
        }
    }

    /// Returns the faces, (m, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let faces = match &self.content {
            Content::Triangles(_, faces) => faces,
            Content::Baked(mesh, _) => mesh.faces(),
        };
        row_array(py, faces.to_vec(), &[faces.len()])
    }

    #[getter]
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.about.sources.clone(), &[self.about.sources.len()])
    }

    #[getter]
    fn part_of<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.about.part_of.clone(), &[self.about.part_of.len()])
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.iter().map(Warning::to_string).collect()
    }
}

impl Model {
    /// Reads a file. A baked file is mapped in place, unless its unit must be converted.
    fn read(path: &Path, wanted: Option<Unit>, limits: &Limits) -> Result<Self, LoadError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        // Only files with the extension of baked files, or without a known extension, are tried
        // here. If such a file is not baked, the reader of all formats reports it. A name without
        // an extension may be that of shared memory.
        if Format::from_extension(&extension).is_none_or(|format| format == Format::Baked)
            && let Ok(baked) = Baked::open_with(path, limits)
        {
            let about = baked.provenance()?;
            if about.unit.is_none() || wanted.is_none_or(|wanted| about.unit == Some(wanted)) {
                let about = Provenance { unit: wanted.or(about.unit), ..about };
                let content = Content::Baked(baked.mesh()?, Arc::new(baked));
                return Ok(Self { content, about, format: Format::Baked, warnings: Vec::new() });
            }
        }
        let impinge_files::Model { mut positions, faces, sources, part_of, parts, unit, warnings, format } =
            impinge_files::load_with(path, limits)?;
        if let (Some(stated), Some(wanted)) = (unit, wanted) {
            positions = converted(positions, stated, wanted);
        }
        let about = Provenance { sources, part_of, parts, unit: wanted.or(unit) };
        Ok(Self { content: Content::Triangles(positions, faces), about, format, warnings })
    }

    /// Returns the first vertex that is out of range for a mesh.
    fn first_out_of_range(&self) -> Option<usize> {
        let Content::Triangles(Positions::F64(rows), _) = &self.content else { return None };
        rows.iter().position(|row| row.iter().any(|x| x.abs() >= LIMIT))
    }

    pub(crate) fn content(&self) -> &Content {
        &self.content
    }
}

/// Returns the unit with a symbol.
///
/// # Errors
/// `InputError` that lists the symbols.
pub(crate) fn unit_of(py: Python<'_>, symbol: Option<&str>) -> PyResult<Option<Unit>> {
    let parse = |text: &str| text.parse().map_err(|error: UnknownUnit| error.to_string());
    symbol.map(|text| parse(text).map_err(|error| Fault::new("unit", "unit", error).raised(py))).transpose()
}

/// Origin of the faces in Python: polygons and parts, (m,), names of the parts, and the unit. It is
/// `None` if each face is its own polygon, of one part without a name.
type About = Option<(Vec<u32>, Vec<u32>, Vec<String>, Option<String>)>;

/// Writes a mesh with its hierarchy, the origin of its faces, and optionally its proxies to a file.
#[pyfunction]
pub(crate) fn bake(mesh: &Bound<'_, PyAny>, path: PathBuf, about: About, with_proxies: bool) -> PyResult<()> {
    write(mesh, about, with_proxies, move |content| replace_file(path, content))
}

/// Returns the bytes that [`bake`] writes.
#[pyfunction]
pub(crate) fn to_baked<'py>(
    mesh: &Bound<'py, PyAny>,
    about: About,
    with_proxies: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let written = write(mesh, about, with_proxies, |content| {
        let mut bytes = Vec::new();
        content(&mut bytes)?;
        Ok(bytes)
    })?;
    Ok(PyBytes::new(mesh.py(), &written))
}

/// Function that writes the bytes of a baked file.
type Writing = Box<dyn FnOnce(&mut dyn Write) -> io::Result<()>>;

fn write<T: Send + 'static>(
    mesh: &Bound<'_, PyAny>,
    about: About,
    with_proxies: bool,
    to: impl FnOnce(Writing) -> io::Result<T> + Send + 'static,
) -> PyResult<T> {
    let py = mesh.py();
    let (mesh, proxies) = if with_proxies { proxies_of(mesh)? } else { (mesh_of(mesh, "mesh")?, None) };
    let written: io::Result<T> = workers::run(py, move |_| {
        let provenance = provenance(about, mesh.faces().len());
        to(Box::new(move |out| write_baked(&mesh, &provenance, proxies.as_ref(), out)))
    })?;
    Ok(written?)
}

/// Returns the provenance of a number of faces.
fn provenance(about: About, faces: usize) -> Provenance {
    let of_face = || ((0..faces as u32).collect(), vec![0; faces], vec![String::new()], None);
    let (sources, part_of, parts, unit) = about.unwrap_or_else(of_face);
    Provenance { sources, part_of, parts, unit: unit.and_then(|unit| unit.parse().ok()) }
}

/// Returns the same lengths in another unit.
fn converted(positions: Positions, from: Unit, to: Unit) -> Positions {
    if from == to {
        return positions;
    }
    let conversion = from.to(to);
    Positions::F64((0..positions.len()).map(|i| positions.get(i).map(|x| conversion.apply(x))).collect())
}

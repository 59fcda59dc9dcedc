//! What a file holds, before a mesh is made of it.

use std::path::PathBuf;

use impinge::Positions;
use impinge_files::{Unit, Warning};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::errors::{Fault, load_error};
use crate::workers;

/// The triangles of a file, and where they came from.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct Model {
    model: impinge_files::Model,
    unit: Option<Unit>,
}

#[pymethods]
impl Model {
    /// Reads a file; `unit` is the one that the vertices are wanted in.
    #[new]
    fn new(py: Python<'_>, path: PathBuf, unit: Option<&str>) -> PyResult<Self> {
        let wanted = unit
            .map(|text| text.parse::<Unit>().map_err(|error| Fault::new("unit", "unit", error.to_string()).raised(py)))
            .transpose()?;
        let mut model =
            workers::run(py, move |_| impinge_files::load(path))?.map_err(|error| load_error(py, &error))?;
        if let (Some(stated), Some(wanted)) = (model.unit, wanted) {
            model.positions = converted(model.positions, stated, wanted);
        }
        Ok(Self { unit: wanted.or(model.unit), model })
    }

    #[getter]
    fn format(&self) -> String {
        self.model.format.to_string()
    }

    #[getter]
    fn unit(&self) -> Option<&'static str> {
        self.unit.map(Unit::symbol)
    }

    #[getter]
    fn parts(&self) -> Vec<String> {
        self.model.parts.clone()
    }

    /// (n, 3), in the file's precision.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let count = [self.model.positions.len()];
        match &self.model.positions {
            Positions::F32(positions) => row_array(py, positions.clone(), &count),
            Positions::F64(positions) => row_array(py, positions.clone(), &count),
        }
    }

    /// (m, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        row_array(py, self.model.faces.clone(), &[self.model.faces.len()])
    }

    #[getter]
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.model.sources.clone(), &[self.model.sources.len()])
    }

    #[getter]
    fn part_of<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, self.model.part_of.clone(), &[self.model.part_of.len()])
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.model.warnings.iter().map(Warning::to_string).collect()
    }
}

impl Model {
    /// Copies of its arrays.
    pub(crate) fn triangles(&self) -> (Positions, Vec<[u32; 3]>) {
        (self.model.positions.clone(), self.model.faces.clone())
    }
}

/// The same lengths in another unit, each coordinate rounded once where one of the units is a whole number of the other,
/// else twice.
fn converted(positions: Positions, from: Unit, to: Unit) -> Positions {
    // Whole numbers of micrometres.
    let [from, to] = [from, to].map(|unit| (unit.metres() * 1e6).round());
    if from == to {
        return positions;
    }
    let convert = |x: f64| match () {
        () if from % to == 0.0 => x * (from / to),
        () if to % from == 0.0 => x / (to / from),
        () => x * from / to,
    };
    Positions::F64((0..positions.len()).map(|i| positions.get(i).map(convert)).collect())
}

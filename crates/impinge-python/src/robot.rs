//! Robots: what their files say about them, and their kinematics.

use std::path::PathBuf;
use std::sync::Arc;

use impinge::Shape;
use impinge::robot::{ConfigurationError, IgnoredReason, Robot};
use impinge_files::{Limits, LoadedRobot, LoadedState, RobotGeometry, RobotOptions, load_robot};
use pyo3::prelude::*;

use crate::arrays::{plain_column, row_array};
use crate::errors::{Fault, load_error};
use crate::motions::matrix;
use crate::workers;

/// A robot with all that its files say about it.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct RobotCore {
    loaded: Arc<LoadedRobot>,
}

/// Name, group, and names of joints with the values of their coordinates.
type StateRow = (String, String, Vec<(String, Vec<f64>)>);

#[pymethods]
impl RobotCore {
    /// Loads a URDF file, and optionally an SRDF file. `packages` are names with folders.
    #[new]
    #[pyo3(signature = (path, srdf, packages, geometry, max_bytes, max_triangles))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        srdf: Option<PathBuf>,
        packages: Vec<(String, PathBuf)>,
        geometry: &str,
        max_bytes: Option<u64>,
        max_triangles: Option<u64>,
    ) -> PyResult<Self> {
        let geometry = match geometry {
            "visual" => RobotGeometry::Visual,
            "hull" => RobotGeometry::Hull,
            _ => RobotGeometry::Collision,
        };
        let mut limits = Limits::default();
        (limits.max_bytes, limits.max_triangles) = (max_bytes, max_triangles);
        let options = RobotOptions { srdf, packages, geometry, limits };
        let loaded = workers::run(py, move |_| load_robot(&path, &options))?;
        let loaded = loaded.map_err(|error| load_error(py, &error))?;
        Ok(loaded.into())
    }

    #[getter]
    fn name(&self) -> &str {
        &self.loaded.name
    }

    /// Returns the name of each link, and whether it has a shape.
    fn links(&self) -> Vec<(String, bool)> {
        self.robot().links().iter().map(|link| (link.name.clone(), link.shape.is_some())).collect()
    }

    /// Returns the name and the limits of each coordinate.
    fn coordinates(&self) -> Vec<(String, f64, f64)> {
        let row = |name: &str, [lower, upper]: [f64; 2]| (name.to_owned(), lower, upper);
        self.robot().coordinates().iter().map(|coordinate| row(&coordinate.name, coordinate.limits)).collect()
    }

    fn groups(&self) -> Vec<(String, Vec<String>)> {
        self.loaded.groups.iter().map(|group| (group.name.clone(), group.joints.clone())).collect()
    }

    fn states(&self) -> Vec<StateRow> {
        let row = |state: &LoadedState| (state.name.clone(), state.group.clone(), state.values.clone());
        self.loaded.states.iter().map(row).collect()
    }

    /// Returns the checked pairs of indices of links.
    fn pairs(&self) -> Vec<[usize; 2]> {
        self.robot().pairs().to_vec()
    }

    /// Returns the ignored pairs of indices of links, with the reason.
    fn ignored(&self) -> Vec<([usize; 2], String)> {
        let text = |reason: IgnoredReason| match reason {
            IgnoredReason::Rigid => "rigid".to_owned(),
            IgnoredReason::Adjacent => "adjacent".to_owned(),
            IgnoredReason::Disabled(reason) if !reason.is_empty() => format!("disabled: {reason}"),
            _ => "disabled".to_owned(),
        };
        self.robot().ignored().into_iter().map(|(pair, reason)| (pair, text(reason))).collect()
    }

    fn warnings(&self) -> Vec<String> {
        self.loaded.warnings.iter().map(ToString::to_string).collect()
    }

    /// Raises an error if a configuration is invalid.
    fn check_rows(&self, q: &Bound<'_, PyAny>) -> PyResult<()> {
        let rows = self.robot().check_rows(&plain_column::<f64>(q)?);
        rows.map(|_| ()).map_err(|error| invalid(&error).raised(q.py()))
    }

    /// Returns the poses of all links in each configuration, (n, links, 4, 4).
    fn poses<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, loaded) = (q.py(), self.loaded.clone());
        let values = plain_column::<f64>(q)?;
        let rows = loaded.robot.check_rows(&values).map_err(|error| invalid(&error).raised(py))?;
        let links = loaded.robot.links().len();
        let matrices = workers::run(py, move |_| {
            let columns = loaded.robot.coordinates().len();
            let mut matrices = Vec::with_capacity(rows * links);
            for row in 0..rows {
                let poses = loaded.robot.poses(&values[row * columns..(row + 1) * columns])?;
                matrices.extend(poses.iter().map(matrix));
            }
            Ok(matrices)
        })?;
        let matrices = matrices.map_err(|error: ConfigurationError| invalid(&error).raised(py))?;
        row_array(py, matrices, &[rows, links])?.call_method1("reshape", (rows, links, 4, 4))
    }
}

impl From<LoadedRobot> for RobotCore {
    fn from(loaded: LoadedRobot) -> Self {
        Self { loaded: Arc::new(loaded) }
    }
}

impl RobotCore {
    pub(crate) fn loaded(&self) -> &Arc<LoadedRobot> {
        &self.loaded
    }

    fn robot(&self) -> &Robot {
        &self.loaded.robot
    }

    /// Returns the shape of a link, or `None` if there is no such link or it has no shape.
    pub(crate) fn shape(&self, link: usize) -> Option<&Shape> {
        self.robot().links().get(link)?.shape.as_ref()
    }
}

/// Returns the error about a value of a configuration.
pub(crate) fn invalid(error: &ConfigurationError) -> Fault {
    let (kind, at) = match *error {
        ConfigurationError::NonFinite { row, coordinate } => ("non-finite", vec![row, coordinate]),
        ConfigurationError::OutOfRange { row, coordinate } => ("out-of-range", vec![row, coordinate]),
        ConfigurationError::ZeroQuaternion { row, coordinate } => ("not-unit-quaternion", vec![row, coordinate]),
        _ => ("shape", Vec::new()),
    };
    Fault::new(kind, "q", error.to_string()).at(at)
}

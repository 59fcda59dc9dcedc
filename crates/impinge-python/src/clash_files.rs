//! What people look at and hand on of a report: its page, pictures, and BCF files.

use std::sync::Arc;

use impinge::clash::Report;
use impinge_report::bcf::{BcfOptions, BcfVersion, write_bcf};
use impinge_report::html::write_clash_page;
use impinge_report::picture::Gallery;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::clash::{Search, VERSION, no_unit};
use crate::pictures::pixels;
use crate::workers;

/// Report with its scenes, from which files are written.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct ClashFiles {
    search: Arc<Search>,
    report: Arc<Report>,
}

impl ClashFiles {
    pub(crate) fn new(search: &Arc<Search>, report: Report) -> Self {
        Self { search: Arc::clone(search), report: Arc::new(report) }
    }

    /// Runs a job on the report and its scenes.
    fn run<T: Send + 'static>(
        &self,
        py: Python<'_>,
        job: impl FnOnce(&Search, &Report) -> T + Send + 'static,
    ) -> PyResult<T> {
        let (search, report) = (Arc::clone(&self.search), Arc::clone(&self.report));
        workers::run(py, move |_| job(&search, &report))
    }
}

#[pymethods]
impl ClashFiles {
    /// Returns the page that shows the report in a browser.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        self.run(py, |search, report| {
            let sides = search.sides();
            let mut page = Vec::new();
            // Writing to a list of bytes cannot fail, and the page is UTF-8.
            let _ = write_clash_page(&mut page, &sides, report, &search.about(&sides), search.up, VERSION);
            String::from_utf8_lossy(&page).into_owned()
        })
    }

    /// Returns a picture of the clash or of the duplicates with an identity, (height, width, 3), or
    /// None if a part is unbounded or the report has no such identity.
    fn picture<'py>(&self, py: Python<'py>, id: String, size: [u32; 2]) -> PyResult<Option<Bound<'py, PyAny>>> {
        let drawn = self.run(py, move |search, report| {
            let sides = search.sides();
            let gallery = Gallery::new(&sides, search.unit, search.up, size);
            let clash = report.clashes.iter().find(|clash| clash.id == id);
            let set = report.duplicates.iter().find(|set| set.id == id);
            let view = clash.and_then(|clash| gallery.clash(clash));
            view.or_else(|| gallery.duplicates(set?)).map(|view| view.draw())
        })?;
        drawn.map(|picture| pixels(py, &picture)).transpose()
    }

    /// Returns the report as a BCF file. `date` is in seconds since the start of 1970.
    fn bcf<'py>(&self, py: Python<'py>, version: &str, date: i64) -> PyResult<Bound<'py, PyBytes>> {
        let unit = self.search.unit.ok_or_else(|| no_unit(py))?;
        let version = BcfVersion::ALL.into_iter().find(|known| known.name() == version).unwrap_or_default();
        let file = self.run(py, move |search, report| {
            let sides = search.sides();
            let options = BcfOptions { version, unit, up: search.up, date };
            let mut file = Vec::new();
            write_bcf(&mut file, report, &search.about(&sides), &sides, &options).map(|_| file)
        })?;
        Ok(PyBytes::new(py, &file?))
    }
}

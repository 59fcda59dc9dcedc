//! The page about the hierarchy.

use std::path::Path;

use impinge_report::html::{PageAbout, write_hierarchy_page};

use super::{Inspection, report};
use crate::axis::Axis;
use crate::failure::Failure;
use crate::numerals::counted;
use crate::output;

/// Writes the page.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(super) fn write(path: &Path, inspection: &Inspection, up: Axis) -> Result<(), Failure> {
    let Inspection { body, .. } = inspection;
    let file = &body.about.path;
    let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
    let rows = report::hierarchy(inspection).into_iter().map(|(name, value)| [name.to_owned(), value]);
    let about = PageAbout {
        title: name.clone(),
        heading: format!("Hierarchy of {}", counted(body.mesh.faces().len(), "triangle")),
        rows: rows.collect(),
        unit: body.about.unit,
        up: up.into(),
        version: env!("CARGO_PKG_VERSION"),
    };
    output::write(path, |out| write_hierarchy_page(out, &name, &body.mesh, &about))
}

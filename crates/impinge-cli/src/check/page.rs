//! The page about both meshes.

use std::path::Path;

use impinge::query;
use impinge_files::{Format, Unit};
use impinge_report::html::{PageAbout, PairPage, write_pair_page};
use impinge_report::picture;

use super::{Outcome, report};
use crate::axis::Axis;
use crate::failure::Failure;
use crate::{output, units};

/// Writes the page. `up` is the axis that points up, if it was stated.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(super) fn write(path: &Path, outcome: &Outcome, up: Option<Axis>) -> Result<(), Failure> {
    let bodies = &outcome.bodies;
    let is_gltf = bodies.iter().any(|body| matches!(body.about.format, Format::Gltf | Format::Glb));
    let up = up.map_or(if is_gltf { picture::Axis::Y } else { picture::Axis::Z }, picture::Axis::from);
    let names = [0, 1].map(|side| {
        let path = &bodies[side].about.path;
        path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
    });
    let unit = units::common(outcome.units());
    let symbol = unit.map_or(String::new(), |unit: Unit| format!(" {unit}"));
    let mut rows: Vec<[String; 2]> = ["A", "B"]
        .into_iter()
        .zip(0..)
        .map(|(name, side)| {
            let cells = report::describe(&bodies[side], outcome.bounds[side].as_ref());
            [name.to_owned(), format!("{}: {}", names[side], cells.join(", "))]
        })
        .collect();
    let of_report = report::findings(outcome).into_iter().filter(|(name, _)| *name != "time");
    rows.extend(of_report.map(|(name, value)| [name.to_owned(), value]));
    let meshes = outcome.placed([false; 2]);
    let surfaces = (!outcome.intersects()).then(|| query::distance(meshes[0], meshes[1]));
    if let (Some(distance), None) = (&surfaces, &outcome.distance) {
        rows.push(["distance".to_owned(), report::distance_text(outcome, distance, &symbol)]);
    }
    let nearest = surfaces.and_then(|distance| distance.witness).map(|witness| [witness.point_a, witness.point_b]);
    let curves = outcome.curves.as_ref().map_or(&[][..], |curves| &curves.polylines);
    let about = PageAbout {
        title: names.join(", "),
        heading: report::headline(outcome).concat(),
        rows,
        unit,
        up,
        version: env!("CARGO_PKG_VERSION"),
    };
    let page = PairPage { names, meshes, pairs: &outcome.pairs, curves, nearest };
    output::write(path, |out| write_pair_page(out, &page, &about))
}

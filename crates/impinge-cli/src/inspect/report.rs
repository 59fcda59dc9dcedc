//! The text report.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};

use super::Inspection;
use crate::numerals::{count, counted, length, time};
use crate::repair;

const STRONG: Style = Style::new().bold();
const FAINT: Style = Style::new().dimmed();
const SOUND: Style = Style::new().bold().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Green)));
const ODD: Style = Style::new().bold().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Yellow)));

/// Returns the report with ANSI styles; the output stream keeps or strips them.
pub(super) fn text(inspection: &Inspection) -> String {
    let mut text = head(inspection);
    let mut section = |title: &str, rows: Vec<(&'static str, String)>| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n{STRONG}{title}{STRONG:#}");
        for (label, value) in rows {
            let _ = writeln!(text, "  {FAINT}{label:<20}{FAINT:#}{value}");
        }
    };
    section("hierarchy", hierarchy(inspection));
    section("mesh", health(inspection));
    if let Some(proxies) = &inspection.proxies {
        section("proxies", proxies.rows());
    }
    let seconds = inspection.seconds;
    let times = [("load", seconds.load), ("build", seconds.build), ("inspect", seconds.inspect)];
    text += "\n";
    if let Some(drawn) = &inspection.drawn {
        let boxes = if drawn.boxes == 1 { "1 box".to_owned() } else { format!("{} boxes", count(drawn.boxes)) };
        let _ = writeln!(text, "{FAINT}picture{FAINT:#}  {boxes} of level {} in {}", drawn.level, drawn.path);
    }
    let times = times.map(|(phase, seconds)| format!("{phase} {}", time(seconds))).join(", ");
    let _ = writeln!(text, "{FAINT}time{FAINT:#}     {times}");
    text
}

fn head(inspection: &Inspection) -> String {
    let Inspection { body, bounds, .. } = inspection;
    let extents = match bounds {
        Some(bounds) => bounds.extents().map(length).join(" x "),
        None => "empty".to_owned(),
    };
    let vertices = match body.mesh.positions().len() {
        1 => "1 vertex".to_owned(),
        n => format!("{} vertices", count(n)),
    };
    format!(
        "{STRONG}{}{STRONG:#}\n  {}  {}  {vertices}  {}  {extents} {}\n",
        body.about.path.display(),
        body.about.format,
        counted(body.mesh.faces().len(), "triangle"),
        counted(body.about.parts.len(), "part"),
        body.about.unit.map_or("(no unit)", |unit| unit.symbol()),
    )
}

pub(super) fn hierarchy(inspection: &Inspection) -> Vec<(&'static str, String)> {
    let tree = &inspection.tree;
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let bytes = inspection.body.mesh.memory();
    let each = match inspection.body.mesh.faces().len() {
        0 => String::new(),
        faces => format!(", {:.1} bytes a triangle", bytes as f64 / faces as f64),
    };
    vec![
        ("nodes", format!("{} of eight children, {} full", count(tree.inner), percent(tree.node_fill))),
        ("leaves", format!("{} of eight triangles, {} full", count(tree.leaves), percent(tree.leaf_fill))),
        ("depth", count(tree.depth)),
        ("surface area", format!("{:.1} times the area of the root, over all boxes", tree.sah)),
        ("overlap", format!("{} of a node's area, for all pairs of its children", percent(tree.overlap))),
        ("memory", format!("{:.1} MB{each}", bytes as f64 / 1e6)),
    ]
}

fn health(inspection: &Inspection) -> Vec<(&'static str, String)> {
    let health = &inspection.health;
    let odd = |n: usize| if n == 0 { "none".to_owned() } else { format!("{ODD}{}{ODD:#}", count(n)) };
    let closed = if inspection.body.mesh.faces().is_empty() {
        "empty".to_owned()
    } else if health.is_manifold() {
        format!("{SOUND}closed{SOUND:#}: each edge has two faces, oriented consistently")
    } else if inspection.body.mesh.is_closed() {
        format!("{SOUND}closed{SOUND:#}: each edge has as many faces in one direction as in the other")
    } else {
        format!("{ODD}not closed{ODD:#}: its inside is not well defined")
    };
    let precision = match health.double_coordinates {
        0 => "single precision holds every coordinate exactly".to_owned(),
        n => format!("double precision is needed for {}", counted(n, "coordinate")),
    };
    let mut rows = vec![("surface", closed)];
    if let Some(diagnosis) = repair::diagnosis(&inspection.body.mesh, health) {
        rows.push(("to repair", diagnosis));
    }
    rows.extend([
        ("pieces", count(health.components)),
        ("open edges", odd(health.open_edges)),
        ("non-manifold edges", odd(health.non_manifold_edges)),
        ("misoriented edges", odd(health.misoriented_edges)),
        ("faces without area", odd(health.degenerate_faces)),
        ("duplicate faces", odd(health.duplicate_faces)),
        ("duplicate vertices", odd(health.duplicate_vertices)),
        ("unused vertices", odd(health.unused_vertices)),
        ("precision", precision),
    ]);
    rows
}

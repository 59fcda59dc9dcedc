//! The text report: a table of volumes.

use std::fmt::Write;

use anstyle::Style;

use super::Outcome;
use super::advice::advice;
use super::measure::{HullRow, Row};
use crate::numerals::{counted, length, short_time};

const STRONG: Style = Style::new().bold();
const FAINT: Style = Style::new().dimmed();

/// Returns the report with ANSI styles; the output stream keeps or strips them.
pub(super) fn text(outcome: &Outcome) -> String {
    let about = &outcome.body.about;
    let unit = about.unit.map_or("(no unit)", |unit| unit.symbol());
    let mut text = format!("{STRONG}{}{STRONG:#}\n", about.path.display());
    // Writing to a String cannot fail.
    let triangles = counted(outcome.body.mesh.faces().len(), "triangle");
    let _ = writeln!(text, "{}  {triangles}  {}  {unit}\n", about.format, counted(outcome.points, "corner"));
    let header = ["volume", "size", "area", "bytes", "build", "test", "turn"].map(str::to_owned);
    let cells: Vec<[String; 7]> = std::iter::once(hull_cells(&outcome.hull))
        .chain(outcome.rows.iter().map(|row| cells(row, &outcome.hull)))
        .collect();
    let widths: [usize; 7] = std::array::from_fn(|column| {
        cells.iter().chain([&header]).map(|row| row[column].chars().count()).max().unwrap_or(0)
    });
    let line = |row: &[String; 7]| {
        let first = format!("{:<1$}", row[0], widths[0]);
        let rest = (1..7).map(|column| format!("{:>1$}", row[column], widths[column]));
        std::iter::once(first).chain(rest).collect::<Vec<_>>().join("  ")
    };
    let _ = writeln!(text, "{FAINT}{}{FAINT:#}", line(&header));
    for row in &cells {
        let _ = writeln!(text, "{}", line(row));
    }
    let _ = writeln!(
        text,
        "\n{FAINT}size and area are relative to the convex hull; test is one overlap test and turn is following one rotation (for hulls: an exact test, and posing the hull){FAINT:#}\n"
    );
    for advice in advice(&outcome.hull, &outcome.rows) {
        let _ = writeln!(text, "{FAINT}{:<13}{FAINT:#}{}", advice.label, advice.sentence);
    }
    text
}

fn hull_cells(hull: &HullRow) -> [String; 7] {
    let [size, area] = [hull.volume, hull.surface_area].map(|own| relative(own, own));
    let [build, test, turn] = [hull.build, hull.overlap, hull.follow].map(short_time);
    ["convex hull".to_owned(), size, area, hull.bytes.to_string(), build, test, turn]
}

fn cells(row: &Row, hull: &HullRow) -> [String; 7] {
    [
        row.name.to_owned(),
        relative(row.volume, hull.volume),
        relative(row.surface_area, hull.surface_area),
        row.bytes.to_string(),
        short_time(row.build),
        short_time(row.overlap),
        short_time(row.follow),
    ]
}

/// Returns the value relative to the value of the hull; `-` if the hull is flat.
fn relative(own: f64, of_hull: f64) -> String {
    if of_hull > 0.0 { length(own / of_hull) } else { "-".to_owned() }
}

//! The text report.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};
use impinge::query::{Contained, Distance, Penetrates, Proximity, Witness};

use super::Outcome;
use crate::Verdict;
use crate::body::Body;
use crate::bounds::Bounds;
use crate::numerals::{count, counted, length, time};
use crate::units;

const STRONG: Style = Style::new().bold();
const FAINT: Style = Style::new().dimmed();
const CLEAR: Style = Style::new().bold().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Green)));
const COLLISION: Style = Style::new().bold().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Red)));

/// Returns the report with ANSI styles; the output stream keeps or strips them.
pub(super) fn text(outcome: &Outcome) -> String {
    let mut text = meshes(outcome);
    text += "\n";
    text += &verdict(outcome);
    text += "\n";
    for (label, value) in findings(outcome) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{FAINT}{label:<10}{FAINT:#}{value}");
    }
    text
}

/// Returns the first line: the same verdict as the exit code, and the number of pairs.
fn verdict(outcome: &Outcome) -> String {
    let style = if outcome.verdict() == Verdict::Clear { CLEAR } else { COLLISION };
    let [headline, counted] = headline(outcome);
    format!("{style}{headline}{style:#}{counted}\n")
}

/// Returns the verdict, and the number of pairs after a colon if there are any.
pub(super) fn headline(outcome: &Outcome) -> [String; 2] {
    let pairs = outcome.pairs.len();
    let headline = match (pairs, outcome.solid.and_then(|solid| solid.contained)) {
        (0, None) => "No intersection".to_owned(),
        (0, Some(contained)) => inside(contained).to_owned(),
        (_, _) => "The meshes intersect".to_owned(),
    };
    let headline = match outcome.penetrates {
        None => headline,
        Some(Penetrates::No) if pairs > 0 => "The meshes touch, but do not penetrate".to_owned(),
        Some(Penetrates::No) => "No intersection".to_owned(),
        Some(Penetrates::Yes) => "The meshes penetrate each other".to_owned(),
        Some(Penetrates::Undecided) => "The meshes may penetrate each other: undecided".to_owned(),
    };
    let counted = if pairs == 0 { String::new() } else { format!(": {} of faces", counted(pairs, "pair")) };
    [headline, counted]
}

fn inside(contained: Contained) -> &'static str {
    match contained {
        Contained::A => "A lies inside B",
        Contained::B => "B lies inside A",
        Contained::Both => "Parts of each lie inside the other",
    }
}

/// Returns two lines for each mesh. The columns of the second lines are aligned.
fn meshes(outcome: &Outcome) -> String {
    let cells = [0, 1].map(|side| describe(&outcome.bodies[side], outcome.bounds[side].as_ref()));
    let widths: Vec<usize> = cells[0].iter().zip(&cells[1]).map(|(a, b)| a.len().max(b.len())).collect();
    let mut text = String::new();
    for (side, name) in ["A", "B"].into_iter().enumerate() {
        let [format, triangles, vertices, parts, extents] = &cells[side];
        let _ = writeln!(text, "{STRONG}{name}  {}{STRONG:#}", outcome.bodies[side].about.path.display());
        let _ = writeln!(
            text,
            "   {format:<0$}  {triangles:>1$}  {vertices:>2$}  {parts:>3$}  {extents}",
            widths[0], widths[1], widths[2], widths[3]
        );
    }
    text
}

pub(super) fn describe(body: &Body, bounds: Option<&Bounds>) -> [String; 5] {
    let about = &body.about;
    let extents = match bounds {
        Some(bounds) => bounds.extents().map(length).join(" x "),
        None => "empty".to_owned(),
    };
    let unit = about.unit.map_or("(no unit)", |unit| unit.symbol());
    [
        about.format.to_string(),
        counted(body.mesh.faces().len(), "triangle"),
        match body.mesh.positions().len() {
            1 => "1 vertex".to_owned(),
            n => format!("{} vertices", count(n)),
        },
        counted(about.parts.len(), "part"),
        format!("{extents} {unit}"),
    ]
}

/// Returns the distance and the nearest points as text.
pub(super) fn distance_text(outcome: &Outcome, distance: &Distance, unit: &str) -> String {
    let Some(Witness { point_a, point_b, faces: Some([face_a, face_b]) }) = distance.witness else {
        let is_inside = distance.upper == 0.0;
        return if is_inside { "0: one lies inside the other" } else { "infinite: a mesh is empty" }.to_owned();
    };
    let is_undecided = distance.proximity == Proximity::Undecided;
    let alternative = if is_undecided { "0 if one lies inside the other, which is undecided; else " } else { "" };
    let mut text = format!("{alternative}{}{unit}", length(distance.upper));
    let ends = [(0, "A", face_a, point_a), (1, "B", face_b, point_b)];
    for (side, name, face, point) in ends {
        let about = &outcome.bodies[side].about;
        let part = if about.parts.len() > 1 { format!(" of {}", about.part(face)) } else { String::new() };
        let _ = write!(text, "; {name} face {}{part} at {}", count(face as usize), point.map(length).join(", "));
    }
    text
}

/// Returns the labeled lines below the verdict.
pub(super) fn findings(outcome: &Outcome) -> Vec<(&'static str, String)> {
    let mut findings = Vec::new();
    if let (Some(contained), false) = (outcome.solid.and_then(|solid| solid.contained), outcome.pairs.is_empty()) {
        findings.push(("inside", format!("{}, in part", inside(contained))));
    }
    if outcome.solid.is_some_and(|solid| solid.undecided) {
        findings.push((
            "undecided",
            "the winding number of an open mesh is too close to one half to prove what counts as inside".to_owned(),
        ));
    }
    if let (Some(curves), false) = (&outcome.curves, outcome.pairs.is_empty()) {
        let closed = curves.closed();
        let open = curves.polylines.len() - closed;
        let unit = units::common(outcome.units()).map_or(String::new(), |unit| format!(" {unit}"));
        findings.push((
            "curves",
            format!("{} closed, {} open; {}{unit} long in all", count(closed), count(open), length(curves.length())),
        ));
        if !curves.points.is_empty() {
            findings.push(("touching", format!("at {}", counted(curves.points.len(), "single point"))));
        }
        findings.push(("coplanar", format!("{} of faces", counted(curves.coplanar_pairs, "pair"))));
    }
    let unit = units::common(outcome.units()).map_or(String::new(), |unit| format!(" {unit}"));
    if let Some(distance) = &outcome.distance {
        findings.push(("distance", distance_text(outcome, distance, &unit)));
    }
    if let Some(clearance) = outcome.clearance {
        let kept = if clearance.is_violated { "not kept" } else { "kept" };
        findings.push(("clearance", format!("{}{unit} is {kept}", length(clearance.required))));
    }
    let seconds = outcome.seconds;
    let times = [("load", seconds.load), ("build", seconds.build), ("query", seconds.query)];
    findings.push(("time", times.map(|(phase, seconds)| format!("{phase} {}", time(seconds))).join(", ")));
    findings
}

//! Writes a report as JSON: one object of schema `impinge.clash/1`.
//!
//! Each item of a list is a line of its own, so that people can edit statuses and compare two
//! reports. The bytes do not depend on the number of threads or on the time.

use std::io::{self, Write};

use impinge::clash::{Clash, DuplicateSet, Gone, Group, Inner, Kind, Known, Member, Report, Shared};
use impinge::query::Curves;
use serde::Serialize;

use super::about::ReportAbout;
use crate::unit::Unit;

/// Name of the schema, which [`load_previous`](super::load_previous) expects.
pub(super) const SCHEMA: &str = "impinge.clash/1";

/// Writes a report as one JSON object. `version` is the version of the program.
///
/// # Errors
/// Returns the errors of the output.
pub fn write_clash_json(
    out: &mut dyn Write,
    report: &Report,
    about: &ReportAbout<'_>,
    version: &str,
) -> io::Result<()> {
    let length = |x: f64| length_text(x, about.unit);
    write!(out, "{{\"schema\":{},\"version\":{}", text(&SCHEMA)?, text(&version)?)?;
    if let Some(unit) = about.unit {
        field(out, "unit", &unit.symbol())?;
    }
    list(out, "scenes", about.scenes.iter())?;
    field(out, "asked", &about.asked)?;
    if let Some(rules) = about.rules {
        let used = rules.rules.iter().zip(&report.checked_by_rule).map(|(rule, &pairs)| RuleRow {
            name: &rule.name,
            a: &rule.a,
            b: &rule.b,
            tolerance: rule.tolerance,
            clearance: rule.clearance,
            severity: rule.severity.as_deref(),
            pairs,
        });
        list(out, "rules", used)?;
        let ignored = rules.ignores.iter().zip(&report.ignored_by_rule);
        list(
            out,
            "ignores",
            ignored.map(|(ignore, &pairs)| IgnoreRow { why: &ignore.why, a: &ignore.a, b: &ignore.b, pairs }),
        )?;
    }
    field(out, "counts", &counts(report, about))?;
    let decades = report.decades.decades.iter();
    list(out, "decades", decades.map(|decade| Decade { from: decade.from, to: decade.to, pairs: decade.count }))?;
    if let Some(gap) = report.decades.gap {
        let (below, inside, above) = (gap.below, gap.inside, gap.above);
        field(out, "widest_gap", &WidestGap { from: gap.from, to: gap.to, below, inside, above })?;
    }
    list(out, "duplicates", report.duplicates.iter().map(|set| duplicates(set, about)))?;
    list(out, "groups", report.groups.iter().map(|each| group(each, report, &length)))?;
    list(out, "clashes", report.clashes.iter().map(|each| clash(each, about)))?;
    if let Some(all) = &report.gone {
        list(out, "gone", all.iter().map(gone))?;
    }
    if let Some(stopped) = report.stopped {
        field(out, "complete", &false)?;
        field(out, "stopped", &stopped.to_string())?;
    }
    out.write_all(b"}\n")
}

/// Formats a length for a sentence: to four digits, with its unit. Lengths below a meter are in
/// millimeters if the unit is the meter or the centimeter.
///
/// ```
/// use impinge_files::{Unit, length_text};
///
/// assert_eq!(length_text(0.0361, Some(Unit::Meter)), "36.1 mm");
/// ```
#[must_use]
pub fn length_text(x: f64, unit: Option<Unit>) -> String {
    let (x, unit) = match unit {
        Some(Unit::Meter | Unit::Centimeter) if x * unit.map_or(1.0, Unit::meters) < 1.0 => {
            (x * unit.map_or(1.0, Unit::meters) * 1e3, Some(Unit::Millimeter))
        }
        unit => (x, unit),
    };
    let digits = format!("{x:.3e}");
    // The shortest text of the number rounded to four digits.
    let rounded = digits.parse::<f64>().unwrap_or(x);
    let number = if rounded == 0.0 || (1e-3..1e6).contains(&rounded) { rounded.to_string() } else { digits };
    unit.map_or(number.clone(), |unit| format!("{number} {unit}"))
}

fn text(value: &impl Serialize) -> io::Result<String> {
    serde_json::to_string(value).map_err(io::Error::other)
}

fn field(out: &mut dyn Write, name: &str, value: &impl Serialize) -> io::Result<()> {
    write!(out, ",\n{}:{}", text(&name)?, text(value)?)
}

fn list<T: Serialize>(out: &mut dyn Write, name: &str, items: impl Iterator<Item = T>) -> io::Result<()> {
    write!(out, ",\n{}:[", text(&name)?)?;
    for (at, item) in items.enumerate() {
        write!(out, "{}{}", if at > 0 { ",\n" } else { "\n" }, text(&item)?)?;
    }
    out.write_all(b"]")
}

#[derive(Serialize)]
struct RuleRow<'r> {
    name: &'r str,
    a: &'r str,
    b: &'r str,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    severity: Option<&'r str>,
    pairs: usize,
}

#[derive(Serialize)]
struct IgnoreRow<'r> {
    why: &'r str,
    a: &'r str,
    b: &'r str,
    pairs: usize,
}

#[derive(Serialize)]
struct CountsRow {
    candidates: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    unchecked: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ignored: Option<usize>,
    duplicate: usize,
    contained: usize,
    clash: usize,
    undecided: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<usize>,
}

fn counts(report: &Report, about: &ReportAbout<'_>) -> CountsRow {
    let counts = report.counts;
    let has_clearance = about.asked.clearance.is_some()
        || about.rules.is_some_and(|rules| rules.rules.iter().any(|rule| rule.clearance.is_some()));
    CountsRow {
        candidates: counts.candidates,
        unchecked: about.rules.map(|_| counts.unchecked),
        ignored: about.rules.map(|_| counts.ignored),
        duplicate: counts.duplicate,
        contained: counts.contained,
        clash: counts.clash,
        undecided: counts.undecided,
        contact: about.asked.contacts.then_some(counts.contact),
        clearance: has_clearance.then_some(counts.clearance),
    }
}

#[derive(Serialize)]
struct Decade {
    from: f64,
    to: f64,
    pairs: usize,
}

#[derive(Serialize)]
struct WidestGap {
    from: f64,
    to: f64,
    below: usize,
    inside: usize,
    above: usize,
}

#[derive(Serialize)]
struct Part<'r> {
    scene: &'r str,
    part: usize,
    key: &'r str,
    #[serde(rename = "type", skip_serializing_if = "str::is_empty")]
    kind: &'r str,
    name: &'r str,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    path: &'r [String],
}

fn part(member: &Member) -> Part<'_> {
    let Member { scene, part, key, kind, name, path } = member;
    Part { scene, part: part.index(), key, kind, name, path }
}

#[derive(Serialize)]
struct DuplicateRow<'r> {
    id: &'r str,
    #[serde(flatten)]
    labels: Labels<'r>,
    parts: Vec<Part<'r>>,
}

/// Statements of people and rules about a clash.
#[derive(Serialize)]
struct Labels<'r> {
    #[serde(skip_serializing_if = "Option::is_none")]
    rule: Option<&'r str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    severity: Option<&'r str>,
    status: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    accepted: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<&'r str>,
}

fn rule_name<'r>(about: &ReportAbout<'r>, rule: Option<usize>) -> Option<&'r str> {
    about.rules?.rules.get(rule?).map(|rule| rule.name.as_str())
}

fn duplicates<'r>(set: &'r DuplicateSet, about: &ReportAbout<'r>) -> DuplicateRow<'r> {
    let (severity, note) = (set.severity.as_deref(), set.note.as_deref());
    let rule = rule_name(about, set.rule);
    let labels = Labels { rule, severity, status: set.status.name(), accepted: None, note };
    DuplicateRow { id: &set.id, labels, parts: set.parts.iter().map(|member| part(member)).collect() }
}

#[derive(Serialize)]
struct GroupRow<'r> {
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<Part<'r>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    types: Option<&'r [String; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scenes: Option<&'r [String; 2]>,
    sentence: String,
    clashes: Vec<&'r str>,
}

fn group<'r>(group: &'r Group, report: &'r Report, length: &dyn Fn(f64) -> String) -> GroupRow<'r> {
    let (mut by_part, mut types, mut scenes) = (None, None, None);
    match &group.by {
        Shared::Part(member) => by_part = Some(part(member)),
        Shared::Types(pair) => types = Some(pair),
        Shared::Scenes(pair) => scenes = Some(pair),
    }
    let clashes = group.clashes.iter().map(|&at| report.clashes[at].id.as_str()).collect();
    GroupRow { part: by_part, types, scenes, sentence: group.sentence(report, length), clashes }
}

#[derive(Serialize)]
struct ClashRow<'r> {
    id: &'r str,
    kind: &'static str,
    /// The part that lies inside the other, `a` or `b`.
    #[serde(skip_serializing_if = "Option::is_none")]
    inner: Option<&'static str>,
    #[serde(flatten)]
    labels: Labels<'r>,
    a: Part<'r>,
    b: Part<'r>,
    /// The upper bound is null if it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    faces: Option<[u32; 2]>,
    /// Polylines, and then one list with a single point for each isolated point in which the
    /// surfaces touch.
    #[serde(skip_serializing_if = "Option::is_none")]
    curves: Option<Vec<&'r [[f64; 3]]>>,
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    bounds: Option<[[f64; 3]; 2]>,
    proved: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
}

fn clash<'r>(clash: &'r Clash, about: &ReportAbout<'r>) -> ClashRow<'r> {
    ClashRow {
        id: &clash.id,
        kind: clash.kind.name(),
        inner: match clash.kind {
            Kind::Contained(Inner::A) => Some("a"),
            Kind::Contained(Inner::B) => Some("b"),
            _ => None,
        },
        labels: Labels {
            rule: rule_name(about, clash.rule),
            severity: clash.severity.as_deref(),
            status: clash.status.name(),
            accepted: clash.accepted,
            note: clash.note.as_deref(),
        },
        a: part(&clash.a),
        b: part(&clash.b),
        depth: clash.depth,
        gap: clash.gap,
        volume: clash.volume,
        point: clash.point,
        normal: clash.normal,
        faces: clash.faces,
        curves: clash.curves.as_ref().map(lines),
        bounds: clash.bounds,
        proved: clash.proved,
        why: clash.why.map(|why| why.to_string()),
    }
}

fn lines(curves: &Curves) -> Vec<&[[f64; 3]]> {
    let points = curves.points.iter().map(std::slice::from_ref);
    curves.polylines.iter().map(Vec::as_slice).chain(points).collect()
}

#[derive(Serialize)]
struct GoneRow<'r> {
    id: &'r str,
    kind: &'r str,
    status: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<&'r str>,
    parts: &'r [String],
    names: &'r [String],
    /// The parts that no longer exist.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    removed: &'r [String],
}

fn gone(gone: &Gone) -> GoneRow<'_> {
    let Known { id, kind, status, depth, gap, accepted: _, note, parts, names } = &gone.clash;
    let (note, removed) = (note.as_deref(), &gone.removed[..]);
    GoneRow { id, kind, status: status.name(), depth: *depth, gap: *gap, note, parts, names, removed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_four_digits_and_a_unit_of_their_size() {
        let cases = [
            (0.036, Some(Unit::Meter), "36 mm"),
            (0.012_345_6, Some(Unit::Meter), "12.35 mm"),
            (1.5, Some(Unit::Meter), "1.5 m"),
            (1e-9, Some(Unit::Meter), "1.000e-6 mm"),
            (0.0, Some(Unit::Meter), "0 mm"),
            (36.0, Some(Unit::Millimeter), "36 mm"),
            (0.25, Some(Unit::Inch), "0.25 in"),
            (0.25, None, "0.25"),
            (2_345_678.0, None, "2.346e6"),
        ];
        for (length, unit, expected) in cases {
            assert_eq!(length_text(length, unit), expected);
        }
    }
}

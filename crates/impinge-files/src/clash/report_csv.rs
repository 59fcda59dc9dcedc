//! Writes a report as CSV, with one row a clash.

use std::io::{self, Write};
use std::sync::Arc;

use impinge::clash::{Clash, Member, Report};

use super::about::ReportAbout;

/// Columns of the file.
const COLUMNS: [&str; 31] = [
    "id",
    "kind",
    "status",
    "rule",
    "severity",
    "unit",
    "depth_lower",
    "depth_upper",
    "gap_lower",
    "gap_upper",
    "x",
    "y",
    "z",
    "a_scene",
    "a_key",
    "a_type",
    "a_name",
    "a_path",
    "b_scene",
    "b_key",
    "b_type",
    "b_name",
    "b_path",
    "proved",
    "why",
    "accepted",
    "note",
    "a_part",
    "b_part",
    "volume_lower",
    "volume_upper",
];

/// Writes a report as CSV with a head. Each clash is a row, and each duplicate of a set is a row
/// with the first part of the set. Lengths have all digits.
///
/// # Errors
/// Returns the errors of the output.
pub fn write_clash_csv(out: &mut dyn Write, report: &Report, about: &ReportAbout<'_>) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(COLUMNS)?;
    let unit = about.unit.map_or("", |unit| unit.symbol());
    let rule = |rule: Option<usize>| {
        let rule = about.rules.zip(rule).and_then(|(rules, rule)| rules.rules.get(rule));
        rule.map_or(String::new(), |rule| rule.name.clone())
    };
    for set in &report.duplicates {
        for part in &set.parts[1..] {
            let (severity, note) = (set.severity.clone().unwrap_or_default(), set.note.clone().unwrap_or_default());
            let mut row =
                vec![set.id.clone(), "duplicate".to_owned(), set.status.to_string(), rule(set.rule), severity];
            row.push(unit.to_owned());
            row.resize(13, String::new());
            push_parts(&mut row, [&set.parts[0], part]);
            row.extend(["true".to_owned(), String::new(), String::new(), note]);
            push_numbers(&mut row, [&set.parts[0], part]);
            row.resize(COLUMNS.len(), String::new());
            csv.write_record(&row)?;
        }
    }
    for clash in &report.clashes {
        let Clash { id, kind, status, severity, depth, gap, volume, point, proved, why, accepted, note, .. } = clash;
        let text = |text: &Option<String>| text.clone().unwrap_or_default();
        let numbers = |numbers: Option<&[f64]>, count: usize| match numbers {
            // An infinite upper bound is not known.
            Some(numbers) => {
                numbers.iter().map(|x| if x.is_finite() { format!("{x:?}") } else { String::new() }).collect()
            }
            None => vec![String::new(); count],
        };
        let mut row = vec![id.clone(), kind.name().to_owned(), status.to_string(), rule(clash.rule), text(severity)];
        row.push(unit.to_owned());
        row.extend(numbers(depth.as_ref().map(|depth| &depth[..]), 2));
        row.extend(numbers(gap.as_ref().map(|gap| &gap[..]), 2));
        row.extend(numbers(point.as_ref().map(|point| &point[..]), 3));
        push_parts(&mut row, [&clash.a, &clash.b]);
        row.push(proved.to_string());
        row.push(why.map_or(String::new(), |why| why.to_string()));
        row.extend(numbers(accepted.as_ref().map(std::slice::from_ref), 1));
        row.push(text(note));
        push_numbers(&mut row, [&clash.a, &clash.b]);
        row.extend(numbers(volume.as_ref().map(|volume| &volume[..]), 2));
        csv.write_record(&row)?;
    }
    csv.flush()
}

fn push_parts(row: &mut Vec<String>, parts: [&Arc<Member>; 2]) {
    for part in parts {
        let Member { scene, key, kind, name, path, .. } = &**part;
        row.extend([scene.clone(), key.clone(), kind.clone(), name.clone(), path.join("/")]);
    }
}

fn push_numbers(row: &mut Vec<String>, parts: [&Arc<Member>; 2]) {
    row.extend(parts.map(|part| part.part.index().to_string()));
}

//! Reads a report back, for the statuses of the next report.
//!
//! Unknown fields are ignored, and fields that the statuses do not need may be absent.

use std::path::Path;

use impinge::clash::{Known, Previous, Status};
use serde::Deserialize;

use super::length::Length;
use super::report_json::SCHEMA;
use crate::{
    error::{LoadError, Place},
    limits::Limits,
    regular_file::read_regular_file,
    unit::Unit,
};

#[derive(Deserialize)]
struct File {
    #[serde(default)]
    schema: String,
    unit: Option<String>,
    #[serde(default)]
    asked: Question,
    #[serde(default)]
    duplicates: Vec<Row>,
    #[serde(default)]
    clashes: Vec<Row>,
}

#[derive(Default, Deserialize)]
struct Question {
    tolerance: Option<f64>,
    clearance: Option<f64>,
}

#[derive(Deserialize)]
struct Row {
    id: String,
    kind: Option<String>,
    status: Option<String>,
    depth: Option<[Option<f64>; 2]>,
    gap: Option<[Option<f64>; 2]>,
    accepted: Option<f64>,
    note: Option<String>,
    a: Option<Part>,
    b: Option<Part>,
    #[serde(default)]
    parts: Vec<Part>,
}

#[derive(Deserialize)]
struct Part {
    #[serde(default)]
    scene: String,
    #[serde(default)]
    key: String,
    #[serde(default)]
    name: String,
}

/// Loads the clashes of a report that [`write_clash_json`](super::write_clash_json) wrote. Lengths
/// are converted to `unit`, the unit of the scenes.
///
/// # Errors
/// Returns an error if the file cannot be read, is not such a report, or has an unknown status. The
/// error names the line or the clash.
pub fn load_previous(path: impl AsRef<Path>, unit: Option<Unit>, limits: &Limits) -> Result<Previous, LoadError> {
    let path = path.as_ref();
    let load = || parse_previous(&read_regular_file(path, limits)?, unit);
    load().map_err(|e| e.in_file(path))
}

/// Reads a report from bytes, as [`load_previous`] does from a file.
///
/// # Errors
/// Returns an error as [`load_previous`] does; the path of the error is empty.
pub fn parse_previous(bytes: &[u8], unit: Option<Unit>) -> Result<Previous, LoadError> {
    let file: File = serde_json::from_slice(bytes).map_err(|error| {
        LoadError::refused("a report that --json or --bcf of impinge clash wrote", &error)
            .at(Place::Line(error.line() as u64))
    })?;
    if file.schema != SCHEMA {
        let entry = Place::Entry("schema".to_owned());
        return Err(LoadError::syntax(format!("the schema {SCHEMA}"), file.schema.as_bytes()).at(entry));
    }
    let stated = match &file.unit {
        None => None,
        Some(text) => Some(text.parse::<Unit>().map_err(|error| {
            LoadError::syntax(error.to_string(), text.as_bytes()).at(Place::Entry("unit".to_owned()))
        })?),
    };
    let length = |value: f64| {
        let converted = Length { value, unit: stated }.in_unit(unit);
        converted.ok_or_else(|| {
            LoadError::syntax(super::NO_UNIT, file.unit.as_deref().unwrap_or_default().as_bytes())
                .at(Place::Entry("unit".to_owned()))
                .with_hint(super::NO_UNIT_HINT)
        })
    };
    let interval = |bounds: Option<[Option<f64>; 2]>| {
        let Some([lower, upper]) = bounds else { return Ok(None) };
        let upper = upper.map_or(Ok(f64::INFINITY), length)?;
        Ok::<_, LoadError>(Some([length(lower.unwrap_or(0.0))?, upper]))
    };
    let known = |row: Row| {
        let status = match row.status {
            None => Status::New,
            Some(text) => text.parse::<Status>().map_err(|error| {
                LoadError::syntax(format!("a status ({error})"), text.as_bytes())
                    .at(Place::Entry(format!("clash {:?}", row.id)))
            })?,
        };
        let members: Vec<Part> = row.a.into_iter().chain(row.b).chain(row.parts).collect();
        Ok(Known {
            id: row.id,
            kind: row.kind.unwrap_or_else(|| "clash".to_owned()),
            status,
            depth: interval(row.depth)?,
            gap: interval(row.gap)?,
            accepted: row.accepted.map(length).transpose()?,
            note: row.note,
            parts: members.iter().map(|part| format!("{}/{}", part.scene, part.key)).collect(),
            names: members.into_iter().map(|part| part.name).collect(),
        })
    };
    // A set of duplicates has no kind of its own.
    let set = |row: Row| known(Row { kind: Some("duplicate".to_owned()), ..row });
    let sets = file.duplicates.into_iter().map(set);
    let clashes = sets.collect::<Result<Vec<_>, LoadError>>()?;
    let rest = file.clashes.into_iter().map(known).collect::<Result<Vec<_>, LoadError>>()?;
    let Question { tolerance, clearance } = file.asked;
    let [tolerance, clearance] = [tolerance, clearance].map(|bound| bound.map(length).transpose());
    Ok(Previous { clashes: [clashes, rest].concat(), tolerance: tolerance?, clearance: clearance? })
}

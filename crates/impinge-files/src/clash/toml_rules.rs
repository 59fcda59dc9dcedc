//! Rules in TOML.
//!
//! ```toml
//! tolerance = "2mm"
//!
//! [sets]
//! pipes = { type = "IfcPipe*", scene = "mep" }
//! walls = { type = ["IfcWall*", "IfcSlab"], except = { name = "*temporary*" } }
//!
//! [[rule]]
//! name = "pipes through walls"
//! a = "pipes"
//! b = "walls"
//! clearance = "25mm"
//! severity = "high"
//!
//! [[ignore]]
//! a = "walls"
//! b = "walls"
//! why = "walls are joined"
//!
//! [[accept]]
//! id = "c-abcd2345"
//! depth = "40mm"
//! note = "agreed on 3 May"
//! ```

use std::collections::BTreeMap;

use impinge::clash::{ALL, Accept, Ignore, Rule, Selector, Set};
use serde::Deserialize;
use toml::Spanned;

use super::length::{FORM, Length};
use super::rules::{RulesFile, line_of};
use crate::{
    error::{LoadError, Place},
    unit::Unit,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    tolerance: Option<Spanned<LengthText>>,
    clearance: Option<Spanned<LengthText>>,
    #[serde(default)]
    sets: BTreeMap<String, Spanned<OneOrMany<SelectorTable>>>,
    #[serde(default)]
    rule: Vec<Spanned<RuleTable>>,
    #[serde(default)]
    ignore: Vec<Spanned<IgnoreTable>>,
    #[serde(default)]
    accept: Vec<Spanned<AcceptTable>>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a number or a text such as \"25mm\"")]
enum LengthText {
    Number(f64),
    Text(String),
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "one item or a list")]
enum OneOrMany<T> {
    One(T),
    Many(Vec<T>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SelectorTable {
    #[serde(rename = "type")]
    kind: Option<OneOrMany<String>>,
    name: Option<OneOrMany<String>>,
    path: Option<OneOrMany<String>>,
    scene: Option<OneOrMany<String>>,
    except: Option<OneOrMany<ExceptTable>>,
}

/// A selector without exceptions of its own.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExceptTable {
    #[serde(rename = "type")]
    kind: Option<OneOrMany<String>>,
    name: Option<OneOrMany<String>>,
    path: Option<OneOrMany<String>>,
    scene: Option<OneOrMany<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RuleTable {
    name: Option<String>,
    a: String,
    b: String,
    tolerance: Option<LengthText>,
    clearance: Option<LengthText>,
    severity: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct IgnoreTable {
    a: String,
    b: String,
    why: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AcceptTable {
    id: String,
    depth: Option<LengthText>,
    note: Option<String>,
}

pub(super) fn read(text: &str, unit: Option<Unit>) -> Result<RulesFile, LoadError> {
    let file: File = toml::from_str(text).map_err(|error| {
        let place = error.span().map(|span| line_of(text, span.start));
        let error = LoadError::refused("rules in TOML", &error.message());
        place.into_iter().fold(error, LoadError::at)
    })?;
    let mut read = RulesFile::default();
    for (name, any) in file.sets {
        let place = line_of(text, any.span().start);
        if name == ALL {
            return Err(
                LoadError::syntax("another name for a set: * is the set of all parts", name.as_bytes()).at(place)
            );
        }
        if let Place::Line(line) = place {
            read.lines.insert(name.clone(), line);
        }
        let any = any.into_inner().into_vec().into_iter().map(SelectorTable::selector).collect();
        read.rules.sets.push(Set { name, any });
    }
    let length = |value: LengthText, place: &Place| length(value, unit).map_err(|error| error.at(place.clone()));
    let outer = |value: Option<Spanned<LengthText>>| value.map(|value| length_at(value, text, unit)).transpose();
    (read.tolerance, read.clearance) = (outer(file.tolerance)?, outer(file.clearance)?);
    let known = |set: &str, place: &Place| {
        if set == ALL || read.lines.contains_key(set) {
            return Ok(());
        }
        let names: Vec<&str> = read.lines.keys().map(String::as_str).collect();
        Err(LoadError::syntax(sets_text(names), set.as_bytes()).at(place.clone()))
    };
    for table in file.rule {
        let place = line_of(text, table.span().start);
        let RuleTable { name, a, b, tolerance, clearance, severity } = table.into_inner();
        known(&a, &place)?;
        known(&b, &place)?;
        let name = name.unwrap_or_else(|| format!("{a} against {b}"));
        let tolerance = tolerance.map(|value| length(value, &place)).transpose()?;
        let clearance = clearance.map(|value| length(value, &place)).transpose()?;
        read.rules.rules.push(Rule { name, a, b, tolerance, clearance, severity });
    }
    for table in file.ignore {
        let place = line_of(text, table.span().start);
        let IgnoreTable { a, b, why } = table.into_inner();
        known(&a, &place)?;
        known(&b, &place)?;
        let why = why.unwrap_or_else(|| format!("{a} against {b}"));
        read.rules.ignores.push(Ignore { why, a, b });
    }
    for table in file.accept {
        let place = line_of(text, table.span().start);
        let AcceptTable { id, depth, note } = table.into_inner();
        let depth = depth.map(|value| length(value, &place)).transpose()?;
        read.rules.accepts.push(Accept { id, depth, note });
    }
    Ok(read)
}

/// Returns what a name of a set must be, for an error.
fn sets_text(mut names: Vec<&str>) -> String {
    names.sort_unstable();
    format!("the name of a set: {ALL}{}", names.iter().map(|name| format!(", {name}")).collect::<String>())
}

fn length_at(value: Spanned<LengthText>, text: &str, unit: Option<Unit>) -> Result<f64, LoadError> {
    let place = line_of(text, value.span().start);
    length(value.into_inner(), unit).map_err(|error| error.at(place))
}

fn length(value: LengthText, unit: Option<Unit>) -> Result<f64, LoadError> {
    let (length, text) = match value {
        LengthText::Number(value) if value >= 0.0 && value.is_finite() => {
            (Ok(Length { value, unit: None }), String::new())
        }
        LengthText::Number(value) => return Err(LoadError::syntax(FORM, value.to_string().as_bytes())),
        LengthText::Text(text) => (text.parse::<Length>(), text),
    };
    let invalid = |expected: &str| LoadError::syntax(expected, text.as_bytes());
    let length = length.map_err(|_| invalid(FORM))?;
    length.in_unit(unit).ok_or_else(|| invalid(super::NO_UNIT).with_hint(super::NO_UNIT_HINT))
}

impl<T> OneOrMany<T> {
    fn into_vec(self) -> Vec<T> {
        match self {
            Self::One(one) => vec![one],
            Self::Many(many) => many,
        }
    }
}

fn patterns(value: Option<OneOrMany<String>>) -> Vec<String> {
    value.map_or_else(Vec::new, OneOrMany::into_vec)
}

impl SelectorTable {
    fn selector(self) -> Selector {
        let Self { kind, name, path, scene, except } = self;
        let except = except.map_or_else(Vec::new, OneOrMany::into_vec);
        Selector {
            except: except.into_iter().map(ExceptTable::selector).collect(),
            ..ExceptTable { kind, name, path, scene }.selector()
        }
    }
}

impl ExceptTable {
    fn selector(self) -> Selector {
        let Self { kind, name, path, scene } = self;
        let [kind, name, path, scene] = [kind, name, path, scene].map(patterns);
        Selector { kind, name, path, scene, except: Vec::new() }
    }
}

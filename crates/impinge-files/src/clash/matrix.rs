//! A matrix of rules in CSV: which groups are checked against each other.
//!
//! ```csv
//! mm,IfcPipe*,IfcDuct*,IfcWall*
//! IfcPipe*,2,c25,10
//! IfcDuct*,,2,10 c50
//! IfcWall*,,,
//! ```
//! A group is a pattern for types, or `label:pattern` for the types of one scene. An empty cell
//! means that the groups are not checked. A number is a tolerance, and a number after `c` a
//! clearance. The first cell states the unit of bare numbers; if it is empty they are millimeters.

use std::collections::BTreeMap;

use impinge::clash::{Rule, Selector, Set};

use super::length::{FORM, Length};
use super::rules::RulesFile;
use crate::{
    error::{LoadError, Place},
    unit::Unit,
};

/// Tolerance and clearance of a cell.
type Cell = [Option<f64>; 2];

pub(super) fn read(text: &str, unit: Option<Unit>) -> Result<RulesFile, LoadError> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut read = RulesFile::default();
    let mut groups: Vec<String> = Vec::new();
    let mut bare = unit.map(|_| Unit::Millimeter);
    let mut cells: BTreeMap<[String; 2], Cell> = BTreeMap::new();
    for record in reader.records() {
        let record = record.map_err(|error| {
            let place = error.position().map(|position| Place::Line(position.line()));
            place.into_iter().fold(LoadError::refused("a CSV matrix", &error), LoadError::at)
        })?;
        let line = record.position().map_or(1, csv::Position::line);
        let in_line = |error: LoadError| error.at(Place::Line(line));
        let mut fields = record.iter().map(str::trim);
        let head = fields.next().unwrap_or_default();
        if groups.is_empty() {
            if !head.is_empty() {
                let parsed = head.parse::<Unit>();
                bare =
                    Some(parsed.map_err(|_| {
                        in_line(LoadError::syntax("a unit or nothing in the first cell", head.as_bytes()))
                    })?);
            }
            groups = fields.map(str::to_owned).collect();
            while groups.last().is_some_and(String::is_empty) {
                groups.pop();
            }
            if groups.is_empty() {
                return Err(in_line(LoadError::syntax("names of groups after the first cell", b"")));
            }
            for group in &groups {
                if read.lines.insert(group.clone(), line).is_some() || group.is_empty() {
                    return Err(in_line(LoadError::syntax("a group that is named once", group.as_bytes())));
                }
                read.rules.sets.push(set(group));
            }
            continue;
        }
        if !read.lines.contains_key(head) {
            read.lines.insert(head.to_owned(), line);
            read.rules.sets.push(set(head));
        }
        for (column, field) in fields.enumerate().filter(|(_, field)| !field.is_empty()) {
            let Some(group) = groups.get(column) else {
                return Err(in_line(LoadError::syntax("a group at the head of the column", field.as_bytes())));
            };
            let cell = cell(field, bare, unit).map_err(in_line)?;
            let mut pair = [head.to_owned(), group.clone()];
            pair.sort_unstable();
            if cells.insert(pair, cell).is_some_and(|known| known != cell) {
                let what = "the same value as the cell across the diagonal";
                return Err(in_line(LoadError::syntax(what, field.as_bytes())));
            }
        }
    }
    if groups.is_empty() {
        return Err(LoadError::syntax("a CSV matrix", b"").at(Place::Line(1)));
    }
    let rule = |([a, b], [tolerance, clearance]): ([String; 2], Cell)| Rule {
        name: format!("{a} against {b}"),
        a,
        b,
        tolerance,
        clearance,
        severity: None,
    };
    read.rules.rules = cells.into_iter().map(rule).collect();
    // A group with empty cells alone is not checked, so it may be empty. A matrix without any
    // numbers checks nothing.
    if read.rules.rules.is_empty() {
        return Err(LoadError::syntax("a matrix with at least one number", b"").at(Place::Line(1)));
    }
    Ok(read)
}

fn set(group: &str) -> Set {
    let (scene, kind) = match group.split_once(':') {
        Some((scene, kind)) => (vec![scene.trim().to_owned()], kind.trim()),
        None => (Vec::new(), group),
    };
    Set { name: group.to_owned(), any: vec![Selector { kind: vec![kind.to_owned()], scene, ..Selector::default() }] }
}

fn cell(field: &str, bare: Option<Unit>, unit: Option<Unit>) -> Result<Cell, LoadError> {
    let mut cell = [None, None];
    for word in field.split_whitespace() {
        let (side, number) = match word.strip_prefix(['c', 'C']) {
            Some(number) => (1, number),
            None => (0, word),
        };
        let length = number.parse::<Length>();
        let length =
            length.map_err(|_| LoadError::syntax(format!("{FORM}, or c before a clearance"), word.as_bytes()))?;
        let length = Length { unit: length.unit.or(bare), ..length };
        let Some(value) = length.in_unit(unit) else {
            return Err(LoadError::syntax(super::NO_UNIT, word.as_bytes()).with_hint(super::NO_UNIT_HINT));
        };
        if cell[side].replace(value).is_some() {
            return Err(LoadError::syntax("one tolerance and one clearance at most", field.as_bytes()));
        }
    }
    Ok(cell)
}

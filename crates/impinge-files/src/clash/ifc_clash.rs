//! Clash sets of IfcClash, in JSON as they are.
//!
//! A clash set has a name, one or two lists of sources, and a mode. A source is a file with a
//! selector. The name of the file without its extension is the label of the scene. Selectors are
//! lists of IFC classes, such as `IfcWall, IfcSlab`; `!` before a class excludes it, `Name="..."`
//! selects by name, and `+` separates alternatives. A class also selects its `StandardCase` and
//! `ElementedCase`. Other filters need the IFC file and are errors.
//!
//! Source of the form: IfcOpenShell, `src/ifcclash/ifcclash/ifcclash.py`, version 0.8. Only the
//! form of the data is read; the meaning of a mode is that of this project.

use std::path::Path;

use impinge::clash::{Rule, Selector, Set};
use serde::Deserialize;

use super::length::{FORM, Length};
use super::rules::RulesFile;
use crate::{
    error::{LoadError, Place},
    unit::Unit,
};

#[derive(Deserialize)]
struct ClashSet {
    name: String,
    a: Vec<Source>,
    #[serde(default)]
    b: Vec<Source>,
    mode: Mode,
    tolerance: Option<f64>,
    clearance: Option<f64>,
}

#[derive(Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum Mode {
    Intersection,
    Collision,
    Clearance,
}

#[derive(Deserialize)]
struct Source {
    file: String,
    mode: Option<SourceMode>,
    selector: Option<String>,
}

#[derive(Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum SourceMode {
    /// All elements.
    A,
    /// All elements but the selected ones.
    E,
    /// The selected elements.
    I,
}

pub(super) fn read(text: &str, unit: Option<Unit>) -> Result<RulesFile, LoadError> {
    let sets: Vec<ClashSet> = serde_json::from_str(text)
        .map_err(|error| LoadError::refused("clash sets of IfcClash", &error).at(Place::Line(error.line() as u64)))?;
    let mut read = RulesFile::default();
    for (number, clash_set) in sets.into_iter().enumerate() {
        let ClashSet { name, a, b, mode, tolerance, clearance } = clash_set;
        let place = || Place::Entry(format!("clash set {number}, {name:?}"));
        let meters = |value: Option<f64>| {
            let Some(value) = value else { return Ok(None) };
            let is_length = value >= 0.0 && value.is_finite();
            // IfcClash measures in meters. A scene without a unit is taken to be in meters.
            let length = Length { value, unit: unit.map(|_| Unit::Meter) };
            let length = length.in_unit(unit).filter(|_| is_length);
            length.map(Some).ok_or_else(|| LoadError::syntax(FORM, value.to_string().as_bytes()).at(place()))
        };
        let (tolerance, clearance) = match mode {
            Mode::Intersection => (meters(tolerance)?, None),
            Mode::Collision => (Some(0.0), None),
            Mode::Clearance => (None, meters(clearance)?),
        };
        if a.is_empty() {
            return Err(LoadError::syntax("at least one source in \"a\"", b"").at(place()));
        }
        let mut add = |side: &str, sources: &[Source]| {
            let name = format!("{name}, {side}, set {number}");
            let any = sources.iter().map(selectors).collect::<Result<Vec<_>, _>>();
            let any = any.map_err(|error| error.at(place()))?.concat();
            read.rules.sets.push(Set { name: name.clone(), any });
            Ok::<_, LoadError>(name)
        };
        let side_a = add("a", &a)?;
        let side_b = if b.is_empty() { side_a.clone() } else { add("b", &b)? };
        read.rules.rules.push(Rule { name, a: side_a, b: side_b, tolerance, clearance, severity: None });
    }
    if read.rules.rules.is_empty() {
        return Err(LoadError::syntax("at least one clash set", b"[]").at(Place::Line(1)));
    }
    Ok(read)
}

/// Returns the selectors of a source. A part is in the source if one of them selects it.
fn selectors(source: &Source) -> Result<Vec<Selector>, LoadError> {
    let file = source.file.rsplit(['/', '\\']).next().unwrap_or_default();
    let label = Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let all = Selector { scene: vec![label], ..Selector::default() };
    let text = source.selector.as_deref().unwrap_or_default().trim();
    match source.mode {
        None | Some(SourceMode::A) => Ok(vec![all]),
        _ if text.is_empty() => Ok(vec![all]),
        Some(SourceMode::I) => {
            let of_scene = |selector| Selector { scene: all.scene.clone(), ..selector };
            Ok(alternatives(text)?.into_iter().map(of_scene).collect())
        }
        Some(SourceMode::E) => Ok(vec![Selector { except: alternatives(text)?, ..all }]),
    }
}

fn alternatives(text: &str) -> Result<Vec<Selector>, LoadError> {
    text.split('+').map(filters).collect()
}

fn filters(text: &str) -> Result<Selector, LoadError> {
    let unknown = |filter: &str| {
        LoadError::syntax("IFC classes such as IfcWall, or Name=\"...\", in a selector", filter.as_bytes())
    };
    let mut selector = Selector::default();
    for filter in text.split(',').map(str::trim) {
        let (is_excluded, class) = match filter.strip_prefix('!') {
            Some(class) => (true, class),
            None => (false, filter),
        };
        if let Some((field, value)) = filter.split_once('=') {
            if field.trim() != "Name" {
                return Err(unknown(filter));
            }
            selector.name.push(value.trim().trim_matches('"').to_owned());
        } else if class.starts_with("Ifc") && class.chars().all(|letter| letter.is_ascii_alphanumeric()) {
            let classes = ["", "StandardCase", "ElementedCase"].map(|suffix| format!("{class}{suffix}"));
            let is_all = ["IfcElement", "IfcProduct", "IfcObject", "IfcRoot"].contains(&class);
            match (is_excluded, is_all) {
                (true, _) => selector.except.push(Selector { kind: classes.to_vec(), ..Selector::default() }),
                (false, true) => selector.kind.push("*".to_owned()),
                (false, false) => selector.kind.extend(classes),
            }
        } else {
            return Err(unknown(filter));
        }
    }
    Ok(selector)
}

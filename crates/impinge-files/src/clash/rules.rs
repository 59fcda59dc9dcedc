//! Rules of clash detection from files: TOML, a CSV matrix, or clash sets of IfcClash.

use std::{collections::HashMap, path::Path};

use impinge::clash::Rules;

use super::{ifc_clash, matrix, toml_rules};
use crate::{
    error::{LoadError, LoadErrorKind, Place},
    limits::Limits,
    regular_file::read_regular_file,
    unit::Unit,
};

/// Rules from a file. Lengths are in the unit of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RulesFile {
    /// The rules.
    pub rules: Rules,
    /// Tolerance of rules that state none.
    pub tolerance: Option<f64>,
    /// Clearance of rules that state none.
    pub clearance: Option<f64>,
    /// Line of each set in the file, counted from one.
    pub(super) lines: HashMap<String, u64>,
}

/// Form of a file of rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RulesFormat {
    /// Sets, rules, ignores and accepts in TOML.
    Toml,
    /// A matrix of groups in CSV.
    Csv,
    /// Clash sets of IfcClash in JSON.
    IfcClash,
}

/// Maximum number of sets and of rules, each. Each pair of parts is compared with each rule, so
/// more rules make a search slow, and fewer exclude large matrices.
const MAX_RULES: usize = 4096;

impl RulesFile {
    /// Returns the line on which a set is defined, counted from one. Returns `None` for a set that
    /// the file does not define.
    #[must_use]
    pub fn line_of_set(&self, set: &str) -> Option<u64> {
        self.lines.get(set).copied()
    }
}

impl RulesFormat {
    /// Returns the format that an extension stands for: `toml`, `csv` or `json`, in any case.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        let known = [("toml", Self::Toml), ("csv", Self::Csv), ("json", Self::IfcClash)];
        known.into_iter().find(|(name, _)| name.eq_ignore_ascii_case(extension)).map(|(_, format)| format)
    }
}

/// Loads rules from a file whose extension is `toml`, `csv` or `json`. `unit` is the unit of the
/// scenes.
///
/// # Errors
/// Returns an error if the file cannot be read, the extension is another one, or the content is
/// invalid. The error names the line.
pub fn load_rules(path: impl AsRef<Path>, unit: Option<Unit>, limits: &Limits) -> Result<RulesFile, LoadError> {
    let path = path.as_ref();
    let load = || {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        let Some(format) = RulesFormat::from_extension(&extension) else {
            return Err(LoadError::syntax(
                "a file of rules whose name ends in .toml, .csv or .json",
                extension.as_bytes(),
            ));
        };
        parse_rules(&read_regular_file(path, limits)?, format, unit)
    };
    load().map_err(|e| e.in_file(path))
}

/// Reads rules from bytes, as [`load_rules`] does from a file.
///
/// ```
/// use impinge_files::{RulesFormat, Unit, parse_rules};
///
/// let text = r#"
/// [sets]
/// pipes = { type = "IfcPipe*" }
/// walls = { type = ["IfcWall*", "IfcSlab"] }
///
/// [[rule]]
/// a = "pipes"
/// b = "walls"
/// clearance = "25mm"
/// "#;
/// let file = parse_rules(text.as_bytes(), RulesFormat::Toml, Some(Unit::Meter))?;
/// assert_eq!(file.rules.rules[0].clearance, Some(0.025));
/// # Ok::<(), impinge_files::LoadError>(())
/// ```
///
/// # Errors
/// Returns an error as [`load_rules`] does; the path of the error is empty.
pub fn parse_rules(bytes: &[u8], format: RulesFormat, unit: Option<Unit>) -> Result<RulesFile, LoadError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        LoadError::syntax("UTF-8 text", &bytes[error.valid_up_to()..]).at(Place::Byte(error.valid_up_to() as u64))
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let file = match format {
        RulesFormat::Toml => toml_rules::read(text, unit),
        RulesFormat::Csv => matrix::read(text, unit),
        RulesFormat::IfcClash => ifc_clash::read(text, unit),
    }?;
    for (what, count) in [("sets", file.rules.sets.len()), ("rules", file.rules.rules.len() + file.rules.ignores.len())]
    {
        if count > MAX_RULES {
            let (count, limit) = (count as u64, MAX_RULES as u64);
            return Err(LoadError::new(LoadErrorKind::TooMany { what, count, limit }));
        }
    }
    Ok(file)
}

/// Returns the number of the line that contains a byte of a text, counted from one.
pub(super) fn line_of(text: &str, offset: usize) -> Place {
    let before = &text.as_bytes()[..offset.min(text.len())];
    Place::Line(1 + before.iter().filter(|&&byte| byte == b'\n').count() as u64)
}

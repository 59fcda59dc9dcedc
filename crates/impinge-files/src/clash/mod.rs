//! Files of clash detection: rules, reports and previous reports.
//!
//! `rules` reads rules in TOML (`toml_rules`), as a CSV `matrix`, or as clash sets of IfcClash
//! (`ifc_clash`), with lengths that have units (`length`). `about` describes the scenes and the
//! question, `report_json` and `report_csv` write reports, and `previous` reads a report back.
//! Guarded by `tests/it/clash`.

mod about;
mod ifc_clash;
mod length;
mod matrix;
mod previous;
mod report_csv;
mod report_json;
mod rules;
mod toml_rules;

pub use about::{Asked, Repaired, ReportAbout, SceneAbout, bounds_of};
pub use length::{InvalidLength, Length};
pub use previous::{load_previous, parse_previous};
pub use report_csv::write_clash_csv;
pub use report_json::{length_text, write_clash_json};
pub use rules::{RulesFile, RulesFormat, load_rules, parse_rules};

/// Form of a length if the unit of the scene is not known.
const NO_UNIT: &str = "a length without a unit, because the scenes state none";

/// Advice for a length with a unit if the unit of the scene is not known.
const NO_UNIT_HINT: &str = "state the unit of the scenes, for example with --unit";

//! The reason why there is no answer: text for standard error, and JSON for programs.

use std::fmt;
use std::io;
use std::path::Path;

use anstyle::{AnsiColor, Style};
use impinge::{InputError, InputErrorKind};
use impinge_files::LoadError;
use serde::Serialize;

/// A failure: the fault, its place, and what to do about it. Fields that are not known are absent
/// from the JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Failure {
    /// Short stable name of the kind of failure, for programs.
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// Place in the file, or name of the argument.
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    place: Option<String>,
    message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    hint: Option<String>,
}

impl Failure {
    /// Builds a failure of a kind, with a message about what is wrong.
    pub(crate) fn new(kind: &'static str, message: impl Into<String>) -> Self {
        Self { kind, file: None, place: None, message: message.into(), hint: None }
    }

    /// Adds the path of the file that is at fault.
    pub(crate) fn in_file(mut self, path: &Path) -> Self {
        self.file = Some(path.display().to_string());
        self
    }

    /// Adds the place in the file, such as `line 12`, or the name of the argument.
    pub(crate) fn at(mut self, place: impl Into<String>) -> Self {
        self.place = Some(place.into());
        self
    }

    /// Adds a hint about what to do.
    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Builds the failure for an error of the operating system; `attempt` names what failed.
    pub(crate) fn from_io(error: &io::Error, attempt: &str) -> Self {
        Self::new("io", format!("{attempt}: {error}"))
    }

    /// Builds the failure for a mesh or a pose that the library found invalid.
    pub(crate) fn from_input(error: &InputError) -> Self {
        let kind = match error.kind() {
            InputErrorKind::NonFinite { .. } => "non-finite",
            InputErrorKind::OutOfRange { .. } => "out-of-range",
            InputErrorKind::IndexOutOfBounds { .. } => "index-out-of-bounds",
            InputErrorKind::TooMany { .. } => "too-many",
            InputErrorKind::OutOfMemory { .. } => "out-of-memory",
            InputErrorKind::NotAffine { .. } => "not-affine",
            InputErrorKind::Singular => "singular",
            InputErrorKind::NotUnitQuaternion { .. } => "not-unit-quaternion",
            _ => "input",
        };
        let text = error.to_string();
        let Some(hint) = error.hint() else { return Self::new(kind, text) };
        let message = text.strip_suffix(&format!(" ({hint})")).unwrap_or(&text);
        Self::new(kind, message).hint(hint)
    }

    /// Builds the failure for invalid arguments.
    pub(crate) fn from_usage(error: &clap::Error) -> Self {
        let text = error.to_string();
        let mut paragraphs =
            text.split("\n\n").map(|paragraph| paragraph.split_whitespace().collect::<Vec<_>>().join(" "));
        let message = paragraphs.next().unwrap_or_default();
        let tip = paragraphs.find_map(|paragraph| paragraph.strip_prefix("tip: ").map(str::to_owned));
        Self::new("usage", message.strip_prefix("error: ").unwrap_or(&message))
            .hint(tip.unwrap_or_else(|| "run with --help to list the arguments".to_owned()))
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        let failure = Self::new(error.kind().name(), error.kind().to_string()).in_file(error.path());
        Self { place: error.place().map(ToString::to_string), hint: error.hint().map(str::to_owned), ..failure }
    }
}

/// Formats the failure for a person: `error: bunny.obj, line 12: ...`, then `hint: ...` on a second
/// line.
impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = Style::new().bold().fg_color(Some(AnsiColor::Red.into()));
        write!(f, "{error}error{error:#}: ")?;
        let place: Vec<&str> = [&self.file, &self.place].into_iter().flatten().map(String::as_str).collect();
        if !place.is_empty() {
            write!(f, "{}: ", place.join(", "))?;
        }
        write!(f, "{}", self.message)?;
        match &self.hint {
            Some(hint) => {
                let style = Style::new().bold();
                write!(f, "\n {style}hint{style:#}: {hint}")
            }
            None => Ok(()),
        }
    }
}

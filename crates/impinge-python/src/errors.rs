//! Errors of the library as exceptions of Python. `impinge.InputError` says which argument is
//! invalid, where in it, and why.

use impinge::{InputError, InputErrorKind};
use impinge_files::{LoadError, LoadErrorKind};
use pyo3::exceptions::{PyMemoryError, PyOSError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

/// Kind of the errors that are raised as `MemoryError`.
pub(crate) const OUT_OF_MEMORY: &str = "out-of-memory";

/// An error in an argument, as `impinge.InputError` reports it.
pub(crate) struct Fault {
    /// Short stable name of the kind of error, such as `"non-finite"`.
    pub(crate) kind: &'static str,
    /// Name of the argument, such as `"pose_b"`.
    pub(crate) argument: String,
    /// Index of the invalid value in the argument. Empty for the whole argument.
    pub(crate) at: Vec<usize>,
    /// Message for people, without the name of the argument.
    pub(crate) message: String,
    /// Hint about how to correct the argument, if there is one.
    pub(crate) hint: Option<String>,
}

impl Fault {
    /// Returns an error about a whole argument.
    pub(crate) fn new(kind: &'static str, argument: &str, message: impl Into<String>) -> Self {
        Self { kind, argument: argument.to_owned(), at: Vec::new(), message: message.into(), hint: None }
    }

    pub(crate) fn at(mut self, at: Vec<usize>) -> Self {
        self.at = at;
        self
    }

    pub(crate) fn hint(mut self, hint: Option<impl Into<String>>) -> Self {
        self.hint = hint.map(Into::into);
        self
    }

    /// Returns the exception for this error: a `MemoryError` if there is not enough memory, and an
    /// `InputError` otherwise.
    pub(crate) fn raised(self, py: Python<'_>) -> PyErr {
        if self.kind == OUT_OF_MEMORY {
            return PyMemoryError::new_err(format!("{}: {}", self.argument, self.message));
        }
        let at = match PyTuple::new(py, self.at) {
            Ok(at) => at.into_any(),
            Err(error) => return error,
        };
        raise(py, self.kind, &self.argument, &at, &self.message, self.hint.as_deref())
    }
}

fn raise(py: Python<'_>, kind: &str, what: &str, place: &Bound<'_, PyAny>, message: &str, hint: Option<&str>) -> PyErr {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let made = || {
        let class = CLASS.import(py, "impinge._errors", "InputError")?;
        let named = PyDict::new(py);
        named.set_item("kind", kind)?;
        named.set_item("what", what)?;
        named.set_item("where", place)?;
        named.set_item("hint", hint)?;
        class.call((message,), Some(&named))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// Returns the exception for a file that was read, but whose content is invalid.
pub(crate) fn file_error(py: Python<'_>, path: &str, kind: &str, message: &str) -> PyErr {
    raise(py, kind, path, &py.None().into_bound(py), message, None)
}

/// Returns the short name of an error of the library, and the index within one vertex array, face
/// array or matrix.
pub(crate) fn kind_and_place(error: &InputError) -> (&'static str, Vec<usize>) {
    match *error.kind() {
        InputErrorKind::NonFinite { what, index } => ("non-finite", place(what, index)),
        InputErrorKind::OutOfRange { what, index, .. } => ("out-of-range", place(what, index)),
        InputErrorKind::IndexOutOfBounds { face, .. } => ("index-out-of-bounds", vec![face]),
        InputErrorKind::OtherCount { .. } => ("shape", Vec::new()),
        InputErrorKind::TooMany { .. } => ("too-many", Vec::new()),
        InputErrorKind::OutOfMemory { .. } => (OUT_OF_MEMORY, Vec::new()),
        InputErrorKind::NotAffine { .. } => ("not-affine", vec![3]),
        InputErrorKind::Singular => ("singular", Vec::new()),
        InputErrorKind::NotUnitQuaternion { .. } => ("not-unit-quaternion", Vec::new()),
        InputErrorKind::Empty { .. } => ("empty", Vec::new()),
        InputErrorKind::Open { .. } => ("open", Vec::new()),
        InputErrorKind::Negative { index, .. } => ("negative", vec![index]),
        InputErrorKind::NotRigid { .. } => ("not-rigid", Vec::new()),
        InputErrorKind::ZeroAxis => ("zero-axis", Vec::new()),
        InputErrorKind::NotRoundable { .. } => ("not-roundable", Vec::new()),
        InputErrorKind::ZeroDirection { .. } => ("zero-direction", Vec::new()),
        _ => ("input", Vec::new()),
    }
}

/// Returns the index of an invalid value. The library counts the entries of a matrix row by row.
fn place(what: &str, index: usize) -> Vec<usize> {
    if what == "pose entry" { vec![index / 4, index % 4] } else { vec![index] }
}

/// Returns the message of the library without its hint, which Python stores separately.
pub(crate) fn message(error: &InputError) -> String {
    let text = error.to_string();
    let Some(hint) = error.hint() else { return text };
    text.strip_suffix(&format!(" ({hint})")).unwrap_or(&text).to_owned()
}

/// Returns the exception for a file that cannot be loaded: an `OSError` of the usual kind if it
/// cannot be read, and an `InputError` if its content is invalid.
pub(crate) fn load_error(py: Python<'_>, error: &LoadError) -> PyErr {
    if let LoadErrorKind::Io { kind, message } = error.kind() {
        return std::io::Error::new(*kind, format!("{}: {message}", error.path().display())).into();
    }
    if let LoadErrorKind::NotAFile { .. } = error.kind() {
        return PyOSError::new_err(error.to_string());
    }
    content_error(py, &error.path().display().to_string(), error)
}

/// Returns the exception for invalid content that an argument has.
pub(crate) fn content_error(py: Python<'_>, argument: &str, error: &LoadError) -> PyErr {
    let place = error.place().map(ToString::to_string);
    error_at(py, error.kind().name(), argument, place, &error.kind().to_string(), error.hint())
}

/// Returns the exception for an error at a place in a file or a text, such as a line.
pub(crate) fn error_at(
    py: Python<'_>,
    kind: &str,
    what: &str,
    place: Option<String>,
    message: &str,
    hint: Option<&str>,
) -> PyErr {
    let place = match place.into_pyobject(py) {
        Ok(place) => place,
        Err(impossible) => match impossible {},
    };
    raise(py, kind, what, &place, message, hint)
}

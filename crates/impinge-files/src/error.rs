//! Errors of loading a file: the problem, and its place in the file.

use std::{
    fmt::{self, Write},
    path::{Path, PathBuf},
};

use impinge::character::RigErrorKind;

use crate::{format::Format, pieces::PieceProblem, plain::Plain, robot::RobotProblem, text::name};

/// The error that a file could not be loaded: which file, where in it, what is wrong and what to
/// do.
///
/// The [`Display`](fmt::Display) text contains all of these: `bunny.obj, line 12: face 5 names
/// vertex 900, but there are 812 vertices`.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadError(Box<Inner>);

#[derive(Clone, Debug, PartialEq)]
struct Inner {
    path: PathBuf,
    kind: LoadErrorKind,
    place: Option<Place>,
    hint: Option<&'static str>,
}

/// The kind of problem with a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LoadErrorKind {
    /// The file could not be read.
    Io {
        /// Category of the operating system's error.
        kind: std::io::ErrorKind,
        /// Message of the operating system.
        message: String,
    },
    /// The path is not that of a regular file.
    NotAFile {
        /// Description of the path: `"a pipe"`, `"a device"` or `"a socket"`.
        found: &'static str,
    },
    /// The extension is not that of a supported format.
    UnsupportedFormat {
        /// The extension, without the dot; empty if there is none.
        extension: String,
    },
    /// The file needs a feature of its format that is not supported.
    UnsupportedFeature {
        /// Name of the feature, such as `KHR_draco_mesh_compression`.
        name: String,
    },
    /// The file has no bytes.
    Empty,
    /// The content does not have the expected format.
    WrongContent {
        /// The expected format.
        expected: Format,
        /// Description of the content that was found.
        found: &'static str,
    },
    /// The file ends early, or its counts are too large.
    Truncated {
        /// Items that are missing: `"triangles"`, `"bytes of buffer 0"`.
        what: String,
        /// Number of items that the file states.
        expected: u64,
        /// Maximum number of items that the file has room for.
        found: u64,
    },
    /// The text or the structure breaks the rules of the format.
    Syntax {
        /// Item that the format requires at this place.
        expected: String,
        /// Text that was found at this place.
        found: String,
    },
    /// A vertex that a face uses has a coordinate that is NaN, infinite or too large for its type.
    NonFinite {
        /// The vertex, counted from zero in the file, or in the entry that the place names; in STL,
        /// the corner.
        vertex: u64,
    },
    /// A face refers to a vertex that does not exist.
    IndexOutOfBounds {
        /// The face, counted from zero in the file, or in the entry that the place names.
        face: u64,
        /// The index as it is written in the file.
        index: i64,
        /// Number of vertices.
        len: u64,
    },
    /// A count exceeds the limit for a mesh, for a file of this size, or of
    /// [`Limits`](crate::Limits).
    TooMany {
        /// Items that are counted.
        what: &'static str,
        /// Number of items in the file.
        count: u64,
        /// Maximum number of items.
        limit: u64,
    },
    /// A baked file differs from the file that was written, or does not hold a valid mesh.
    Corrupt {
        /// Description of the problem.
        what: String,
    },
    /// A character cannot be animated.
    BrokenRig {
        /// The problem with its bones, weights or keys.
        kind: RigErrorKind,
    },
    /// A robot description is invalid: a link, a joint or a mesh.
    BrokenRobot {
        /// The problem, with the name of the link or joint.
        problem: RobotProblem,
    },
    /// An object of a planning scene cannot be made.
    BrokenObject {
        /// Name of the object.
        object: String,
        /// The problem of a shape of the object.
        problem: PieceProblem,
    },
    /// A file refers to another file outside its own folder.
    OutsideFolder {
        /// The reference, as it is written in the file.
        uri: String,
    },
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A byte offset, counted from zero.
    Byte(u64),
    /// A line, counted from one.
    Line(u64),
    /// A named entry, such as `accessor 3` or `object 12`.
    Entry(String),
}

impl LoadError {
    pub(crate) fn new(kind: LoadErrorKind) -> Self {
        Self(Box::new(Inner { path: PathBuf::new(), kind, place: None, hint: None }))
    }

    pub(crate) fn truncated(what: impl Into<String>, expected: u64, found: u64) -> Self {
        Self::new(LoadErrorKind::Truncated { what: what.into(), expected, found })
            .with_hint("the file is cut off or its counts are wrong")
    }

    pub(crate) fn unsupported(name: impl Into<String>) -> Self {
        Self::new(LoadErrorKind::UnsupportedFeature { name: name.into() })
    }

    /// Builds a syntax error. `found` is quoted, and truncated if it is long; empty bytes become
    /// "nothing".
    pub(crate) fn syntax(expected: impl Into<String>, found: &[u8]) -> Self {
        const SHOWN: usize = 40;
        let found = match found {
            [] => "nothing".to_owned(),
            _ if found.len() > SHOWN => format!("{:?}...", String::from_utf8_lossy(&found[..SHOWN])),
            _ => format!("{:?}", String::from_utf8_lossy(found)),
        };
        Self::new(LoadErrorKind::Syntax { expected: expected.into(), found })
    }

    /// Returns the error about a text that a parser refuses, with the reason of the parser.
    pub(crate) fn refused(expected: impl Into<String>, reason: &dyn fmt::Display) -> Self {
        const SHOWN: usize = 400;
        let mut found: String = reason.to_string().chars().take(SHOWN + 1).collect();
        if found.chars().count() > SHOWN {
            found.pop();
            found += "...";
        }
        Self::new(LoadErrorKind::Syntax { expected: expected.into(), found })
    }

    pub(crate) fn io(error: &std::io::Error) -> Self {
        Self::new(LoadErrorKind::Io { kind: error.kind(), message: error.to_string() })
    }

    pub(crate) fn at(mut self, place: Place) -> Self {
        self.0.place = Some(place);
        self
    }

    pub(crate) fn with_hint(mut self, hint: &'static str) -> Self {
        self.0.hint = Some(hint);
        self
    }

    pub(crate) fn in_file(mut self, path: &Path) -> Self {
        self.0.path = path.to_owned();
        self
    }

    /// Returns the path of the file; empty if the bytes did not come from a file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Returns the kind of problem, for programs.
    #[must_use]
    pub fn kind(&self) -> &LoadErrorKind {
        &self.0.kind
    }

    /// Returns the place in the file; `None` if the error has no single place.
    #[must_use]
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// Returns advice on how to solve the problem; `None` if there is no advice.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        self.0.hint
    }
}

impl LoadErrorKind {
    /// Returns a short stable name: `io`, `not-a-file`, `unsupported-format`,
    /// `unsupported-feature`, `empty`, `wrong-content`, `truncated`, `syntax`, `non-finite`,
    /// `index-out-of-bounds`, `too-many`, `corrupt`, `broken-rig`, `broken-robot`, `broken-object`
    /// or `outside-folder`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Io { .. } => "io",
            Self::NotAFile { .. } => "not-a-file",
            Self::UnsupportedFormat { .. } => "unsupported-format",
            Self::UnsupportedFeature { .. } => "unsupported-feature",
            Self::Empty => "empty",
            Self::WrongContent { .. } => "wrong-content",
            Self::Truncated { .. } => "truncated",
            Self::Syntax { .. } => "syntax",
            Self::NonFinite { .. } => "non-finite",
            Self::IndexOutOfBounds { .. } => "index-out-of-bounds",
            Self::TooMany { .. } => "too-many",
            Self::Corrupt { .. } => "corrupt",
            Self::BrokenRig { .. } => "broken-rig",
            Self::BrokenRobot { .. } => "broken-robot",
            Self::BrokenObject { .. } => "broken-object",
            Self::OutsideFolder { .. } => "outside-folder",
        }
    }
}

/// Formats the problem without file, place and hint.
impl fmt::Display for LoadErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let f = &mut Plain(f);
        match self {
            Self::Io { message, .. } => f.write_str(message),
            Self::NotAFile { found } => write!(f, "not a regular file, but {found}"),
            Self::UnsupportedFormat { extension } => {
                match extension.as_str() {
                    "" => write!(f, "unknown format, because there is no file extension")?,
                    _ => write!(f, "unsupported format .{extension}")?,
                }
                write!(f, "; supported formats are")?;
                for (i, format) in Format::ALL.iter().enumerate() {
                    write!(f, "{} .{}", if i == 0 { "" } else { "," }, format.extension())?;
                }
                write!(f, ", each also as .gz")
            }
            Self::UnsupportedFeature { name } => write!(f, "needs {name}, which is not supported"),
            Self::Empty => write!(f, "the file is empty"),
            Self::WrongContent { expected, found } => write!(f, "not {expected}, but {found}"),
            Self::Truncated { what, expected, found } => {
                write!(f, "{expected} {what} promised, but there is room for {found} at most")
            }
            Self::Syntax { expected, found } => write!(f, "expected {expected}, found {found}"),
            Self::NonFinite { vertex } => {
                write!(f, "vertex {vertex} has a coordinate that is NaN, infinite or too large")
            }
            Self::IndexOutOfBounds { face, index, len } => {
                write!(f, "face {face} names vertex {index}, but there are {len} vertices")
            }
            Self::TooMany { what, count, limit } => {
                write!(f, "{count} {what} exceed the limit of {limit}")
            }
            Self::Corrupt { what } => f.write_str(what),
            Self::BrokenRig { kind } => write!(f, "{kind}"),
            Self::BrokenRobot { problem } => write!(f, "{problem}"),
            Self::BrokenObject { object, problem } => write!(f, "object {:?}: {problem}", name(object.as_bytes())),
            Self::OutsideFolder { uri } => write!(f, "{uri:?} is not a file inside this file's folder"),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let f = &mut Plain(f);
        match self {
            Self::Byte(at) => write!(f, "byte {at}"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Entry(entry) => f.write_str(entry),
        }
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let f = &mut Plain(f);
        let Inner { path, kind, place, hint } = &*self.0;
        match (path.as_os_str().is_empty(), place) {
            (true, None) => {}
            (true, Some(place)) => write!(f, "{place}: ")?,
            (false, None) => write!(f, "{}: ", path.display())?,
            (false, Some(place)) => write!(f, "{}, {place}: ", path.display())?,
        }
        write!(f, "{kind}")?;
        match hint {
            Some(hint) => write!(f, " ({hint})"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for LoadError {}

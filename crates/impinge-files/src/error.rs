//! What went wrong with a file, and where in it.

use std::{
    fmt::{self, Write},
    path::{Path, PathBuf},
};

use impinge::character::RigErrorKind;

use crate::{format::Format, plain::Plain};

/// A file that could not be loaded: which file, where in it, what is wrong and what to do.
///
/// Its [`Display`](fmt::Display) text says all of it: `bunny.obj, line 12: face 5 names vertex 900, but there are 812
/// vertices`.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadError(Box<Inner>);

#[derive(Clone, Debug, PartialEq)]
struct Inner {
    path: PathBuf,
    kind: LoadErrorKind,
    place: Option<Place>,
    hint: Option<&'static str>,
}

/// The ways in which a file can be wrong.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LoadErrorKind {
    /// The file could not be read.
    Io {
        /// The operating system's category.
        kind: std::io::ErrorKind,
        /// The operating system's words.
        message: String,
    },
    /// The extension names no format that can be read.
    UnsupportedFormat {
        /// The extension, without the dot; empty where there is none.
        extension: String,
    },
    /// The format is known, but the file needs a part of it that is not supported.
    UnsupportedFeature {
        /// The feature by its own name, such as `KHR_draco_mesh_compression`.
        name: String,
    },
    /// The file has no bytes.
    Empty,
    /// The content is not what the extension says.
    WrongContent {
        /// The format of the extension.
        expected: Format,
        /// What was found instead.
        found: &'static str,
    },
    /// The file ends before what it promises.
    Truncated {
        /// What is missing: `"triangles"`, `"bytes of buffer 0"`.
        what: String,
        /// How many were promised.
        expected: u64,
        /// How many there are room for at most.
        found: u64,
    },
    /// The text or structure breaks the format's rules.
    Syntax {
        /// What the format wants here.
        expected: String,
        /// What stands here.
        found: String,
    },
    /// A vertex that a face uses has a coordinate that is NaN, infinite or too large for its type.
    NonFinite {
        /// The vertex, counted from zero in the file, or in the entry that the place names; in STL the corner.
        vertex: u64,
    },
    /// A face names a vertex that does not exist.
    IndexOutOfBounds {
        /// The face, counted from zero in the file, or in the entry that the place names.
        face: u64,
        /// The index as the file has it.
        index: i64,
        /// How many vertices there are.
        len: u64,
    },
    /// A count is beyond what a mesh, or a file of this size, may have.
    TooMany {
        /// What is counted.
        what: &'static str,
        /// How many the file asks for.
        count: u64,
        /// How many are allowed.
        limit: u64,
    },
    /// A baked file is not what was written, or not a mesh.
    Corrupt {
        /// What is wrong with it.
        what: String,
    },
    /// A character cannot be animated.
    BrokenRig {
        /// What is wrong with its bones, weights or keys.
        kind: RigErrorKind,
    },
    /// A file names another file that lies outside its own folder.
    OutsideFolder {
        /// The name.
        uri: String,
    },
}

/// Where in a file.
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

    /// `found` is quoted, and cut where it is long.
    pub(crate) fn syntax(expected: impl Into<String>, found: &[u8]) -> Self {
        const SHOWN: usize = 40;
        let found = match found {
            [] => "nothing".to_owned(),
            _ if found.len() > SHOWN => format!("{:?}...", String::from_utf8_lossy(&found[..SHOWN])),
            _ => format!("{:?}", String::from_utf8_lossy(found)),
        };
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

    /// The file; empty for bytes that came without one.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// What is wrong, for a program.
    #[must_use]
    pub fn kind(&self) -> &LoadErrorKind {
        &self.0.kind
    }

    /// Where in the file, if there is one place.
    #[must_use]
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        self.0.hint
    }
}

impl LoadErrorKind {
    /// A short stable name: `io`, `unsupported-format`, `unsupported-feature`, `empty`, `wrong-content`, `truncated`,
    /// `syntax`, `non-finite`, `index-out-of-bounds`, `too-many`, `corrupt`, `broken-rig` or `outside-folder`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Io { .. } => "io",
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
            Self::OutsideFolder { .. } => "outside-folder",
        }
    }
}

/// What is wrong, without file, place and advice.
impl fmt::Display for LoadErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let f = &mut Plain(f);
        match self {
            Self::Io { message, .. } => f.write_str(message),
            Self::UnsupportedFormat { extension } => {
                match extension.as_str() {
                    "" => write!(f, "no extension, so no known format")?,
                    _ => write!(f, "unsupported format .{extension}")?,
                }
                write!(f, "; supported are")?;
                for (i, format) in Format::ALL.iter().enumerate() {
                    write!(f, "{} .{}", if i == 0 { "" } else { "," }, format.extension())?;
                }
                write!(f, ", and each of them as .gz")
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
                write!(f, "{count} {what} are more than the {limit} that are allowed")
            }
            Self::Corrupt { what } => f.write_str(what),
            Self::BrokenRig { kind } => write!(f, "{kind}"),
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

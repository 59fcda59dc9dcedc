//! Loads the buffers of a glTF document: the chunk of a GLB file, base64 text, or files in the
//! folder of the document.

use std::{
    borrow::Cow,
    collections::HashMap,
    fs,
    path::{Component, Path, PathBuf},
};

use base64::{
    Engine, alphabet,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    limits::Limits,
    regular_file,
};

use super::document::Buffer;

/// Base64 decoder that accepts text with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// All buffers of a document. Buffers that name the same file share its content.
pub(super) struct Buffers<'a> {
    data: Vec<Cow<'a, [u8]>>,
    /// For each buffer, its index in `data`; `None` for a buffer without data.
    of_buffer: Vec<Option<usize>>,
    total_len: u64,
}

/// The content of one or several buffers, before it is read.
struct Content<'d, 'a> {
    origin: Origin<'d, 'a>,
    /// Number of bytes that the buffers state, at most.
    len: u64,
    /// The first buffer with this content, for errors.
    first: usize,
}

enum Origin<'d, 'a> {
    Chunk(&'a [u8]),
    /// Base64 text.
    Text(&'d str),
    /// A file: its URI for errors, and its path without links.
    File(&'d str, PathBuf),
}

impl<'a> Buffers<'a> {
    /// Loads all buffers. Files must lie in `folder`; `None` reads none. Only as many bytes of a
    /// file are read as its buffers state.
    pub(super) fn load(
        buffers: &[Buffer],
        chunk: Option<&'a [u8]>,
        folder: Option<&Path>,
        limits: &Limits,
    ) -> Result<Self, LoadError> {
        let (contents, of_buffer) = contents(buffers, chunk, folder)?;
        let mut data = Vec::with_capacity(contents.len());
        let mut total_len = 0_u64;
        for content in contents {
            let place = || Place::Entry(format!("buffer {}", content.first));
            let bytes = content.read(limits, total_len).map_err(|e| e.at(place()))?;
            total_len += bytes.len() as u64;
            data.push(bytes);
        }
        for (i, (buffer, content)) in buffers.iter().zip(&of_buffer).enumerate() {
            let Some(content) = *content else { continue };
            let found = data[content].len() as u64;
            if found < buffer.byte_length {
                let error = LoadError::truncated("bytes", buffer.byte_length, found);
                return Err(error.at(Place::Entry(format!("buffer {i}"))));
            }
        }
        Ok(Self { data, of_buffer, total_len })
    }

    /// Returns the bytes of a buffer, or `None` if it does not exist or has no data.
    pub(super) fn get(&self, buffer: u32) -> Option<&[u8]> {
        let content = self.of_buffer.get(buffer as usize).copied().flatten()?;
        Some(&self.data[content])
    }

    /// Returns the total number of bytes.
    pub(super) fn total_len(&self) -> u64 {
        self.total_len
    }
}

/// Returns the different contents, and for each buffer the index of its content.
fn contents<'d, 'a>(
    buffers: &'d [Buffer],
    chunk: Option<&'a [u8]>,
    folder: Option<&Path>,
) -> Result<(Vec<Content<'d, 'a>>, Vec<Option<usize>>), LoadError> {
    let mut contents: Vec<Content<'_, '_>> = Vec::new();
    let (mut by_uri, mut by_path) = (HashMap::new(), HashMap::new());
    let mut of_buffer = Vec::with_capacity(buffers.len());
    for (i, buffer) in buffers.iter().enumerate() {
        let mut add = |origin| {
            contents.push(Content { origin, len: 0, first: i });
            contents.len() - 1
        };
        let content = match (buffer.uri.as_deref(), chunk) {
            (None, Some(chunk)) if i == 0 => Some(add(Origin::Chunk(chunk))),
            (None, _) => None,
            (Some(uri), _) => Some(match (by_uri.get(uri), uri.strip_prefix("data:")) {
                (Some(&known), _) => known,
                (None, Some(text)) => *by_uri.entry(uri).insert_entry(add(Origin::Text(text))).get(),
                (None, None) => {
                    let path = path_of(uri, folder).map_err(|e| e.at(Place::Entry(format!("buffer {i}"))))?;
                    let file = || add(Origin::File(uri, path.clone()));
                    let content = *by_path.entry(path.clone()).or_insert_with(file);
                    by_uri.insert(uri, content);
                    content
                }
            }),
        };
        if let Some(content) = content {
            contents[content].len = contents[content].len.max(buffer.byte_length);
        }
        of_buffer.push(content);
    }
    Ok((contents, of_buffer))
}

impl<'a> Content<'_, 'a> {
    /// Returns the bytes. `before` is the number of bytes that other contents have.
    fn read(&self, limits: &Limits, before: u64) -> Result<Cow<'a, [u8]>, LoadError> {
        match &self.origin {
            Origin::Chunk(chunk) => Ok(Cow::Borrowed(*chunk)),
            Origin::Text(text) => decode(text).map(Cow::Owned),
            Origin::File(uri, path) => {
                self.read_file(path, limits, before).map(Cow::Owned).map_err(|e| match e.kind() {
                    LoadErrorKind::Io { kind, message } => {
                        LoadError::new(LoadErrorKind::Io { kind: *kind, message: format!("{uri}: {message}") })
                    }
                    _ => e,
                })
            }
        }
    }

    fn read_file(&self, path: &Path, limits: &Limits, before: u64) -> Result<Vec<u8>, LoadError> {
        let (file, len) = regular_file::open(path)?;
        limits.check_bytes("bytes of buffers", before.saturating_add(len.min(self.len)))?;
        let mut bytes = Vec::new();
        regular_file::read_up_to(&file, len, self.len, &mut bytes)?;
        Ok(bytes)
    }
}

/// Decodes the text of a data URI after its scheme.
fn decode(content: &str) -> Result<Vec<u8>, LoadError> {
    let Some((_, text)) = content.split_once(";base64,") else {
        return Err(LoadError::unsupported("a data URI that is not base64"));
    };
    BASE64.decode(text).map_err(|e| LoadError::syntax("base64 text", e.to_string().as_bytes()))
}

/// Returns the path of a file that a URI names, without links, so that different spellings give the
/// same path.
fn path_of(uri: &str, folder: Option<&Path>) -> Result<PathBuf, LoadError> {
    let path =
        relative_path(uri).ok_or_else(|| LoadError::new(LoadErrorKind::OutsideFolder { uri: uri.to_owned() }))?;
    let Some(folder) = folder else {
        return Err(LoadError::unsupported(format!("the file {uri:?} beside it")));
    };
    fs::canonicalize(folder.join(path)).map_err(|e| {
        let message = format!("{uri}: {e}");
        LoadError::new(LoadErrorKind::Io { kind: e.kind(), message })
    })
}

/// Returns the path of a relative URI, or `None` if it may lead outside of its folder.
fn relative_path(uri: &str) -> Option<PathBuf> {
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8().ok()?;
    // On some systems, backslashes and colons are separators, drives or schemes.
    if decoded.is_empty() || decoded.contains(['\\', ':', '\0']) {
        return None;
    }
    let path = PathBuf::from(decoded.into_owned());
    let is_inside = path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    is_inside.then(|| path.components().filter(|c| *c != Component::CurDir).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_outside_of_the_folder_are_rejected() {
        for inside in ["a.bin", "./a.bin", "sub/a%20b.bin", "...bin"] {
            assert!(relative_path(inside).is_some(), "{inside}");
        }
        let outside = [
            "",
            "/etc/passwd",
            "../a.bin",
            "a/../../b",
            "%2e%2e/a",
            "%2Fetc",
            "..\\a",
            "http://x/y",
            "C:a",
            "a%00",
            "a/..",
        ];
        for outside in outside {
            assert!(relative_path(outside).is_none(), "{outside}");
        }
    }

    #[test]
    fn base64_is_decoded_with_or_without_padding() {
        for text in ["application/octet-stream;base64,AQI=", ";base64,AQI"] {
            assert_eq!(decode(text), Ok(vec![1, 2]));
        }
        assert_eq!(decode(";base64,A!").unwrap_err().kind().name(), "syntax");
        assert_eq!(decode("text/plain,x").unwrap_err().kind().name(), "unsupported-feature");
    }
}

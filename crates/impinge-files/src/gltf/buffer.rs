//! Loads the buffers of a glTF document: the chunk of a GLB file, base64 text, or files in the
//! folder of the document.

use std::{
    borrow::Cow,
    collections::HashMap,
    fs::File,
    io::Read,
    path::{Component, Path, PathBuf},
};

use base64::{
    Engine, alphabet,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

use crate::error::{LoadError, LoadErrorKind, Place};

use super::document::Buffer;

/// Base64 decoder that accepts text with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// All buffers of a document. Each file is read once.
pub(super) struct Buffers<'a> {
    data: Vec<Cow<'a, [u8]>>,
    /// For each buffer, its index in `data`; `None` for a buffer without data.
    of_buffer: Vec<Option<usize>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn load(buffers: &[Buffer], chunk: Option<&'a [u8]>, folder: Option<&Path>) -> Result<Self, LoadError> {
        let mut data = Vec::new();
        let mut by_uri = HashMap::new();
        let mut of_buffer = Vec::new();
        for (i, buffer) in buffers.iter().enumerate() {
            let place = || Place::Entry(format!("buffer {i}"));
            let entry = match (buffer.uri.as_deref(), chunk) {
                (None, Some(chunk)) if i == 0 => {
                    data.push(Cow::Borrowed(chunk));
                    Some(data.len() - 1)
                }
                (None, _) => None,
                (Some(uri), _) => Some(match by_uri.get(uri) {
                    Some(&entry) => entry,
                    None => {
                        data.push(Cow::Owned(read_uri(uri, folder).map_err(|e| e.at(place()))?));
                        by_uri.insert(uri, data.len() - 1);
                        data.len() - 1
                    }
                }),
            };
            if let Some(entry) = entry {
                let found = data[entry].len() as u64;
                if found < buffer.byte_length {
                    return Err(LoadError::truncated("bytes", buffer.byte_length, found).at(place()));
                }
            }
            of_buffer.push(entry);
        }
        Ok(Self { data, of_buffer })
    }

    /// Returns the bytes of a buffer, or `None` if it does not exist or has no data.
    pub(super) fn get(&self, buffer: u32) -> Option<&[u8]> {
        let entry = self.of_buffer.get(buffer as usize).copied().flatten()?;
        Some(&self.data[entry])
    }

    /// Returns the total number of bytes.
    pub(super) fn total_len(&self) -> u64 {
        self.data.iter().map(|d| d.len() as u64).sum()
    }
}

fn read_uri(uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, LoadError> {
    if let Some(content) = uri.strip_prefix("data:") {
        let Some((_, text)) = content.split_once(";base64,") else {
            return Err(LoadError::unsupported("a data URI that is not base64"));
        };
        return BASE64.decode(text).map_err(|e| LoadError::syntax("base64 text", e.to_string().as_bytes()));
    }
    let path =
        relative_path(uri).ok_or_else(|| LoadError::new(LoadErrorKind::OutsideFolder { uri: uri.to_owned() }))?;
    let Some(folder) = folder else {
        return Err(LoadError::unsupported(format!("the file {uri:?} beside it")));
    };
    let mut bytes = Vec::new();
    let read = File::open(folder.join(path)).and_then(|mut file| file.read_to_end(&mut bytes));
    match read {
        Ok(_) => Ok(bytes),
        Err(e) => {
            let message = format!("{uri}: {e}");
            Err(LoadError::new(LoadErrorKind::Io { kind: e.kind(), message }))
        }
    }
}

/// Returns the path of a relative URI, or `None` if it may lead outside of its folder.
fn relative_path(uri: &str) -> Option<PathBuf> {
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8().ok()?;
    // On some systems, backslashes and colons are separators, drives or schemes.
    if decoded.is_empty() || decoded.contains(['\\', ':', '\0']) {
        return None;
    }
    let path = PathBuf::from(decoded.into_owned());
    path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir)).then_some(path)
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
        for text in ["data:application/octet-stream;base64,AQI=", "data:;base64,AQI"] {
            assert_eq!(read_uri(text, None), Ok(vec![1, 2]));
        }
        assert_eq!(read_uri("data:;base64,A!", None).unwrap_err().kind().name(), "syntax");
        assert_eq!(read_uri("data:text/plain,x", None).unwrap_err().kind().name(), "unsupported-feature");
    }
}

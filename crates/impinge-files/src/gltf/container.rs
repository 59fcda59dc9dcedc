//! The binary container GLB (glTF 2.0 specification, §4.4): a header, a chunk of JSON, and an
//! optional chunk of bytes.

use crate::{
    error::{LoadError, Place},
    model::{WarningKind, Warnings},
};

/// Splits a GLB file into its JSON chunk and its optional binary chunk.
pub(super) fn split<'a>(bytes: &'a [u8], warnings: &mut Warnings) -> Result<(&'a [u8], Option<&'a [u8]>), LoadError> {
    let [magic, version, total] = [0, 4, 8].map(|at| bytes.get(at..at + 4));
    let (Some(magic), Some(version), Some(total)) = (magic, version.map(word), total.map(word)) else {
        return Err(LoadError::truncated("bytes of header", 12, bytes.len() as u64));
    };
    if magic != b"glTF" {
        return Err(LoadError::syntax("glTF", magic).at(Place::Byte(0)));
    }
    if version != 2 {
        let error = LoadError::unsupported(format!("GLB version {version}")).at(Place::Byte(4));
        return Err(if version == 1 { error.with_hint(super::CONVERT_VERSION_1) } else { error });
    }
    let len = bytes.len() as u64;
    if u64::from(total) > len {
        return Err(LoadError::truncated("bytes", total.into(), len).at(Place::Byte(8)));
    }
    let (content, trailing) = bytes.split_at(total as usize);
    warnings.add(WarningKind::TrailingBytes, trailing.len() as u64, || Some(Place::Byte(total.into())));

    let (mut json, mut binary, mut at) = (None, None, 12);
    while let Some(head) = content.get(at..at + 8) {
        let (size, kind) = (word(&head[..4]) as usize, &head[4..]);
        let Some(chunk) = content.get(at + 8..).and_then(|rest| rest.get(..size)) else {
            let room = content.len() - at - 8;
            return Err(LoadError::truncated("bytes of a chunk", size as u64, room as u64).at(Place::Byte(at as u64)));
        };
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + size;
    }
    let json = json.ok_or_else(|| LoadError::syntax("a chunk of JSON", b"").at(Place::Byte(12)))?;
    Ok((json, binary))
}

fn word(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte))
}

//! Decodes text files: byte order marks, UTF-16, and NULs that pad lines or the end of the file.

use std::borrow::Cow;

use memchr::memchr;

use crate::{
    error::{LoadError, Place},
    format::Format,
    model::{WarningKind, Warnings},
    text::{line_at, not_text, without_bom},
};

/// Text without NULs and without a byte order mark.
#[derive(Debug)]
pub(crate) struct PlainText<'a> {
    /// The text. It has the same lines as the file, but other bytes if the file is UTF-16.
    pub(crate) text: Cow<'a, [u8]>,
    /// Number of padding NULs that were replaced by spaces.
    padding: u64,
    /// Line of the first padding NUL.
    first_line: u64,
}

impl<'a> PlainText<'a> {
    /// Decodes UTF-16 if the file has its byte order mark, and replaces padding NULs by spaces.
    ///
    /// # Errors
    /// Returns an error if there is a NUL within a line: then the file is binary, or UTF-16 without
    /// a byte order mark.
    pub(crate) fn new(bytes: &'a [u8], format: Format) -> Result<Self, LoadError> {
        let mut text = match utf16(bytes) {
            Some(text) => Cow::Owned(text.into_bytes()),
            None => Cow::Borrowed(without_bom(bytes)),
        };
        let Some(first) = memchr(0, &text) else { return Ok(Self { text, padding: 0, first_line: 0 }) };
        let place = |at| match &text {
            Cow::Borrowed(text) => Place::Byte((bytes.len() - text.len() + at) as u64),
            Cow::Owned(text) => Place::Line(line_at(text, at)),
        };
        let padding = padding(&text, first).map_err(|at| not_text(format).at(place(at)))?;
        let first_line = line_at(&text, first);
        for byte in &mut text.to_mut()[first..] {
            if *byte == 0 {
                *byte = b' ';
            }
        }
        Ok(Self { text, padding, first_line })
    }

    /// Adds the warning about padding NULs, if there are any.
    pub(crate) fn warn(&self, warnings: &mut Warnings) {
        warnings.add(WarningKind::PaddingNuls, self.padding, || Some(Place::Line(self.first_line)));
    }
}

/// Returns the text of a UTF-16 file, or `None` if the file has no byte order mark of UTF-16.
pub(crate) fn utf16(bytes: &[u8]) -> Option<String> {
    let (mark, units) = bytes.split_first_chunk()?;
    let unit = match mark {
        [0xFF, 0xFE] => u16::from_le_bytes,
        [0xFE, 0xFF] => u16::from_be_bytes,
        _ => return None,
    };
    let (pairs, _) = units.as_chunks();
    let mut text = String::with_capacity(pairs.len());
    let chars = char::decode_utf16(pairs.iter().map(|&pair| unit(pair)));
    text.extend(chars.map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
    Some(text)
}

/// Returns the number of NULs if all of them are padding, else the offset of a NUL that is not.
///
/// Padding is a run of NULs after text, if the run touches the end of a line or of the file. A run
/// at the start of a file is not padding, because binary files begin like that.
fn padding(text: &[u8], first: usize) -> Result<u64, usize> {
    let is_line_end = |b: &u8| matches!(b, b'\n' | b'\r');
    let mut count = 0;
    let mut next = Some(first);
    while let Some(start) = next {
        let len = text[start..].iter().take_while(|&&b| b == 0).count();
        let end = start + len;
        let before = text[..start].last();
        let after = text.get(end);
        let touches = before.is_some_and(is_line_end) || (before.is_some() && after.is_none_or(is_line_end));
        if !touches {
            return Err(start);
        }
        count += len as u64;
        next = memchr(0, &text[end..]).map(|at| end + at);
    }
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(bytes: &[u8]) -> Result<(Vec<u8>, Option<String>), String> {
        let plain = PlainText::new(bytes, Format::Obj).map_err(|e| e.to_string())?;
        let mut warnings = Warnings::default();
        plain.warn(&mut warnings);
        Ok((plain.text.to_vec(), warnings.into_vec().first().map(ToString::to_string)))
    }

    #[test]
    fn utf16_with_a_byte_order_mark_is_decoded() {
        let text = "v 1 2 3\ng caf\u{E9} \u{1F600}\n";
        let expected = Ok((text.as_bytes().to_vec(), None));
        let units: Vec<u16> = "\u{FEFF}".encode_utf16().chain(text.encode_utf16()).collect();
        let little: Vec<u8> = units.iter().flat_map(|u| u.to_le_bytes()).collect();
        let big: Vec<u8> = units.iter().flat_map(|u| u.to_be_bytes()).collect();
        assert_eq!(plain(&little), expected);
        assert_eq!(plain(&big), expected);
        // A lone surrogate and half a unit at the end are not text, but no reason to reject the
        // rest.
        assert_eq!(plain(b"\xFF\xFEa\0\0\xD8b\0c"), Ok(("a\u{FFFD}b".into(), None)));
        assert_eq!(plain(b"\xEF\xBB\xBFa"), Ok((b"a".to_vec(), None)));
        let error = "line 2: not OBJ, but binary data or UTF-16";
        assert_eq!(plain(b"\xFF\xFE\n\0a\0\0\0b\0"), Err(error.to_owned()));
    }

    #[test]
    fn padding_becomes_spaces() {
        let warning = |n: u64, line| {
            let first = if n == 1 { "at" } else { "the first at" };
            Some(format!("NUL bytes between lines or at the end of the text, ignored: {n}, {first} line {line}"))
        };
        assert_eq!(plain(b"a\nb\0\0"), Ok((b"a\nb  ".to_vec(), warning(2, 2))));
        assert_eq!(plain(b"a\0\nb\0\r\nc"), Ok((b"a \nb \r\nc".to_vec(), warning(2, 1))));
        assert_eq!(plain(b"a\n\0b"), Ok((b"a\n b".to_vec(), warning(1, 2))));
    }

    #[test]
    fn nuls_within_a_line_are_errors() {
        for (bytes, at) in
            [(&b"\0\x01\x02"[..], 0), (b"v\0 \x001\0", 1), (b"\0v\0 ", 0), (b"a\n\0b\0c", 4), (b"\0\0", 0)]
        {
            assert_eq!(plain(bytes), Err(format!("byte {at}: not OBJ, but binary data or UTF-16")));
        }
    }
}

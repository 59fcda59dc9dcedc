//! STL (3D Systems, *StereoLithography Interface Specification*, 1988), binary and ASCII.
//!
//! A file is binary if its length is exactly 84 + 50 n for the count n that it states. It is ASCII
//! if it begins with `solid` and a facet or the end follows. Any other file that contains a NUL or
//! states a count of 4294967295 is binary with missing or extra bytes, because many binary files
//! begin with `solid`. Normals, attributes and colors are ignored. Corners with equal positions
//! become one vertex ([`weld`](crate::weld)). Each `solid` of an ASCII file is a part.
//!
//! - A binary file whose count is 0 or 4294967295 is read to its end, with a warning.
//! - In ASCII, text after `endfacet`, comments from `#` to the end of the line, and a missing
//!   `endsolid` or `normal` cause warnings. A facet with more than three corners is triangulated by
//!   [`polygon`](crate::polygon).

mod ascii;
mod binary;

use crate::{
    encoding::{PlainText, utf16},
    error::{LoadError, LoadErrorKind},
    format::Format,
    limits::Limits,
    model::Model,
    text::{split_token, trim_start, without_bom},
};

pub(crate) use binary::has_binary_length;

/// Reports whether the bytes begin as an ASCII file: `solid`, a name, then a facet or the end,
/// possibly after comments.
pub(crate) fn opens_as_text(bytes: &[u8]) -> bool {
    let line_end = |text: &[u8]| memchr::memchr2(b'\n', b'\r', text).unwrap_or(text.len());
    let text = trim_start(without_bom(bytes));
    if !text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return false;
    }
    let mut text = trim_start(&text[line_end(text)..]);
    while text.starts_with(b"#") {
        text = trim_start(&text[line_end(text)..]);
    }
    let (word, _) = split_token(text);
    [&b"facet"[..], b"endsolid"].iter().any(|w| word.eq_ignore_ascii_case(w))
}

pub(crate) fn read(bytes: &[u8], limits: &Limits) -> Result<Model, LoadError> {
    if is_binary(bytes) {
        return binary::read(bytes, limits);
    }
    // The text may not be STL; then the ASCII reader reports the place of the error.
    ascii::read(&PlainText::new(bytes, Format::Stl)?, limits)
}

fn is_binary(bytes: &[u8]) -> bool {
    if has_binary_length(bytes) {
        return true;
    }
    if opens_as_text(bytes) || opens_as_utf16(bytes) {
        return false;
    }
    memchr::memchr(0, bytes).is_some() || binary::stated_count(bytes) == Some(u32::MAX)
}

/// Reports whether a UTF-16 file begins with `solid`. A byte order mark alone may be the header of
/// a binary file.
fn opens_as_utf16(bytes: &[u8]) -> bool {
    const SOLID: usize = 2 + 2 * 5;
    utf16(&bytes[..bytes.len().min(SOLID)]).is_some_and(|text| text.eq_ignore_ascii_case("solid"))
}

fn non_finite(corner: usize) -> LoadError {
    LoadError::new(LoadErrorKind::NonFinite { vertex: corner as u64 })
}

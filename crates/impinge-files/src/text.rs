//! Splits text formats into lines, tokens and numbers. Text is handled as bytes, because names and
//! comments need not be UTF-8.

use std::str::FromStr;

use memchr::memchr;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    plain::is_control_character,
};

/// Returns the error that the bytes are not text if they contain a NUL, else `None`.
pub(crate) fn binary_data(bytes: &[u8], expected: Format) -> Option<LoadError> {
    memchr(0, bytes).map(|at| not_text(expected).at(Place::Byte(at as u64)))
}

/// Returns the error that a file is not text.
pub(crate) fn not_text(expected: Format) -> LoadError {
    LoadError::new(LoadErrorKind::WrongContent { expected, found: "binary data or UTF-16" })
}

/// Returns the bytes after a UTF-8 byte order mark, or all bytes if there is none.
pub(crate) fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Reports whether a byte is white space within a line or at its end.
pub(crate) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0x0B | 0x0C)
}

pub(crate) fn trim_start(text: &[u8]) -> &[u8] {
    let start = text.iter().position(|&b| !is_space(b)).unwrap_or(text.len());
    &text[start..]
}

pub(crate) fn trim(text: &[u8]) -> &[u8] {
    let text = trim_start(text);
    let end = text.iter().rposition(|&b| !is_space(b)).map_or(0, |last| last + 1);
    &text[..end]
}

/// Returns the first token and the text after it.
pub(crate) fn split_token(text: &[u8]) -> (&[u8], &[u8]) {
    let text = trim_start(text);
    let end = text.iter().position(|&b| is_space(b)).unwrap_or(text.len());
    text.split_at(end)
}

/// Returns the tokens between white space.
pub(crate) fn tokens(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|&b| is_space(b)).filter(|token| !token.is_empty())
}

/// Returns the f64 nearest to a decimal number that is the whole token, also in the notations of
/// Fortran and of C on Windows. Returns `None` if the token is not a number.
pub(crate) fn number(token: &[u8]) -> Option<f64> {
    fast_float2::parse(token).ok().or_else(|| foreign_number(token))
}

/// Returns the f32 nearest to a decimal number that is the whole token, in the notations of
/// [`number`].
///
/// Parsing an f64 first would round the number twice.
#[inline]
pub(crate) fn single_number(token: &[u8]) -> Option<f32> {
    fast_float2::parse(token).ok().or_else(|| foreign_number(token))
}

/// Parses a number with the exponent letter of Fortran (`1.0D+01`). Also parses a NaN or infinity
/// as C on Windows writes it (`-nan(ind)`, `1.#QNAN`); both become a NaN.
///
/// Uses the parser of the standard library, so that the faster parser has only one caller and can
/// be inlined there.
#[cold]
#[inline(never)]
fn foreign_number<T: FromStr>(token: &[u8]) -> Option<T> {
    let unsigned = token.strip_prefix(b"-").or_else(|| token.strip_prefix(b"+")).unwrap_or(token);
    let is_nan = |start: &[u8]| start.eq_ignore_ascii_case(b"nan(") || start == b"1.#I" || start == b"1.#Q";
    if unsigned.get(..4).is_some_and(is_nan) {
        return "nan".parse().ok();
    }
    let letter = token.iter().position(|b| matches!(b, b'd' | b'D'))?;
    let mut copy = [0; MAX_FOREIGN];
    let copy = copy.get_mut(..token.len())?;
    copy.copy_from_slice(token);
    copy[letter] = b'e';
    str::from_utf8(copy).ok()?.parse().ok()
}

/// Maximum length of a number with a Fortran exponent, in bytes. Fortran writes at most 25
/// characters for a double.
const MAX_FOREIGN: usize = 64;

/// Returns the decimal integer that is the whole token, clamped to the range of i64. Returns `None`
/// if the token is not an integer.
pub(crate) fn integer(token: &[u8]) -> Option<i64> {
    let (negative, digits) = match token {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    let mut value = 0_i64;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value.saturating_mul(10).saturating_add(i64::from(digit - b'0'));
    }
    (!digits.is_empty()).then_some(if negative { -value } else { value })
}

/// Returns the name of a part as UTF-8: trimmed, and truncated to [`MAX_NAME`] bytes. Bytes that
/// are not UTF-8 and control characters become replacement characters.
pub(crate) fn name(text: &[u8]) -> String {
    let text = trim(text);
    let mut name = String::from_utf8_lossy(&text[..text.len().min(MAX_NAME)]).into_owned();
    if name.contains(is_control_character) {
        name = name.replace(is_control_character, "\u{FFFD}");
    }
    name.truncate(name.floor_char_boundary(MAX_NAME));
    name
}

/// Maximum length of a part's name, in bytes. Many parts can share one name of the file, so without
/// a limit they could take memory quadratic in the file's size.
pub(crate) const MAX_NAME: usize = 255;

/// Returns the line of the byte at `offset`, counted from one.
pub(crate) fn line_at(bytes: &[u8], offset: usize) -> u64 {
    let before = &bytes[..offset.min(bytes.len())];
    1 + memchr::memchr_iter(line_end(bytes), before).count() as u64
}

/// Returns the byte that ends a line: `
/// `, or `\r` if the file has no `
/// ` at all.
fn line_end(bytes: &[u8]) -> u8 {
    if memchr(b'\n', bytes).is_none() && memchr(b'\r', bytes).is_some() { b'\r' } else { b'\n' }
}

/// Iterates over the lines of a text and counts them from one.
#[derive(Clone)]
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    end: u8,
    number: u64,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, end: line_end(bytes), number: 0 }
    }

    /// Returns the number of the line that was returned last.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Returns the lines that were not returned yet.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    /// Returns the next line. Its end may still contain a `\r`, which every reader treats as white
    /// space.
    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let (line, rest) = match memchr(self.end, self.rest) {
            Some(at) => (&self.rest[..at], &self.rest[at + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        self.number += 1;
        Some(line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_may_end_in_lf_crlf_or_cr() {
        for text in [&b"a\nb\n\nc"[..], b"a\r\nb\r\n\r\nc\r\n", b"a\rb\r\rc"] {
            let lines: Vec<_> = Lines::new(text).map(trim).collect();
            assert_eq!(lines, [&b"a"[..], b"b", b"", b"c"]);
            let at = text.iter().position(|&b| b == b'c').unwrap();
            assert_eq!(line_at(text, at), 4);
        }
    }

    #[test]
    fn numbers_of_fortran_and_of_c_on_windows_are_parsed() {
        for (text, value) in [("1.0D+01", 10.0), ("-0.1d-1", -0.01), ("5D0", 5.0), ("1e3", 1000.0)] {
            assert_eq!(number(text.as_bytes()), Some(value), "{text}");
            assert_eq!(single_number(text.as_bytes()), Some(value as f32), "{text}");
        }
        for nan in ["nan", "-nan(ind)", "1.#QNAN", "-1.#IND00", "+1.#INF"] {
            assert!(number(nan.as_bytes()).unwrap().is_nan(), "{nan}");
        }
        let long = format!("1{}D0", "0".repeat(MAX_FOREIGN));
        for bad in ["", "D", "1D", "1D+", "1DD1", "0x1D", "1.0#c", "1,5", &long] {
            assert_eq!(number(bad.as_bytes()), None, "{bad}");
        }
    }

    #[test]
    fn integers_saturate() {
        assert_eq!(integer(b"-12"), Some(-12));
        assert_eq!(integer(b"+7"), Some(7));
        assert_eq!(integer(b"99999999999999999999999"), Some(i64::MAX));
        for bad in [&b""[..], b"-", b"1.0", b"1e3", b"x"] {
            assert_eq!(integer(bad), None);
        }
    }

    #[test]
    fn names_are_valid_utf8_of_bounded_length() {
        assert_eq!(name(b"  caf\xE9 \r"), "caf\u{FFFD}");
        assert_eq!(name(&[0xFF; 1000]).len(), MAX_NAME);
        assert!(name("é".repeat(1000).as_bytes()).len() <= MAX_NAME);
    }
}

//! Reads the values of an ASCII PLY file.

use crate::{
    error::{LoadError, Place},
    format::Format,
    text::{binary_data, line_at, number, single_number, split_token, trim_start},
};

use super::{Values, header::Scalar};

pub(super) struct Ascii<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Number of rows with values that the header does not declare.
    surplus: u64,
    /// Byte offset of the first such value.
    first_surplus: usize,
}

impl<'a> Ascii<'a> {
    /// Builds a reader of the values from byte `at` on.
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Result<Self, LoadError> {
        match binary_data(bytes, Format::Ply) {
            Some(error) => Err(error.with_hint("the header says ascii")),
            None => Ok(Self { bytes, at, surplus: 0, first_surplus: 0 }),
        }
    }

    fn token(&mut self) -> Result<&'a [u8], LoadError> {
        let (token, rest) = split_token(&self.bytes[self.at..]);
        if token.is_empty() {
            let error = LoadError::syntax("a value", b"").with_hint("the file is cut off or its counts are wrong");
            return Err(error.at(self.place(self.at)));
        }
        self.at = self.bytes.len() - rest.len();
        Ok(token)
    }
}

impl Values for Ascii<'_> {
    fn next(&mut self, scalar: Scalar) -> Result<f64, LoadError> {
        let at = self.at;
        let token = self.token()?;
        let value = match scalar {
            Scalar::Float => single_number(token).map(f64::from),
            _ => number(token),
        };
        value.ok_or_else(|| LoadError::syntax("a number", token).at(self.place(at)))
    }

    fn skip(&mut self, _: Scalar, count: u64) -> Result<(), LoadError> {
        for _ in 0..count {
            self.token()?;
        }
        Ok(())
    }

    /// Returns 2: a digit and the white space after it.
    fn min_size(&self, _: Scalar) -> u64 {
        2
    }

    fn offset(&self) -> usize {
        self.at
    }

    fn seek(&mut self, offset: usize) {
        self.at = offset;
    }

    fn place(&self, offset: usize) -> Place {
        // Take the line of the token after the offset, or at the end, of the last token.
        let rest = trim_start(&self.bytes[offset..]);
        let token = if rest.is_empty() { offset } else { self.bytes.len() - rest.len() };
        Place::Line(line_at(self.bytes, token))
    }

    fn remaining(&self) -> u64 {
        trim_start(&self.bytes[self.at..]).len() as u64
    }

    fn end_row(&mut self) {
        let rest = &self.bytes[self.at..];
        let len = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        if !trim_start(&rest[..len]).is_empty() {
            if self.surplus == 0 {
                self.first_surplus = self.at;
            }
            self.surplus += 1;
        }
        self.at += len;
    }

    fn surplus(&self) -> Option<(u64, Place)> {
        (self.surplus > 0).then(|| (self.surplus, self.place(self.first_surplus)))
    }
}

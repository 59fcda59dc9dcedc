//! Reads ASCII OFF. A vertex is three numbers; a face is a number and that many indices.
//!
//! Most files have one vertex or face per line, and the rest of the line are attributes, in any
//! number. Other files break lines anywhere. A file is read by lines first. If that fails, it is
//! read by tokens: then a vertex has as many numbers as the header states, and the rest of a face's
//! line are attributes.

use crate::{
    encoding::PlainText,
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::Limits,
    model::{Faces, Model, WarningKind, stored, too_many},
    non_finite::NonFinite,
    text::{integer, number, split_token, tokens, trim_start},
};

use super::{Content, Header};

pub(super) fn read(plain: &PlainText<'_>, limits: &Limits) -> Result<Model, LoadError> {
    let mut content = Content::new(&plain.text);
    let (counts, extra_values) = read_counts(&mut content)?;
    let body = |by_tokens| Body { content: content.clone(), line: &[], by_tokens, limits };
    let by_lines = body(false).read(counts, 0, plain);
    by_lines.or_else(|error| body(true).read(counts, extra_values, plain).map_err(|_| error))
}

/// Returns the numbers of vertices and faces, and the number of values after the position of a
/// vertex.
fn read_counts(content: &mut Content<'_>) -> Result<([u64; 2], usize), LoadError> {
    let mut line = content.next().unwrap_or_default();
    let mut extra_values = 0;
    if let Some(header) = Header::new(line) {
        if header.is_of_other_dimension() {
            let name = format!("the OFF dialect {}", String::from_utf8_lossy(line).trim_end());
            return Err(LoadError::unsupported(name).at(content.place()));
        }
        extra_values = header.extra_values();
        let rest = header.rest;
        line = if trim_start(rest).is_empty() { content.next().unwrap_or_default() } else { rest };
    }
    let mut numbers = tokens(line);
    let mut counts = [0; 2];
    for (count, what) in counts.iter_mut().zip(["the number of vertices", "the number of faces"]) {
        let token = numbers.next().unwrap_or_default();
        *count = integer(token)
            .and_then(|n| u64::try_from(n).ok())
            .ok_or_else(|| LoadError::syntax(what, token).at(content.place()))?;
    }
    for (count, what) in counts.into_iter().zip(["vertices", "faces"]) {
        if count > u64::from(u32::MAX) {
            return Err(too_many(what, count).at(content.place()));
        }
    }
    Ok((counts, extra_values))
}

/// The part of the file after the counts.
struct Body<'a> {
    content: Content<'a>,
    /// The rest of the current line.
    line: &'a [u8],
    /// Whether lines may be broken anywhere.
    by_tokens: bool,
    limits: &'a Limits,
}

impl<'a> Body<'a> {
    fn read(
        mut self,
        [vertices, faces]: [u64; 2],
        extra_values: usize,
        plain: &PlainText<'_>,
    ) -> Result<Model, LoadError> {
        let (positions, non_finite) = self.read_vertices(vertices, extra_values)?;
        let mut faces = self.read_faces(faces, &positions)?;
        non_finite.check_unused(&mut faces, Place::Line)?;
        plain.warn(&mut faces.warnings);
        let parts = if faces.faces.is_empty() { Vec::new() } else { vec![String::new()] };
        faces.into_model(stored(positions), parts, None, Format::Off)
    }

    fn read_vertices(&mut self, count: u64, extra_values: usize) -> Result<(Vec<[f64; 3]>, NonFinite), LoadError> {
        let mut positions = Vec::new();
        let mut non_finite = NonFinite::default();
        while (positions.len() as u64) < count {
            if !self.start_item() {
                let vertex = positions.len() as u64;
                return Err(LoadError::truncated("vertices", count, vertex).at(self.content.place()));
            }
            let mut position = [0.0; 3];
            for x in &mut position {
                let token = self.token();
                *x = number(token).ok_or_else(|| LoadError::syntax("a coordinate", token).at(self.content.place()))?;
            }
            for _ in 0..extra_values {
                self.token();
            }
            if !position.iter().all(|x| x.is_finite()) {
                non_finite.add(positions.len(), self.content.lines.number());
            }
            positions.push(position);
        }
        non_finite.replace(&mut positions);
        Ok((positions, non_finite))
    }

    fn read_faces(&mut self, count: u64, positions: &[[f64; 3]]) -> Result<Faces, LoadError> {
        let mut faces = Faces::new(self.limits);
        let mut corners = Vec::new();
        for face in 0..count {
            if !self.start_item() {
                return Err(LoadError::truncated("faces", count, face).at(self.content.place()));
            }
            self.read_corners(face, positions.len(), &mut corners).map_err(|e| e.at(self.content.place()))?;
            faces.polygon(&corners, |i| positions[i as usize], 0, || self.content.place())?;
            self.line = &[];
        }
        let left = trim_start(self.content.lines.rest()).len();
        if left > 0 && self.content.next().is_some() {
            // If the header omits attributes, reading by tokens takes too few tokens, and lines
            // remain at the end.
            if self.by_tokens {
                return Err(LoadError::syntax("the end of the file", self.line).at(self.content.place()));
            }
            faces.warnings.add(WarningKind::TrailingBytes, left as u64, || Some(self.content.place()));
        }
        Ok(faces)
    }

    fn read_corners(&mut self, face: u64, len: usize, corners: &mut Vec<u32>) -> Result<(), LoadError> {
        corners.clear();
        let token = self.token();
        let count = integer(token)
            .and_then(|n| u64::try_from(n).ok())
            .ok_or_else(|| LoadError::syntax("the number of corners", token))?;
        while (corners.len() as u64) < count {
            let token = self.token();
            if token.is_empty() {
                return Err(LoadError::truncated("corners of a face", count, corners.len() as u64));
            }
            let index = integer(token).ok_or_else(|| LoadError::syntax("a vertex index", token))?;
            let vertex = u32::try_from(index).ok().filter(|&v| (v as usize) < len);
            let out_of_bounds = LoadErrorKind::IndexOutOfBounds { face, index, len: len as u64 };
            corners.push(vertex.ok_or_else(|| LoadError::new(out_of_bounds))?);
        }
        Ok(())
    }

    /// Moves to the first token of the next vertex or face. Returns whether there is one.
    fn start_item(&mut self) -> bool {
        if !self.by_tokens || trim_start(self.line).is_empty() {
            match self.content.next() {
                Some(line) => self.line = line,
                None => return false,
            }
        }
        true
    }

    /// Returns the next token. It is empty at the end of the file, or at the end of the line if the
    /// file is read by lines.
    #[inline]
    fn token(&mut self) -> &'a [u8] {
        let (mut token, mut rest) = split_token(self.line);
        if token.is_empty() && self.by_tokens {
            (token, rest) = split_token(self.content.next().unwrap_or_default());
        }
        self.line = rest;
        token
    }
}

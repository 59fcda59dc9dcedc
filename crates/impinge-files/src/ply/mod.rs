//! PLY (Greg Turk, *The PLY Polygon File Format*, 1994), ASCII and binary of both byte orders.
//!
//! - `vertex` must have `x`, `y` and `z`. If one of them is `double` or an integer of 32 or 64
//!   bits, the vertices are f64, else f32. A vertex that no face uses may be [NaN or
//!   infinite](crate::non_finite).
//! - `face` gives polygons by its list `vertex_indices` (or `vertex_index`). They are triangulated
//!   by [`polygon`](crate::polygon).
//! - `tristrips` gives triangle strips by the same list; -1 starts a new strip.
//! - A row of an ASCII file ends with its line. Values that the header does not declare are
//!   skipped, with a warning.
//! - A line of the header without a keyword is a comment, with a warning. The length of a list may
//!   have any type.
//! - All other elements and properties, including lists, are skipped, in any order.

mod ascii;
mod binary;
mod faces;
mod header;
#[cfg(test)]
mod tests;
mod vertices;
mod write;

use impinge::Positions;

pub use write::write_ply;

use crate::{
    error::{LoadError, Place},
    format::Format,
    limits::Limits,
    model::{Faces, Model, WarningKind},
    non_finite::NonFinite,
};
use faces::read_faces;
use header::{Element, Encoding, Header, Property, Scalar};
use vertices::read_vertices;

pub(crate) fn read(bytes: &[u8], limits: &Limits) -> Result<Model, LoadError> {
    let header = Header::read(bytes)?;
    match header.encoding {
        Encoding::Ascii => read_body(&header, ascii::Ascii::new(bytes, header.len)?, limits),
        Encoding::LittleEndian => read_body(&header, binary::Binary::<false>::new(bytes, header.len), limits),
        Encoding::BigEndian => read_body(&header, binary::Binary::<true>::new(bytes, header.len), limits),
    }
}

/// A reader of the values after the header.
trait Values {
    /// Returns the next value in f64. 64-bit integers beyond 2^53 are rounded; no valid count or
    /// index is that large.
    fn next(&mut self, scalar: Scalar) -> Result<f64, LoadError>;

    /// Skips `count` values.
    fn skip(&mut self, scalar: Scalar, count: u64) -> Result<(), LoadError>;

    /// Returns the minimum number of bytes of a value.
    fn min_size(&self, scalar: Scalar) -> u64;

    /// Returns the current byte offset, for errors and for [`seek`](Self::seek).
    fn offset(&self) -> usize;

    /// Moves to a byte offset.
    fn seek(&mut self, offset: usize);

    /// Returns the place of a byte offset, for errors.
    fn place(&self, offset: usize) -> Place;

    /// Returns the number of bytes left.
    fn remaining(&self) -> u64;

    /// Ends a row, and skips values in it that the header does not declare.
    fn end_row(&mut self) {}

    /// Returns the number of rows with undeclared values and the place of the first; `None` if
    /// there are no such rows.
    fn surplus(&self) -> Option<(u64, Place)> {
        None
    }

    /// Reads all vertices in bulk. Returns `None` if their layout does not allow it.
    fn vertices_at_once(&mut self, _element: &Element, _xyz: [usize; 3]) -> Option<Positions> {
        None
    }

    /// Reads all faces in bulk and calls `face` with the indices and the offset of each. Negative
    /// indices appear as numbers above `i32::MAX`. Returns `None` if the layout does not allow it.
    fn faces_at_once(
        &mut self,
        _element: &Element,
        _list: usize,
        _face: impl FnMut(&[u32], usize) -> Result<(), LoadError>,
    ) -> Option<Result<(), LoadError>> {
        None
    }
}

fn read_body(header: &Header, mut values: impl Values, limits: &Limits) -> Result<Model, LoadError> {
    let mut positions = None;
    let mut non_finite = NonFinite::default();
    let mut faces = Faces::new(limits);
    faces.warnings.add(WarningKind::UnknownLines, header.unknown_lines, || Some(Place::Line(header.first_unknown)));
    let mut deferred = Vec::new();
    let has_vertices = header.elements.iter().any(|e| e.name == "vertex");
    for element in &header.elements {
        check_room(element, &values)?;
        match element.name.as_str() {
            "vertex" => positions = Some(read_vertices(element, &mut values, &mut non_finite)?),
            "face" | "tristrips" if positions.is_none() && has_vertices => {
                deferred.push((element, values.offset()));
                skip_rows(element, &mut values)?;
            }
            "face" | "tristrips" => read_faces(element, &mut values, positions.as_ref(), &mut faces)?,
            _ => skip_rows(element, &mut values)?,
        }
    }
    let end = values.offset();
    faces.warnings.add(WarningKind::TrailingBytes, values.remaining(), || Some(Place::Byte(end as u64)));
    for (element, offset) in deferred {
        values.seek(offset);
        read_faces(element, &mut values, positions.as_ref(), &mut faces)?;
    }
    non_finite.check_unused(&mut faces, |offset| values.place(offset as usize))?;
    if let Some((rows, first)) = values.surplus() {
        faces.warnings.add(WarningKind::SurplusValues, rows, || Some(first));
    }
    let parts = if faces.faces.is_empty() { Vec::new() } else { vec![String::new()] };
    faces.into_model(positions.unwrap_or(Positions::F32(Vec::new())), parts, None, Format::Ply)
}

/// Returns an error if the file is too short for all rows of an element.
fn check_room(element: &Element, values: &impl Values) -> Result<(), LoadError> {
    let min_bytes = |p: &Property| values.min_size(p.list.unwrap_or(p.scalar));
    let row = element.properties.iter().map(min_bytes).sum::<u64>();
    if element.count == 0 || row == 0 {
        return Ok(());
    }
    // The last value of a text needs no separator after it.
    let room = (values.remaining() + 1) / row;
    if element.count <= room {
        return Ok(());
    }
    let what = format!("rows of element {}", element.name);
    Err(LoadError::truncated(what, element.count, room).at(values.place(values.offset())))
}

fn skip_rows(element: &Element, values: &mut impl Values) -> Result<(), LoadError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            skip_property(property, values)?;
        }
        values.end_row();
    }
    Ok(())
}

fn skip_property(property: &Property, values: &mut impl Values) -> Result<(), LoadError> {
    let count = read_len(property, values)?;
    values.skip(property.scalar, count)
}

/// Returns the number of values of a property in this row: 1, or the length of a list.
fn read_len(property: &Property, values: &mut impl Values) -> Result<u64, LoadError> {
    let Some(count) = property.list else { return Ok(1) };
    let at = values.offset();
    let what = "the length of a list";
    let len = read_integer(count, values, what)?;
    u64::try_from(len).map_err(|_| LoadError::syntax(what, len.to_string().as_bytes()).at(values.place(at)))
}

fn read_integer(scalar: Scalar, values: &mut impl Values, what: &str) -> Result<i64, LoadError> {
    let at = values.offset();
    let value = values.next(scalar)?;
    if value.fract() == 0.0 {
        // A value beyond the range of i64 is clamped, which is out of every valid range too.
        Ok(value as i64)
    } else {
        Err(LoadError::syntax(what, value.to_string().as_bytes()).at(values.place(at)))
    }
}

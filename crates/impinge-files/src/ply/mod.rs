//! PLY (Greg Turk, *The PLY Polygon File Format*, 1994), ASCII and binary of both byte orders.
//!
//! - `vertex` must have `x`, `y`, `z`; where one of them is `double` or a 32-bit integer the vertices are f64, else f32.
//! - `face` gives polygons by its list `vertex_indices` (or `vertex_index`), triangulated as
//!   [`polygon`](crate::polygon) says.
//! - `tristrips` gives triangle strips by the same list, in which -1 begins a new strip.
//! - All other elements and properties, lists among them, in any order, are skipped.

mod ascii;
mod binary;
mod faces;
mod header;
mod write;

use impinge::Positions;

pub use write::write_ply;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    model::{Faces, Model, WarningKind},
};
use faces::read_faces;
use header::{Element, Encoding, Header, Property, Scalar};

pub(crate) fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    let header = Header::read(bytes)?;
    match header.encoding {
        Encoding::Ascii => read_body(&header, ascii::Ascii::new(bytes, header.len)?),
        Encoding::LittleEndian => read_body(&header, binary::Binary::<false>::new(bytes, header.len)),
        Encoding::BigEndian => read_body(&header, binary::Binary::<true>::new(bytes, header.len)),
    }
}

/// The values after the header, in order.
trait Values {
    /// The next value, in f64, which holds every value of every type.
    fn next(&mut self, scalar: Scalar) -> Result<f64, LoadError>;

    /// Skips values.
    fn skip(&mut self, scalar: Scalar, count: u64) -> Result<(), LoadError>;

    /// How many bytes a value takes at least.
    fn least_size(&self, scalar: Scalar) -> u64;

    /// The byte offset, for errors and to come back.
    fn offset(&self) -> usize;

    /// Goes back to an offset.
    fn seek(&mut self, offset: usize);

    /// What an offset is called.
    fn place(&self, offset: usize) -> Place;

    /// How many bytes are left.
    fn remaining(&self) -> u64;

    /// All vertices at once, where their layout allows it.
    fn vertices_at_once(&mut self, _element: &Element, _xyz: [usize; 3]) -> Option<Positions> {
        None
    }

    /// All faces at once, where their layout allows it; negative indices come as more than `i32::MAX`.
    fn faces_at_once(
        &mut self,
        _element: &Element,
        _list: usize,
        _face: impl FnMut(&[u32], usize) -> Result<(), LoadError>,
    ) -> Option<Result<(), LoadError>> {
        None
    }
}

fn read_body(header: &Header, mut values: impl Values) -> Result<Model, LoadError> {
    let mut positions = None;
    let mut faces = Faces::default();
    let mut deferred = Vec::new();
    let has_vertices = header.elements.iter().any(|e| e.name == "vertex");
    for element in &header.elements {
        check_room(element, &values)?;
        match element.name.as_str() {
            "vertex" => positions = Some(read_vertices(element, &mut values)?),
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
    let parts = if faces.faces.is_empty() { Vec::new() } else { vec![String::new()] };
    faces.into_model(positions.unwrap_or(Positions::F32(Vec::new())), parts, None, Format::Ply)
}

/// An error where the rows of an element cannot all be there.
fn check_room(element: &Element, values: &impl Values) -> Result<(), LoadError> {
    let least = |p: &Property| values.least_size(p.list.unwrap_or(p.scalar));
    let row = element.properties.iter().map(least).sum::<u64>();
    // The last value of a text needs no separator after it.
    match (values.remaining() + 1).checked_div(row) {
        Some(room) if element.count > room => {
            let what = format!("rows of element {}", element.name);
            Err(LoadError::truncated(what, element.count, room).at(values.place(values.offset())))
        }
        _ => Ok(()),
    }
}

fn skip_rows(element: &Element, values: &mut impl Values) -> Result<(), LoadError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            skip_property(property, values)?;
        }
    }
    Ok(())
}

fn skip_property(property: &Property, values: &mut impl Values) -> Result<(), LoadError> {
    let count = read_len(property, values)?;
    values.skip(property.scalar, count)
}

/// How many values a property has in this row.
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
        // Integer types end at 2^32; a float beyond i64 becomes its end, which is out of every range too.
        Ok(value as i64)
    } else {
        Err(LoadError::syntax(what, value.to_string().as_bytes()).at(values.place(at)))
    }
}

fn read_vertices(element: &Element, values: &mut impl Values) -> Result<Positions, LoadError> {
    let find = |name| element.properties.iter().position(|p| p.name == name && p.list.is_none());
    let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(find) else {
        return Err(LoadError::syntax("properties x, y and z of element vertex", b""));
    };
    let xyz = [x, y, z];
    if let Some(positions) = values.vertices_at_once(element, xyz) {
        let bad = match &positions {
            Positions::F32(v) => v.iter().position(|p| !p.iter().all(|x| x.is_finite())),
            Positions::F64(v) => v.iter().position(|p| !p.iter().all(|x| x.is_finite())),
        };
        return bad.map_or(Ok(positions), |vertex| Err(non_finite(vertex as u64)));
    }
    let single = xyz.iter().all(|&i| element.properties[i].scalar.fits_f32());
    let (mut f32_rows, mut f64_rows) = (Vec::new(), Vec::new());
    for vertex in 0..element.count {
        let mut row = [0.0; 3];
        for (i, property) in element.properties.iter().enumerate() {
            match xyz.iter().position(|&k| k == i) {
                Some(k) => row[k] = values.next(property.scalar)?,
                None => skip_property(property, values)?,
            }
        }
        if !row.iter().all(|x| x.is_finite()) {
            return Err(non_finite(vertex));
        }
        if single {
            // Every value of these types is an f32.
            f32_rows.push(row.map(|x| x as f32));
        } else {
            f64_rows.push(row);
        }
    }
    Ok(if single { Positions::F32(f32_rows) } else { Positions::F64(f64_rows) })
}

fn non_finite(vertex: u64) -> LoadError {
    LoadError::new(LoadErrorKind::NonFinite { vertex }).at(Place::Vertex(vertex))
}

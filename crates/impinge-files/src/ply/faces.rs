//! Reads the polygons and triangle strips of a PLY file.

use impinge::Positions;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    model::{Faces, WarningKind},
};

use super::{
    Values,
    header::{Element, Property, Scalar},
    read_integer, read_len, skip_property,
};

pub(super) fn read_faces(
    element: &Element,
    values: &mut impl Values,
    positions: Option<&Positions>,
    faces: &mut Faces,
) -> Result<(), LoadError> {
    if element.count == 0 {
        return Ok(());
    }
    let is_indices = |p: &Property| p.list.is_some() && ["vertex_indices", "vertex_index"].contains(&p.name.as_str());
    let Some(list) = element.properties.iter().position(is_indices) else {
        let expected = format!("a list vertex_indices of element {}", element.name);
        return Err(LoadError::syntax(expected, b""));
    };
    if element.name == "tristrips" {
        return read_strips(element, list, values, positions.map_or(0, Positions::len), faces);
    }
    match positions {
        None => read_polygons(element, list, values, 0, |_| [0.0; 3], faces),
        Some(Positions::F32(v)) => {
            read_polygons(element, list, values, v.len(), |i| v[i as usize].map(f64::from), faces)
        }
        Some(Positions::F64(v)) => read_polygons(element, list, values, v.len(), |i| v[i as usize], faces),
    }
}

fn read_polygons(
    element: &Element,
    list: usize,
    values: &mut impl Values,
    len: usize,
    position: impl Fn(u32) -> [f64; 3],
    faces: &mut Faces,
) -> Result<(), LoadError> {
    let property = &element.properties[list];
    let min_bytes = values.min_size(property.list.unwrap_or(property.scalar)) + 3 * values.min_size(property.scalar);
    faces.reserve(element.count.min(values.remaining() / min_bytes) as usize);

    // A negative index of a signed type appears as a number in the upper half of u32, which is not
    // a vertex if there are at most `i32::MAX` vertices.
    if len <= i32::MAX as usize {
        let at_once = values.faces_at_once(element, list, |corners, at| {
            if let Some(&index) = corners.iter().find(|&&i| i as usize >= len) {
                let signed = property.scalar == Scalar::Int;
                let index = if signed { i64::from(index.cast_signed()) } else { i64::from(index) };
                return Err(out_of_bounds(index, len, faces.polygons()).at(Place::Byte(at as u64)));
            }
            faces.polygon(corners, &position, 0, || Place::Byte(at as u64))
        });
        if let Some(result) = at_once {
            return result;
        }
    }
    let mut corners = Vec::new();
    for _ in 0..element.count {
        let at = values.offset();
        corners.clear();
        read_row(element, list, values, |index| {
            corners.push(vertex(index, len).ok_or_else(|| out_of_bounds(index, len, faces.polygons()))?);
            Ok(())
        })?;
        faces.polygon(&corners, &position, 0, || values.place(at))?;
    }
    Ok(())
}

/// Reads triangle strips. Every second triangle of a strip has reversed winding; counting restarts
/// after a -1.
fn read_strips(
    element: &Element,
    list: usize,
    values: &mut impl Values,
    len: usize,
    faces: &mut Faces,
) -> Result<(), LoadError> {
    let mut joints = 0;
    for _ in 0..element.count {
        let mut strip = [0; 2];
        let mut seen = 0_usize;
        read_row(element, list, values, |index| {
            if index == -1 {
                seen = 0;
                return Ok(());
            }
            let c = vertex(index, len).ok_or_else(|| out_of_bounds(index, len, faces.polygons()))?;
            let [a, b] = strip;
            strip = [b, c];
            seen += 1;
            if seen < 3 {
                return Ok(());
            }
            if a == b || b == c || c == a {
                joints += 1;
                return Ok(());
            }
            faces.triangle(if seen % 2 == 1 { [a, b, c] } else { [b, a, c] }, 0)
        })?;
    }
    faces.warnings.add(WarningKind::StripJoints, joints, || None);
    Ok(())
}

/// Reads one row and calls `index` with each entry of its list of indices.
fn read_row(
    element: &Element,
    list: usize,
    values: &mut impl Values,
    mut index: impl FnMut(i64) -> Result<(), LoadError>,
) -> Result<(), LoadError> {
    for (i, property) in element.properties.iter().enumerate() {
        if i != list {
            skip_property(property, values)?;
            continue;
        }
        for _ in 0..read_len(property, values)? {
            let at = values.offset();
            let value = read_integer(property.scalar, values, "a vertex index")?;
            index(value).map_err(|e| e.at(values.place(at)))?;
        }
    }
    values.end_row();
    Ok(())
}

fn vertex(index: i64, len: usize) -> Option<u32> {
    u32::try_from(index).ok().filter(|&v| (v as usize) < len)
}

fn out_of_bounds(index: i64, len: usize, face: u32) -> LoadError {
    LoadError::new(LoadErrorKind::IndexOutOfBounds { face: face.into(), index, len: len as u64 })
}

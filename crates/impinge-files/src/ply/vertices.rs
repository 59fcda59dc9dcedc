//! Vertices: `x`, `y` and `z` wherever they stand in a row, in single precision where that holds each of them.

use impinge::Positions;

use super::header::Element;
use super::{Values, skip_property};
use crate::error::{LoadError, LoadErrorKind};

/// The rows of the element `vertex`, of which `x`, `y` and `z` are kept.
pub(super) fn read_vertices(element: &Element, values: &mut impl Values) -> Result<Positions, LoadError> {
    let find = |name| element.properties.iter().position(|p| p.name == name && p.list.is_none());
    let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(find) else {
        return Err(LoadError::syntax("properties x, y and z of element vertex", b""));
    };
    let xyz = [x, y, z];
    let start = values.offset();
    if let Some(positions) = values.vertices_at_once(element, xyz) {
        let bad = match &positions {
            Positions::F32(v) => v.iter().position(|p| !p.iter().all(|x| x.is_finite())),
            Positions::F64(v) => v.iter().position(|p| !p.iter().all(|x| x.is_finite())),
        };
        let row = (values.offset() - start) / positions.len().max(1);
        return match bad {
            Some(vertex) => Err(non_finite(vertex as u64).at(values.place(start + vertex * row))),
            None => Ok(positions),
        };
    }
    let single = xyz.iter().all(|&i| element.properties[i].scalar.fits_f32());
    let (mut f32_rows, mut f64_rows) = (Vec::new(), Vec::new());
    for vertex in 0..element.count {
        let at = values.offset();
        let mut row = [0.0; 3];
        for (i, property) in element.properties.iter().enumerate() {
            match xyz.iter().position(|&k| k == i) {
                Some(k) => row[k] = values.next(property.scalar)?,
                None => skip_property(property, values)?,
            }
        }
        values.end_row();
        if !row.iter().all(|x| x.is_finite()) {
            return Err(non_finite(vertex).at(values.place(at)));
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
    LoadError::new(LoadErrorKind::NonFinite { vertex })
}

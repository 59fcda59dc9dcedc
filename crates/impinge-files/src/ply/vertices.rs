//! Reads the vertices: `x`, `y` and `z` at any place in a row, as f32 if their types fit, else as
//! f64.

use impinge::Positions;

use super::header::Element;
use super::{Values, skip_property};
use crate::{error::LoadError, non_finite::NonFinite};

/// Reads `x`, `y` and `z` of all rows of the element `vertex`. Non-finite vertices are moved to the
/// first finite vertex and listed in `non_finite` with their offset.
pub(super) fn read_vertices(
    element: &Element,
    values: &mut impl Values,
    non_finite: &mut NonFinite,
) -> Result<Positions, LoadError> {
    let find = |name| element.properties.iter().position(|p| p.name == name && p.list.is_none());
    let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(find) else {
        return Err(LoadError::syntax("properties x, y and z of element vertex", b""));
    };
    let xyz = [x, y, z];
    let start = values.offset();
    let mut positions = match values.vertices_at_once(element, xyz) {
        Some(positions) => {
            let row = (values.offset() - start) / positions.len().max(1);
            let at = |vertex| (start + vertex * row) as u64;
            match &positions {
                Positions::F32(v) => find_non_finite(v, |x| x.is_finite(), at, non_finite),
                Positions::F64(v) => find_non_finite(v, |x| x.is_finite(), at, non_finite),
            }
            positions
        }
        None => read_rows(element, values, xyz, non_finite)?,
    };
    match &mut positions {
        Positions::F32(v) => non_finite.replace(v),
        Positions::F64(v) => non_finite.replace(v),
    }
    Ok(positions)
}

fn find_non_finite<T: Copy>(
    positions: &[[T; 3]],
    is_finite: impl Fn(T) -> bool,
    at: impl Fn(usize) -> u64,
    non_finite: &mut NonFinite,
) {
    for (vertex, position) in positions.iter().enumerate() {
        if !position.iter().all(|&x| is_finite(x)) {
            non_finite.add(vertex, at(vertex));
        }
    }
}

/// Reads the rows value by value.
fn read_rows(
    element: &Element,
    values: &mut impl Values,
    xyz: [usize; 3],
    non_finite: &mut NonFinite,
) -> Result<Positions, LoadError> {
    let single = xyz.iter().all(|&i| element.properties[i].scalar.fits_f32());
    let (mut f32_rows, mut f64_rows) = (Vec::new(), Vec::new());
    for vertex in 0..element.count as usize {
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
            non_finite.add(vertex, at as u64);
        }
        if single {
            // f32 holds every value of these types exactly.
            f32_rows.push(row.map(|x| x as f32));
        } else {
            f64_rows.push(row);
        }
    }
    Ok(if single { Positions::F32(f32_rows) } else { Positions::F64(f64_rows) })
}

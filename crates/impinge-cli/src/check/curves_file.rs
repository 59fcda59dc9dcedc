//! Writes intersection curves as Wavefront OBJ: a `v` for each point, an `l` for each curve and a
//! `p` for each isolated point. A closed curve repeats its first index at the end.

use std::io::{self, Write};
use std::path::Path;

use impinge::query::Curves;

use crate::failure::Failure;
use crate::output;

/// Validates the extension of the output file, before any work.
///
/// # Errors
/// Returns an error if the extension is not `.obj`.
pub(super) fn validate_extension(path: &Path) -> Result<(), Failure> {
    if output::extension(path) == "obj" { Ok(()) } else { Err(output::unknown_extension(path, ".obj")) }
}

/// Writes the curves in the common frame and unit.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(super) fn write(path: &Path, curves: &Curves) -> Result<(), Failure> {
    output::write(path, |out| write_obj(out, curves))
}

fn write_obj(out: &mut dyn Write, curves: &Curves) -> io::Result<()> {
    let mut vertices = 0;
    for line in &curves.polylines {
        let closed = line.len() > 1 && line.first() == line.last();
        let points = &line[..line.len() - usize::from(closed)];
        let first = vertices + 1; // OBJ indices start at 1 and continue through the file.
        write_vertices(out, points)?;
        vertices += points.len();
        write!(out, "l")?;
        for index in (first..=vertices).chain(closed.then_some(first)) {
            write!(out, " {index}")?;
        }
        writeln!(out)?;
    }
    write_vertices(out, &curves.points)?;
    (0..curves.points.len()).try_for_each(|at| writeln!(out, "p {}", vertices + 1 + at))
}

/// Writes all digits that are needed to read the same numbers back.
fn write_vertices(out: &mut dyn Write, points: &[[f64; 3]]) -> io::Result<()> {
    points.iter().try_for_each(|[x, y, z]| writeln!(out, "v {x:?} {y:?} {z:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_curves_repeat_their_first_index_and_indices_continue() {
        let [p, q, r] = [[0.0, 0.0, 0.0], [1.5, 0.0, 1e-300], [0.1, -1e300, 0.0]];
        let curves = Curves { polylines: vec![vec![p, q, r, p], vec![q, r]], points: vec![p], coplanar_pairs: 0 };
        let mut text = Vec::new();
        write_obj(&mut text, &curves).unwrap();
        let expected = "v 0.0 0.0 0.0\nv 1.5 0.0 1e-300\nv 0.1 -1e300 0.0\nl 1 2 3 1\n\
                        v 1.5 0.0 1e-300\nv 0.1 -1e300 0.0\nl 4 5\nv 0.0 0.0 0.0\np 6\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }
}

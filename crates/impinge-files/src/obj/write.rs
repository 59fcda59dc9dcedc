//! Writes Wavefront OBJ: an object for each part, with its own vertices.

use std::io::{self, Write};

/// A part that [`write_obj`] writes.
#[derive(Clone, Copy, Debug)]
pub struct ObjPart<'p> {
    /// Name of the object. White space and control characters are written as `_`.
    pub name: &'p str,
    /// Positions of the vertices.
    pub positions: &'p [[f64; 3]],
    /// Triangles, as indices into `positions`.
    pub faces: &'p [[u32; 3]],
}

/// Writes triangles as Wavefront OBJ: one object (`o`) for each part, with its vertices before its
/// faces. Coordinates have as many digits as they need to be read back exactly.
///
/// # Errors
/// Returns an error if writing to `out` fails.
///
/// ```
/// use impinge_files::{Format, ObjPart, parse, write_obj};
///
/// let positions = [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let part = |name| ObjPart { name, positions: &positions, faces: &[[0, 1, 2]] };
/// let mut file = Vec::new();
/// write_obj(&mut file, [part("left"), part("right")])?;
/// let model = parse(&file, Format::Obj).unwrap();
/// assert_eq!((model.parts, model.faces), (vec!["left".into(), "right".into()], vec![[0, 1, 2], [3, 4, 5]]));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_obj<'p>(out: impl Write, parts: impl IntoIterator<Item = ObjPart<'p>>) -> io::Result<()> {
    let mut out = io::BufWriter::with_capacity(1 << 16, out);
    let mut first = 1_u64; // Indices start at 1 and continue through the file.
    for ObjPart { name, positions, faces } in parts {
        let name = name.replace(|letter: char| letter.is_whitespace() || letter.is_control(), "_");
        writeln!(out, "o {name}")?;
        positions.iter().try_for_each(|[x, y, z]| writeln!(out, "v {x:?} {y:?} {z:?}"))?;
        for face in faces {
            let [a, b, c] = face.map(|corner| first + u64::from(corner));
            writeln!(out, "f {a} {b} {c}")?;
        }
        first += positions.len() as u64;
    }
    out.flush()
}

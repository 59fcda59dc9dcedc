//! Writes binary PLY.

use std::io::{self, Write};

use impinge::Positions;

/// Writes triangles as little-endian binary PLY. Vertices are `float` or `double`, like
/// `positions`. Faces are lists of `int` if that type can hold every index, else of `uint`.
///
/// # Errors
/// Returns an error if writing to `out` fails.
///
/// ```
/// let positions = impinge::Positions::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
/// let mut file = Vec::new();
/// impinge_files::write_ply(&mut file, &positions, &[[0, 1, 2]])?;
/// let model = impinge_files::parse(&file, impinge_files::Format::Ply).unwrap();
/// assert_eq!((model.positions, model.faces), (positions, vec![[0, 1, 2]]));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_ply(out: impl Write, positions: &Positions, faces: &[[u32; 3]]) -> io::Result<()> {
    let mut out = io::BufWriter::with_capacity(1 << 16, out);
    let float = match positions {
        Positions::F32(_) => "float",
        Positions::F64(_) => "double",
    };
    let int = if positions.len() <= i32::MAX as usize { "int" } else { "uint" };
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", positions.len())?;
    writeln!(out, "property {float} x\nproperty {float} y\nproperty {float} z")?;
    writeln!(out, "element face {}\nproperty list uchar {int} vertex_indices\nend_header", faces.len())?;
    match positions {
        Positions::F32(v) => v.as_flattened().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?,
        Positions::F64(v) => v.as_flattened().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?,
    }
    for face in faces {
        out.write_all(&[3])?;
        face.iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))?;
    }
    out.flush()
}

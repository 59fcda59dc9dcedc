//! The rows of PLY, ASCII and binary.

use impinge_files::{
    Format::Ply,
    WarningKind::{SurplusValues, UnknownLines, UnusedNonFinite},
};

use super::{row, triangles};
use crate::dialects::{Dialect, Expect::Refused};

/// Returns an ASCII file with this line in its header, these types of coordinates, lengths and
/// indices, and these rows.
fn ascii_ply(line: &str, [x, length, index]: [&str; 3], rows: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\n{line}\nelement vertex 4\nproperty {x} x\nproperty {x} y\nproperty {x} z\nelement face 1\n\
         property list {length} {index} vertex_indices\nend_header\n{rows}\n"
    )
}

const PLAIN: [&str; 3] = ["float", "uchar", "int"];
const ROWS: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2";

pub(super) fn rows() -> Vec<Dialect> {
    [ply_headers(), ply_bodies()].into_iter().flatten().collect()
}

fn ply_headers() -> Vec<Dialect> {
    let plain = ascii_ply("comment", PLAIN, ROWS);
    let binary = |encoding: &str, float: fn(f32) -> [u8; 4], int: fn(u32) -> [u8; 4]| {
        let mut bytes = plain[..plain.len() - ROWS.len() - 1].replace("ascii", encoding).into_bytes();
        bytes.extend([0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.].into_iter().flat_map(float));
        bytes.push(3);
        bytes.extend([0, 1, 2].into_iter().flat_map(int));
        bytes
    };
    vec![
        row(
            Ply,
            "ASCII, or binary in either byte order",
            "read",
            triangles(1, &[]),
            [
                plain.clone().into_bytes(),
                binary("binary_little_endian", f32::to_le_bytes, u32::to_le_bytes),
                binary("binary_big_endian", f32::to_be_bytes, u32::to_be_bytes),
            ],
        ),
        row(
            Ply,
            "lines that end in `\\n`, `\\r\\n` or `\\r`",
            "read",
            triangles(1, &[]),
            [plain.clone(), plain.replace('\n', "\r\n"), plain.replace('\n', "\r")],
        ),
        row(Ply, "version `1` in place of `1.0`", "read", triangles(1, &[]), [plain.replace("1.0", "1")]),
        row(
            Ply,
            "header lines without `comment`",
            "skipped, with a warning",
            triangles(1, &[UnknownLines]),
            [ascii_ply("Created by a program - http://x", PLAIN, ROWS)],
        ),
        row(
            Ply,
            "header lines that look like a misspelled `element` or `property`",
            "refused: names the line",
            Refused("syntax"),
            [ascii_ply("proprety float w", PLAIN, ROWS), ascii_ply("elemnt edge 0", PLAIN, ROWS)],
        ),
        row(
            Ply,
            "types `int8` to `float64`, or `char` to `double`",
            "read",
            triangles(1, &[]),
            [ascii_ply("", ["float64", "int8", "uint16"], ROWS), ascii_ply("", ["double", "char", "ushort"], ROWS)],
        ),
        row(
            Ply,
            "64-bit types (`int64`, `uint64`, `long`, `ulong`)",
            "read; coordinates beyond 2^53 are rounded to a double",
            triangles(1, &[]),
            [ascii_ply("", ["long", "ulong", "int64"], ROWS), ascii_ply("", ["int64", "uint64", "uint64"], ROWS)],
        ),
        row(
            Ply,
            "lists whose length is a `float` or `double`",
            "read",
            triangles(1, &[]),
            [ascii_ply("", ["float", "float", "int"], ROWS), ascii_ply("", ["float", "double", "int"], ROWS)],
        ),
    ]
}

fn ply_bodies() -> Vec<Dialect> {
    let body = |rows: &str| ascii_ply("", PLAIN, rows);
    let strips = body(ROWS).replace("element face", "element tristrips").replace("uchar", "int");
    let cloud = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                 element edge 1\nproperty int vertex1\nend_header\n0 0 0\n0\n";
    vec![
        row(Ply, "triangle strips (`tristrips`)", "read", triangles(2, &[]), [strips.replace("3 0 1 2", "4 0 1 2 3")]),
        row(Ply, "other elements and properties, or no faces", "read without them", triangles(0, &[]), [cloud]),
        row(
            Ply,
            "ASCII rows with more values than the header names",
            "read without them, with a warning",
            triangles(1, &[SurplusValues]),
            [body(&ROWS.replace("1 1 0", "1 1 0 255 255"))],
        ),
        row(
            Ply,
            "NaN or infinity in a vertex that no face uses",
            "read, with a warning: the vertex takes the position of the first finite vertex",
            triangles(1, &[UnusedNonFinite]),
            [body(&ROWS.replace("0 1 0", "nan nan nan")), body("1e39 0 0\n0 0 0\n0 1 0\n1 0 0\n3 3 1 2")],
        ),
        row(
            Ply,
            "NaN or infinity in a vertex that a face uses",
            "refused: names the line or byte of the vertex",
            Refused("non-finite"),
            [body(&ROWS.replace("1 1 0", "nan nan nan"))],
        ),
        row(
            Ply,
            "a face with a vertex that does not exist",
            "refused: names the line or byte",
            Refused("index-out-of-bounds"),
            [body(&ROWS.replace("3 0 1 2", "3 0 1 4")), body(&ROWS.replace("3 0 1 2", "3 0 1 -1"))],
        ),
        row(
            Ply,
            "counts for which the file is too short",
            "refused: names the line or byte",
            Refused("truncated"),
            [body(ROWS).replace("vertex 4", "vertex 4000000000")],
        ),
    ]
}

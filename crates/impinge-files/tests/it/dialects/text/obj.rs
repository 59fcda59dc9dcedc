//! The rows of OBJ.

use impinge_files::{
    Format::Obj,
    WarningKind::{NotTriangles, PaddingNuls, ShortFaces, StrayText, UnknownLines, UnusedNonFinite},
};

use super::{row, triangles, utf16};
use crate::dialects::{Dialect, Expect::Refused};

/// Returns an OBJ file of four vertices, then these lines.
fn square(faces: &str) -> String {
    format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{faces}\n")
}

pub(super) fn rows() -> Vec<Dialect> {
    [obj(), obj_warnings()].into_iter().flatten().collect()
}

fn obj() -> Vec<Dialect> {
    let marked = square("f 1 2 3").replacen('v', "\u{FEFF}v", 1);
    let corners = "f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//2 -1//1\nf 1/1/1 2/2/2 +3/3/3";
    let weights = "v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 nan\nf 1 2 3\n";
    let fortran = "v 1.0D+01 0 0\nv 0 1d0 0\nv 0 0 0\nf 1 2 3\n";
    vec![
        row(Obj, "corners as `1`, `1/2`, `1//3`, `1/2/3` or `-1`", "read", triangles(4, &[]), [square(corners)]),
        row(
            Obj,
            "faces with more than three corners, also concave",
            "read, triangulated",
            triangles(3, &[]),
            ["v 0 0 0\nv 4 0 0\nv 4 4 0\nv 3 1 0\nf 1 2 3 4\nf 1 2 3"],
        ),
        row(Obj, "faces before their vertices", "read", triangles(1, &[]), [format!("f 1 2 3\n{}", square(""))]),
        row(Obj, "weights or colors after the numbers of `v`", "ignored", triangles(1, &[]), [weights]),
        row(
            Obj,
            "comments after the numbers (`f 1 2 3 # c`)",
            "read",
            triangles(2, &[]),
            [square("f 1 2 3 # 4 \\\nf 1 3 4#c"), square("").replace("\n", " # c\n") + "f 1 2 3\nf 1 3 4"],
        ),
        row(
            Obj,
            "`\\` at the end of a line, to continue it",
            "read",
            triangles(1, &[]),
            [square("f 1 2 \\\n3"), square("f 1 \\ \r\n2 3\\"), square("f 1 2 3 \\\n")],
        ),
        row(
            Obj,
            "keywords in upper case (`V`, `F`)",
            "read",
            triangles(1, &[]),
            [square("F 1 2 3"), square("f 1 2 3").to_uppercase()],
        ),
        row(Obj, "Fortran exponents (`1.0D+01`)", "read", triangles(1, &[]), [fortran]),
        row(
            Obj,
            "UTF-8 or UTF-16 with a byte order mark",
            "read",
            triangles(1, &[]),
            [marked.clone().into_bytes(), utf16(&marked, u16::to_le_bytes), utf16(&marked, u16::to_be_bytes)],
        ),
    ]
}

fn obj_warnings() -> Vec<Dialect> {
    vec![
        row(
            Obj,
            "`\\` after a face that the next line does not continue",
            "read, with a warning",
            triangles(2, &[StrayText]),
            [square("f 1 2 3 \\\nf 1 3 4")],
        ),
        row(
            Obj,
            "NULs between lines or at the end",
            "ignored, with a warning",
            triangles(1, &[PaddingNuls]),
            [square("f 1 2 3\n\0\0\0"), square("\0\nf 1 2 3\0")],
        ),
        row(
            Obj,
            "NULs within a line: binary data, or UTF-16 without a mark",
            "refused: names the byte",
            Refused("wrong-content"),
            [square("f 1 \x002 3").into_bytes(), utf16(&square("f 1 2 3"), u16::to_le_bytes)],
        ),
        row(
            Obj,
            "NaN or infinity in a vertex that no face uses",
            "read, with a warning: the vertex takes the position of the first finite vertex",
            triangles(1, &[UnusedNonFinite]),
            [square("v nan nan nan\nf 2 3 4"), square("v 1e999 0 -inf\nv 1.#QNAN 0 0\nf 2 3 4")],
        ),
        row(
            Obj,
            "NaN or infinity in a vertex that a face uses",
            "refused: names the line of the vertex",
            Refused("non-finite"),
            [square("v nan nan nan\nf 2 3 5")],
        ),
        row(
            Obj,
            "a face with vertex 0, or a vertex that does not exist",
            "refused: names the line",
            Refused("index-out-of-bounds"),
            [square("f 0 1 2"), square("f 1 2 9"), square("f 1 2 -5")],
        ),
        row(
            Obj,
            "faces of one or two corners",
            "skipped, with a warning",
            triangles(1, &[ShortFaces]),
            [square("f 1 2\nf 1 2 3\nf 1")],
        ),
        row(
            Obj,
            "points, lines, curves or surfaces (`p`, `l`, `curv`, `surf`)",
            "skipped, with a warning",
            triangles(1, &[NotTriangles]),
            [square("p 1\nl 1 2\nf 1 2 3")],
        ),
        row(
            Obj,
            "lines that are no statement",
            "skipped, with a warning",
            triangles(1, &[UnknownLines]),
            [square("hello\nf 1 2 3"), square("V is a letter\nf 1 2 3")],
        ),
    ]
}

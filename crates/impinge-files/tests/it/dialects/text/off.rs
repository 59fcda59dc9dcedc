//! The rows of OFF, ASCII and binary.

use impinge_files::{
    Format::Off,
    WarningKind::{PaddingNuls, TrailingBytes, UnusedNonFinite},
};

use super::{row, triangles, utf16};
use crate::dialects::{Dialect, Expect::Refused};

pub(super) fn rows() -> Vec<Dialect> {
    let off = |header: &str| format!("{header}\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    let plain = off("OFF\n4 2 0");
    let mut binary = b"OFF BINARY\n".to_vec();
    binary.extend([3, 1, 0].into_iter().flat_map(i32::to_be_bytes));
    binary.extend([0., 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_be_bytes));
    binary.extend([3, 0, 1, 2, 1].into_iter().flat_map(i32::to_be_bytes));
    let cut = binary.clone();
    binary.extend(0.5_f32.to_be_bytes());
    vec![
        row(
            Off,
            "headers `OFF`, `COFF`, `NOFF`, `STOFF` and their combinations, or none",
            "read",
            triangles(2, &[]),
            [plain.clone(), off("STCNOFF\n4 2"), off("4 2 0")],
        ),
        row(
            Off,
            "counts on the line of the header, also glued to it (`OFF4 2 0`)",
            "read",
            triangles(2, &[]),
            [off("OFF 4 2 0"), off("OFF4 2 0"), off("COFF4 2 0")],
        ),
        row(Off, "a header in lower case", "read", triangles(2, &[]), [off("off\n4 2 0"), off("coff 4 2 0")]),
        row(
            Off,
            "comments and blank lines",
            "read",
            triangles(2, &[]),
            [format!("# c\n{}", plain.replace('\n', " # c\n\n"))],
        ),
        row(
            Off,
            "attributes after a vertex or face on its line",
            "ignored",
            triangles(2, &[]),
            [plain.replace("1 1 0", "1 1 0 255 0 0").replace("3 0 1 2", "3 0 1 2 0.5 0.5 nan")],
        ),
        row(
            Off,
            "vertices or faces that are broken over lines, or several vertices on a line",
            "read",
            triangles(2, &[]),
            [plain.replace("3 0 1 2", "3 0\n1\n2"), plain.replace("0\n1", "0 1"), plain.replace("1 1 0", "1\n1\n0")],
        ),
        row(Off, "`OFF BINARY`, as Geomview writes it (big-endian)", "read", triangles(1, &[]), [binary]),
        row(
            Off,
            "Fortran exponents, or UTF-16 with a byte order mark",
            "read",
            triangles(2, &[]),
            [plain.replace("1 1 0", "1.0D+00 1 0").into_bytes(), utf16(&format!("\u{FEFF}{plain}"), u16::to_be_bytes)],
        ),
        row(
            Off,
            "NULs between lines or at the end",
            "ignored, with a warning",
            triangles(2, &[PaddingNuls]),
            [plain.replace("0 1 0\n", "0 1 0\0\n"), plain.clone() + "\0"],
        ),
        row(
            Off,
            "lines after the last face",
            "ignored, with a warning",
            triangles(2, &[TrailingBytes]),
            [plain.clone() + "more\n"],
        ),
        row(
            Off,
            "NaN or infinity in a vertex that no face uses",
            "read, with a warning: the vertex takes the position of the first finite vertex",
            triangles(1, &[UnusedNonFinite]),
            [plain
                .replace("1 1 0", "nan 1 0")
                .replace("3 0 1 2", "3 0 1 3")
                .replace("3 0 2 3\n", "")
                .replace(" 2 0", " 1 0")],
        ),
        row(
            Off,
            "NaN or infinity in a vertex that a face uses",
            "refused: names the line or byte of the vertex",
            Refused("non-finite"),
            [plain.replace("1 1 0", "nan 1 0")],
        ),
        row(
            Off,
            "a face with a vertex that does not exist",
            "refused: names the line or byte",
            Refused("index-out-of-bounds"),
            [plain.replace("3 0 1 2", "3 0 1 4"), plain.replace("3 0 1 2", "3 0 1 -1")],
        ),
        row(
            Off,
            "fewer vertices or faces than the counts",
            "refused: names the line or byte",
            Refused("truncated"),
            [plain.replace("4 2 0", "4 3 0").into_bytes(), cut],
        ),
        row(
            Off,
            "vertices of other dimensions (`4OFF`, `nOFF`)",
            "refused: names the dialect",
            Refused("unsupported-feature"),
            [off("4OFF\n4 2 0"), off("nOFF\n3 4 2 0")],
        ),
    ]
}

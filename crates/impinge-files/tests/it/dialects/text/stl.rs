//! The rows of STL, ASCII and binary.

use impinge_files::{
    Format::Stl,
    WarningKind::{MissingKeywords, PaddingNuls, PolygonFacets, StrayText, TrailingBytes, UnsetCount},
};

use super::{row, triangles, utf16};
use crate::dialects::{Dialect, Expect::Refused};

const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

fn solid(facets: &str) -> String {
    format!("solid a\n{facets}endsolid a\n")
}

pub(super) fn rows() -> Vec<Dialect> {
    [ascii_stl(), binary_stl()].into_iter().flatten().collect()
}

fn ascii_stl() -> Vec<Dialect> {
    let facet = |from: &str, to: &str| solid(&FACET.replace(from, to));
    vec![
        row(
            Stl,
            "ASCII: several solids",
            "read, each as a part",
            triangles(2, &[]),
            [solid(FACET).repeat(2), solid(FACET).to_uppercase().replace('\n', "\r\n").repeat(2)],
        ),
        row(
            Stl,
            "ASCII: normals that are wrong, zero or NaN",
            "ignored",
            triangles(1, &[]),
            [facet("0 0 1", "0 0 0"), facet("0 0 1", "-nan(ind) nan x")],
        ),
        row(
            Stl,
            "ASCII: text after `endfacet`",
            "skipped, with a warning",
            triangles(2, &[StrayText]),
            [solid(&format!("{}{FACET}", FACET.replace("endfacet", "endfacet blah 1")))],
        ),
        row(
            Stl,
            "ASCII: comments from `#` to the end of the line",
            "skipped, with a warning",
            triangles(1, &[StrayText]),
            [solid(&format!("# c\n{FACET}")), facet("loop\n", "loop # c\n"), facet("endfacet", "endfacet # c")],
        ),
        row(
            Stl,
            "ASCII: no `normal`, or no `endsolid`",
            "read, with a warning",
            triangles(1, &[MissingKeywords]),
            [facet(" normal 0 0 1", ""), facet(" 0 0 1", ""), format!("solid\n{FACET}")],
        ),
        row(
            Stl,
            "ASCII: more than three corners in a loop",
            "triangulated, with a warning",
            triangles(2, &[PolygonFacets]),
            [facet("endloop", "vertex -1 0.1 0\nendloop")],
        ),
        row(
            Stl,
            "ASCII: Fortran exponents, or UTF-16 with a byte order mark",
            "read",
            triangles(1, &[]),
            [
                facet("vertex 1", "vertex 1.D0").into_bytes(),
                utf16(&format!("\u{FEFF}{}", solid(FACET)), u16::to_le_bytes),
            ],
        ),
        row(
            Stl,
            "ASCII: NULs at the end",
            "ignored, with a warning",
            triangles(1, &[PaddingNuls]),
            [solid(FACET) + "\0\0"],
        ),
        row(
            Stl,
            "ASCII: a facet that is cut off or has fewer than three corners",
            "refused: names the line",
            Refused("syntax"),
            [&solid(FACET)[..80], &facet("vertex 0 1 0\n", "")],
        ),
    ]
}

/// Returns a binary file with this header and count, two triangles, and this end.
fn binary(header: &[u8], count: u32, end: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for x in [1_f32, 2.0] {
        let corners = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, x, 0.0];
        bytes.extend(corners.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0x1F, 0x80]);
    }
    bytes.extend(end);
    bytes
}

fn binary_stl() -> Vec<Dialect> {
    let mut nan = binary(b"", 2, b"");
    nan[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    vec![
        row(
            Stl,
            "binary: a header that begins with `solid`",
            "read",
            triangles(2, &[]),
            [binary(b"solid a", 2, b""), binary(b"solid a\nfacet normal", 2, b"")],
        ),
        row(
            Stl,
            "binary: bytes after the last triangle",
            "ignored, with a warning",
            triangles(2, &[TrailingBytes]),
            [binary(b"", 2, b"tail")],
        ),
        row(
            Stl,
            "binary: count 0 or 4294967295, then whole triangles",
            "read to the end, with a warning",
            triangles(2, &[UnsetCount]),
            [binary(b"", 0, b""), binary(b"", u32::MAX, b"")],
        ),
        row(
            Stl,
            "binary: count 0 or 4294967295, the last triangle cut off",
            "read without the last, with two warnings",
            triangles(2, &[UnsetCount, TrailingBytes]),
            [binary(b"", 0, &[0; 49]), binary(b"", u32::MAX, &[0; 49])],
        ),
        row(
            Stl,
            "binary: another count that is too large",
            "refused: names the byte",
            Refused("truncated"),
            [binary(b"", 3, b""), binary(b"", 3, &[0; 49])],
        ),
        row(Stl, "binary: NaN or infinity in a corner", "refused: names the byte", Refused("non-finite"), [nan]),
    ]
}

//! Wavefront OBJ (*Advanced Visualizer* manual, appendix B1): `v`, `f`, `o` and `g`.
//!
//! - A vertex is the first three numbers of `v`; a weight or colors after them are ignored. A
//!   vertex that no face uses may be [NaN or infinite](crate::non_finite).
//! - A face corner is the first number of `a/b/c`. It counts from 1; a negative number counts
//!   backwards from the last vertex so far. A corner may refer to a vertex that comes later. Faces
//!   are triangulated by [`polygon`](crate::polygon).
//! - A part is the object (`o`) and group (`g`) of a face, named `object/group`; a new object ends
//!   the group.
//! - A `\` at the end of a line joins it to the next, except in a comment. `#` starts a comment,
//!   also after the numbers of a vertex or a face.
//! - Keywords may be in upper case.
//! - `p`, `l`, curves and surfaces are skipped and counted. So is any line that is not an OBJ
//!   statement.

mod statements;
mod write;

use std::collections::HashMap;

use foldhash::fast::RandomState;

pub use write::{ObjPart, write_obj};

use crate::{
    encoding::PlainText,
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::Limits,
    model::{Faces, Model, WarningKind, stored},
    non_finite::NonFinite,
    text::{integer, name, number, split_token, tokens},
};
use statements::Statements;

pub(crate) fn read(bytes: &[u8], limits: &Limits) -> Result<Model, LoadError> {
    let plain = PlainText::new(bytes, Format::Obj)?;
    let text = &*plain.text;
    let (positions, non_finite) = read_vertices(text)?;
    let mut faces = FaceReader { positions: &positions, faces: Faces::new(limits), ..FaceReader::default() };
    let mut statements = Statements::new(text);
    while let Some((line, statement)) = statements.next() {
        let (keyword, rest) = split_token(&statement);
        let place = Place::Line(line);
        faces.statement(keyword, rest, &place).map_err(|e| e.at(place))?;
    }
    let FaceReader { mut faces, parts, .. } = faces;
    non_finite.check_unused(&mut faces, Place::Line)?;
    let (stray, first) = statements.stray_backslashes();
    faces.warnings.add(WarningKind::StrayText, stray, || Some(Place::Line(first)));
    plain.warn(&mut faces.warnings);
    faces.into_model(stored(positions), parts, None, Format::Obj)
}

/// Reads all vertices in a separate pass, because a face may refer to a vertex that comes later.
fn read_vertices(text: &[u8]) -> Result<(Vec<[f64; 3]>, NonFinite), LoadError> {
    let mut positions = Vec::new();
    let mut non_finite = NonFinite::default();
    let mut statements = Statements::new(text);
    while let Some((line, statement)) = statements.next() {
        let position = match split_token(&statement) {
            (b"v", rest) => vertex(rest).map_err(|e| e.at(Place::Line(line)))?,
            (b"V", rest) => match vertex(rest) {
                Ok(position) => position,
                Err(_) => continue,
            },
            _ => continue,
        };
        if !position.iter().all(|x| x.is_finite()) {
            non_finite.add(positions.len(), line);
        }
        positions.push(position);
    }
    non_finite.replace(&mut positions);
    Ok((positions, non_finite))
}

/// Parses the three numbers of a vertex.
#[inline]
fn vertex(rest: &[u8]) -> Result<[f64; 3], LoadError> {
    let mut numbers = tokens(rest);
    let mut position = [0.0; 3];
    for x in &mut position {
        let token = numbers.next().unwrap_or_default();
        let parsed = number(token).or_else(|| number(without_comment(token)));
        *x = parsed.ok_or_else(|| LoadError::syntax("a coordinate", token))?;
    }
    Ok(position)
}

/// Returns the text before the first `#`.
fn without_comment(text: &[u8]) -> &[u8] {
    memchr::memchr(b'#', text).map_or(text, |at| &text[..at])
}

/// Parses the vertex index of a face corner, as written in the file.
fn corner_index(token: &[u8]) -> Option<i64> {
    integer(token.split(|&b| b == b'/').next().unwrap_or_default())
}

#[derive(Default)]
struct FaceReader<'a> {
    /// All vertices of the file.
    positions: &'a [[f64; 3]],
    /// Number of vertices before the current line.
    seen: u64,
    object: String,
    group: String,
    /// The part of the current object and group; `None` until it has a face.
    part: Option<u32>,
    part_by_name: HashMap<String, u32, RandomState>,
    parts: Vec<String>,
    corners: Vec<u32>,
    faces: Faces,
}

impl FaceReader<'_> {
    fn statement(&mut self, keyword: &[u8], rest: &[u8], place: &Place) -> Result<(), LoadError> {
        let unread = match keyword {
            b"v" => {
                self.seen += 1;
                return Ok(());
            }
            // The manual reads the obsolete `fo` as `f`.
            b"f" | b"fo" => return self.face(rest, place),
            b"o" => {
                self.object = name(rest);
                self.group.clear();
                self.part = None;
                return Ok(());
            }
            b"g" => {
                self.group = name(rest);
                self.part = None;
                return Ok(());
            }
            b"p" | b"l" | b"curv" | b"curv2" | b"surf" => WarningKind::NotTriangles,
            _ if keyword.starts_with(b"#") || SILENT.contains(&keyword) => return Ok(()),
            _ if keyword.iter().any(u8::is_ascii_uppercase) => return self.upper_case(keyword, rest, place),
            _ => WarningKind::UnknownLines,
        };
        self.faces.warnings.add(unread, 1, || Some(place.clone()));
        Ok(())
    }

    /// Processes a line whose keyword has upper-case letters. It is a vertex or a face only if its
    /// numbers are valid; otherwise it is a line of prose.
    fn upper_case(&mut self, keyword: &[u8], rest: &[u8], place: &Place) -> Result<(), LoadError> {
        let keyword = keyword.to_ascii_lowercase();
        let is_statement = match &*keyword {
            b"v" => vertex(rest).is_ok(),
            b"f" | b"fo" => tokens(without_comment(rest)).all(|token| corner_index(token).is_some()),
            _ => true,
        };
        if is_statement {
            return self.statement(&keyword, rest, place);
        }
        self.faces.warnings.add(WarningKind::UnknownLines, 1, || Some(place.clone()));
        Ok(())
    }

    fn face(&mut self, rest: &[u8], place: &Place) -> Result<(), LoadError> {
        self.corners.clear();
        for token in tokens(rest) {
            let (vertex, attributes) = token.split_at(token.iter().position(|&b| b == b'/').unwrap_or(token.len()));
            let Some(index) = integer(vertex) else {
                let before = without_comment(token);
                if !before.is_empty() {
                    let expected = "a face corner such as 1, 1/2 or 1/2/3";
                    let index = corner_index(before).ok_or_else(|| LoadError::syntax(expected, token))?;
                    self.corners.push(self.corner(index)?);
                }
                break;
            };
            self.corners.push(self.corner(index)?);
            if attributes.contains(&b'#') {
                break;
            }
        }
        let part = if self.corners.len() < 3 { 0 } else { self.part() };
        self.faces.polygon(&self.corners, |i| self.positions[i as usize], part, || place.clone())
    }

    fn corner(&self, index: i64) -> Result<u32, LoadError> {
        let vertex = match index {
            0 => None,
            1.. => Some(index.unsigned_abs() - 1),
            ..0 => self.seen.checked_sub(index.unsigned_abs()),
        };
        let (face, len) = (self.faces.polygons().into(), self.positions.len() as u64);
        vertex.filter(|&v| v < len).and_then(|v| u32::try_from(v).ok()).ok_or_else(|| {
            let error = LoadError::new(LoadErrorKind::IndexOutOfBounds { face, index, len });
            if index == 0 { error.with_hint("OBJ counts vertices from 1") } else { error }
        })
    }

    /// Returns the part of the current object and group, and adds it if it is new.
    fn part(&mut self) -> u32 {
        if let Some(part) = self.part {
            return part;
        }
        let name = match (self.object.as_str(), self.group.as_str()) {
            ("", group) => group.to_owned(),
            (object, "") => object.to_owned(),
            (object, group) => name(format!("{object}/{group}").as_bytes()),
        };
        let parts = &mut self.parts;
        let part = *self.part_by_name.entry(name).or_insert_with_key(|name| {
            parts.push(name.clone());
            parts.len() as u32 - 1
        });
        self.part = Some(part);
        part
    }
}

/// Keywords of statements that are skipped without a warning: attributes, materials and display
/// settings.
const SILENT: &[&[u8]] = &[
    b"",
    b"vt",
    b"vn",
    b"vp",
    b"s",
    b"mg",
    b"usemtl",
    b"mtllib",
    b"usemap",
    b"maplib",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"shadow_obj",
    b"trace_obj",
    b"cstype",
    b"deg",
    b"bmat",
    b"step",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
    b"ctech",
    b"stech",
];

#[cfg(test)]
mod tests {
    use impinge::Positions;

    use super::*;

    fn read(bytes: &[u8]) -> Result<Model, LoadError> {
        super::read(bytes, &Limits::default())
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn parse(text: impl AsRef<[u8]>) -> Model {
        read(text.as_ref()).unwrap()
    }

    fn error(text: impl AsRef<[u8]>) -> String {
        read(text.as_ref()).unwrap_err().to_string()
    }

    #[test]
    fn face_corners_are_read_in_every_notation() {
        let model = parse(format!("{SQUARE}f 1 2 3\nf 1/1 3/2 4/3\nf -4//1 -3//1 -2//1\nf 1/1/1 +3/1/1 -1/2/3\n"));
        assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 3]]);
        assert_eq!(model.sources, [0, 1, 2, 3]);
        assert_eq!((model.part_of, model.parts), (vec![0; 4], vec![String::new()]));
        assert_eq!(model.positions.len(), 4);
        assert_eq!(model.unit, None);
        assert!(model.warnings.is_empty());
    }

    #[test]
    fn polygons_and_parts_are_remembered() {
        let text = format!("{SQUARE}o a\nf 1 2 3 4\ng b\nf 1 2\nf 1 2 4\no c\ng never\no a\nf 1 2 3\n");
        let model = parse(text);
        assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [0, 1, 2]]);
        assert_eq!(model.sources, [0, 0, 2, 3]);
        assert_eq!(model.part_of, [0, 0, 1, 0]);
        assert_eq!(model.parts, ["a", "a/b"]);
        assert_eq!(model.warnings[0].kind, WarningKind::ShortFaces);
        assert_eq!(model.warnings[0].to_string(), "faces of fewer than three corners, skipped: 1, at line 8");
    }

    #[test]
    fn byte_order_marks_continued_lines_and_line_ends_are_read() {
        let text = b"\xEF\xBB\xBF  v 0 0 0 1 0.5 nan\r\n\tv 1e0 0. .0\r\nv 0 \\\r\n1 0\r\n# caf\xE9 C:\\\r\ng \xFF\xFE\r\nf 1 \\\r\n2 3\r\n";
        let model = parse(text);
        assert_eq!(model.positions, Positions::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        assert_eq!(model.faces, [[0, 1, 2]]);
        assert_eq!(model.parts, ["\u{FFFD}\u{FFFD}"]);
        // A face may come before its vertices, lines may end in \r alone, and the last line needs
        // no end.
        assert_eq!(parse("f 1 2 3\rv 0 0 0\rv 0 0 1\rv 0 1 0").faces, [[0, 1, 2]]);
    }

    #[test]
    fn unknown_lines_are_counted() {
        let model = parse("3 1\nv 0 0 0\nl 1 1\nfoo\nmtllib x.mtl\n\np 1\n");
        let text: Vec<_> = model.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            text,
            [
                "lines that are not statements of this format, skipped: 2, the first at line 1",
                "points, lines or curves, skipped: 2, the first at line 3"
            ]
        );
        assert!(model.faces.is_empty() && model.parts.is_empty());
    }

    #[test]
    fn errors_name_the_line() {
        let face = |f: &str| error(format!("{SQUARE}\n{f}\n"));
        assert_eq!(face("f 1 2 900"), "line 6: face 0 names vertex 900, but there are 4 vertices");
        assert_eq!(
            face("f 0 1 2"),
            "line 6: face 0 names vertex 0, but there are 4 vertices (OBJ counts vertices from 1)"
        );
        assert_eq!(face("f 1 2 -5"), "line 6: face 0 names vertex -5, but there are 4 vertices");
        let huge = face("f 1 2 99999999999999999999");
        assert_eq!(huge, "line 6: face 0 names vertex 9223372036854775807, but there are 4 vertices");
        assert_eq!(face("f 1 2 x"), "line 6: expected a face corner such as 1, 1/2 or 1/2/3, found \"x\"");
        assert_eq!(face("f 1 2 x#y"), "line 6: expected a face corner such as 1, 1/2 or 1/2/3, found \"x#y\"");
        assert_eq!(face("v 1 2"), "line 6: expected a coordinate, found nothing");
        assert_eq!(face("v 1 2 1,5"), "line 6: expected a coordinate, found \"1,5\"");
        let not_finite = "line 6: vertex 4 has a coordinate that is NaN, infinite or too large";
        for number in ["nan", "-inf", "1e999", "-nan(ind)"] {
            assert_eq!(face(&format!("v 1 2 {number}\nf 1 2 5")), not_finite);
        }
        assert_eq!(error(b"v 0 0 0\n1\x002"), "byte 9: not OBJ, but binary data or UTF-16");
        assert_eq!(face("F 1 2 9"), "line 6: face 0 names vertex 9, but there are 4 vertices");
    }

    fn kinds(model: &Model) -> Vec<(WarningKind, u64)> {
        model.warnings.iter().map(|w| (w.kind, w.count)).collect()
    }

    #[test]
    fn comments_may_follow_numbers() {
        let model = parse(
            "v 0 0 0# a\nv 1 0 0 #b\nv 1 1 0 # c\nf 1 2 3 # 1\nf 1//1 2//2 3//3# 1\nf 1 2 3#\nf 1 2 3/1#1 x\nf #1 2 3\n",
        );
        assert_eq!(model.faces, [[0, 1, 2]; 4]);
        assert_eq!(kinds(&model), [(WarningKind::ShortFaces, 1)]);
        let split = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\\nf 3 2 1 \\ \n# end\n");
        assert_eq!(split.faces, [[0, 1, 2], [2, 1, 0]]);
        assert_eq!(kinds(&split), [(WarningKind::StrayText, 1)]);
    }

    #[test]
    fn keywords_may_be_in_upper_case() {
        let model = parse("O a\nV 0 0 0\nv 1 0 0\nV 0 1 0\nG b\nF 1 2 3\nF -1 -2 -3\nL 1 2\nVN 0 0 1\nUSEMTL x\n");
        assert_eq!(model.faces, [[0, 1, 2], [2, 1, 0]]);
        assert_eq!(model.positions, Positions::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        assert_eq!(model.parts, ["a/b"]);
        assert_eq!(kinds(&model), [(WarningKind::NotTriangles, 1)]);
        // Lines of prose are not vertices, and do not count as vertices.
        let prose = parse("V is a letter\nV 1 2\nF is one too\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
        assert_eq!(prose.faces, [[0, 1, 2]]);
        assert_eq!(kinds(&prose), [(WarningKind::UnknownLines, 3)]);
    }

    #[test]
    fn unused_vertices_need_not_be_finite() {
        let model = parse("v nan nan nan\nv 5 6 7\nv 1 0 -inf\nv 8 8 8\nv 9 9 8\nv 1.#QNAN 0 0\nf 2 4 5\nf 1 2\n");
        let [a, b, c] = [[5.0, 6.0, 7.0], [8.0; 3], [9.0, 9.0, 8.0]];
        assert_eq!(model.positions, Positions::F32(vec![a, a, a, b, c, a]));
        assert_eq!(model.faces, [[1, 3, 4]]);
        assert_eq!(kinds(&model), [(WarningKind::ShortFaces, 1), (WarningKind::UnusedNonFinite, 3)]);
        assert_eq!(model.warnings[1].first, Some(Place::Line(1)));
    }

    #[test]
    fn fortran_numbers_utf16_and_padding_are_read() {
        let text = "v 0.1D+01 0 0\nv 2d0 0 0\nv 0 1 0\nf 1 2 3\n";
        let model = parse(text);
        assert_eq!(model.positions, Positions::F32(vec![[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        let units = "\u{FEFF}".encode_utf16().chain(text.encode_utf16());
        let wide = parse(units.flat_map(u16::to_be_bytes).collect::<Vec<_>>());
        assert_eq!((wide.positions, wide.faces), (model.positions, model.faces));
        let padded = parse(format!("{SQUARE}\0\nf 1 2 3\0\n\0\0"));
        assert_eq!((padded.faces.len(), kinds(&padded)), (1, vec![(WarningKind::PaddingNuls, 4)]));
    }
}

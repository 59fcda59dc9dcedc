//! OFF, the object file format of Geomview (its manual, §4.2.5), ASCII and binary.
//!
//! The header is `OFF` in any case, or missing. Before `OFF`, `ST`, `C` and `N` state that vertices
//! have texture coordinates, colors and normals. The counts of vertices, faces and edges may follow
//! on the same line, also without a space; the count of edges is ignored. A vertex that no face
//! uses may be [NaN or infinite](crate::non_finite). `#` starts a comment. Faces are triangulated
//! by [`polygon`](crate::polygon).

mod binary;
mod text;

use crate::{
    encoding::PlainText,
    error::{LoadError, Place},
    format::Format,
    limits::Limits,
    model::Model,
    text::{Lines, split_token, trim_start, without_bom},
};

/// Reports whether a text begins as an OFF file, possibly after comments.
pub(crate) fn opens(text: &[u8]) -> bool {
    let line = Content::new(text).next().unwrap_or_default();
    split_token(line).0.ends_with(b"OFF") && Header::new(line).is_some()
}

pub(crate) fn read(bytes: &[u8], limits: &Limits) -> Result<Model, LoadError> {
    let mut content = Content::new(without_bom(bytes));
    let line = content.next().unwrap_or_default();
    if let Some(header) = Header::new(line).filter(|header| header.is_binary() && !header.is_of_other_dimension()) {
        return binary::read(bytes, bytes.len() - content.lines.rest().len(), &header, limits);
    }
    text::read(&PlainText::new(bytes, Format::Off)?, limits)
}

/// Iterates over the lines that are not only comments, without their comments.
#[derive(Clone)]
struct Content<'a> {
    lines: Lines<'a>,
}

impl<'a> Content<'a> {
    fn new(text: &'a [u8]) -> Self {
        Self { lines: Lines::new(text) }
    }

    fn place(&self) -> Place {
        Place::Line(self.lines.number())
    }
}

impl<'a> Iterator for Content<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        self.lines.by_ref().find_map(|line| {
            let line = trim_start(line.split(|&b| b == b'#').next().unwrap_or_default());
            (!line.is_empty()).then_some(line)
        })
    }
}

/// A header such as `STCNOFF`.
struct Header<'a> {
    /// Letters before `OFF`.
    prefix: &'a [u8],
    /// Text after `OFF` on the line.
    rest: &'a [u8],
}

impl<'a> Header<'a> {
    /// Returns the header at the start of a line, or `None` if there is none.
    fn new(line: &'a [u8]) -> Option<Self> {
        let (token, _) = split_token(line);
        let at = token.windows(3).position(|word| word.eq_ignore_ascii_case(b"OFF"))?;
        let mut letters = &token[..at];
        // Only the case distinguishes normals (`N`) from a dimension (`n`).
        for flag in [&b"ST"[..], b"st", b"C", b"c", b"N", b"4", b"n"] {
            letters = letters.strip_prefix(flag).unwrap_or(letters);
        }
        let glued = &token[at + 3..];
        let is_header = letters.is_empty() && glued.first().is_none_or(u8::is_ascii_digit);
        is_header.then_some(Self { prefix: &token[..at], rest: &line[at + 3..] })
    }

    fn has(&self, letter: u8) -> bool {
        self.prefix.contains(&letter)
    }

    /// Reports whether vertices have four coordinates, or a number of coordinates that the file
    /// states.
    fn is_of_other_dimension(&self) -> bool {
        self.has(b'4') || self.has(b'n')
    }

    fn is_binary(&self) -> bool {
        split_token(self.rest).0.eq_ignore_ascii_case(b"BINARY")
    }

    /// Returns the number of values after the position of a vertex: three for a normal, four for a
    /// color, and two for texture coordinates.
    fn extra_values(&self) -> usize {
        let values =
            |letters: [u8; 2], count| if letters.into_iter().any(|letter| self.has(letter)) { count } else { 0 };
        values(*b"NN", 3) + values(*b"Cc", 4) + values(*b"Ts", 2)
    }
}

#[cfg(test)]
mod tests {
    use impinge::Positions;

    use super::*;
    use crate::model::WarningKind;

    fn read(bytes: &[u8]) -> Result<Model, LoadError> {
        super::read(bytes, &Limits::default())
    }

    fn error(text: &str) -> String {
        read(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn headers_comments_and_attributes_are_read() {
        for head in ["OFF\n4 2 0", "OFF 4 2 0", "# c\n\nCOFF # c\n# c\n4 2 0 # c", "STCNOFF\r\n4 2", "4 2 5"] {
            let text = format!(
                "{head}\n0 0 0 9 9 9\n1 0 0 255 0 0 # vertex\n\n1 1 0\n0 1 0.1\n4 0 1 2 3 0.5 0.5 nan\n3 0 1 3 # end\n"
            );
            let model = read(text.as_bytes()).unwrap();
            let expected = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]];
            assert_eq!(model.positions, Positions::F64(expected));
            assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
            assert_eq!(model.sources, [0, 0, 1]);
            assert_eq!((model.part_of, model.parts.len()), (vec![0; 3], 1));
            assert!(model.warnings.is_empty(), "{:?}", model.warnings);
            assert_eq!(opens(text.as_bytes()), head != "4 2 5");
        }
    }

    #[test]
    fn unusual_but_valid_files_are_read() {
        assert!(read(b"OFF 0 0 0").unwrap().positions.is_empty());
        let model = read(b"OFF 3 3 0\n0 0 0\n0 0 1\n0 1 0\n2 0 1\n0\n3 0 1 2\n# end\nmore\n").unwrap();
        assert_eq!((model.faces.len(), &model.sources[..]), (1, &[2][..]));
        let kinds: Vec<_> = model.warnings.iter().map(|w| (w.kind, w.count)).collect();
        assert_eq!(kinds, [(WarningKind::ShortFaces, 2), (WarningKind::TrailingBytes, 11)]);
    }

    #[test]
    fn errors_name_the_line() {
        let hint = "(the file is cut off or its counts are wrong)";
        assert_eq!(
            error("OFF\n2 1\n0 0 0\n"),
            format!("line 3: 2 vertices promised, but there is room for 1 at most {hint}")
        );
        let head = "OFF\n1 1 0\n0 0 0\n";
        assert_eq!(error(head), format!("line 3: 1 faces promised, but there is room for 0 at most {hint}"));
        assert_eq!(error(&format!("{head}3 0 0 1")), "line 4: face 0 names vertex 1, but there are 1 vertices");
        assert_eq!(error(&format!("{head}3 0 0 -1")), "line 4: face 0 names vertex -1, but there are 1 vertices");
        let short = format!("line 4: 9999999999 corners of a face promised, but there is room for 1 at most {hint}");
        assert_eq!(error(&format!("{head}9999999999 0")), short);
        assert_eq!(error(&format!("{head}x")), "line 4: expected the number of corners, found \"x\"");
        let nan = "line 2: vertex 0 has a coordinate that is NaN, infinite or too large";
        assert_eq!(error("OFF 1 1 0\n0 nan 0\n3 0 0 0"), nan);
        assert_eq!(error("OFF -1 0 0"), "line 1: expected the number of vertices, found \"-1\"");
        assert_eq!(error("OFF 5000000000 0 0"), "line 1: 5000000000 vertices exceed the limit of 4294967295");
        assert!(error("OFF BINARY\n").starts_with("byte 11: 4 bytes promised, but there is room for 0"));
        assert_eq!(error("4off BINARY"), "line 1: needs the OFF dialect 4off BINARY, which is not supported");
        assert_eq!(error("noff\n2"), "line 1: needs the OFF dialect noff, which is not supported");
        assert_eq!(error("4OFF\n1 0 0\n0 0 0 1"), "line 1: needs the OFF dialect 4OFF, which is not supported");
        assert_eq!(error("hello"), "line 1: expected the number of vertices, found \"hello\"");
    }

    const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3\n";

    #[test]
    fn headers_in_any_case_and_without_a_space() {
        for head in ["OFF4 2 0", "off\n4 2 0", "Off 4 2 0", "coff4 2 0\n#c", "stCNOFF4 2"] {
            let model = read(format!("{head}\n{SQUARE}").as_bytes()).unwrap();
            assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3]], "{head}");
            assert!(model.warnings.is_empty());
        }
        // Only a header in upper case proves the format of a file with another extension.
        assert!(opens(b"# c\nOFF") && opens(b"COFF 4 2 0") && !opens(b"off\n4 2 0") && !opens(b"OFF4 2 0"));
        for text in ["OFFSET 4 2 0\n", "XOFF 4 2 0\n", "OF 4 2 0\n"] {
            assert!(error(&format!("{text}{SQUARE}")).starts_with("line 1: expected the number of vertices"), "{text}");
        }
    }

    #[test]
    fn lines_may_be_broken_anywhere() {
        let expected = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        for text in [
            "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0\n1\n2\n3 0 2\n3\n".to_owned(),
            format!("OFF\n4 2 0\n{}", SQUARE.replace(" 1 0\n", "\n1 #c\n\n0\n")),
            format!("OFF\n4 2 0\n{}", SQUARE.replace("0\n1", "0 1")),
            "NOFF 4 2\n0 0 0 0 0 1 1 0 0 0 0\n1 1 1 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 9 9\n3\n0 2 3".to_owned(),
        ] {
            let model = read(text.as_bytes()).unwrap();
            assert_eq!(model.positions, Positions::F32(expected.clone()), "{text}");
            assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3]], "{text}");
            assert!(model.warnings.is_empty());
        }
        // Attributes that the header does not state: read by tokens, they would be vertices.
        let text = "OFF 2 1\n0 0 0 9 9 9\n1 0 0 9 9 9\n3 0 1 2\n";
        assert_eq!(error(text), "line 4: face 0 names vertex 2, but there are 2 vertices");
    }

    #[test]
    fn unused_vertices_need_not_be_finite() {
        let model = read(b"OFF 4 1\nnan 0 0\n1 0 0\n0 1 0\n0 0 1\n3 1 2 3\n\0").unwrap();
        assert_eq!(model.positions.get(0), [1.0, 0.0, 0.0]);
        let warnings: Vec<_> = model.warnings.iter().map(|w| (w.kind, w.count, w.first.clone())).collect();
        let unused = (WarningKind::UnusedNonFinite, 1, Some(Place::Line(2)));
        assert_eq!(warnings, [unused, (WarningKind::PaddingNuls, 1, Some(Place::Line(7)))]);
    }
}

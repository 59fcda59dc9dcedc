//! Reads ASCII STL token by token, because some writers break lines differently.

use crate::{
    encoding::PlainText,
    error::{LoadError, Place},
    format::Format,
    limits::Limits,
    model::{Faces, Model, WarningKind, stored, too_many},
    text::{line_at, name, number, split_token},
    weld::Weld,
};

use super::non_finite;

pub(super) fn read(plain: &PlainText<'_>, limits: &Limits) -> Result<Model, LoadError> {
    let text = &*plain.text;
    let mut reader = Reader { text, faces: Faces::new(limits), ..Reader::default() };
    reader.read().map_err(|e| e.at(Place::Line(line_at(text, reader.token_at))))?;
    let Reader { mut faces, weld, parts, .. } = reader;
    plain.warn(&mut faces.warnings);
    faces.into_model(stored(weld.into_positions()), parts, None, Format::Stl)
}

struct Reader<'a> {
    text: &'a [u8],
    /// Byte offset of the search for the next token.
    at: usize,
    /// Byte offset of the last token.
    token_at: usize,
    /// Number of corners so far in the file.
    corners: usize,
    /// Vertices of the current facet.
    facet: Vec<u32>,
    faces: Faces,
    weld: Weld<f64>,
    parts: Vec<String>,
}

impl Default for Reader<'_> {
    fn default() -> Self {
        let (faces, weld) = (Faces::default(), Weld::with_capacity(0));
        Self { text: &[], at: 0, token_at: 0, corners: 0, facet: Vec::new(), faces, weld, parts: Vec::new() }
    }
}

impl<'a> Reader<'a> {
    fn read(&mut self) -> Result<(), LoadError> {
        self.expect("solid")?;
        while self.read_solid()? {}
        Ok(())
    }

    /// Reads a solid after its keyword, up to and including the keyword of the next solid. Returns
    /// whether there is a next solid.
    fn read_solid(&mut self) -> Result<bool, LoadError> {
        let name = name(self.rest_of_line());
        let first = self.faces.faces.len();
        let part = self.parts.len() as u32;
        let mut facets = 0_u64;
        let next = loop {
            let token = self.token();
            if token.eq_ignore_ascii_case(b"facet") {
                self.read_facet(part)?;
                self.skip_stray_text();
                facets += 1;
            } else if token.eq_ignore_ascii_case(b"endsolid") {
                self.rest_of_line();
                break self.next_solid()?;
            } else if facets > 0 && (token.is_empty() || token.eq_ignore_ascii_case(b"solid")) {
                self.warn(WarningKind::MissingKeywords);
                break !token.is_empty();
            } else {
                return Err(self.unexpected("facet or endsolid", token));
            }
        };
        if self.faces.faces.len() > first {
            self.parts.push(name);
        }
        Ok(next)
    }

    /// Reads the keyword of the next solid. Returns whether there is one.
    fn next_solid(&mut self) -> Result<bool, LoadError> {
        let token = self.token();
        if token.is_empty() || token.eq_ignore_ascii_case(b"solid") {
            return Ok(!token.is_empty());
        }
        Err(self.unexpected("solid", token))
    }

    fn read_facet(&mut self, part: u32) -> Result<(), LoadError> {
        let start = self.token_at;
        self.read_normal()?;
        self.expect("loop")?;
        self.facet.clear();
        loop {
            let token = self.token();
            if self.facet.len() >= 3 && token.eq_ignore_ascii_case(b"endloop") {
                break;
            }
            if !token.eq_ignore_ascii_case(b"vertex") {
                let expected = if self.facet.len() < 3 { "vertex" } else { "vertex or endloop" };
                return Err(self.unexpected(expected, token));
            }
            let vertex = self.read_vertex()?;
            self.facet.push(vertex);
        }
        self.expect("endfacet")?;
        let (text, weld) = (self.text, &self.weld);
        let place = || Place::Line(line_at(text, start));
        if self.facet.len() > 3 {
            self.faces.warnings.add(WarningKind::PolygonFacets, 1, || Some(place()));
        }
        self.faces.polygon(&self.facet, |i| weld.position(i), part, place)
    }

    /// Reads up to and including `outer`. The three numbers of the normal are ignored, and may be
    /// missing.
    fn read_normal(&mut self) -> Result<(), LoadError> {
        let mut token = self.token();
        if token.eq_ignore_ascii_case(b"normal") {
            for _ in 0..3 {
                token = self.token();
                if token.eq_ignore_ascii_case(b"outer") {
                    break;
                }
            }
            if !token.eq_ignore_ascii_case(b"outer") {
                return self.expect("outer");
            }
        }
        if !token.eq_ignore_ascii_case(b"outer") {
            return Err(self.unexpected("normal or outer", token));
        }
        self.warn(WarningKind::MissingKeywords);
        Ok(())
    }

    fn read_vertex(&mut self) -> Result<u32, LoadError> {
        let mut position = [0.0; 3];
        for x in &mut position {
            let token = self.token();
            *x = number(token).ok_or_else(|| self.unexpected("a coordinate", token))?;
        }
        let corner = self.corners;
        self.corners += 1;
        if !position.iter().all(|x| x.is_finite()) {
            return Err(non_finite(corner));
        }
        self.weld.vertex(position).ok_or_else(|| too_many("vertices", corner as u64))
    }

    /// Skips text after `endfacet` on its line, up to the next facet or the end of the solid.
    fn skip_stray_text(&mut self) {
        self.token_at = self.at;
        let mut is_stray = false;
        loop {
            let rest = &self.text[self.at..];
            let (token, after) = split_token(rest);
            let space = &rest[..rest.len() - token.len() - after.len()];
            let ends = token.is_empty() || token[0] == b'#' || space.iter().any(|b| matches!(b, b'\n' | b'\r'));
            if ends || KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(token)) {
                break;
            }
            self.at = self.text.len() - after.len();
            is_stray = true;
        }
        if is_stray {
            self.warn(WarningKind::StrayText);
        }
    }

    /// Returns the next token that is not a comment; empty at the end of the file.
    #[inline]
    fn token(&mut self) -> &'a [u8] {
        loop {
            let (token, rest) = split_token(&self.text[self.at..]);
            self.at = self.text.len() - rest.len();
            self.token_at = self.at - token.len();
            if token.first() != Some(&b'#') {
                return token;
            }
            self.warn(WarningKind::StrayText);
            self.rest_of_line();
        }
    }

    fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.text[self.at..];
        let len = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        self.at += len;
        &rest[..len]
    }

    fn expect(&mut self, keyword: &'static str) -> Result<(), LoadError> {
        let token = self.token();
        if token.eq_ignore_ascii_case(keyword.as_bytes()) { Ok(()) } else { Err(self.unexpected(keyword, token)) }
    }

    /// Adds a warning about the last token.
    #[cold]
    fn warn(&mut self, kind: WarningKind) {
        let (text, at) = (self.text, self.token_at);
        self.faces.warnings.add(kind, 1, || Some(Place::Line(line_at(text, at))));
    }

    fn unexpected(&self, expected: &'static str, token: &[u8]) -> LoadError {
        let error = LoadError::syntax(expected, token);
        if token.is_empty() { error.with_hint("the file is cut off") } else { error }
    }
}

/// Keywords that may follow `endfacet` on its line.
const KEYWORDS: [&[u8]; 3] = [b"facet", b"endsolid", b"solid"];

#[cfg(test)]
mod tests {
    use impinge::Positions;

    use super::*;

    fn read(bytes: &[u8]) -> Result<Model, LoadError> {
        crate::stl::read(bytes, &Limits::default())
    }

    fn error(bytes: impl AsRef<[u8]>) -> String {
        read(bytes.as_ref()).unwrap_err().to_string()
    }

    fn warnings(model: &Model) -> Vec<(WarningKind, u64, Option<Place>)> {
        model.warnings.iter().map(|w| (w.kind, w.count, w.first.clone())).collect()
    }

    const FACET: &str =
        "facet normal nan 0 -nan(ind)\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\nendloop endfacet\n";

    #[test]
    fn every_solid_is_a_part() {
        let text = format!(
            "solid a b\r\n{FACET}{}endsolid a b\n\nsolid\nendsolid\nSOLID c\n{FACET}endsolid",
            FACET.to_uppercase()
        );
        let model = read(text.as_bytes()).unwrap();
        assert_eq!(model.faces, [[0, 1, 2]; 3]);
        assert_eq!(model.part_of, [0, 0, 1]);
        assert_eq!(model.parts, ["a b", "c"]);
        assert!(model.warnings.is_empty());
        assert!(read(b"solid nothing\nendsolid nothing").unwrap().faces.is_empty());
        let fine = read(text.replace(" 1 0 0", " 0.1 0 0").as_bytes()).unwrap();
        assert_eq!(fine.positions, Positions::F64(vec![[0.0; 3], [0.1, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    }

    #[test]
    fn errors_name_the_line() {
        let vertex = |v: &str| error(format!("solid x\nfacet normal 0 0 1\nouter loop\n{v}"));
        assert_eq!(vertex("vertex 0 0 x"), "line 4: expected a coordinate, found \"x\"");
        let nan = "has a coordinate that is NaN, infinite or too large";
        assert_eq!(vertex("vertex 0 0 inf"), format!("line 4: vertex 0 {nan}"));
        assert_eq!(vertex("vertex 0 0 0\nvertex 0 0 nan"), format!("line 5: vertex 1 {nan}"));
        assert_eq!(vertex("vertex 0 0 0\nendloop"), "line 5: expected vertex, found \"endloop\"");
        let three = "vertex 0 0 0\n".repeat(3);
        assert_eq!(vertex(&format!("{three}end")), "line 7: expected vertex or endloop, found \"end\"");
        assert_eq!(error("solid x\n"), "line 2: expected facet or endsolid, found nothing (the file is cut off)");
        assert_eq!(error("solid x\nfacet\nloop"), "line 3: expected normal or outer, found \"loop\"");
        assert_eq!(error("solid x\nhello\nfacet"), "line 2: expected facet or endsolid, found \"hello\"");
        assert_eq!(error("solid x\nendsolid\nfacet"), "line 3: expected solid, found \"facet\"");
        assert_eq!(error("v 1 2 3"), "line 1: expected solid, found \"v\"");
    }

    #[test]
    fn stray_text_and_comments_are_skipped() {
        let facet = FACET.replace("endfacet", "endfacet blah 1 # c") + &FACET.replace('\n', " ");
        let text =
            format!("solid a\n# c\n{facet}blah {facet}{}\nendsolid # c\n#end", FACET.replace("loop\n", "loop # c\n"));
        let model = read(text.as_bytes()).unwrap();
        assert_eq!(model.faces, [[0, 1, 2]; 5]);
        assert_eq!(model.parts, ["a"]);
        // Text three times, and five comments; the comment after `endsolid` may be a name.
        assert_eq!(warnings(&model), [(WarningKind::StrayText, 8, Some(Place::Line(2)))]);
    }

    #[test]
    fn a_file_of_one_line_takes_linear_time() {
        let line = format!("solid a\n{}", FACET.replace('\n', " ").repeat(100_000));
        let start = std::time::Instant::now();
        assert_eq!(read(line.as_bytes()).unwrap().faces.len(), 100_000);
        assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
    }

    #[test]
    fn missing_keywords_change_nothing() {
        let bare = FACET.replace(" normal nan 0 -nan(ind)", "");
        let short = FACET.replace("nan 0 -nan(ind)", "1");
        let text = format!("solid a\n{FACET}solid b\n{bare}{short}");
        let model = read(text.as_bytes()).unwrap();
        assert_eq!((model.faces.len(), &model.part_of[..]), (3, &[0, 1, 1][..]));
        assert_eq!(model.parts, ["a", "b"]);
        assert_eq!(warnings(&model), [(WarningKind::MissingKeywords, 4, Some(Place::Line(8)))]);
    }

    #[test]
    fn facets_with_more_than_three_corners_are_polygons() {
        // Concave at the fourth corner: a fan about the first corner would cover points outside.
        let corners = ["0 0 0", "4 0 0", "4 4 0", "3 1 0"].map(|v| format!("vertex {v}\n")).concat();
        let text = format!("solid\nfacet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n{FACET}endsolid\n");
        let model = read(text.as_bytes()).unwrap();
        assert_eq!(model.faces.len(), 3);
        assert_eq!(model.sources, [0, 0, 1]);
        assert!(!model.faces.contains(&[0, 1, 2]));
        assert_eq!(warnings(&model), [(WarningKind::PolygonFacets, 1, Some(Place::Line(2)))]);
    }

    #[test]
    fn utf16_comments_and_padding_are_read() {
        let text = format!("solid a\n{FACET}endsolid\n");
        let wide: Vec<u8> = "\u{FEFF}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        assert_eq!(read(&wide).unwrap().faces, [[0, 1, 2]]);
        let commented = text.replace("facet normal", "# c\n\n#d\nfacet normal") + "\0";
        assert_eq!(read(commented.as_bytes()).unwrap().faces, [[0, 1, 2]]);
        let padded = read(format!("{text}\0\0").as_bytes()).unwrap();
        assert_eq!(warnings(&padded), [(WarningKind::PaddingNuls, 2, Some(Place::Line(9)))]);
    }
}

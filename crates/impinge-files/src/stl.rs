//! STL (3D Systems, *StereoLithography Interface Specification*, 1988), binary and ASCII.
//!
//! A file is binary where its length is exactly 84 + 50 n for the count n that it states, ASCII where it opens with
//! `solid` and a facet or the end follows, and else binary with something missing or added: many binary files open with
//! `solid`. Normals, attributes and colours are not looked at. Corners with equal positions become one vertex
//! ([`weld`](crate::weld)). Each `solid` of an ASCII file is a part.

use impinge::Positions;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    model::{Faces, Model, WarningKind, stored, too_many},
    text::{binary_data, line_at, name, number, split_token, trim_start, without_bom},
    weld::Weld,
};

const HEADER: usize = 84;
const FACET: usize = 50;

/// Whether the length is that of a binary file.
pub(crate) fn has_binary_length(bytes: &[u8]) -> bool {
    stated_count(bytes).is_some_and(|count| bytes.len() as u64 == HEADER as u64 + FACET as u64 * u64::from(count))
}

/// Whether an ASCII file opens like this: `solid`, a name, then a facet or the end.
pub(crate) fn opens_as_text(bytes: &[u8]) -> bool {
    let text = trim_start(without_bom(bytes));
    if !text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return false;
    }
    let name_end = memchr::memchr2(b'\n', b'\r', text).unwrap_or(text.len());
    let (word, _) = split_token(&text[name_end..]);
    [&b"facet"[..], b"endsolid"].iter().any(|w| word.eq_ignore_ascii_case(w))
}

pub(crate) fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    if has_binary_length(bytes) {
        return read_binary(bytes);
    }
    if opens_as_text(bytes) {
        return read_text(bytes);
    }
    if memchr::memchr(0, bytes).is_some() {
        return read_binary(bytes);
    }
    // Text, but not the text of an STL file; the ASCII reader says where it goes wrong.
    read_text(bytes)
}

fn stated_count(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

fn read_binary(bytes: &[u8]) -> Result<Model, LoadError> {
    let Some(count) = stated_count(bytes) else {
        return Err(LoadError::truncated("bytes of header", HEADER as u64, bytes.len() as u64));
    };
    let body = &bytes[HEADER..];
    let room = (body.len() / FACET) as u64;
    if u64::from(count) > room {
        return Err(LoadError::truncated("triangles", count.into(), room).at(Place::Byte(HEADER as u64 - 4)));
    }
    let count = count as usize;
    let (facets, trailing) = body.split_at(count * FACET);
    let mut faces = Faces::default();
    faces.reserve(count);
    let mut weld = Weld::<f32>::with_capacity(count / 2);
    for (i, facet) in facets.as_chunks::<FACET>().0.iter().enumerate() {
        let (numbers, _) = facet[12..48].as_chunks::<4>();
        let numbers: [f32; 9] = std::array::from_fn(|k| f32::from_le_bytes(numbers[k]));
        if let Some(k) = numbers.iter().position(|x| !x.is_finite()) {
            return Err(non_finite(3 * i + k / 3).at(Place::Byte((HEADER + i * FACET + 12 + 4 * k) as u64)));
        }
        let [a, b, c] = [0, 3, 6].map(|k| weld.vertex([numbers[k], numbers[k + 1], numbers[k + 2]]));
        let face = a.zip(b).zip(c).ok_or_else(|| too_many("vertices", 3 * count as u64))?;
        faces.triangle([face.0.0, face.0.1, face.1], 0)?;
    }
    faces.warnings.add(WarningKind::TrailingBytes, trailing.len() as u64, || {
        Some(Place::Byte((bytes.len() - trailing.len()) as u64))
    });
    let parts = if count == 0 { Vec::new() } else { vec![String::new()] };
    faces.into_model(Positions::F32(weld.into_positions()), parts, None, Format::Stl)
}

fn non_finite(corner: usize) -> LoadError {
    LoadError::new(LoadErrorKind::NonFinite { vertex: corner as u64 })
}

fn read_text(bytes: &[u8]) -> Result<Model, LoadError> {
    if let Some(error) = binary_data(bytes, Format::Stl) {
        return Err(error);
    }
    let mut reader = TextReader { text: without_bom(bytes), ..TextReader::default() };
    let at = bytes.len() - reader.text.len();
    reader.read().map_err(|e| e.at(Place::Line(line_at(bytes, at + reader.token_at))))?;
    let TextReader { faces, weld, parts, .. } = reader;
    faces.into_model(stored(weld.into_positions()), parts, None, Format::Stl)
}

/// The ASCII grammar, token by token, since not every writer keeps its lines.
struct TextReader<'a> {
    text: &'a [u8],
    /// Where the next token is looked for, and where the last one began.
    at: usize,
    token_at: usize,
    faces: Faces,
    weld: Weld<f64>,
    parts: Vec<String>,
}

impl Default for TextReader<'_> {
    fn default() -> Self {
        let (faces, weld) = (Faces::default(), Weld::with_capacity(0));
        Self { text: &[], at: 0, token_at: 0, faces, weld, parts: Vec::new() }
    }
}

impl<'a> TextReader<'a> {
    fn read(&mut self) -> Result<(), LoadError> {
        loop {
            self.expect("solid")?;
            let solid = name(self.rest_of_line());
            self.read_solid(solid)?;
            self.rest_of_line();
            if trim_start(&self.text[self.at..]).is_empty() {
                return Ok(());
            }
        }
    }

    /// Facets up to and with `endsolid`.
    fn read_solid(&mut self, name: String) -> Result<(), LoadError> {
        let first = self.faces.faces.len();
        let part = self.parts.len() as u32;
        loop {
            let token = self.token();
            if token.eq_ignore_ascii_case(b"endsolid") {
                break;
            }
            if !token.eq_ignore_ascii_case(b"facet") {
                return Err(self.unexpected("facet or endsolid", token));
            }
            self.read_facet(part)?;
        }
        if self.faces.faces.len() > first {
            self.parts.push(name);
        }
        Ok(())
    }

    fn read_facet(&mut self, part: u32) -> Result<(), LoadError> {
        self.expect("normal")?;
        for _ in 0..3 {
            self.token();
        }
        self.expect("outer")?;
        self.expect("loop")?;
        let mut face = [0; 3];
        for vertex in &mut face {
            self.expect("vertex")?;
            *vertex = self.read_vertex()?;
        }
        self.expect("endloop")?;
        self.expect("endfacet")?;
        self.faces.triangle(face, part)
    }

    fn read_vertex(&mut self) -> Result<u32, LoadError> {
        let mut position = [0.0; 3];
        for x in &mut position {
            let token = self.token();
            *x = number(token).ok_or_else(|| self.unexpected("a coordinate", token))?;
        }
        let corner = 3 * self.faces.faces.len();
        if !position.iter().all(|x| x.is_finite()) {
            return Err(non_finite(corner));
        }
        self.weld.vertex(position).ok_or_else(|| too_many("vertices", corner as u64))
    }

    /// The next token; empty at the end of the file.
    fn token(&mut self) -> &'a [u8] {
        let (token, rest) = split_token(&self.text[self.at..]);
        self.at = self.text.len() - rest.len();
        self.token_at = self.at - token.len();
        token
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

    fn unexpected(&self, expected: &'static str, token: &[u8]) -> LoadError {
        let error = LoadError::syntax(expected, token);
        if token.is_empty() { error.with_hint("the file is cut off") } else { error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binary(header: &[u8], facets: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, 0);
        bytes.extend((facets.len() as u32).to_le_bytes());
        for facet in facets {
            bytes.extend([f32::NAN; 3].iter().chain(facet.as_flattened()).flat_map(|x| x.to_le_bytes()));
            bytes.extend([0xFF, 0xFF]);
        }
        bytes
    }

    const FACETS: [[[f32; 3]; 3]; 2] =
        [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.0, 1.0, 0.0], [1.0, -0.0, 0.0], [1.0, 1.0, 0.1]]];

    #[test]
    fn binary_files_are_welded() {
        for header in [&b"solid facet"[..], b"", b"solid\nfacet normal"] {
            let model = read(&binary(header, &FACETS)).unwrap();
            let expected = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.1]];
            assert_eq!(model.positions, Positions::F32(expected));
            assert_eq!(model.faces, [[0, 1, 2], [2, 1, 3]]);
            assert_eq!((&model.sources[..], &model.part_of[..], model.parts.len()), (&[0, 1][..], &[0, 0][..], 1));
        }
        let empty = read(&binary(b"", &[])).unwrap();
        assert!(empty.positions.is_empty() && empty.parts.is_empty());
    }

    #[test]
    fn text_with_parts() {
        let facet = "facet normal nan 0 -nan(ind)\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\nendloop endfacet\n";
        let text = format!(
            "solid a b\r\n{facet}{}endsolid a b\n\nsolid\nendsolid\nSOLID c\n{facet}endsolid",
            facet.to_uppercase()
        );
        let model = read(text.as_bytes()).unwrap();
        assert_eq!(model.faces, [[0, 1, 2]; 3]);
        assert_eq!(model.part_of, [0, 0, 1]);
        assert_eq!(model.parts, ["a b", "c"]);
        assert!(read(b"solid nothing\nendsolid nothing").unwrap().faces.is_empty());
        let fine = read(text.replace(" 1 0 0", " 0.1 0 0").as_bytes()).unwrap();
        assert_eq!(fine.positions, Positions::F64(vec![[0.0; 3], [0.1, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    }

    fn error(bytes: &[u8]) -> String {
        read(bytes).unwrap_err().to_string()
    }

    #[test]
    fn errors_name_the_place() {
        let mut lying = binary(b"", &FACETS);
        lying[80..84].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
        let text = "byte 80: 4000000000 triangles promised, but there is room for 2 at most (the file is cut off or its counts are wrong)";
        assert_eq!(error(&lying), text);
        assert!(error(&binary(b"solid", &FACETS)[..100]).starts_with("byte 80: 2 triangles promised"));
        assert!(error(&[0; 20]).starts_with("84 bytes of header promised"));
        let mut nan = FACETS;
        nan[1][2][0] = f32::NAN;
        let text = "byte 170: vertex 5 has a coordinate that is NaN, infinite or too large";
        assert_eq!(error(&binary(b"", &nan)), text);
        assert_eq!(
            error(b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x"),
            "line 4: expected a coordinate, found \"x\""
        );
        let nan = b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf";
        assert_eq!(error(nan), "line 4: vertex 0 has a coordinate that is NaN, infinite or too large");
        let cut = b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop";
        assert_eq!(error(cut), "line 5: expected vertex, found \"endloop\"");
        assert_eq!(error(b"solid x\n"), "line 2: expected facet or endsolid, found nothing (the file is cut off)");
        assert_eq!(error(b"v 1 2 3"), "line 1: expected solid, found \"v\"");
    }

    #[test]
    fn trailing_bytes_are_counted() {
        let mut bytes = binary(b"", &FACETS);
        bytes.extend(b"tail");
        let model = read(&bytes).unwrap();
        assert_eq!(model.faces.len(), 2);
        assert_eq!(
            model.warnings[0].to_string(),
            "bytes after the end of the content, ignored: 4, the first at byte 184"
        );
    }
}

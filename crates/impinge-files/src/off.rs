//! OFF, the object file format of Geomview (its manual, §4.2.5), ASCII.
//!
//! The header is `OFF`, with `ST`, `C` and `N` before it where vertices have texture coordinates, colours and normals, or
//! nothing; the counts of vertices, faces and (unread) edges may stand on its line. After that a vertex is the first
//! three numbers of a line, and a face the first number and as many after it; what follows on the line are attributes.
//! `#` opens a comment. Faces are triangulated as [`polygon`](crate::polygon) says.

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    model::{Faces, Model, WarningKind, stored, too_many},
    text::{Lines, binary_data, integer, number, split_token, tokens, trim_start, without_bom},
};

/// Whether this is how an OFF file opens, comments aside.
pub(crate) fn opens(text: &[u8]) -> bool {
    Content::new(text).next().is_some_and(|line| header(split_token(line).0).is_some())
}

pub(crate) fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    if let Some(error) = binary_data(bytes, Format::Off) {
        return Err(error);
    }
    let mut content = Content::new(without_bom(bytes));
    let [vertices, faces] = read_counts(&mut content)?;
    let positions = read_vertices(&mut content, vertices)?;
    let faces = read_faces(&mut content, faces, &positions)?;
    let parts = if faces.faces.is_empty() { Vec::new() } else { vec![String::new()] };
    faces.into_model(stored(positions), parts, None, Format::Off)
}

/// The lines that are more than a comment, without their comments.
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

/// The prefix of a header such as `STCNOFF`.
fn header(token: &[u8]) -> Option<&[u8]> {
    let prefix = token.strip_suffix(b"OFF")?;
    let mut rest = prefix;
    for flag in [&b"ST"[..], b"C", b"N", b"4", b"n"] {
        rest = rest.strip_prefix(flag).unwrap_or(rest);
    }
    rest.is_empty().then_some(prefix)
}

fn read_counts(content: &mut Content<'_>) -> Result<[u64; 2], LoadError> {
    let mut line = content.next().unwrap_or_default();
    let (token, rest) = split_token(line);
    if let Some(prefix) = header(token) {
        if prefix.contains(&b'4') || prefix.contains(&b'n') || split_token(rest).0 == b"BINARY" {
            let name = format!("the OFF dialect {}", String::from_utf8_lossy(line).trim_end());
            return Err(LoadError::unsupported(name).at(content.place()));
        }
        line = if trim_start(rest).is_empty() { content.next().unwrap_or_default() } else { rest };
    }
    let mut numbers = tokens(line);
    let mut counts = [0; 2];
    for (count, what) in counts.iter_mut().zip(["the number of vertices", "the number of faces"]) {
        let token = numbers.next().unwrap_or_default();
        *count = integer(token)
            .and_then(|n| u64::try_from(n).ok())
            .ok_or_else(|| LoadError::syntax(what, token).at(content.place()))?;
    }
    for (count, what) in counts.into_iter().zip(["vertices", "faces"]) {
        if count > u64::from(u32::MAX) {
            return Err(too_many(what, count).at(content.place()));
        }
    }
    Ok(counts)
}

fn read_vertices(content: &mut Content<'_>, count: u64) -> Result<Vec<[f64; 3]>, LoadError> {
    let mut positions = Vec::new();
    while (positions.len() as u64) < count {
        let vertex = positions.len() as u64;
        let Some(line) = content.next() else {
            return Err(LoadError::truncated("vertices", count, vertex).at(content.place()));
        };
        let mut numbers = tokens(line);
        let mut position = [0.0; 3];
        for x in &mut position {
            let token = numbers.next().unwrap_or_default();
            *x = number(token).ok_or_else(|| LoadError::syntax("a coordinate", token).at(content.place()))?;
        }
        if !position.iter().all(|x| x.is_finite()) {
            return Err(LoadError::new(LoadErrorKind::NonFinite { vertex }).at(content.place()));
        }
        positions.push(position);
    }
    Ok(positions)
}

fn read_faces(content: &mut Content<'_>, count: u64, positions: &[[f64; 3]]) -> Result<Faces, LoadError> {
    let mut faces = Faces::default();
    let mut corners = Vec::new();
    for face in 0..count {
        let Some(line) = content.next() else {
            return Err(LoadError::truncated("faces", count, face).at(content.place()));
        };
        read_corners(line, face, positions.len(), &mut corners).map_err(|e| e.at(content.place()))?;
        faces.polygon(&corners, |i| positions[i as usize], 0, || content.place())?;
    }
    let left = trim_start(content.lines.rest()).len();
    if left > 0 && content.next().is_some() {
        faces.warnings.add(WarningKind::TrailingBytes, left as u64, || Some(content.place()));
    }
    Ok(faces)
}

fn read_corners(line: &[u8], face: u64, len: usize, corners: &mut Vec<u32>) -> Result<(), LoadError> {
    corners.clear();
    let mut numbers = tokens(line);
    let token = numbers.next().unwrap_or_default();
    let count = integer(token)
        .and_then(|n| u64::try_from(n).ok())
        .ok_or_else(|| LoadError::syntax("the number of corners", token))?;
    while (corners.len() as u64) < count {
        let token = match numbers.next() {
            Some(token) => token,
            None => return Err(LoadError::truncated("corners of a face", count, corners.len() as u64)),
        };
        let index = integer(token).ok_or_else(|| LoadError::syntax("a vertex index", token))?;
        let vertex = u32::try_from(index).ok().filter(|&v| (v as usize) < len);
        corners.push(
            vertex.ok_or_else(|| LoadError::new(LoadErrorKind::IndexOutOfBounds { face, index, len: len as u64 }))?,
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use impinge::Positions;

    use super::*;

    fn error(text: &str) -> String {
        read(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn headers_comments_and_attributes() {
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
    fn odd_but_valid() {
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
        assert_eq!(error("OFF 1 0 0\n0 nan 0"), nan);
        assert_eq!(error("OFF -1 0 0"), "line 1: expected the number of vertices, found \"-1\"");
        assert_eq!(
            error("OFF 5000000000 0 0"),
            "line 1: 5000000000 vertices are more than the 4294967295 that are allowed"
        );
        assert_eq!(error("OFF BINARY\n"), "line 1: needs the OFF dialect OFF BINARY, which is not supported");
        assert_eq!(error("4OFF\n1 0 0\n0 0 0 1"), "line 1: needs the OFF dialect 4OFF, which is not supported");
        assert_eq!(error("hello"), "line 1: expected the number of vertices, found \"hello\"");
    }
}

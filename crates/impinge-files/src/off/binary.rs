//! Reads binary OFF: after the line of the header, all values are big-endian and 4 bytes long.
//!
//! First come the numbers of vertices, faces and edges. Each vertex has a position, and the normal,
//! color and texture coordinates that the header states. Each face has the number of its corners,
//! their indices, the number of its color values, and these values.

use impinge::Positions;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::Limits,
    model::{Faces, Model, WarningKind},
    non_finite::NonFinite,
};

use super::Header;

/// Reads the file, whose values begin at byte `start`.
pub(super) fn read(bytes: &[u8], start: usize, header: &Header<'_>, limits: &Limits) -> Result<Model, LoadError> {
    let mut words = Words { bytes, at: start };
    let [vertices, faces, _] = [
        words.count("the number of vertices")?,
        words.count("the number of faces")?,
        words.count("the number of edges")?,
    ];
    let (mut positions, non_finite) = read_vertices(&mut words, vertices, header.extra_values())?;
    non_finite.replace(&mut positions);
    let mut faces = read_faces(&mut words, faces, &positions, Faces::new(limits))?;
    non_finite.check_unused(&mut faces, Place::Byte)?;
    let trailing = bytes.len() - words.at;
    faces.warnings.add(WarningKind::TrailingBytes, trailing as u64, || Some(words.place()));
    let parts = if faces.faces.is_empty() { Vec::new() } else { vec![String::new()] };
    faces.into_model(Positions::F32(positions), parts, None, Format::Off)
}

fn read_vertices(
    words: &mut Words<'_>,
    count: u64,
    extra_values: usize,
) -> Result<(Vec<[f32; 3]>, NonFinite), LoadError> {
    let start = words.at;
    let row = 3 + extra_values;
    let values = words.take("vertices", count, row)?;
    let position = |row: &[[u8; 4]]| [0, 1, 2].map(|k| f32::from_be_bytes(row[k]));
    let positions: Vec<_> = values.chunks_exact(row).map(position).collect();
    let mut non_finite = NonFinite::default();
    for (vertex, position) in positions.iter().enumerate() {
        if !position.iter().all(|x| x.is_finite()) {
            non_finite.add(vertex, (start + 4 * row * vertex) as u64);
        }
    }
    Ok((positions, non_finite))
}

fn read_faces(words: &mut Words<'_>, count: u64, positions: &[[f32; 3]], mut faces: Faces) -> Result<Faces, LoadError> {
    // Each face stores at least its number of corners and its number of color values.
    words.check_room("faces", count, 2)?;
    let mut corners = Vec::new();
    for face in 0..count {
        let place = words.place();
        let corner_count = words.count("the number of corners")?;
        let indices = words.take("corners of a face", corner_count, 1)?;
        corners.clear();
        for &index in indices {
            let index = u32::from_be_bytes(index);
            if index as usize >= positions.len() {
                let (index, len) = (index.cast_signed().into(), positions.len() as u64);
                return Err(LoadError::new(LoadErrorKind::IndexOutOfBounds { face, index, len }).at(place));
            }
            corners.push(index);
        }
        let color_values = words.count("the number of color values")?;
        words.take("color values", color_values, 1)?;
        faces.polygon(&corners, |i| positions[i as usize].map(f64::from), 0, || place)?;
    }
    Ok(faces)
}

/// A reader of 4-byte values.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    fn place(&self) -> Place {
        Place::Byte(self.at as u64)
    }

    /// Returns the words of the next `count` rows.
    fn take(&mut self, what: &str, count: u64, row: usize) -> Result<&'a [[u8; 4]], LoadError> {
        self.check_room(what, count, row)?;
        let start = self.at;
        self.at += 4 * row * count as usize;
        Ok(self.bytes[start..self.at].as_chunks().0)
    }

    /// Returns an error if fewer than `count` rows of `row` words can follow.
    fn check_room(&self, what: &str, count: u64, row: usize) -> Result<(), LoadError> {
        let room = (self.bytes.len() - self.at) as u64 / (4 * row as u64);
        if count <= room { Ok(()) } else { Err(LoadError::truncated(what, count, room).at(self.place())) }
    }

    fn count(&mut self, what: &'static str) -> Result<u64, LoadError> {
        let place = self.place();
        let Some(&word) = self.bytes[self.at..].first_chunk() else {
            return Err(LoadError::truncated("bytes", 4, (self.bytes.len() - self.at) as u64).at(place));
        };
        self.at += 4;
        let count = i32::from_be_bytes(word);
        u64::try_from(count).map_err(|_| LoadError::syntax(what, count.to_string().as_bytes()).at(place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    enum Value {
        Int(i32),
        Float(f32),
    }
    use Value::{Float, Int};

    fn file(header: &str, values: impl IntoIterator<Item = Value>) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend(values.into_iter().flat_map(|value| match value {
            Int(i) => i.to_be_bytes(),
            Float(x) => x.to_be_bytes(),
        }));
        bytes
    }

    /// Returns a square with `extra_values` more values per vertex, and two color values for the
    /// first face.
    fn square(extra_values: usize) -> Vec<Value> {
        let mut values: Vec<_> = [4, 2, 0].map(Int).into();
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            values.extend([x, y, 0.1].map(Float));
            values.extend((0..extra_values).map(|_| Float(f32::NAN)));
        }
        values.extend([4, 0, 1, 2, 3, 2].map(Int));
        values.extend([0.5, 0.5].map(Float));
        values.extend([3, 2, 1, 0, 0].map(Int));
        values
    }

    fn error(bytes: &[u8]) -> String {
        crate::off::read(bytes, &Limits::default()).unwrap_err().to_string()
    }

    #[test]
    fn vertices_are_read_for_every_header() {
        for (header, extra_values) in [
            ("OFF BINARY\n", 0),
            ("# c\nCOFF BINARY # c\r\n", 4),
            ("NOFF BINARY\n", 3),
            ("STCNOFF BINARY\n", 9),
            ("off binary\n", 0),
        ] {
            let model = crate::off::read(&file(header, square(extra_values)), &Limits::default()).unwrap();
            let expected = vec![[0.0, 0.0, 0.1], [1.0, 0.0, 0.1], [1.0, 1.0, 0.1], [0.0, 1.0, 0.1]];
            assert_eq!(model.positions, Positions::F32(expected), "{header}");
            assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
            assert_eq!((model.sources, model.parts.len()), (vec![0, 0, 1], 1));
            assert!(model.warnings.is_empty());
        }
        let empty = crate::off::read(&file("OFF BINARY\n", [0, 0, 0].map(Int)), &Limits::default()).unwrap();
        assert!(empty.positions.is_empty() && empty.parts.is_empty());
    }

    #[test]
    fn errors_name_the_byte() {
        let hint = "(the file is cut off or its counts are wrong)";
        let whole = file("OFF BINARY\n", square(0));
        for len in 11..whole.len() {
            assert!(error(&whole[..len]).ends_with(hint), "{len}");
        }
        let values = |values: &[i32]| error(&file("OFF BINARY\n", values.iter().map(|&i| Int(i))));
        let room = |n: u64| format!("promised, but there is room for {n} at most {hint}");
        assert_eq!(values(&[i32::MAX, 0, 0]), format!("byte 23: 2147483647 vertices {}", room(0)));
        assert_eq!(values(&[0, i32::MAX, 0]), format!("byte 23: 2147483647 faces {}", room(0)));
        assert_eq!(values(&[-1, 0, 0]), "byte 11: expected the number of vertices, found \"-1\"");
        assert_eq!(values(&[1, 1, 0, 0, 0, 0, 9, 0]), format!("byte 39: 9 corners of a face {}", room(1)));
        let face = values(&[1, 1, 0, 0, 0, 0, 1, -2, 0]);
        assert_eq!(face, "byte 35: face 0 names vertex -2, but there are 1 vertices");
        let nan = values(&[1, 1, 0, 0, -1, 0, 3, 0, 0, 0, 0]);
        assert_eq!(nan, "byte 23: vertex 0 has a coordinate that is NaN, infinite or too large");
    }

    #[test]
    fn unused_vertices_and_trailing_bytes_are_warnings() {
        let mut bytes = file("OFF BINARY\n", [2, 0, 0].map(Int).into_iter().chain([1.0; 3].map(Float)));
        bytes.extend(file("", [f32::NAN; 3].map(Float)));
        bytes.extend(b"tail");
        let model = crate::off::read(&bytes, &Limits::default()).unwrap();
        assert_eq!(model.positions, Positions::F32(vec![[1.0; 3]; 2]));
        let warnings: Vec<_> = model.warnings.iter().map(|w| (w.kind, w.count, w.first.clone())).collect();
        let expected = [
            (WarningKind::UnusedNonFinite, 1, Some(Place::Byte(35))),
            (WarningKind::TrailingBytes, 4, Some(Place::Byte(47))),
        ];
        assert_eq!(warnings, expected);
    }
}

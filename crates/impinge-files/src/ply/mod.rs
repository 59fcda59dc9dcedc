//! PLY (Greg Turk, *The PLY Polygon File Format*, 1994), ASCII and binary of both byte orders.
//!
//! - `vertex` must have `x`, `y`, `z`; where one of them is `double` or a 32-bit integer the vertices are f64, else f32.
//! - `face` gives polygons by its list `vertex_indices` (or `vertex_index`), triangulated as
//!   [`polygon`](crate::polygon) says.
//! - `tristrips` gives triangle strips by the same list, in which -1 begins a new strip.
//! - A row of an ASCII file ends its line: values that the header does not know are skipped, with a warning.
//! - All other elements and properties, lists among them, in any order, are skipped.

mod ascii;
mod binary;
mod faces;
mod header;
mod vertices;
mod write;

use impinge::Positions;

pub use write::write_ply;

use crate::{
    error::{LoadError, Place},
    format::Format,
    model::{Faces, Model, WarningKind},
};
use faces::read_faces;
use header::{Element, Encoding, Header, Property, Scalar};
use vertices::read_vertices;

pub(crate) fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    let header = Header::read(bytes)?;
    match header.encoding {
        Encoding::Ascii => read_body(&header, ascii::Ascii::new(bytes, header.len)?),
        Encoding::LittleEndian => read_body(&header, binary::Binary::<false>::new(bytes, header.len)),
        Encoding::BigEndian => read_body(&header, binary::Binary::<true>::new(bytes, header.len)),
    }
}

/// The values after the header, in order.
trait Values {
    /// The next value, in f64, which holds every value of every type.
    fn next(&mut self, scalar: Scalar) -> Result<f64, LoadError>;

    /// Skips values.
    fn skip(&mut self, scalar: Scalar, count: u64) -> Result<(), LoadError>;

    /// How many bytes a value takes at least.
    fn least_size(&self, scalar: Scalar) -> u64;

    /// The byte offset, for errors and to come back.
    fn offset(&self) -> usize;

    /// Goes back to an offset.
    fn seek(&mut self, offset: usize);

    /// What an offset is called.
    fn place(&self, offset: usize) -> Place;

    /// How many bytes are left.
    fn remaining(&self) -> u64;

    /// Ends a row: values that the header does not know are skipped.
    fn end_row(&mut self) {}

    /// How many rows had such values, and where the first of them stands.
    fn surplus(&self) -> Option<(u64, Place)> {
        None
    }

    /// All vertices at once, where their layout allows it.
    fn vertices_at_once(&mut self, _element: &Element, _xyz: [usize; 3]) -> Option<Positions> {
        None
    }

    /// All faces at once, where their layout allows it; negative indices come as more than `i32::MAX`.
    fn faces_at_once(
        &mut self,
        _element: &Element,
        _list: usize,
        _face: impl FnMut(&[u32], usize) -> Result<(), LoadError>,
    ) -> Option<Result<(), LoadError>> {
        None
    }
}

fn read_body(header: &Header, mut values: impl Values) -> Result<Model, LoadError> {
    let mut positions = None;
    let mut faces = Faces::default();
    let mut deferred = Vec::new();
    let has_vertices = header.elements.iter().any(|e| e.name == "vertex");
    for element in &header.elements {
        check_room(element, &values)?;
        match element.name.as_str() {
            "vertex" => positions = Some(read_vertices(element, &mut values)?),
            "face" | "tristrips" if positions.is_none() && has_vertices => {
                deferred.push((element, values.offset()));
                skip_rows(element, &mut values)?;
            }
            "face" | "tristrips" => read_faces(element, &mut values, positions.as_ref(), &mut faces)?,
            _ => skip_rows(element, &mut values)?,
        }
    }
    let end = values.offset();
    faces.warnings.add(WarningKind::TrailingBytes, values.remaining(), || Some(Place::Byte(end as u64)));
    for (element, offset) in deferred {
        values.seek(offset);
        read_faces(element, &mut values, positions.as_ref(), &mut faces)?;
    }
    if let Some((rows, first)) = values.surplus() {
        faces.warnings.add(WarningKind::SurplusValues, rows, || Some(first));
    }
    let parts = if faces.faces.is_empty() { Vec::new() } else { vec![String::new()] };
    faces.into_model(positions.unwrap_or(Positions::F32(Vec::new())), parts, None, Format::Ply)
}

/// An error where the rows of an element cannot all be there.
fn check_room(element: &Element, values: &impl Values) -> Result<(), LoadError> {
    let least = |p: &Property| values.least_size(p.list.unwrap_or(p.scalar));
    let row = element.properties.iter().map(least).sum::<u64>();
    if element.count == 0 || row == 0 {
        return Ok(());
    }
    // The last value of a text needs no separator after it.
    let room = (values.remaining() + 1) / row;
    if element.count <= room {
        return Ok(());
    }
    let what = format!("rows of element {}", element.name);
    Err(LoadError::truncated(what, element.count, room).at(values.place(values.offset())))
}

fn skip_rows(element: &Element, values: &mut impl Values) -> Result<(), LoadError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            skip_property(property, values)?;
        }
        values.end_row();
    }
    Ok(())
}

fn skip_property(property: &Property, values: &mut impl Values) -> Result<(), LoadError> {
    let count = read_len(property, values)?;
    values.skip(property.scalar, count)
}

/// How many values a property has in this row.
fn read_len(property: &Property, values: &mut impl Values) -> Result<u64, LoadError> {
    let Some(count) = property.list else { return Ok(1) };
    let at = values.offset();
    let what = "the length of a list";
    let len = read_integer(count, values, what)?;
    u64::try_from(len).map_err(|_| LoadError::syntax(what, len.to_string().as_bytes()).at(values.place(at)))
}

fn read_integer(scalar: Scalar, values: &mut impl Values, what: &str) -> Result<i64, LoadError> {
    let at = values.offset();
    let value = values.next(scalar)?;
    if value.fract() == 0.0 {
        // Integer types end at 2^32; a float beyond i64 becomes its end, which is out of every range too.
        Ok(value as i64)
    } else {
        Err(LoadError::syntax(what, value.to_string().as_bytes()).at(values.place(at)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASCII: &str = "ply\nformat ascii 1.0\ncomment made by hand\n";

    fn parse(text: impl AsRef<[u8]>) -> Model {
        read(text.as_ref()).unwrap()
    }

    fn error(text: impl AsRef<[u8]>) -> String {
        read(text.as_ref()).unwrap_err().to_string()
    }

    fn kinds(model: &Model) -> Vec<(WarningKind, u64)> {
        model.warnings.iter().map(|w| (w.kind, w.count)).collect()
    }

    /// A quad and a triangle: properties in odd order, extra elements, lists in the vertices, and faces first.
    fn odd(encoding: &str, value: impl Fn(&mut Vec<u8>, Scalar, f64)) -> Vec<u8> {
        use Scalar::{Char, Double, Float, Int, UChar, UInt, UShort};
        let mut out = format!(
            "ply\nformat {encoding} 1.0\nobj_info x\nelement junk 2\nproperty list int double stuff\nelement face 2\n\
             property uchar red\nproperty list uchar uint vertex_index\nproperty list uint8 float32 uv\n\
             element vertex 4\nproperty double z\nproperty list char ushort tags\nproperty float32 x\nproperty int y\n\
             element empty 4000000000\nend_header\n"
        )
        .into_bytes();
        let mut put = |scalar, values: &[f64]| values.iter().for_each(|&v| value(&mut out, scalar, v));
        for list in [&[][..], &[0.1, 0.2]] {
            put(Int, &[list.len() as f64]);
            put(Double, list);
        }
        for (corners, uv) in [(&[0., 1., 2., 3.][..], &[f64::NAN][..]), (&[2., 1., 0.], &[])] {
            put(UChar, &[255.0, corners.len() as f64]);
            put(UInt, corners);
            put(UChar, &[uv.len() as f64]);
            put(Float, uv);
        }
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            put(Double, &[0.1]);
            put(Char, &[1.0]);
            put(UShort, &[65535.0]);
            put(Float, &[x]);
            put(Int, &[y]);
        }
        out
    }

    fn put_binary(out: &mut Vec<u8>, scalar: Scalar, value: f64, big: bool) {
        let mut bytes = match scalar {
            Scalar::Char => (value as i8).to_le_bytes().to_vec(),
            Scalar::UChar => (value as u8).to_le_bytes().to_vec(),
            Scalar::Short => (value as i16).to_le_bytes().to_vec(),
            Scalar::UShort => (value as u16).to_le_bytes().to_vec(),
            Scalar::Int => (value as i32).to_le_bytes().to_vec(),
            Scalar::UInt => (value as u32).to_le_bytes().to_vec(),
            Scalar::Float => (value as f32).to_le_bytes().to_vec(),
            Scalar::Double => value.to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        out.extend(bytes);
    }

    #[test]
    fn any_layout_in_any_encoding() {
        let files = [
            odd("ascii", |out, _, v| out.extend(format!("{v} ").bytes())),
            odd("binary_little_endian", |out, s, v| put_binary(out, s, v, false)),
            odd("binary_big_endian", |out, s, v| put_binary(out, s, v, true)),
        ];
        // ASCII rows end their lines, and this writer has no lines.
        assert!(read(&files[0]).is_err());
        for file in &files[1..] {
            let model = parse(file);
            let expected = vec![[0.0, 0.0, 0.1], [1.0, 0.0, 0.1], [1.0, 1.0, 0.1], [0.0, 1.0, 0.1]];
            assert_eq!(model.positions, Positions::F64(expected));
            assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
            assert_eq!(model.sources, [0, 0, 1]);
            assert!(kinds(&model).is_empty());
        }
    }

    #[test]
    fn plain_layouts_in_bulk() {
        for (encoding, big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
            for (float, index) in [(Scalar::Float, Scalar::Int), (Scalar::Double, Scalar::UInt)] {
                let (f, i) = if float == Scalar::Float { ("float", "int") } else { ("double", "uint") };
                let mut file = format!(
                    "ply\r\nformat {encoding} 1.0\r\nelement vertex 4\r\nproperty uchar red\r\nproperty {f} x\r\nproperty {f} z\r\n\
                     property {f} y\r\nelement face 3\r\nproperty short a\r\nproperty list uchar {i} vertex_indices\r\n\
                     property char b\r\nend_header\r\n"
                )
                .into_bytes();
                for v in 0..4_i16 {
                    put_binary(&mut file, Scalar::UChar, 7.0, big);
                    for k in 0..3 {
                        put_binary(&mut file, float, f64::from(v * v + k) / 4.0, big);
                    }
                }
                for face in [&[0_u8, 1, 2][..], &[3, 2, 1, 0], &[1]] {
                    put_binary(&mut file, Scalar::Short, -1.0, big);
                    put_binary(&mut file, Scalar::UChar, face.len() as f64, big);
                    face.iter().for_each(|&v| put_binary(&mut file, index, v.into(), big));
                    put_binary(&mut file, Scalar::Char, -1.0, big);
                }
                let model = parse(&file);
                let row = |v: f64| [v * v, v * v + 2.0, v * v + 1.0].map(|x| x / 4.0);
                for v in 0..4_u8 {
                    assert_eq!(model.positions.get(v.into()), row(v.into()));
                }
                assert_eq!(matches!(model.positions, Positions::F32(_)), float == Scalar::Float);
                assert_eq!(model.faces.len(), 3);
                assert_eq!(model.faces[0], [0, 1, 2]);
                assert_eq!(kinds(&model).last(), Some(&(WarningKind::ShortFaces, 1)));
            }
        }
    }

    #[test]
    fn floats_of_text_are_rounded_once() {
        let head = "element vertex 1\nproperty float x\nproperty float y\nproperty double z\nend_header\n";
        // Halfway between two f32 as the nearest f64 has it, but truly above.
        let model = parse(format!("{ASCII}{head}1.00000005960464477540 0.1 0.1"));
        assert_eq!(model.positions, Positions::F64(vec![[f64::from(1.0_f32 + f32::EPSILON), f64::from(0.1_f32), 0.1]]));
    }

    #[test]
    fn strips_turn_every_second_triangle() {
        let head = "element vertex 6\nproperty short x\nproperty uchar y\nproperty char z\nelement tristrips 2\nproperty list int int vertex_indices\nend_header\n";
        let rows = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 -1\n9 0 1 2 3 -1 2 3 4 5\n5 0 1 1 2 3\n";
        let model = parse(format!("{ASCII}{head}{rows}"));
        assert_eq!(model.faces, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [1, 2, 3]]);
        assert_eq!(model.sources, [0, 1, 2, 3, 4]);
        assert!(matches!(model.positions, Positions::F32(_)));
        assert_eq!(kinds(&model), [(WarningKind::StripJoints, 2)]);
    }

    #[test]
    fn odd_but_valid() {
        assert!(parse(format!("{ASCII}end_header\n")).faces.is_empty());
        let head = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
        let model = parse(format!("{ASCII}{head}0 0 0 1 1\n7 7"));
        assert_eq!(kinds(&model), [(WarningKind::TrailingBytes, 3), (WarningKind::SurplusValues, 1)]);
        assert_eq!(model.warnings[1].first, Some(Place::Line(9)));
    }

    #[test]
    fn errors_name_the_place() {
        let hint = "(the file is cut off or its counts are wrong)";
        let head = |n: u64, m: u64| {
            format!(
                "{ASCII}element vertex {n}\nproperty float x\nproperty float y\nproperty float z\nelement face {m}\nproperty list int int vertex_indices\nend_header\n"
            )
        };
        assert!(
            error("ply\nformat ascii 1.0\nelement vertex 1")
                .ends_with("expected end_header, found nothing (the file is cut off)")
        );
        assert_eq!(
            error("ply\nformat binary 1.0\n"),
            "line 2: expected ascii, binary_little_endian or binary_big_endian, found \"binary\""
        );
        let text =
            format!("line 11: 5000000000 rows of element vertex promised, but there is room for 0 at most {hint}");
        assert_eq!(error(head(5_000_000_000, 0)), text);
        assert_eq!(
            error(head(1, 0) + "0 nan 0"),
            "line 11: vertex 0 has a coordinate that is NaN, infinite or too large"
        );
        assert_eq!(
            error(head(1, 0) + "0 1e39 0"),
            "line 11: vertex 0 has a coordinate that is NaN, infinite or too large"
        );
        assert_eq!(error(head(1, 0) + "0 x 0"), "line 11: expected a number, found \"x\"");
        assert_eq!(
            error(head(1, 1) + "0 0 0\n3 0 0 -1\n"),
            "line 12: face 0 names vertex -1, but there are 1 vertices"
        );
        assert_eq!(
            error(head(1, 1) + "0 0 0\n2147483647 0 0\n"),
            format!("line 12: expected a value, found nothing {hint}")
        );
        assert_eq!(error(head(1, 1) + "0 0 0\n-3 0 0\n"), "line 12: expected the length of a list, found \"-3\"");
        assert_eq!(error(head(1, 1) + "0 0 0\n3 0 0 0.5\n"), "line 12: expected a vertex index, found \"0.5\"");
        assert!(
            error(head(1, 1) + "0 0 0\n3 0 0 \0\n")
                .ends_with("not PLY, but binary data or UTF-16 (the header says ascii)")
        );
        let binary = |n: u64, m: u64, body: &[u8]| {
            let head = head(n, m).replace("ascii", "binary_little_endian").replace("list int", "list uchar");
            (head.len(), error([head.as_bytes(), body].concat()))
        };
        let (at, text) = binary(2, 0, &[0; 20]);
        assert_eq!(
            text,
            format!("byte {at}: 2 rows of element vertex promised, but there is room for 1 at most {hint}")
        );
        let (_, text) = binary(1, 1, &[[0; 12], [3, 0, 0, 0, 0, 254, 255, 255, 255, 0, 0, 0]].concat());
        assert!(text.contains("promised"), "{text}");
        let (at, text) = binary(1, 1, &[&[0; 12][..], &[2, 0, 0, 0, 0, 254, 255, 255, 255]].concat());
        assert_eq!(text, format!("byte {}: face 0 names vertex -2, but there are 1 vertices", at + 12));
        let (at, text) = binary(1, 0, &[0, 0, 0xC0, 0x7F, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(text, format!("byte {at}: vertex 0 has a coordinate that is NaN, infinite or too large"));
        assert!(
            error(format!("{ASCII}element vertex 1\nproperty float x\nend_header\n1"))
                .contains("expected properties x, y and z")
        );
        assert!(
            error(format!("{ASCII}element face 1\nproperty int i\nend_header\n1"))
                .contains("a list vertex_indices of element face")
        );
    }
}

//! Tests of layouts, encodings and errors of PLY files.

use super::*;

const ASCII: &str = "ply\nformat ascii 1.0\ncomment made by hand\n";

fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    super::read(bytes, &Limits::default())
}

fn parse(text: impl AsRef<[u8]>) -> Model {
    read(text.as_ref()).unwrap()
}

fn error(text: impl AsRef<[u8]>) -> String {
    read(text.as_ref()).unwrap_err().to_string()
}

fn kinds(model: &Model) -> Vec<(WarningKind, u64)> {
    model.warnings.iter().map(|w| (w.kind, w.count)).collect()
}

/// Returns a file with a quad and a triangle, in an unusual layout: properties in unusual order,
/// extra elements, lists in the vertices, and faces first.
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
        Scalar::Long => (value as i64).to_le_bytes().to_vec(),
        Scalar::ULong => (value as u64).to_le_bytes().to_vec(),
        Scalar::Float => (value as f32).to_le_bytes().to_vec(),
        Scalar::Double => value.to_le_bytes().to_vec(),
    };
    if big {
        bytes.reverse();
    }
    out.extend(bytes);
}

#[test]
fn any_layout_is_read_in_any_encoding() {
    let files = [
        odd("ascii", |out, _, v| out.extend(format!("{v} ").bytes())),
        odd("binary_little_endian", |out, s, v| put_binary(out, s, v, false)),
        odd("binary_big_endian", |out, s, v| put_binary(out, s, v, true)),
    ];
    // ASCII rows end with their lines, and this writer writes no lines.
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
fn plain_layouts_are_read_in_bulk() {
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

/// Returns a file with three vertices and a face, with these types of a coordinate, a length and an
/// index.
fn typed(coordinate: Scalar, length: Scalar, index: Scalar, big: bool) -> Vec<u8> {
    let name = |scalar| match scalar {
        Scalar::Long => "int64",
        Scalar::ULong => "ulong",
        Scalar::Double => "double",
        _ => "float",
    };
    let encoding = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut file = format!("ply\nformat {encoding} 1\nelement vertex 3\n");
    for axis in ["x", "y", "z"] {
        file += &format!("property {} {axis}\n", name(coordinate));
    }
    file += &format!("element face 1\nproperty list {} {} vertex_index\nend_header\n", name(length), name(index));
    let mut file = file.into_bytes();
    for x in [0.0, 0.0, 0.0, -4.0, 0.0, 0.0, 0.0, -4.0, 0.0] {
        put_binary(&mut file, coordinate, x, big);
    }
    put_binary(&mut file, length, 3.0, big);
    for i in [2.0, 1.0, 0.0] {
        put_binary(&mut file, index, i, big);
    }
    file
}

#[test]
fn types_of_64_bits_and_lengths_of_any_type_are_read() {
    use Scalar::{Double, Float, Long, ULong};
    for big in [false, true] {
        for (coordinate, length, index) in [(Long, ULong, Long), (Float, Float, ULong), (Double, Double, Float)] {
            let model = parse(typed(coordinate, length, index, big));
            let expected = [[0.0; 3], [-4.0, 0.0, 0.0], [0.0, -4.0, 0.0]];
            assert_eq!([0, 1, 2].map(|i| model.positions.get(i)), expected);
            assert_eq!(matches!(model.positions, Positions::F32(_)), coordinate == Float);
            assert_eq!(model.faces, [[2, 1, 0]]);
            assert!(kinds(&model).is_empty());
        }
    }
    let head = "element vertex 1\nproperty int64 x\nproperty long y\nproperty uint64 z\nelement face 1\n\
                property list float int vertex_indices\nend_header\n-9223372036854775808 -1 9007199254740992\n";
    let model = parse(format!("{ASCII}{head}3.0 0 0 0\n"));
    assert_eq!(model.positions, Positions::F64(vec![[-9_223_372_036_854_775_808.0, -1.0, 9_007_199_254_740_992.0]]));
    for length in ["2.5", "nan", "-1", "1e30"] {
        let text = error(format!("{ASCII}{head}{length} 0 0 0\n"));
        assert!(text.starts_with("line 12: expected "), "{text}");
    }
}

#[test]
fn header_lines_without_a_keyword_are_comments() {
    let head = "Created by a program - http://x\nelement vertex 1\nproperty float x\nproperty float y\n\
                property float z\nUnits: mm\nend_header\n";
    let model = parse(format!("{ASCII}{head}1 2 3\n"));
    assert_eq!(model.positions, Positions::F32(vec![[1.0, 2.0, 3.0]]));
    assert_eq!(kinds(&model), [(WarningKind::UnknownLines, 2)]);
    assert_eq!(model.warnings[0].first, Some(Place::Line(4)));
    for typo in ["proprety float w", "Property list uchar int vertex_indices", "elemnt face 1"] {
        let text = error(format!("{ASCII}{typo}\n{head}1 2 3\n"));
        assert_eq!(text, format!("line 4: expected format, element, property, comment or end_header, found {typo:?}"));
    }
    assert!(error("ply\nformat ascii 2\nend_header\n").starts_with("line 2: expected version 1.0"));
}

#[test]
fn unused_vertices_need_not_be_finite() {
    let head = |encoding: &str, face: bool| {
        let face = if face { "element face 1\nproperty list uchar int vertex_indices\n" } else { "" };
        format!(
            "ply\nformat {encoding} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{face}end_header\n"
        )
    };
    let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let rows = [[f32::NAN; 3], a, b, c];
    let mut binary = head("binary_big_endian", true).into_bytes();
    binary.extend(rows.as_flattened().iter().flat_map(|x| x.to_be_bytes()));
    let at = binary.len();
    binary.extend([&[3][..], &[1, 2, 3_u32].map(u32::to_be_bytes).concat()].concat());
    let text = head("ascii", true) + "nan nan nan\n1 0 0\n0 1 0\n0 0 1\n3 1 2 3\n";
    for (file, first) in [(&binary, Place::Byte(at as u64 - 48)), (&text.clone().into_bytes(), Place::Line(10))] {
        let model = parse(file);
        assert_eq!(model.positions, Positions::F32(vec![a, a, b, c]));
        assert_eq!(model.faces, [[1, 2, 3]]);
        assert_eq!(kinds(&model), [(WarningKind::UnusedNonFinite, 1)]);
        assert_eq!(model.warnings[0].first, Some(first));
    }
    let nothing = parse(head("ascii", false) + &"1 inf nan\n".repeat(4));
    assert_eq!(nothing.positions, Positions::F32(vec![[0.0; 3]; 4]));
    let used = error(text.replace("3 1 2 3", "4 1 2 3 0"));
    assert_eq!(used, "line 10: vertex 0 has a coordinate that is NaN, infinite or too large");
}

#[test]
fn decimal_floats_are_rounded_once() {
    let head = "element vertex 1\nproperty float x\nproperty float y\nproperty double z\nend_header\n";
    // The nearest f64 is halfway between two f32, but the true value is above it.
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
fn unusual_but_valid_files_are_read() {
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
    let text = format!("line 11: 5000000000 rows of element vertex promised, but there is room for 0 at most {hint}");
    assert_eq!(error(head(5_000_000_000, 0)), text);
    assert_eq!(
        error(head(1, 1) + "0 nan 0\n3 0 0 0"),
        "line 11: vertex 0 has a coordinate that is NaN, infinite or too large"
    );
    assert_eq!(
        error(head(1, 1) + "0 1e39 0\n3 0 0 0"),
        "line 11: vertex 0 has a coordinate that is NaN, infinite or too large"
    );
    assert_eq!(error(head(1, 0) + "0 x 0"), "line 11: expected a number, found \"x\"");
    assert_eq!(error(head(1, 1) + "0 0 0\n3 0 0 -1\n"), "line 12: face 0 names vertex -1, but there are 1 vertices");
    assert_eq!(
        error(head(1, 1) + "0 0 0\n2147483647 0 0\n"),
        format!("line 12: expected a value, found nothing {hint}")
    );
    assert_eq!(error(head(1, 1) + "0 0 0\n-3 0 0\n"), "line 12: expected the length of a list, found \"-3\"");
    assert_eq!(error(head(1, 1) + "0 0 0\n3 0 0 0.5\n"), "line 12: expected a vertex index, found \"0.5\"");
    assert!(
        error(head(1, 1) + "0 0 0\n3 0 0 \0\n").ends_with("not PLY, but binary data or UTF-16 (the header says ascii)")
    );
    let binary = |n: u64, m: u64, body: &[u8]| {
        let head = head(n, m).replace("ascii", "binary_little_endian").replace("list int", "list uchar");
        (head.len(), error([head.as_bytes(), body].concat()))
    };
    let (at, text) = binary(2, 0, &[0; 20]);
    assert_eq!(text, format!("byte {at}: 2 rows of element vertex promised, but there is room for 1 at most {hint}"));
    let (_, text) = binary(1, 1, &[[0; 12], [3, 0, 0, 0, 0, 254, 255, 255, 255, 0, 0, 0]].concat());
    assert!(text.contains("promised"), "{text}");
    let (at, text) = binary(1, 1, &[&[0; 12][..], &[2, 0, 0, 0, 0, 254, 255, 255, 255]].concat());
    assert_eq!(text, format!("byte {}: face 0 names vertex -2, but there are 1 vertices", at + 12));
    let nan = [&[0; 12][..], &[0, 0, 0xC0, 0x7F, 0, 0, 0, 0, 0, 0, 0, 0], &[3], &[1, 0, 0, 0].repeat(3)].concat();
    let (at, text) = binary(2, 1, &nan);
    assert_eq!(text, format!("byte {}: vertex 1 has a coordinate that is NaN, infinite or too large", at + 12));
    assert!(
        error(format!("{ASCII}element vertex 1\nproperty float x\nend_header\n1"))
            .contains("expected properties x, y and z")
    );
    assert!(
        error(format!("{ASCII}element face 1\nproperty int i\nend_header\n1"))
            .contains("a list vertex_indices of element face")
    );
}

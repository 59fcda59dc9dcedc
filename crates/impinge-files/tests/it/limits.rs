//! Tests of the limits that a caller sets: every format respects them, and the errors name the
//! limit, the place and the remedy.

use std::{fs, io::Write};

use impinge::character::{Character, Mode, Plan, Rig};
use impinge_files::{
    Format, Limits, LoadErrorKind, character_text, load_character_with, load_plan_with, load_rig_with, load_with,
    parse_rig_with, parse_with,
};

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn package(model: &str) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    zip.start_file("3D/3dmodel.model", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(model.as_bytes()).unwrap();
    zip.finish().unwrap().into_inner()
}

/// Returns files of every format with two triangles.
fn two_triangles() -> Vec<(Format, Vec<u8>)> {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let mut binary = vec![b' '; 80];
    binary.extend(2_u32.to_le_bytes());
    binary.extend([1; 100]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    let gltf = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0},{"mesh":0}],"meshes":[{"primitives":[{"attributes":
        {"POSITION":0}}]}],"accessors":[{"componentType":5126,"count":3,"type":"VEC3"}]}"#;
    let collada = r##"<COLLADA version="1.4.1"><library_geometries><geometry id="g"><mesh><source id="p"><float_array>0 0 0 1 0 0 1 1
        0 0 1 0</float_array></source><polygons><input semantic="VERTEX" source="#p"/><p>0 1 2 3</p></polygons></mesh></geometry>
        </library_geometries></COLLADA>"##;
    let model = r#"<model><resources><object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1"
        z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object></resources><build><item objectid="1"/>
        <item objectid="1"/></build></model>"#;
    vec![
        (Format::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n".to_vec()),
        (Format::Off, b"OFF 4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n".to_vec()),
        (Format::Stl, format!("solid\n{facet}{facet}endsolid\n").into_bytes()),
        (Format::Stl, binary),
        (Format::Ply, ply.into()),
        (Format::Gltf, gltf.into()),
        (Format::Collada, collada.into()),
        (Format::ThreeMf, package(model)),
    ]
}

#[test]
fn every_format_respects_the_maximum_number_of_triangles() {
    for (format, file) in two_triangles() {
        let limits = Limits::default();
        assert_eq!(parse_with(&file, format, &limits.with_max_triangles(2)).unwrap().faces.len(), 2, "{format}");
        let error = parse_with(&file, format, &limits.with_max_triangles(1)).unwrap_err();
        let expected = LoadErrorKind::TooMany { what: "triangles", count: 2, limit: 1 };
        assert_eq!(error.kind(), &expected, "{format}");
        assert_eq!(error.hint(), Some("if you trust the file, load it with a larger max_triangles"));
        assert!(error.place().is_some(), "{format}: {error}");
    }
}

#[test]
fn every_format_respects_the_maximum_number_of_bytes() {
    for (format, file) in two_triangles() {
        let len = file.len() as u64;
        let limits = Limits::default();
        let error = parse_with(&file, format, &limits.with_max_bytes(len - 1)).unwrap_err();
        let expected = LoadErrorKind::TooMany { what: "bytes of the file", count: len, limit: len - 1 };
        assert_eq!(error.kind(), &expected);
        assert_eq!(error.hint(), Some("if you trust the file, load it with a larger max_bytes"));
        if format != Format::ThreeMf {
            assert!(parse_with(&file, format, &limits.with_max_bytes(len)).is_ok());
            let packed = gzip(&file.repeat(3));
            let error = parse_with(&packed, format, &limits.with_max_bytes(packed.len() as u64)).unwrap_err();
            assert!(matches!(error.kind(), LoadErrorKind::TooMany { what: "unpacked bytes", .. }), "{error}");
        }
    }
}

#[test]
fn larger_limits_accept_files_that_the_defaults_refuse() {
    let blank = gzip(format!("{}\nv 0 0 0\n", " ".repeat(80 << 20)).as_bytes());
    let limits = Limits::default();
    assert_eq!(parse_with(&blank, Format::Obj, &limits).unwrap_err().kind().name(), "too-many");
    let larger = limits.with_max_bytes(100 << 20);
    assert_eq!(parse_with(&blank, Format::Obj, &larger).unwrap().positions.len(), 1);

    // 19 doublings of a triangle.
    let doubled: String = (1..=19)
        .map(|id| {
            let inner = format!("<component objectid=\"{}\"/>", id - 1);
            format!("<object id=\"{id}\"><components>{inner}{inner}</components></object>")
        })
        .collect();
    let model = format!(
        "<model><resources><object id=\"0\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>\
        <vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh></object>\
        {doubled}</resources><build><item objectid=\"19\"/></build></model>"
    );
    let file = package(&model);
    let error = parse_with(&file, Format::ThreeMf, &limits).unwrap_err();
    let expected = LoadErrorKind::TooMany { what: "vertices", count: 3 << 19, limit: 1 << 20 };
    assert_eq!(
        (error.kind(), error.place().map(ToString::to_string).as_deref()),
        (&expected, Some("3D/3dmodel.model, object 18"))
    );
    let error = error.to_string();
    assert!(error.contains("load it with a larger max_triangles"), "{error}");
    let model = parse_with(&file, Format::ThreeMf, &limits.with_max_triangles(1 << 19)).unwrap();
    assert_eq!(model.faces.len(), 1 << 19);
}

#[test]
fn buffers_of_gltf_files_count_as_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in [("a.bin", 300), ("b.bin", 300)] {
        fs::write(folder.path().join(name), vec![0; content]).unwrap();
    }
    let path = folder.path().join("a.gltf");
    let document =
        r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":200},{"uri":"b.bin","byteLength":200}]}"#;
    fs::write(&path, document).unwrap();
    assert!(load_with(&path, &Limits::default().with_max_bytes(400)).is_ok());
    let error = load_with(&path, &Limits::default().with_max_bytes(399)).unwrap_err();
    let expected = LoadErrorKind::TooMany { what: "bytes of buffers", count: 400, limit: 399 };
    assert_eq!((error.kind(), error.path()), (&expected, path.as_path()));
}

#[test]
fn rigs_and_saved_characters_respect_the_limits() {
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robot.glb");
    let size = fs::metadata(&data).unwrap().len();
    let limits = Limits::default();
    let kind = |result: Result<_, impinge_files::LoadError>| result.map(|_: Rig| ()).unwrap_err().kind().clone();
    assert_eq!(
        kind(load_rig_with(&data, &limits.with_max_bytes(size - 1))),
        LoadErrorKind::TooMany { what: "bytes of the file", count: size, limit: size - 1 }
    );
    assert_eq!(
        kind(parse_rig_with(&fs::read(&data).unwrap(), &limits.with_max_bytes(size - 1))),
        LoadErrorKind::TooMany { what: "bytes of the file", count: size, limit: size - 1 }
    );
    let rig = load_rig_with(&data, &limits.with_max_bytes(size)).unwrap();
    let triangles = rig.skin().faces().len() as u64;
    assert_eq!(
        load_rig_with(&data, &limits.with_max_triangles(triangles)).unwrap().skin().faces().len() as u64,
        triangles
    );
    assert!(matches!(
        kind(load_rig_with(&data, &limits.with_max_triangles(triangles - 1))),
        LoadErrorKind::TooMany { what: "triangles", limit, .. } if limit == triangles - 1
    ));

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("parts.toml");
    let character = Character::fit(&rig, &Plan::automatic(&rig, 2).unwrap(), Mode::Snug).unwrap();
    let text = character_text(&rig, &character);
    fs::write(&path, &text).unwrap();
    let (enough, few) = (limits.with_max_bytes(text.len() as u64), limits.with_max_bytes(text.len() as u64 - 1));
    assert!(load_character_with(&path, &rig, &enough).is_ok() && load_plan_with(&path, &rig, &enough).is_ok());
    assert_eq!(load_character_with(&path, &rig, &few).unwrap_err().kind().name(), "too-many");
    assert_eq!(load_plan_with(&path, &rig, &few).unwrap_err().kind().name(), "too-many");
}

//! Tests of files on disk: extensions, content that contradicts them, other files in the folder,
//! and errors.

use std::{fs, io::Write};

use impinge::Positions;
use impinge_files::{Format, LoadErrorKind, Place, WarningKind, load};
use tempfile::tempdir;

const OFF: &str = "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn extensions_are_read_in_any_case_and_content_decides() {
    let folder = tempdir().unwrap();
    for (name, warns) in [("a.off", false), ("a.OFF", false), ("a.Obj", true), ("a.stl", true), ("a.3MF", true)] {
        let path = folder.path().join(name);
        fs::write(&path, OFF).unwrap();
        let model = load(&path).unwrap();
        assert_eq!((model.faces.len(), model.format), (1, Format::Off), "{name}");
        let kinds: Vec<_> = model.warnings.iter().map(|w| w.kind).collect();
        assert_eq!(kinds, if warns { vec![WarningKind::OtherExtension] } else { vec![] }, "{name}");
    }
}

#[test]
fn content_proves_its_format() {
    let stl = [vec![b'v'; 80], vec![0; 4]].concat();
    let rows: [(&[u8], Option<Format>); 19] = [
        (b"ply\nformat", Some(Format::Ply)),
        (b"ply\r\nformat", Some(Format::Ply)),
        (b"plywood", None),
        (b"\xEF\xBB\xBF# c\n COFF\n", Some(Format::Off)),
        (b"OFFSET", None),
        (b"glTF\x02\0\0\0", Some(Format::Glb)),
        (b" {\"asset\": 1}", Some(Format::Gltf)),
        (b"{\"other\": 1}", None),
        (b"PK\x03\x04", Some(Format::ThreeMf)),
        (b"<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">", Some(Format::Collada)),
        (b"<?xml version=\"1.0\"?>\n<model>", None),
        (b"\x1F\x8B\x08\0", None),
        (b"Solid name\r\n  Facet normal", Some(Format::Stl)),
        (b"solid name\nendsolid", Some(Format::Stl)),
        (b"solid name\n# c\n\n#facet\nfacet", Some(Format::Stl)),
        (b"solid name\n# facet\n", None),
        (b"solid state", None),
        (&stl, Some(Format::Stl)),
        (b"v 0 0 0\n", None),
    ];
    for (bytes, format) in rows {
        assert_eq!(Format::of_content(bytes), format, "{}", String::from_utf8_lossy(bytes));
    }
    for format in Format::ALL {
        assert_eq!(Format::from_extension(&format.extension().to_uppercase()), Some(format));
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn gzip_files_are_read_in_the_format_of_their_content() {
    let folder = tempdir().unwrap();
    let load_as = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        load(path)
    };
    let packed = gzip(OFF.as_bytes());
    let other = vec![WarningKind::OtherExtension];
    for (name, content, warnings) in [
        ("a.off.gz", &packed[..], vec![]),
        ("a.OFF.GZ", &packed, vec![]),
        ("a.gz", &packed, vec![]),
        ("a.scan.gz", &packed, vec![]),
        ("a.off", &packed, other.clone()),
        ("a.obj.gz", &packed, other.clone()),
        ("a.off.gz", OFF.as_bytes(), other),
    ] {
        let model = load_as(name, content).unwrap();
        assert_eq!((model.faces.len(), model.format), (1, Format::Off), "{name}");
        assert_eq!(model.warnings.iter().map(|w| w.kind).collect::<Vec<_>>(), warnings, "{name}");
    }
    // OBJ cannot be detected by content, so its extension is needed.
    let obj = gzip(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(load_as("a.obj.gz", &obj).unwrap().faces.len(), 1);
    let error = load_as("a.tar.gz", &obj).unwrap_err();
    assert_eq!(error.kind(), &LoadErrorKind::UnsupportedFormat { extension: "tar.gz".into() });
    assert_eq!(load_as("a.gz", &obj).unwrap_err().kind().name(), "unsupported-format");
    let error = load_as("a.off.gz", &packed[..packed.len() - 4]).unwrap_err().to_string();
    assert!(error.contains("a.off.gz, byte 0: expected a complete gzip file"), "{error}");
    let error = load_as("a.obj.gz", &gzip(b"v 0 0 0\nf 1 2 3\n")).unwrap_err().to_string();
    assert!(error.contains("a.obj.gz, line 2: face 0 names vertex 2"), "{error}");
    assert_eq!(load_as("a.obj.gz", &gzip(b"")).unwrap_err().kind(), &LoadErrorKind::Empty);
    // A binary STL file may begin with any bytes.
    let stl = [&packed[..4], &[0; 80]].concat();
    assert_eq!(load_as("a.stl", &stl).unwrap().format, Format::Stl);
}

#[test]
fn a_rig_may_be_compressed_by_gzip() {
    let bytes = fs::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robot.glb")).unwrap();
    let rig = impinge_files::parse_rig(&gzip(&bytes)).unwrap();
    assert_eq!(rig.skeleton().bones().len(), impinge_files::parse_rig(&bytes).unwrap().skeleton().bones().len());
}

#[test]
fn errors_name_the_file() {
    let folder = tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let path = file("bunny.obj", b"v 0 0 0\nf 1 1 900\n");
    let error = load(&path).unwrap_err();
    assert_eq!(error.path(), path);
    assert_eq!(error.place(), Some(&Place::Line(2)));
    assert_eq!(error.kind(), &LoadErrorKind::IndexOutOfBounds { face: 0, index: 900, len: 1 });
    let text = format!("{}, line 2: face 0 names vertex 900, but there are 1 vertices", path.display());
    assert_eq!(error.to_string(), text);

    assert_eq!(load(file("no_extension", OFF.as_bytes())).unwrap().format, Format::Off, "as its content proves");
    for (name, content) in [("a.fbx", OFF), ("a.ZIP", OFF), ("a", "v 0 0 0\n"), ("obj", "v 0 0 0\n")] {
        let error = load(file(name, content.as_bytes())).unwrap_err();
        assert_eq!(error.kind().name(), "unsupported-format");
        assert!(
            error.to_string().ends_with(
                "supported formats are .obj, .stl, .ply, .off, .gltf, .glb, .3mf, .dae, .impinge, each also as .gz"
            ),
            "{error}"
        );
    }
    for format in Format::ALL {
        let error = load(file(&format!("none.{}", format.extension()), b"")).unwrap_err();
        assert_eq!(error.kind(), &LoadErrorKind::Empty);
    }
    let error = load(folder.path().join("missing.obj")).unwrap_err();
    assert!(matches!(error.kind(), LoadErrorKind::Io { kind: std::io::ErrorKind::NotFound, .. }));
    assert!(load(folder.path()).is_err());
    let error = load(file("text.stl", b"hello")).unwrap_err().to_string();
    assert!(error.ends_with("text.stl, line 1: expected solid, found \"hello\""), "{error}");
    let error = load(file("binary.obj", &[0, 1, 2])).unwrap_err().to_string();
    assert!(error.ends_with("byte 0: not OBJ, but binary data or UTF-16"), "{error}");
}

#[test]
fn external_buffers_are_read_only_from_the_folder_of_the_document() {
    let root = tempdir().unwrap();
    let folder = root.path().join("model");
    fs::create_dir_all(folder.join("sub")).unwrap();
    let bytes: Vec<u8> = [0_f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    for place in ["model/a b.bin", "model/sub/c.bin", "outside.bin"] {
        fs::write(root.path().join(place), &bytes).unwrap();
    }
    let load_with = |uri: &str, len: usize| {
        let text = format!(
            r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "{uri}", "byteLength": {len}}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]}}"#
        );
        let path = folder.join("a.gltf");
        fs::write(&path, text).unwrap();
        load(path)
    };
    for inside in ["a%20b.bin", "sub/c.bin", "./sub/./c.bin"] {
        let model = load_with(inside, 36).unwrap();
        assert_eq!(model.positions, Positions::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    }
    let absolute = root.path().join("outside.bin");
    for outside in ["../outside.bin", "sub/../../outside.bin", "%2E%2E/outside.bin", absolute.to_str().unwrap()] {
        assert_eq!(load_with(outside, 36).unwrap_err().kind().name(), "outside-folder", "{outside}");
    }
    let error = load_with("none.bin", 36).unwrap_err();
    assert_eq!((error.kind().name(), error.place()), ("io", Some(&Place::Entry("buffer 0".into()))));
    assert_eq!(load_with("sub/c.bin", 37).unwrap_err().kind().name(), "truncated");
}

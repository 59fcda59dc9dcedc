//! Invalid and hostile scenes: an error with a place, never a panic and never much work.

use std::{fs, path::Path};

use impinge_files::{Format, Limits, LoadErrorKind, SceneOptions, load, load_scene, parse_scene};
use impinge_testkit::generate::Rng;

use super::document;

#[test]
fn errors_name_the_file_and_the_node() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.gltf");
    for (nodes, message) in [
        (r#"{"mesh": 0}, {"mesh": 7}"#, "broken.gltf, node 1: expected mesh 7"),
        (r#"{"children": [1]}, {"mesh": 0, "rotation": [0, 0, 0, 0]}"#, "node 1: expected a quaternion of length 1"),
        (r#"{"mesh": 0, "scale": [1e300, 1, 1], "translation": [1e300, 0, 0]}"#, "node 0: vertex 0 has a coordinate"),
        (r#"{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"SCALE": 9}}}}"#, "node 0"),
        (r#"{"children": [0]}"#, "broken.gltf: expected a node without parent"),
    ] {
        fs::write(&path, document(&format!(r#""nodes": [{nodes}]"#))).unwrap();
        let error = load_scene(&path, &SceneOptions::default()).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
    let origin = Some([0.0, f64::NAN, 0.0]);
    let options = SceneOptions { origin, ..SceneOptions::default() };
    let error = parse_scene(document(r#""nodes": []"#).as_bytes(), Format::Gltf, &options).unwrap_err();
    assert!(error.to_string().contains("expected a finite origin"), "{error}");
    let far = "v 9 9 9\nv 0 0 0\nv 1e40 0 0\nv 0 1 0\nf 2 3 4\n";
    let error = parse_scene(far.as_bytes(), Format::Obj, &SceneOptions::default()).unwrap_err();
    assert_eq!(error.kind(), &LoadErrorKind::NonFinite { vertex: 2 });
}

#[test]
fn models_that_must_be_converted_name_the_command() {
    let folder = tempfile::tempdir().unwrap();
    for (name, extra) in [("a.ifc", "impinge[ifc]"), ("a.STEP", "impinge[step]"), ("a.stp", "impinge[step]")] {
        let path = folder.path().join(name);
        fs::write(&path, "ISO-10303-21;").unwrap();
        for error in [load(&path).unwrap_err(), load_scene(&path, &SceneOptions::default()).unwrap_err()] {
            assert_eq!(error.kind().name(), "unsupported-format");
            let hint = error.hint().unwrap();
            assert!(hint.contains(extra) && hint.contains("python -m impinge.convert"), "{error}");
        }
    }
}

#[test]
fn instances_are_limited_by_the_size_of_the_file() {
    // Thirty levels of nodes with two paths each: a billion parts.
    let mut nodes: Vec<String> = (0..30).map(|at| format!(r#"{{"children": [{0}, {0}]}}"#, at + 1)).collect();
    nodes.push(r#"{"mesh": 0}"#.into());
    let refused = |text: &str, what: &str| {
        let error = parse_scene(text.as_bytes(), Format::Gltf, &SceneOptions::default()).unwrap_err();
        assert!(matches!(error.kind(), LoadErrorKind::TooMany { .. }) && error.to_string().contains(what), "{error}");
    };
    refused(&document(&format!(r#""nodes": [{}]"#, nodes.join(","))), "nodes");
    // A node with long extras on 2^14 paths.
    nodes.drain(..16);
    let nodes: Vec<String> = (0..14).map(|at| format!(r#"{{"children": [{0}, {0}]}}"#, at + 1)).collect();
    let long = "x".repeat(10_000);
    let last = format!(r#"{{"mesh": 0, "extras": {{"note": "{long}"}}}}"#);
    refused(&document(&format!(r#""nodes": [{}, {last}]"#, nodes.join(","))), "bytes of names and extras");
    // A chain of nodes with meshes is read, with the innermost names of each path.
    let chain: Vec<String> =
        (0..2_000).map(|at| format!(r#"{{"mesh": 0, "name": "n{at}", "children": [{}]}}"#, at + 1)).collect();
    let text = document(&format!(r#""nodes": [{}, {{"mesh": 0}}]"#, chain.join(",")));
    let model = parse_scene(text.as_bytes(), Format::Gltf, &SceneOptions::default()).unwrap();
    assert_eq!((model.parts.len(), model.meshes.len()), (2001, 1));
    assert_eq!((model.parts[2000].details.path.len(), &*model.parts[2000].details.path[63]), (64, "n1999"));
}

#[test]
fn a_shared_mesh_counts_once() {
    let nodes = vec![r#"{"mesh": 0}"#; 50].join(",");
    let text = document(&format!(r#""nodes": [{nodes}]"#));
    let with =
        |triangles| SceneOptions { limits: Limits::default().with_max_triangles(triangles), ..SceneOptions::default() };
    assert_eq!(parse_scene(text.as_bytes(), Format::Gltf, &with(4)).unwrap().parts.len(), 50);
    let error = parse_scene(text.as_bytes(), Format::Gltf, &with(3)).unwrap_err();
    assert_eq!(error.kind(), &LoadErrorKind::TooMany { what: "triangles", count: 4, limit: 3 });
    let other = document(r#""nodes": [{"mesh": 0}, {"mesh": 1}]"#);
    let error = parse_scene(other.as_bytes(), Format::Gltf, &with(7)).unwrap_err();
    assert_eq!(error.kind(), &LoadErrorKind::TooMany { what: "triangles", count: 8, limit: 7 });
}

/// Replaces bytes of the JSON text and of the header by hostile ones.
fn mutate(rng: &mut Rng, bytes: &mut [u8], json: usize) {
    const BYTES: &[u8] = b"0123456789-eE.[]{}\":,nt\xFF\0";
    for _ in 0..=rng.integer(0, 1) {
        let reach = if rng.integer(0, 7) == 0 { bytes.len() } else { json };
        let at = rng.integer(0, reach as i64 - 1) as usize;
        bytes[at] = BYTES[rng.integer(0, BYTES.len() as i64 - 1) as usize];
    }
}

#[test]
fn corrupted_scenes_never_panic() {
    let robot = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robot.glb")).unwrap();
    let json = 20 + u32::from_le_bytes([robot[12], robot[13], robot[14], robot[15]]) as usize;
    let text = document(
        r#""scenes": [{"nodes": [0, 3]}], "nodes": [{"children": [1, 2], "name": "a"}, {"mesh": 0, "scale": [1, 1, 0], "extras": {"id": 1}},
        {"mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}, {"mesh": 0}]"#,
    );
    let mut rng = Rng::new(54);
    let [mut read, mut refused] = [0, 0];
    for round in 0..1_000 {
        let (mut bytes, reach, format) = match round % 2 {
            0 => (robot.clone(), json, Format::Glb),
            _ => (text.clone().into_bytes(), text.len(), Format::Gltf),
        };
        mutate(&mut rng, &mut bytes, reach);
        match parse_scene(&bytes, format, &SceneOptions::default()) {
            Ok(model) => {
                read += 1;
                assert!(model.parts.iter().all(|part| part.mesh < model.meshes.len()));
                model.into_scene(|mesh| mesh.into()).unwrap();
            }
            Err(error) => {
                refused += 1;
                assert!(!error.to_string().is_empty());
            }
        }
    }
    assert!(read > 150 && refused > 150, "{read} read, {refused} refused");
}

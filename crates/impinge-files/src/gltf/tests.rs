//! Tests with documents written by hand: every primitive mode, component type, kind of accessor,
//! buffer and error.

use base64::{Engine, prelude::BASE64_STANDARD};

use super::*;

/// Returns a document with one buffer that holds these bytes as base64 text.
fn document(buffer: &[u8], rest: &str) -> String {
    let (len, text) = (buffer.len(), BASE64_STANDARD.encode(buffer));
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {len}, "uri": "data:;base64,{text}"}}], {rest}}}"#
    )
}

fn read(bytes: &[u8], format: Format, folder: Option<&Path>) -> Result<Model, LoadError> {
    super::read(bytes, format, folder, &Limits::default())
}

fn parse(text: &str) -> Result<Model, LoadError> {
    read(text.as_bytes(), Format::Gltf, None)
}

fn error(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Returns five points of a strip, (0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 2, 0), and u8
/// indices 4 3 2 1 0 3.
fn strip() -> Vec<u8> {
    let mut bytes = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0., 0., 2., 0.]);
    bytes.extend([4, 3, 2, 1, 0, 3]);
    bytes
}

const STRIP: &str = r#""bufferViews": [{"buffer": 0, "byteLength": 60}, {"buffer": 0, "byteOffset": 60, "byteLength": 6}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}]"#;

/// Returns a document with the strip as one mesh with these primitives, and further entries.
fn with_primitives(primitives: &str, rest: &str) -> String {
    document(&strip(), &format!(r#"{STRIP}, "meshes": [{{"name": "m", "primitives": [{primitives}]}}] {rest}"#))
}

#[test]
fn every_primitive_mode_is_read_with_and_without_indices() {
    let mode = |mode: u32, indices: &str| {
        let model =
            parse(&with_primitives(&format!(r#"{{"attributes": {{"POSITION": 0}}, "mode": {mode} {indices}}}"#), ""));
        let model = model.unwrap();
        assert_eq!(model.sources, (0..model.faces.len() as u32).collect::<Vec<_>>());
        (model.faces, model.warnings.iter().map(|w| (w.kind, w.count)).collect::<Vec<_>>())
    };
    let indexed = r#", "indices": 1"#;
    assert_eq!(mode(4, ""), (vec![[0, 1, 2]], vec![(WarningKind::LeftoverCorners, 2)]));
    assert_eq!(mode(4, indexed), (vec![[4, 3, 2], [1, 0, 3]], vec![]));
    assert_eq!(mode(5, ""), (vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], vec![]));
    assert_eq!(mode(5, indexed).0, [[4, 3, 2], [3, 1, 2], [2, 1, 0], [1, 3, 0]]);
    assert_eq!(mode(6, ""), (vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]], vec![]));
    assert_eq!(mode(6, indexed).0, [[4, 3, 2], [4, 2, 1], [4, 1, 0], [4, 0, 3]]);
    for skipped in 0..4 {
        assert_eq!(mode(skipped, indexed), (vec![], vec![(WarningKind::NotTriangles, 1)]));
    }
    let text = with_primitives(r#"{"attributes": {"POSITION": 0}, "mode": 7}"#, "");
    assert_eq!(error(&text), "expected a primitive mode from 0 to 6, found \"7\"");
}

#[test]
fn transforms_compose_and_mirrors_reverse_the_winding() {
    let nodes = r#", "scene": 0, "scenes": [{"nodes": [0, 3]}], "nodes": [
        {"children": [1, 2], "translation": [10, 0, 0], "rotation": [0, 0, 0.70710677, 0.70710677]},
        {"mesh": 0, "name": "turned", "scale": [2, 2, 2]},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
        {"mesh": 0, "translation": [0.1, 0, 0]},
        {"mesh": 0, "name": "not in the scene"}]"#;
    let model = parse(&with_primitives(r#"{"attributes": {"POSITION": 0}}"#, nodes)).unwrap();
    assert_eq!(model.faces, [[0, 1, 2], [5, 7, 6], [10, 11, 12]]);
    assert_eq!(model.parts, ["turned", "m", "m"]);
    assert_eq!(model.part_of, [0, 1, 2]);
    assert_eq!(model.unit, Some(Unit::Meter));
    let Positions::F32(p) = model.positions else { panic!("glTF is f32") };
    // The rotation by 90 degrees is exact, although the length of its quaternion is not exactly 1.
    assert_eq!(p[1..3], [[10.0, 2.0, 0.0], [8.0, 0.0, 0.0]]);
    assert_eq!(p[6..8], [[10.0, -1.0, 5.0], [9.0, 0.0, 5.0]]);
    // Rounded once: the sum of 1 and the f64 nearest to 0.1.
    assert_eq!(p[11], [1.1_f64 as f32, 0.0, 0.0]);
}

#[test]
fn without_scenes_all_roots_are_loaded_and_without_nodes_all_meshes() {
    let primitive = r#"{"attributes": {"POSITION": 0}}"#;
    let count = |rest: &str| parse(&with_primitives(primitive, rest)).unwrap().faces.len();
    assert_eq!(count(""), 1);
    assert_eq!(count(r#", "nodes": [{"mesh": 0}, {"children": [0]}, {"mesh": 0}]"#), 2);
    assert_eq!(count(r#", "nodes": [{"mesh": 0}], "scenes": [{}, {"nodes": [0]}]"#), 0);
    assert_eq!(count(r#", "nodes": [{"mesh": 0}], "scenes": [{}, {"nodes": [0]}], "scene": 1"#), 1);
}

#[test]
fn primitives_share_vertices() {
    let primitives =
        r#"{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 0}, "indices": 1}, {"attributes": {}}"#;
    let model = parse(&with_primitives(primitives, "")).unwrap();
    assert_eq!((model.positions.len(), model.faces.len(), model.parts.len()), (5, 3, 1));
}

/// Loads one triangle whose positions are an accessor with these properties, with indices 0 1 2 of
/// this type.
fn triangle(bytes: &[u8], accessor: &str) -> Result<Vec<[f32; 3]>, LoadError> {
    let len = bytes.len();
    let text = document(
        bytes,
        &format!(
            r#""bufferViews": [{{"buffer": 0, "byteLength": {len}, "byteStride": 8}}, {{"buffer": 0, "byteLength": {len}}}],
            "extensionsRequired": ["KHR_mesh_quantization", "KHR_materials_unlit"],
            "accessors": [{{"count": 3, "type": "VEC3", {accessor}}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]"#
        ),
    );
    match parse(&text)?.positions {
        Positions::F32(p) => Ok(p),
        Positions::F64(_) => panic!("glTF is f32"),
    }
}

#[test]
fn quantized_positions_are_read_in_every_component_type() {
    let bytes: Vec<u8> = (0..24).map(|i| if i % 8 == 1 { 0x80 } else { i * 10 }).collect();
    let p = triangle(&bytes, r#""bufferView": 0, "componentType": 5121"#).unwrap();
    assert_eq!(p, [[0.0, 128.0, 20.0], [80.0, 128.0, 100.0], [160.0, 128.0, 180.0]]);
    let p = triangle(&bytes, r#""bufferView": 0, "componentType": 5121, "normalized": true"#).unwrap();
    assert_eq!(p[1], [80.0 / 255.0, 128.0 / 255.0, 100.0 / 255.0]);
    let p = triangle(&bytes, r#""bufferView": 0, "componentType": 5120, "normalized": true"#).unwrap();
    assert_eq!(p[0], [0.0, -1.0, 20.0 / 127.0]);
    let words: Vec<u8> =
        [1_u16, 0x8000, 3, 0, 5, 6, 7, 0, 9, 10, 0xFFFF].iter().flat_map(|x| x.to_le_bytes()).collect();
    let p = triangle(&words, r#""bufferView": 0, "componentType": 5122"#).unwrap();
    assert_eq!(p, [[1.0, -32768.0, 3.0], [5.0, 6.0, 7.0], [9.0, 10.0, -1.0]]);
    let p = triangle(&words, r#""bufferView": 0, "componentType": 5123, "normalized": true"#).unwrap();
    assert_eq!(p[2], [9.0 / 65535.0, 10.0 / 65535.0, 1.0]);
}

#[test]
fn sparse_accessors_replace_elements() {
    let mut bytes = floats(&[1., 2., 3., 4., 5., 6., 7., 8., 9., -1., -2., -3.]);
    bytes.extend([2, 0]);
    let sparse = r#""sparse": {"count": 1, "indices": {"bufferView": 1, "byteOffset": 48, "componentType": 5123},
        "values": {"bufferView": 1, "byteOffset": 36}}"#;
    let p = triangle(&bytes, &format!(r#""bufferView": 1, "componentType": 5126, {sparse}"#)).unwrap();
    assert_eq!(p, [[1., 2., 3.], [4., 5., 6.], [-1., -2., -3.]]);
    let p = triangle(&bytes, &format!(r#""componentType": 5126, {sparse}"#)).unwrap();
    assert_eq!(p, [[0.; 3], [0.; 3], [-1., -2., -3.]]);
    bytes[48] = 3;
    let e = triangle(&bytes, &format!(r#""componentType": 5126, {sparse}"#)).unwrap_err();
    assert_eq!(e.to_string(), "accessor 0: expected a sparse index that exists, found \"3 of 3\"");
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

#[test]
fn the_chunks_of_a_glb_file_are_read() {
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 66}}], {STRIP},
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}]}}"#
    );
    let bytes = glb(&json, &strip());
    assert_eq!(read(&bytes, Format::Glb, None).unwrap().faces, [[4, 3, 2], [1, 0, 3]]);
    let tail = [&bytes[..], b"tail"].concat();
    assert_eq!(read(&tail, Format::Glb, None).unwrap().warnings[0].kind, WarningKind::TrailingBytes);
    let error = |bytes: &[u8]| read(bytes, Format::Glb, None).unwrap_err().to_string();
    let hint = "(the file is cut off or its counts are wrong)";
    let (len, cut) = (bytes.len(), bytes.len() - 1);
    let text = format!("byte 8: {len} bytes promised, but there is room for {cut} at most {hint}");
    assert_eq!(error(&bytes[..cut]), text);
    let text = format!("buffer 0: 66 bytes promised, but there is room for 65 at most {hint}");
    assert_eq!(error(&glb(&json, &strip()[..65])), text);
    let mut old = bytes.clone();
    old[4] = 1;
    assert_eq!(
        error(&old),
        "byte 4: needs GLB version 1, which is not supported (convert it to glTF 2.0, for example with \
        `npx gltf-pipeline -i in.gltf -o out.gltf`)"
    );
    assert!(error(&glb("{", &[])).starts_with("JSON chunk, line 1 column 1: expected a glTF document"));
}

#[test]
fn errors_name_the_missing_feature() {
    let required = |e: &str| error(&document(&[], &format!(r#""extensionsRequired": ["{e}"]"#)));
    assert_eq!(
        required("KHR_draco_mesh_compression"),
        "needs glTF extension KHR_draco_mesh_compression, which is not supported \
        (decompress it, for example with `npx @gltf-transform/cli copy in.glb out.glb`)"
    );
    assert!(required("EXT_meshopt_compression").contains("EXT_meshopt_compression"));
    assert_eq!(required("EXT_new"), "needs glTF extension EXT_new, which is not supported");
    // The extension is used and not required, but there is no data as a fallback.
    let text = document(
        &[],
        r#""accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "extensions": {"KHR_draco_mesh_compression": {}}}]}]"#,
    );
    assert!(error(&text).contains("KHR_draco_mesh_compression"));
    let compressed =
        r#"{"attributes": {"POSITION": 0}, "indices": 1, "extensions": {"KHR_draco_mesh_compression": {}}}"#;
    assert_eq!(parse(&with_primitives(compressed, "")).unwrap().faces.len(), 2);
    let text = with_primitives(compressed, "").replace(r#"{"bufferView": 1,"#, "{");
    assert!(error(&text).contains("KHR_draco_mesh_compression"));
    // In version 1, lists are objects.
    for lists in ["", r#", "buffers": {}, "meshes": {}, "nodes": {}, "scenes": {}"#] {
        let text = error(&format!(r#"{{"asset": {{"version": "1.0"}} {lists}}}"#));
        assert!(text.starts_with("needs glTF version \"1.0\"") && text.contains("npx gltf-pipeline"), "{text}");
    }
    assert!(error(r#"{"asset": {"version": "2.1", "minVersion": "2.1"}}"#).contains("\"2.1\""));
    assert!(parse(r#"{"asset": {"version": "2.1"}}"#).unwrap().faces.is_empty());
    let beside = r#"{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": "a.bin"}]}"#;
    assert_eq!(error(beside), "buffer 0: needs the file \"a.bin\" beside it, which is not supported");
    let outside = beside.replace("a.bin", "../a.bin");
    assert_eq!(error(&outside), "buffer 0: \"../a.bin\" is not a file inside this file's folder");
}

#[test]
fn cycles_are_errors_and_deep_trees_are_read() {
    let cycle = |nodes: &str| {
        error(&with_primitives(r#"{"attributes": {"POSITION": 0}}"#, &format!(r#", "nodes": [{nodes}]"#)))
    };
    assert_eq!(cycle(r#"{"children": [0]}"#), "expected a node without parent, found \"a cycle of nodes\"");
    let inside = "expected nodes that form no cycle, found \"one that is inside of itself\"";
    assert_eq!(cycle(r#"{"children": [1]}, {"children": [2]}, {"children": [1]}"#), format!("node 1: {inside}"));
    assert_eq!(cycle(r#"{"children": [1]}, {"children": [2, 2]}, {"children": [1]}"#), format!("node 1: {inside}"));
    assert_eq!(cycle(r#"{"children": [9]}"#), "expected node 9, found nothing");
    assert_eq!(cycle(r#"{"mesh": 9}"#), "node 0: expected mesh 9, found nothing");
    // A chain of 100,000 nodes does not overflow the stack.
    let mut nodes: String = (1..100_000).map(|i| format!(r#"{{"children": [{i}]}},"#)).collect();
    nodes.push_str(r#"{"mesh": 0}"#);
    let model = parse(&with_primitives(r#"{"attributes": {"POSITION": 0}}"#, &format!(r#", "nodes": [{nodes}]"#)));
    assert_eq!(model.unwrap().faces.len(), 1);
    let deep =
        format!(r#"{{"asset": {{"version": "2.0"}}, "extras": {}{}}}"#, "[".repeat(100_000), "]".repeat(100_000));
    assert!(parse(&deep).is_ok());
}

#[test]
fn nodes_are_loaded_once_per_path() {
    let nodes = r#", "scene": 0, "scenes": [{"nodes": [0, 3, 3]}], "nodes": [
        {"children": [1, 2]}, {"children": [3], "translation": [10, 0, 0]}, {"children": [3], "scale": [-1, 1, 1]},
        {"mesh": 0, "name": "shared"}]"#;
    let model = parse(&with_primitives(r#"{"attributes": {"POSITION": 0}}"#, nodes)).unwrap();
    assert_eq!(model.faces, [[0, 1, 2], [5, 7, 6], [10, 11, 12], [15, 16, 17]]);
    assert_eq!(model.parts, ["shared"; 4]);
    assert_eq!([0, 1, 6].map(|i| model.positions.get(i)[0]), [10.0, 11.0, -1.0]);
    let shared = model.warnings.iter().find(|w| w.kind == WarningKind::SharedNodes).unwrap();
    assert_eq!((shared.count, &shared.first), (1, &Some(Place::Entry("node 3".into()))));
    // Every node doubles the number of paths to the next.
    let doubling: String = (1..64).map(|i| format!(r#"{{"children": [{i}, {i}]}},"#)).collect();
    let text = with_primitives(r#"{"attributes": {"POSITION": 0}}"#, &format!(r#", "nodes": [{doubling} {{}}]"#));
    assert!(error(&text).contains("nodes exceed the limit of 262144"));
}

#[test]
fn accessors_without_data_are_zeros_within_a_limit() {
    let zeros = |count: u64| {
        let rest = format!(
            r#""accessors": [{{"componentType": 5126, "count": {count}, "type": "VEC3"}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]"#
        );
        parse(&document(&[0; 4], &rest))
    };
    let model = zeros(6).unwrap();
    assert_eq!((model.positions, model.faces.len()), (Positions::F32(vec![[0.0; 3]; 6]), 2));
    // They cannot be used to take any amount of memory.
    let text = "accessor 0: 3000 elements without data exceed the limit of 2048";
    assert_eq!(zeros(3000).unwrap_err().to_string(), text);
}

#[test]
fn gpu_instances_are_placed() {
    // Translations, then rotations of which the second is 180 degrees about Z, then scales of which
    // the last mirrors.
    let mut bytes = strip();
    bytes.extend([0, 0]);
    bytes.extend(floats(&[0., 0., 1., 0., 0., 2., 0., 0., 3.]));
    bytes.extend(floats(&[0., 0., 0., 1., 0., 0., 1., 0., 0., 0., 0., 1.]));
    bytes.extend(floats(&[1., 1., 1., 2., 2., 2., -1., 1., 1.]));
    let load = |attributes: &str, count: u32| {
        parse(&document(
            &bytes,
            &format!(
                r#""extensionsRequired": ["EXT_mesh_gpu_instancing"],
                "bufferViews": [{{"buffer": 0, "byteLength": 60}}, {{"buffer": 0, "byteOffset": 68, "byteLength": 36}},
                {{"buffer": 0, "byteOffset": 104, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 152, "byteLength": 36}}],
                "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}},
                {{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}},
                {{"bufferView": 2, "componentType": 5126, "count": {count}, "type": "VEC4"}},
                {{"bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC3"}}],
                "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "nodes": [{{"mesh": 0, "name": "tree",
                "translation": [10, 0, 0], "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes": {attributes}}}}}}}]"#
            ),
        ))
    };
    let model = load(r#"{"TRANSLATION": 1, "ROTATION": 2, "SCALE": 3, "_ID": 77}"#, 3).unwrap();
    assert_eq!(model.faces, [[0, 1, 2], [3, 4, 5], [6, 8, 7]]);
    assert_eq!(model.parts, ["tree"; 3]);
    assert_eq!(model.part_of, [0, 1, 2]);
    assert_eq!([1, 4, 7].map(|i| model.positions.get(i)), [[11., 0., 1.], [8., 0., 2.], [9., 0., 3.]]);
    assert!(model.warnings.is_empty());
    assert_eq!(load(r#"{"TRANSLATION": 1}"#, 3).unwrap().faces.len(), 3);
    let single = load(r#"{"_ID": 1}"#, 3).unwrap();
    assert_eq!((single.faces.len(), single.warnings[0].kind), (1, WarningKind::SingleInstances));
    let text = load(r#"{"TRANSLATION": 1, "ROTATION": 2}"#, 2).unwrap_err().to_string();
    let place = "node 0, EXT_mesh_gpu_instancing: ";
    assert_eq!(text, format!("{place}expected instance attributes of one length, found \"different lengths\""));
    assert_eq!(
        load(r#"{"TRANSLATION": 9}"#, 3).unwrap_err().to_string(),
        format!("{place}expected accessor 9, found nothing")
    );
}

#[test]
fn errors_name_the_entry() {
    let bad = |from: &str, to: &str| {
        let text = with_primitives(r#"{"attributes": {"POSITION": 0}, "indices": 1}"#, "");
        assert!(text.contains(from));
        error(&text.replacen(from, to, 1))
    };
    let hint = "(the file is cut off or its counts are wrong)";
    let text = format!("accessor 0: 4000000 elements promised, but there is room for 5 at most {hint}");
    assert_eq!(bad(r#""count": 5"#, r#""count": 4000000"#), text);
    assert_eq!(bad(r#""count": 5"#, r#""count": 4"#), "accessor 1: face 0 names vertex 4, but there are 4 vertices");
    assert_eq!(
        bad("5126", "5125"),
        "accessor 0: expected a component type out of [5126, 5120, 5121, 5122, 5123], found \"5125\""
    );
    assert_eq!(bad("VEC3", "VEC2"), "accessor 0: expected an accessor of type VEC3, found \"VEC2\"");
    assert_eq!(bad(r#""indices": 1"#, r#""indices": 7"#), "expected accessor 7, found nothing");
    let text = format!(
        "accessor 0: 66 bytes of buffer 0 up to the end of view 0 promised, but there is room for 66 at most {hint}"
    );
    assert_eq!(bad(r#""byteLength": 60}"#, r#""byteLength": 67}"#), text.replacen("66", "67", 1));
    assert_eq!(
        bad(r#""byteLength": 60"#, r#""byteLength": 60, "byteStride": 4"#),
        "accessor 0: expected a byte stride of 12 or more, found \"4\""
    );
    assert!(bad("2.0", "2.0\"\"").starts_with("line 1: expected a glTF document"));
    assert!(
        error(r#"{"asset": {"version": "2.0"}, "nodes": [{"rotation": [0, 0, 0, 0]}]}"#)
            .starts_with("node 0: expected a quaternion")
    );
    let nan =
        triangle(&floats(&[0., f32::NAN, 0., 0., 0., 0., 0., 0., 0.]), r#""bufferView": 1, "componentType": 5126"#);
    assert_eq!(
        nan.unwrap_err().to_string(),
        "accessor 0: vertex 0 has a coordinate that is NaN, infinite or too large"
    );
    let far = r#", "nodes": [{"mesh": 0, "scale": [1e300, 1, 1]}]"#;
    let text =
        "accessor 0: vertex 1 has a coordinate that is NaN, infinite or too large (after the transform of its node)";
    assert_eq!(error(&with_primitives(r#"{"attributes": {"POSITION": 0}}"#, far)), text);
}

#[test]
fn the_number_of_instances_is_limited() {
    // Three bytes per node; together more triangles than any memory holds.
    let nodes = vec![r#"{"mesh":0}"#; 30_000].join(",");
    let accessor = r#""accessors": [{"componentType": 5126, "count": 16000000, "type": "VEC3"}]"#;
    let text = document(
        &[],
        &format!(
            r#"{accessor}, "nodes": [{nodes}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]"#
        ),
    );
    assert_eq!(parse(&text).unwrap_err().kind().name(), "too-many");
}

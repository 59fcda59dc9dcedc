//! Tests of rigs in files that refer to the same data many times.

use impinge_files::{LoadErrorKind, parse_rig};

/// Returns a GLB file with a triangle that joint 0 of a skin moves: accessors 0 to 2 are positions,
/// joints and weights. Accessor 3 is the number 0.
fn skinned(json: &str) -> Vec<u8> {
    let mut binary: Vec<u8> =
        [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    binary.extend([0; 12]);
    binary.extend([1_f32, 0.0, 0.0, 0.0].repeat(3).iter().flat_map(|x| x.to_le_bytes()));
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":96}}],"bufferViews":[{{"buffer":0,"byteLength":36}},
        {{"buffer":0,"byteOffset":36,"byteLength":12}},{{"buffer":0,"byteOffset":48,"byteLength":48}}],"accessors":[
        {{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},{{"bufferView":1,"componentType":5121,"count":3,"type":"VEC4"}},
        {{"bufferView":2,"componentType":5126,"count":3,"type":"VEC4"}},
        {{"bufferView":0,"componentType":5126,"count":1,"type":"SCALAR"}}],{json}}}"#
    );
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", &binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

const PRIMITIVE: &str = r#"{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}"#;

#[test]
fn rigs_with_many_skins_take_nearly_linear_time() {
    for skins in [20_000, 80_000] {
        let nodes: Vec<String> = (0..skins).map(|skin| format!(r#"{{"mesh":0,"skin":{skin}}}"#)).collect();
        let one = vec![r#"{"joints":[0]}"#; skins].join(",");
        let json =
            format!(r#""nodes":[{}],"skins":[{one}],"meshes":[{{"primitives":[{PRIMITIVE}]}}]"#, nodes.join(","));
        let rig = parse_rig(&skinned(&json)).unwrap();
        assert_eq!((rig.skin().joints().len(), rig.skin().faces().len()), (skins, skins));
    }
}

#[test]
fn chains_of_bones_take_nearly_linear_time() {
    for bones in [20_000, 80_000] {
        let chain: String = (1..=bones).map(|bone| format!(r#"{{"children":[{bone}]}},"#)).collect();
        let json = format!(
            r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{chain}{{"mesh":0,"skin":0}}],"skins":[{{"joints":[{}]}}],
            "meshes":[{{"primitives":[{PRIMITIVE}]}}]"#,
            bones - 1
        );
        assert_eq!(parse_rig(&skinned(&json)).unwrap().skeleton().bones().len(), bones + 1);
    }
}

#[test]
fn primitives_that_nodes_repeat_are_counted_before_they_are_read() {
    let lines = vec![r#"{"mode":1,"attributes":{"POSITION":0}}"#; 20_000].join(",");
    let nodes = vec![r#"{"mesh":0}"#; 20_000].join(",");
    let json = format!(r#""nodes":[{nodes}],"meshes":[{{"primitives":[{lines}]}}]"#);
    let error = parse_rig(&skinned(&json)).unwrap_err();
    assert!(matches!(error.kind(), LoadErrorKind::TooMany { what: "primitives and morph targets", .. }), "{error}");
}

#[test]
fn channels_of_a_mesh_with_many_primitives_take_nearly_linear_time() {
    for many in [10_000, 40_000] {
        let primitives = vec![r#"{"attributes":{},"targets":[{}]}"#; many].join(",");
        let channels = vec![r#"{"sampler":0,"target":{"node":0,"path":"weights"}}"#; many].join(",");
        let json = format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{primitives}]}}],
            "animations":[{{"channels":[{channels}],"samplers":[{{"input":3,"output":3}}]}}]"#
        );
        let rig = parse_rig(&skinned(&json)).unwrap();
        assert_eq!((rig.skin().morphs().len(), rig.animations().len()), (1, 1));
    }
}

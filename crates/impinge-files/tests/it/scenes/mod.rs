//! Tests of scenes from files: shared meshes, poses, names and keys.

mod bad_files;
mod identity;
mod instances;
mod real_files;

use base64::{Engine, prelude::BASE64_STANDARD};
use impinge_files::{Format, SceneModel, SceneOptions, parse_scene};

/// Corners of a tetrahedron, whose faces are counterclockwise from outside, and four translations.
const FLOATS: [f32; 24] = [
    0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, //
    9.0, 0.0, 0.0, 5.0, 0.0, 0.0, 7.0, 0.0, 0.0, 3.0, 0.5, 0.25,
];
const FACES: [u8; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];

/// Returns a glTF document whose meshes `a` and `b` are the tetrahedron. Accessor 2 holds the
/// translations. `rest` has the nodes and further entries.
pub(crate) fn document(rest: &str) -> String {
    let mut bytes: Vec<u8> = FLOATS.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(FACES);
    let base64 = BASE64_STANDARD.encode(&bytes);
    let mesh = |name: &str| {
        format!(r#"{{"name": "{name}", "primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}"#)
    };
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {}, "uri": "data:;base64,{base64}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 96, "byteLength": 12}},
            {{"buffer": 0, "byteOffset": 48, "byteLength": 48}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
            {{"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"}},
            {{"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"}}],
        "meshes": [{}, {}], {rest}}}"#,
        bytes.len(),
        mesh("a"),
        mesh("b")
    )
}

fn parse(text: &str, options: &SceneOptions) -> SceneModel {
    parse_scene(text.as_bytes(), Format::Gltf, options).unwrap()
}

/// Returns the parts of a document with these nodes, all of which are roots unless they are
/// children.
fn scene(nodes: &str) -> SceneModel {
    parse(&document(&format!(r#""nodes": [{nodes}]"#)), &SceneOptions::default())
}

fn names(model: &SceneModel) -> Vec<&str> {
    model.parts.iter().map(|part| &*part.name).collect()
}

fn keys(model: &SceneModel) -> Vec<&str> {
    model.parts.iter().map(|part| &*part.details.key).collect()
}

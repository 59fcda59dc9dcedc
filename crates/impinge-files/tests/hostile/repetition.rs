//! Files that repeat their content: by instances, by references, or by names. Each file comes in
//! two sizes. Memory stays within the same multiple of the size, because the content is counted
//! before it is read.

use std::fs;

use impinge_files::{Format, LoadError, LoadErrorKind, Model, load, parse};

use super::{MEMORY, PER_BYTE, PER_FILE, glb_of, package_of};

/// Runs a reader. Asserts that it takes no more memory than a file of `size` bytes may.
fn measured(size: usize, read: impl FnOnce() -> Result<Model, LoadError>) -> Result<Model, LoadError> {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let result = read();
    let used = MEMORY.peak_usage() - before;
    assert!(used <= PER_BYTE * size + PER_FILE, "{used} bytes for a file of {size}");
    result
}

/// Asserts that a file is refused because of the number of these items.
fn assert_too_many(items: &str, size: usize, read: impl FnOnce() -> Result<Model, LoadError>) {
    let error = measured(size, read).unwrap_err();
    assert!(matches!(error.kind(), LoadErrorKind::TooMany { what, .. } if *what == items), "{items}: {error}");
    assert!(error.place().is_some() && error.hint().is_some(), "{error}");
}

const TRIANGLE: &str = "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>\
    <vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh>";

fn model(attributes: &str, resources: &str, item: usize) -> String {
    format!("<model {attributes}><resources>{resources}</resources><build><item objectid=\"{item}\"/></build></model>")
}

pub(super) fn repeated_content_is_counted_before_it_is_read() {
    for levels in [24, 48] {
        let mut objects = format!("<object id=\"0\" name=\"{}\">{TRIANGLE}</object>", "n".repeat(255));
        for id in 1..=levels {
            let inner = format!("<component objectid=\"{}\"/>", id - 1);
            objects += &format!("<object id=\"{id}\"><components>{inner}{inner}</components></object>");
        }
        let text = model("", &objects, levels);
        assert_too_many("vertices", text.len(), || parse(&package_of(&[("3D/3dmodel.model", &text)]), Format::ThreeMf));
    }
    // As many instances as the limits allow: 100 bytes for each vertex and each triangle.
    let doubled: String = (1..=18)
        .map(|id| {
            let inner = format!("<component objectid=\"{}\"/>", id - 1);
            format!("<object id=\"{id}\"><components>{inner}{inner}</components></object>")
        })
        .collect();
    let file =
        package_of(&[("3D/3dmodel.model", &model("", &format!("<object id=\"0\">{TRIANGLE}</object>{doubled}"), 18))]);
    let items = (3 + 1) << 18;
    let whole = measured(file.len() + items, || parse(&file, Format::ThreeMf)).unwrap();
    assert_eq!(whole.faces.len(), 1 << 18);
    drop(whole);
    // Three vertices at a time: long names take more room than vertices.
    for many in [70_000, 140_000] {
        let components = "<component objectid=\"1\"/>".repeat(many);
        let objects = format!(
            "<object id=\"1\" name=\"{}\">{TRIANGLE}</object><object id=\"2\"><components>{components}</components></object>",
            "n".repeat(255)
        );
        let text = model("", &objects, 2);
        let file = package_of(&[("3D/3dmodel.model", &text)]);
        assert!(parse(&file, Format::ThreeMf).is_err_and(|e| e.to_string().contains("bytes of names")));
    }
    for many in [100, 1000] {
        // A sparse accessor that a mesh decodes for each primitive, and nodes that repeat the mesh.
        let count = 20_000;
        let primitives = vec![r#"{"attributes":{"POSITION":0},"indices":1}"#; many].join(",");
        let nodes = vec![r#"{"mesh":0}"#; many].join(",");
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],"meshes":[{{"primitives":[{primitives}]}}],"accessors":[
            {{"componentType":5126,"count":1,"type":"VEC3","bufferView":1}},{{"componentType":5121,"count":1,"type":"SCALAR",
            "sparse":{{"count":{count},"indices":{{"bufferView":0,"componentType":5121}},"values":{{"bufferView":0}}}}}}],
            "bufferViews":[{{"buffer":0,"byteLength":{count}}},{{"buffer":0,"byteLength":12}}],"buffers":[{{"byteLength":{count}}}]}}"#
        );
        let file = glb_of(&json, &vec![0; count]);
        assert_too_many("sparse elements", file.len(), || parse(&file, Format::Glb));
        // The same mesh at many places.
        let dense =
            json.replace(r#""count":1,"type":"VEC3","bufferView":1"#, r#""count":1600,"type":"VEC3","bufferView":0"#);
        let dense = dense.replace(r#","indices":1"#, "");
        let file = glb_of(&dense, &vec![0; count]);
        assert_too_many("corners of triangles", file.len(), || parse(&file, Format::Glb));
    }
}

pub(super) fn names_and_references_are_looked_up_once() {
    for many in [10_000, 100_000] {
        let attributes: String = (0..many).map(|i| format!(" a{i}=\"\"")).collect();
        let production = "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"";
        let text = |prefixes: usize| {
            model(
                &format!("requiredextensions=\"{}\"{attributes} {production}", "p ".repeat(prefixes)),
                "<object id=\"0\"/>",
                0,
            )
        };
        let read = |text: &str| parse(&package_of(&[("3D/3dmodel.model", text)]), Format::ThreeMf);
        let (fine, repeated) = (text(1000), text(many));
        assert!(measured(fine.len(), || read(&fine)).is_ok());
        assert_too_many("required extensions", repeated.len(), || read(&repeated));
    }
    for many in [2_000, 8_000] {
        // Parts under other capitals than the references to them.
        let names: Vec<String> = (0..many).map(|i| format!("3D/p{i}.model")).collect();
        let component = |i: usize| format!("<component objectid=\"1\" p:path=\"/3d/P{i}.MODEL\"/>");
        let components: String = (0..many).map(component).collect();
        let start = model("", &format!("<object id=\"2\"><components>{components}</components></object>"), 2);
        let inner = "<model><resources><object id=\"1\"/></resources></model>";
        let mut entries: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), inner)).collect();
        entries.push(("3D/3dmodel.model", &start));
        let file = package_of(&entries);
        assert!(measured(start.len() + file.len(), || parse(&file, Format::ThreeMf)).is_ok());
    }
    // One part under many spellings of its path is read once.
    for spellings in [16, 256] {
        let spelled = |i: usize| -> String {
            let capital = |(k, c): (usize, char)| if i >> k & 1 == 1 { c.to_ascii_uppercase() } else { c };
            "abcdefgh".chars().enumerate().map(capital).collect()
        };
        let component = |i: usize| format!("<component objectid=\"1\" p:path=\"/3D/{}.model\"/>", spelled(i));
        let components: String = (0..spellings).map(component).collect();
        let start = model("", &format!("<object id=\"2\"><components>{components}</components></object>"), 2);
        let large = format!("<model><resources><object id=\"1\"/>{}</resources></model>", "<a/>".repeat(10_000));
        let file = package_of(&[("3D/abcdefgh.model", &large), ("3D/3dmodel.model", &start)]);
        assert!(measured(start.len() + large.len(), || parse(&file, Format::ThreeMf)).is_ok());
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("b.bin"), vec![0; 4 << 20]).unwrap();
    for many in [20, 200] {
        // Spellings of one file, of which one byte is used.
        let uri = |i: usize| format!("{}b{}bin", "./".repeat(i / 2), if i.is_multiple_of(2) { "." } else { "%2e" });
        let buffers: Vec<String> = (0..many).map(|i| format!(r#"{{"uri":"{}","byteLength":1}}"#, uri(i))).collect();
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{}]}}"#, buffers.join(","));
        let path = folder.path().join("a.gltf");
        fs::write(&path, &text).unwrap();
        assert!(measured(text.len(), || load(&path)).is_ok());
    }
    for levels in [1_000, 4_000] {
        // Arrays within arrays: the text of each one is read without the text inside of it.
        let sources: String = (0..levels).map(|i| {
            format!("<source id=\"s{i}\"><technique_common><accessor source=\"#a{i}\" count=\"1\"/></technique_common></source>\
                <triangles><input semantic=\"VERTEX\" source=\"#s{i}\"/><p>0 0 0</p></triangles>")
        }).collect();
        let arrays: String = (0..levels).map(|i| format!("<float_array id=\"a{i}\">0 0 0 ")).collect();
        let text = format!(
            "<COLLADA version=\"1.4.1\"><library_geometries><geometry><mesh>{arrays}{}{sources}</mesh></geometry>\
            </library_geometries></COLLADA>",
            "</float_array>".repeat(levels)
        );
        let model = measured(text.len(), || parse(text.as_bytes(), Format::Collada)).unwrap();
        assert_eq!(model.faces.len(), levels);
    }
}

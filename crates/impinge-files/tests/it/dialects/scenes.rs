//! Rows and samples of glTF, 3MF and COLLADA.

use std::io::Write;

use base64::{Engine, prelude::BASE64_STANDARD};
use impinge_files::{Format, WarningKind};

use super::{Dialect, Expect};

pub(crate) fn rows() -> Vec<Dialect> {
    gltf().into_iter().chain(three_mf()).chain(collada()).collect()
}

fn read(count: usize, warnings: &'static [WarningKind]) -> Expect {
    Expect::Triangles { count, warnings }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn utf16(text: &str) -> Vec<u8> {
    format!("\u{FEFF}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect()
}

/// Returns the corners (0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0) as f32.
fn square() -> Vec<u8> {
    [0_f32, 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Returns a document of version 2.0 whose buffer, view and accessor 0 are the square.
fn document(rest: &str) -> String {
    let text = BASE64_STANDARD.encode(square());
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 48, "uri": "data:;base64,{text}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
        {{"componentType": 5126, "count": 3, "type": "VEC3"}}], {rest}}}"#
    )
}

/// Returns a document with one mesh of this primitive, and further entries.
fn with_primitive(primitive: &str, rest: &str) -> Vec<u8> {
    document(&format!(r#""meshes": [{{"primitives": [{{{primitive}}}]}}] {rest}"#)).into_bytes()
}

const STRIP: &str = r#""attributes": {"POSITION": 0}, "mode": 5"#;

/// Returns a document with the square as a strip of two triangles, and further entries.
fn strip(rest: &str) -> Vec<u8> {
    with_primitive(STRIP, rest)
}

fn glb(json: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((20 + json.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes
}

fn gltf() -> Vec<Dialect> {
    let row = |what, answer, files, expect| Dialect { format: Format::Gltf, what, answer, files, expect };
    let required = |extension: &str| strip(&format!(r#", "extensionsRequired": ["{extension}"]"#));
    let node = |rest: &str| strip(&format!(r#", "nodes": [{{"mesh": 0 {rest}}}]"#));
    let instancing = |attributes: &str| {
        node(&format!(r#", "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes": {{{attributes}}}}}}}"#))
    };
    let draco = |accessor: u32| {
        with_primitive(
            &format!(
                r#""attributes": {{"POSITION": {accessor}}}, "mode": 5, "extensions": {{"KHR_draco_mesh_compression": {{}}}}"#
            ),
            r#", "extensionsUsed": ["KHR_draco_mesh_compression"]"#,
        )
    };
    vec![
        row(
            "glTF 2.0 as JSON or in the binary container",
            "read",
            vec![("a.gltf", strip("")), ("a.glb", glb(&strip("")))],
            read(2, &[]),
        ),
        row(
            "bytes after the end of the binary container",
            "read, with a warning",
            vec![("a.glb", [glb(&strip("")), vec![0; 7]].concat())],
            read(2, &[WarningKind::TrailingBytes]),
        ),
        row(
            "an accessor without data",
            "read as zeros",
            vec![("a.gltf", with_primitive(r#""attributes": {"POSITION": 1}"#, ""))],
            read(1, &[]),
        ),
        row(
            "points, lines",
            "skipped, with a warning",
            vec![("a.gltf", with_primitive(r#""attributes": {"POSITION": 0}, "mode": 1"#, ""))],
            read(0, &[WarningKind::NotTriangles]),
        ),
        row(
            "corners after the last whole triangle",
            "ignored, with a warning",
            vec![("a.gltf", with_primitive(r#""attributes": {"POSITION": 0}"#, ""))],
            read(1, &[WarningKind::LeftoverCorners]),
        ),
        row(
            "a skinned mesh",
            "read as modeled, without its pose, with a warning",
            vec![("a.gltf", node(r#", "skin": 0"#))],
            read(2, &[WarningKind::Unposed]),
        ),
        row(
            "a node that several paths reach",
            "read once for each path, with a warning",
            vec![("a.gltf", strip(r#", "nodes": [{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}]"#))],
            read(4, &[WarningKind::SharedNodes]),
        ),
        row(
            "a node inside of itself",
            "refused: names the node",
            vec![("a.gltf", strip(r#", "nodes": [{"children": [1]}, {"children": [1]}]"#))],
            Expect::Refused("syntax"),
        ),
        row(
            "`EXT_mesh_gpu_instancing` with translations, rotations or scales",
            "read: every instance is a part",
            vec![("a.gltf", instancing(r#""TRANSLATION": 0"#))],
            read(8, &[]),
        ),
        row(
            "`EXT_mesh_gpu_instancing` without any of these",
            "read once, with a warning",
            vec![("a.gltf", instancing(r#""_ID": 0"#))],
            read(2, &[WarningKind::SingleInstances]),
        ),
        row(
            "a required extension that moves no vertex: materials, textures, lights, metadata, visibility, physics, `VRM`",
            "read",
            vec![
                ("a.gltf", required("EXT_structural_metadata")),
                ("b.gltf", required("KHR_materials_unlit")),
                ("c.gltf", required("KHR_node_visibility")),
                ("d.gltf", required("VRMC_vrm")),
            ],
            read(2, &[]),
        ),
        row(
            "a mesh compressed by Draco with uncompressed accessors beside it",
            "read from the accessors",
            vec![("a.gltf", draco(0))],
            read(2, &[]),
        ),
        row(
            "a mesh compressed by Draco or meshopt alone",
            "refused: names a program that decompresses it",
            vec![
                ("a.gltf", draco(1)),
                ("b.gltf", required("KHR_draco_mesh_compression")),
                ("c.gltf", required("EXT_meshopt_compression")),
            ],
            Expect::Refused("unsupported-feature"),
        ),
        row(
            "any other required extension",
            "refused: names the extension",
            vec![("a.gltf", required("CESIUM_RTC"))],
            Expect::Refused("unsupported-feature"),
        ),
        row(
            "glTF 1.0",
            "refused: names a program that converts it",
            vec![("a.gltf", br#"{"asset": {"version": "1.0"}, "buffers": {}, "meshes": {}, "nodes": {}}"#.to_vec())],
            Expect::Refused("unsupported-feature"),
        ),
        row(
            "any of these packed by gzip (`a.glb.gz`)",
            "read",
            vec![("a.glb.gz", gzip(&glb(&strip("")))), ("a.gltf.gz", gzip(&strip("")))],
            read(2, &[]),
        ),
    ]
}

fn package(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, content) in entries {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(content).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// Returns a model of one triangle, with attributes, more elements in its mesh, and items.
fn model(attributes: &str, in_mesh: &str, items: &str) -> String {
    format!(
        r#"<model {attributes}><resources><object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
        <vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles>{in_mesh}</mesh></object>
        <object id="2"><components><component objectid="1"/><component objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/>
        </components></object></resources><build>{items}</build></model>"#
    )
}

fn three_mf() -> Vec<Dialect> {
    let row = |what, answer, files, expect| Dialect { format: Format::ThreeMf, what, answer, files, expect };
    let part = |content: &[u8]| vec![("a.3mf", package(&[("3D/3dmodel.model", content)]))];
    let item = r#"<item objectid="1"/>"#;
    let required = |uri: &str, in_mesh: &str| {
        part(model(&format!(r#"xmlns:e="{uri}" requiredextensions="e""#), in_mesh, item).as_bytes())
    };
    let lattice = r#"<e:beamlattice radius="1"><e:beams><e:beam v1="0" v2="1"/></e:beams></e:beamlattice>"#;
    vec![
        row(
            "items and components with transforms",
            "read: each instance is a part",
            part(model("", "", r#"<item objectid="2"/><item objectid="1"/>"#).as_bytes()),
            read(3, &[]),
        ),
        row("a part in UTF-16", "read", part(&utf16(&model("", "", item))), read(1, &[])),
        row(
            "a beam lattice, required or not",
            "triangles read; beams and balls left out, with a warning",
            required("http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02", lattice),
            read(1, &[WarningKind::Beams]),
        ),
        row(
            "required materials, slices, triangle sets, or the production extension",
            "read",
            required("http://schemas.microsoft.com/3dmanufacturing/slice/2015/07", ""),
            read(1, &[]),
        ),
        row(
            "any other required extension",
            "refused: names the extension",
            required("http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01", ""),
            Expect::Refused("unsupported-feature"),
        ),
        row(
            "two attributes of one name in an element of the mesh or the build",
            "refused: names the byte",
            part(model("", "", r#"<item objectid="1" objectid="2"/>"#).as_bytes()),
            Expect::Refused("syntax"),
        ),
        row(
            "an object that does not exist",
            "refused: names the object",
            part(model("", "", r#"<item objectid="7"/>"#).as_bytes()),
            Expect::Refused("syntax"),
        ),
        row(
            "another ZIP archive",
            "refused",
            vec![("a.3mf", package(&[("readme.txt", b"hello")]))],
            Expect::Refused("wrong-content"),
        ),
    ]
}

/// Returns a COLLADA document with a square in the geometry `g`, and more elements.
fn scene(primitives: &str, rest: &str) -> String {
    let primitives = primitives.replace("INPUT", r##"<input semantic="VERTEX" source="#v" offset="0"/>"##);
    format!(
        r##"<COLLADA version="1.4.1"><asset><unit meter="0.0254"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g">
        <mesh><source id="p"><float_array id="a">0 0 0 1 0 0 1 1 0 0 1 0</float_array><technique_common>
        <accessor source="#a" count="4" stride="3"/></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
        </vertices>{primitives}</mesh></geometry></library_geometries>{rest}</COLLADA>"##
    )
}

/// Returns the square in a scene with these nodes.
fn nodes(nodes: &str) -> Vec<u8> {
    let scenes = format!("<library_visual_scenes><visual_scene>{nodes}</visual_scene></library_visual_scenes>");
    scene(QUAD, &scenes).into_bytes()
}

const QUAD: &str = "<polylist>INPUT<vcount>4</vcount><p>0 1 2 3</p></polylist>";
const NODE: &str = r##"<node id="n"><instance_geometry url="#g"/></node>"##;

fn collada() -> Vec<Dialect> {
    let row = |what, answer, files, expect| Dialect { format: Format::Collada, what, answer, files, expect };
    let one = |content: Vec<u8>| vec![("a.dae", content)];
    let primitives = |list: &[&str]| {
        let names = ["a.dae", "b.dae", "c.dae", "d.dae"];
        let scenes = format!("<library_visual_scenes><visual_scene>{NODE}</visual_scene></library_visual_scenes>");
        names.into_iter().zip(list).map(|(name, p)| (name, scene(p, &scenes).into_bytes())).collect()
    };
    let edited = |from: &str, to: &str| {
        let text = String::from_utf8(nodes(NODE)).unwrap();
        assert!(text.contains(from), "{from}");
        text.replace(from, to).into_bytes()
    };
    let skin = r##"<library_controllers><controller id="c"><skin source="#g"/></controller></library_controllers>"##;
    let skinned = nodes(r##"<node><instance_controller url="#c"/></node>"##);
    let skinned = String::from_utf8(skinned).unwrap().replace("<library_visual", &format!("{skin}<library_visual"));
    vec![
        row(
            "`<triangles>`, `<polylist>`, `<polygons>`, `<trifans>`, `<tristrips>`",
            "read",
            primitives(&[
                "<triangles>INPUT<p>0 1 2 0 2 3</p></triangles>",
                "<polygons>INPUT<p>0 1 2 3</p></polygons>",
                "<trifans>INPUT<p>0 1 2 3</p></trifans>",
                "<tristrips>INPUT<p>0 1 3 2</p></tristrips>",
            ]),
            read(2, &[]),
        ),
        row(
            "holes in polygons (`<ph>`)",
            "filled, with a warning",
            primitives(&["<polygons>INPUT<ph><p>0 1 2 3</p><h>0 1 2</h></ph></polygons>"]),
            read(2, &[WarningKind::FilledHoles]),
        ),
        row(
            "`<lines>`, `<linestrips>`, `<spline>`",
            "skipped, with a warning",
            primitives(&["<lines>INPUT<p>0 1</p></lines>"]),
            read(0, &[WarningKind::NotTriangles]),
        ),
        row(
            "`<up_axis>`: X, Y (without one, too) or Z",
            "turned so that Z is up",
            vec![
                ("a.dae", edited("Z_UP", "X_UP")),
                ("b.dae", edited("Z_UP", "Y_UP")),
                ("c.dae", edited("<up_axis>Z_UP</up_axis>", "")),
            ],
            read(2, &[]),
        ),
        row(
            "`<unit>` of a micron, mm, cm, inch, foot or meter",
            "stated as the model's unit; meters without one",
            vec![("a.dae", nodes(NODE)), ("b.dae", edited("<unit meter=\"0.0254\"/>", ""))],
            read(2, &[]),
        ),
        row("`<unit>` of another length", "scaled to meters", one(edited("0.0254", "0.1")), read(2, &[])),
        row(
            "`<matrix>`, `<translate>`, `<rotate>`, `<scale>`, `<lookat>`, `<skew>`",
            "applied in their order",
            one(nodes(&NODE.replace(
                "<instance",
                "<translate>1 2 3</translate><lookat>0 0 0 0 0 1 0 1 0</lookat><skew>45 0 1 0 1 0 0</skew><instance",
            ))),
            read(2, &[]),
        ),
        row(
            "`<instance_node>`",
            "read: each instance is a part",
            one(nodes(&format!("{NODE}<node><instance_node url=\"#n\"/></node>"))),
            read(4, &[]),
        ),
        row(
            "`<instance_controller>`: a skin or morph targets",
            "read as modeled, without its pose, with a warning",
            one(skinned.into_bytes()),
            read(2, &[WarningKind::Unposed]),
        ),
        row("no `<scene>`", "the first visual scene is read", one(nodes(NODE)), read(2, &[])),
        row(
            "no visual scene at all",
            "all geometries are read as they are modeled, with a warning",
            one(scene(QUAD, "").into_bytes()),
            read(2, &[WarningKind::NoScene]),
        ),
        row(
            "UTF-16, ISO 8859-1, or packed by gzip (`a.dae.gz`)",
            "read",
            vec![
                ("a.dae", utf16(&String::from_utf8(nodes(NODE)).unwrap())),
                (
                    "b.dae",
                    nodes(&NODE.replace("id=", "name=\"\u{E9}\" id=")).into_iter().filter(|&b| b != 0xC3).collect(),
                ),
                ("a.dae.gz", gzip(&nodes(NODE))),
            ],
            read(2, &[]),
        ),
        row(
            "a reference to another file",
            "refused: names the file",
            one(edited("url=\"#g\"", "url=\"other.dae#g\"")),
            Expect::Refused("unsupported-feature"),
        ),
        row(
            "nodes inside of themselves",
            "refused: names the line",
            one(nodes("<node id=\"n\"><instance_node url=\"#n\"/></node>")),
            Expect::Refused("syntax"),
        ),
        row(
            "a version other than 1.4 and 1.5",
            "refused: names the version",
            one(edited("1.4.1", "1.3.1")),
            Expect::Refused("unsupported-feature"),
        ),
    ]
}

//! Tests with documents written by hand: primitives, sources, scenes, frames, and errors.

use impinge::Positions;

use crate::model::WarningKind;

use super::*;

fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    super::read(bytes, Axes::ZUp, &Limits::default())
}

/// Returns a document with Z up, in meters, with these libraries and scenes.
fn document(libraries: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n\
        <asset><unit meter=\"1\" name=\"meter\"/><up_axis>Z_UP</up_axis></asset>\n{libraries}\n</COLLADA>\n"
    )
}

/// Five points of a strip: (0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 2, 0).
const SOURCES: &str = r##"<source id="p"><float_array id="pa" count="15">0 0 0 1 0 0 0 1 0 1 1 0 0 2 0</float_array>
    <technique_common><accessor source="#pa" count="5" stride="3"><param name="X"/><param name="Y"/><param name="Z"/></accessor>
    </technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>"##;

const INPUT: &str = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;

fn geometry(id: &str, primitives: &str) -> String {
    format!("<geometry id=\"{id}\" name=\"{id} name\"><mesh>{SOURCES}{primitives}</mesh></geometry>")
}

/// Returns a document with one geometry, `g`, and a scene with these nodes.
fn with_nodes(primitives: &str, nodes: &str) -> String {
    document(&format!(
        "<library_geometries>{}</library_geometries><library_visual_scenes><visual_scene id=\"s\">{nodes}</visual_scene>\
        </library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene>",
        geometry("g", primitives)
    ))
}

fn with_primitives(primitives: &str) -> String {
    with_nodes(primitives, "<node><instance_geometry url=\"#g\"/></node>")
}

fn parse(text: &str) -> Model {
    match read(text.as_bytes()) {
        Ok(model) => model,
        Err(e) => panic!("{e}\n{text}"),
    }
}

fn error(text: &str) -> String {
    read(text.as_bytes()).unwrap_err().to_string()
}

fn warnings(model: &Model) -> Vec<(WarningKind, u64)> {
    model.warnings.iter().map(|w| (w.kind, w.count)).collect()
}

#[test]
fn every_primitive_gives_its_triangles() {
    let faces = |primitive: &str| {
        let model = parse(&with_primitives(&primitive.replace("IN", INPUT)));
        (model.faces.clone(), model.sources.clone(), warnings(&model))
    };
    let two = vec![[0, 1, 2], [1, 3, 2]];
    let rows = [
        ("<triangles>IN<p>0 1 2 1 3 2</p></triangles>", two.clone(), vec![0, 1], vec![]),
        (
            "<triangles>IN<p>0 1 2</p><p>1 3 2 4</p></triangles>",
            two.clone(),
            vec![0, 1],
            vec![(WarningKind::LeftoverCorners, 1)],
        ),
        ("<tristrips>IN<p>0 1 2 3</p><p>0 0 1</p></tristrips>", two, vec![0, 1], vec![(WarningKind::StripJoints, 1)]),
        ("<trifans>IN<p>0 1 3 2</p><p>0 1</p></trifans>", vec![[0, 1, 3], [0, 3, 2]], vec![0, 1], vec![]),
        (
            "<polygons>IN<p>0 1 3 2</p><p>2 3 4</p></polygons>",
            vec![[0, 1, 3], [0, 3, 2], [2, 3, 4]],
            vec![0, 0, 1],
            vec![],
        ),
        (
            "<polygons>IN<ph><p>0 1 3 2</p><h>0 1 2</h><h>0 1 2</h></ph></polygons>",
            vec![[0, 1, 3], [0, 3, 2]],
            vec![0, 0],
            vec![(WarningKind::FilledHoles, 2)],
        ),
        (
            "<polylist>IN<vcount>4 2 3</vcount><p>0 1 3 2 0 1 2 3 4 0</p></polylist>",
            vec![[0, 1, 3], [0, 3, 2], [2, 3, 4]],
            vec![0, 0, 2],
            vec![(WarningKind::ShortFaces, 1), (WarningKind::LeftoverCorners, 1)],
        ),
        (
            "<lines>IN<p>0 1</p></lines><linestrips>IN<p>0 1</p></linestrips>",
            vec![],
            vec![],
            vec![(WarningKind::NotTriangles, 2)],
        ),
        ("<lines count=\"0\">IN</lines><triangles count=\"0\"/>", vec![], vec![], vec![]),
    ];
    for (primitive, expected, sources, warned) in rows {
        assert_eq!(faces(primitive), (expected, sources, warned), "{primitive}");
    }
    let spline = with_primitives("").replace("mesh>", "spline>");
    assert_eq!(warnings(&parse(&spline)), [(WarningKind::NotTriangles, 1)]);
}

#[test]
fn inputs_have_offsets_and_accessors_pick_values() {
    let source = r##"<source id="q"><float_array id="qa">9 9  3 7 1 2  6 7 4 5  0 8</float_array><technique_common>
        <accessor source="#qa" count="2" offset="2" stride="4"><param name="Z"/><param/><param name="X"/><param name="Y"/></accessor>
        </technique_common></source>"##;
    let triangles = r##"<triangles><input semantic="NORMAL" source="#none" offset="2"/><input semantic="VERTEX" source="#v" offset="1"/>
        <p>7 0 9 7 1 9 7 2 9</p></triangles><triangles><input semantic="POSITION" source="#q"/><p>0 1 0</p></triangles>"##;
    let model = parse(&with_primitives(&format!("{source}{triangles}")));
    assert_eq!(model.faces, [[0, 1, 2], [5, 6, 5]]);
    assert_eq!([5, 6].map(|i| model.positions.get(i)), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    // The last corner lacks its third index.
    let cut = with_primitives(&format!("{source}{}", triangles.replace("7 2 9<", "7 2 9 7 2<")));
    assert_eq!(warnings(&parse(&cut)), [(WarningKind::LeftoverCorners, 1)]);
}

#[test]
fn nodes_place_geometries_as_named_parts() {
    let triangle = format!("<triangles>{INPUT}<p>0 1 2</p></triangles>");
    let nodes = r##"<node name="arm"><translate>10 0 0</translate><rotate>0 0 1 90</rotate><instance_geometry url="#g"/>
        <node id="hand"><scale>-2 2 2</scale><instance_geometry url="#g"/></node></node>
        <node><instance_node url="#shared"/><instance_geometry url="#g"/></node>"##;
    let library = "<library_nodes><node id=\"shared\"><translate>0 0 5</translate><instance_geometry url=\"#g\"/></node></library_nodes>";
    let text = with_nodes(&triangle, nodes).replace("<scene>", &format!("{library}<scene>"));
    let model = parse(&text);
    assert_eq!(model.parts, ["arm", "hand", "shared", "g name"]);
    assert_eq!(model.faces, [[0, 1, 2], [5, 7, 6], [10, 11, 12], [15, 16, 17]]);
    assert_eq!(
        [1, 6, 10, 16].map(|i| model.positions.get(i)),
        [[10., 1., 0.], [10., -2., 0.], [0., 0., 5.], [1., 0., 0.]]
    );
    assert_eq!((model.unit, model.format), (Some(Unit::Meter), Format::Collada));
    assert!(matches!(model.positions, Positions::F32(_)));
}

#[test]
fn controllers_apply_only_the_bind_shape_matrix() {
    let controllers = r##"<library_controllers><controller id="c"><skin source="#m"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 7 0 0 0 1
        </bind_shape_matrix></skin></controller><controller id="m"><morph source="#g"/></controller></library_controllers>"##;
    let triangle = format!("<triangles>{INPUT}<p>0 1 2</p></triangles>");
    let text = with_nodes(&triangle, "<node><scale>2 2 2</scale><instance_controller url=\"#c\"/></node>");
    let model = parse(&text.replace("<scene>", &format!("{controllers}<scene>")));
    assert_eq!(model.positions.get(1), [2.0, 0.0, 14.0]);
    assert_eq!(warnings(&model), [(WarningKind::Unposed, 1)]);
    let cycle = text.replace("<scene>", &format!("{}<scene>", controllers.replace("#g", "#c")));
    assert!(error(&cycle).contains("a cycle of controllers"));
}

#[test]
fn the_named_scene_is_loaded_else_the_first_else_all_geometries() {
    let triangle = format!("<triangles>{INPUT}<p>0 1 2</p></triangles>");
    let node = |n: usize| "<node><instance_geometry url=\"#g\"/></node>".repeat(n);
    let scenes = format!(
        "<library_visual_scenes><visual_scene id=\"a\">{}</visual_scene><visual_scene id=\"b\">{}</visual_scene></library_visual_scenes>",
        node(1),
        node(2)
    );
    let geometries =
        format!("<library_geometries>{}{}</library_geometries>", geometry("g", &triangle), geometry("h", &triangle));
    let load = |rest: &str| {
        let model = parse(&document(&format!("{geometries}{rest}")));
        (model.faces.len(), warnings(&model))
    };
    assert_eq!(load(&scenes), (1, vec![]));
    assert_eq!(load(&format!("{scenes}<scene><instance_visual_scene url=\"#b\"/></scene>")), (2, vec![]));
    assert_eq!(load("<scene/>"), (2, vec![(WarningKind::NoScene, 2)]));
    assert_eq!(load(""), (2, vec![(WarningKind::NoScene, 2)]));
}

#[test]
fn frames_have_units_and_axes() {
    let triangle = format!("<triangles>{INPUT}<p>0 1 2</p></triangles>");
    let text = with_primitives(&triangle).replace("0 0 0 1 0 0 0 1 0", "1 2 3 1 0 0 0 1 0");
    let load = |asset: &str| {
        let start = text.find("<asset>").unwrap();
        let end = text.find("</asset>").unwrap() + 8;
        let model = parse(&[&text[..start], asset, &text[end..]].concat());
        (model.positions.get(0), model.unit)
    };
    let meter = Some(Unit::Meter);
    assert_eq!(load("<asset><up_axis>Z_UP</up_axis></asset>"), ([1.0, 2.0, 3.0], meter));
    assert_eq!(load("<asset><up_axis> Y_UP\n</up_axis></asset>"), ([1.0, -3.0, 2.0], meter));
    assert_eq!(load("<asset><up_axis>X_UP</up_axis></asset>"), ([-2.0, -3.0, 1.0], meter));
    assert_eq!(load("<asset/>"), ([1.0, -3.0, 2.0], meter));
    assert_eq!(load(""), ([1.0, -3.0, 2.0], meter));
    let unit = |meter: &str| load(&format!("<asset><unit meter=\"{meter}\"/><up_axis>Z_UP</up_axis></asset>"));
    assert_eq!(unit("0.0254"), ([1.0, 2.0, 3.0], Some(Unit::Inch)));
    assert_eq!(unit("0,01"), ([1.0, 2.0, 3.0], Some(Unit::Centimeter)));
    assert_eq!(unit("0.00999999977648258"), ([1.0, 2.0, 3.0], Some(Unit::Centimeter)));
    assert_eq!(unit("1000"), ([1000.0, 2000.0, 3000.0], meter));
    let wrong = |from: &str, to: &str| error(&text.replace(from, to));
    assert_eq!(wrong("meter=\"1\"", "meter=\"0\""), "line 3: expected a positive length in meters, found \"0\"");
    assert_eq!(wrong("Z_UP", "UP"), "line 3: expected X_UP, Y_UP or Z_UP, found \"UP\"");
}

#[test]
fn every_encoding_and_prefix_is_read() {
    let triangle = format!("<triangles>{INPUT}<p>0 1 <!-- 9 -->2</p></triangles>");
    let text = with_primitives(&triangle).replace("g name", "caf\u{E9}");
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let prefixed = text
        .replace("</", "<\u{0}")
        .replace('<', "<c:")
        .replace("<c:\u{0}", "</c:")
        .replace("<c:?", "<?")
        .replace("<c:!", "<!");
    for bytes in [text.as_bytes(), &latin, &wide, prefixed.as_bytes()] {
        assert!(opens(bytes));
        assert_eq!(read(bytes).unwrap().parts, ["caf\u{E9}"]);
    }
    for other in [&b"<model/>"[..], b"COLLADA", b"# <COLLADA", b"", b"\0", b"\xFF\xFE"] {
        assert!(!opens(other));
    }
}

#[test]
fn errors_name_the_line() {
    let primitive = |text: &str| error(&with_primitives(&text.replace("IN", INPUT)));
    // The geometry begins in line 4 and has two line breaks before its primitives.
    assert_eq!(
        primitive("<triangles>IN<p>0 1 2\n0 1 5</p></triangles>"),
        "line 7: face 1 names vertex 5, but there are 5 vertices"
    );
    assert_eq!(
        primitive("<polylist>IN<vcount>3 3</vcount><p>0 1 2 0 -1 2</p></polylist>"),
        "line 6: face 1 names vertex -1, but there are 5 vertices"
    );
    assert!(
        primitive("<polylist>IN<vcount>3 4</vcount><p>0 1 2 0 1 2</p></polylist>").contains("4 corners of a polygon")
    );
    assert!(primitive("<triangles>IN<p>0 x</p></triangles>").contains("expected a whole number, found \"x\""));
    assert!(primitive("<triangles><p>0 1 2</p></triangles>").contains("expected an input of semantic VERTEX"));
    let bad = |from: &str, to: &str| {
        let text = with_primitives(&format!("<triangles>{INPUT}<p>0 1 2</p></triangles>"));
        assert!(text.contains(from), "{from}");
        error(&text.replace(from, to))
    };
    assert!(bad("1 1 0", "1 1 NaN").contains("line 4: vertex 3 has a coordinate that is NaN"));
    assert!(bad("1 1 0", "1 1").contains("line 5: 5 positions promised, but there is room for 4"));
    assert!(bad("count=\"5\"", "count=\"4000000000\"").contains("4000000000 positions promised"));
    assert!(bad("stride=\"3\"", "stride=\"0\"").contains("expected a stride of 3 or more"));
    assert!(bad("url=\"#g\"", "url=\"#h\"").contains("expected an element with the id \"h\""));
    assert!(bad("url=\"#g\"", "url=\"#v\"").contains("expected the id of a geometry, found \"the element vertices\""));
    assert!(bad("url=\"#s\"", "url=\"#g\"").contains("expected the id of a visual_scene"));
    assert!(bad("url=\"#g\"", "url=\"x.dae#g\"").contains("needs the file \"x.dae#g\" beside it"));
    assert!(bad("1.4.1", "1.3.0").contains("needs COLLADA version \"1.3.0\""));
    assert!(bad("<mesh>", "<convex_mesh convex_hull_of=\"#g\"/><mesh>").contains("needs convex_hull_of"));
    assert!(
        bad("<instance_geometry", "<scale>1e308 1 1</scale><scale>1e308 1 1</scale><instance_geometry")
            .contains("after the transform of its node")
    );
    assert_eq!(error("<a/>"), "not COLLADA, but text without the element COLLADA");
    assert!(error("<COLLADA>").contains("the file is cut off"));
}

#[test]
fn hostile_nesting_and_repetition_are_errors() {
    let triangle = format!("<triangles>{INPUT}<p>0 1 2</p></triangles>");
    let deep = "nodes nested at most 256 deep";
    let cycle = with_nodes(&triangle, "<node id=\"n\"><instance_node url=\"#n\"/></node>");
    assert!(error(&cycle).contains(deep));
    assert!(error(&with_nodes("", &("<node>".repeat(300) + &"</node>".repeat(300)))).contains(deep));
    assert!(read(with_nodes("", &("<node>".repeat(256) + &"</node>".repeat(256))).as_bytes()).is_ok());
    let twice = |i: usize| {
        format!("<node id=\"n{i}\"><instance_node url=\"#n{}\"/><instance_node url=\"#n{}\"/></node>", i + 1, i + 1)
    };
    let doubling: String = (0..60).map(twice).collect();
    let end = "<node id=\"n60\"><instance_geometry url=\"#g\"/></node>";
    assert!(error(&with_nodes("", &format!("{doubling}{end}"))).contains("nodes exceed the limit of 262144"));
    // Many sources that refer to one long array.
    let source = |i: usize| {
        let accessor = "<technique_common><accessor source=\"#long\" count=\"10000\" stride=\"3\"/></technique_common>";
        format!(
            "<source id=\"s{i}\">{accessor}</source><triangles><input semantic=\"VERTEX\" source=\"#s{i}\"/><p>0 1 2</p></triangles>"
        )
    };
    let long = format!("<source><float_array id=\"long\">{}</float_array></source>", "0 ".repeat(30_000));
    let text = with_primitives(&(long + &(0..2000).map(source).collect::<String>()));
    assert!(error(&text).contains("positions of sources exceed the limit of"));
    // Hundreds of thousands of nested elements need no stack.
    let text = document(&("<extra>".repeat(300_000) + &"</extra>".repeat(300_000)));
    assert!(parse(&text).faces.is_empty());
}

#[test]
fn byte_order_marks_do_not_shift_the_text() {
    let text = document("<extra/>");
    for marks in 0..3 {
        assert!(parse(&("\u{FEFF}".repeat(marks) + &text)).faces.is_empty());
    }
}

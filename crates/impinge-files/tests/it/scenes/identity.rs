//! Names, keys, types and extras of parts.

use std::fs;

use impinge_files::{Format, SceneOptions, WarningKind, load_scene, parse_scene};

use super::{document, keys, names, parse, scene};

#[test]
fn extras_hold_key_type_and_any_other_value_as_text() {
    let model = scene(
        r#"{"mesh": 0, "name": "a", "extras": {"GlobalId": "g", "type": "IfcWall", "load": 1.50, "tags": [1, {"x": null}], "fire": true}},
        {"mesh": 0, "name": "b", "extras": {"id": 17, "guid": "h", "class": "Pipe"}}, {"mesh": 0, "name": "c", "extras": "free text"},
        {"mesh": 0, "name": "IfcSlab|2O2Fr$t4X7Zf8NOew3FNr2", "extras": {"id": null, "GlobalId": ""}},
        {"mesh": 0, "name": "IfcSlab|2O2Fr$t4X7Zf8NOew3FNr3", "extras": {"guid": "own", "type": "Own"}}"#,
    );
    assert_eq!(keys(&model), ["g", "h", "c", "2O2Fr$t4X7Zf8NOew3FNr2", "own"]);
    let kinds: Vec<&str> = model.parts.iter().map(|part| &*part.details.kind).collect();
    assert_eq!(kinds, ["IfcWall", "Pipe", "", "IfcSlab", "Own"]);
    let extras = |part: usize| model.parts[part].details.extras.clone();
    let text = |pairs: &[(&str, &str)]| pairs.iter().map(|&(a, b)| (a.to_owned(), b.to_owned())).collect::<Vec<_>>();
    assert_eq!(extras(0), text(&[("load", "1.50"), ("tags", r#"[1, {"x": null}]"#), ("fire", "true")]));
    assert_eq!(extras(1), text(&[("id", "17")]));
    assert_eq!(extras(2), text(&[("extras", "free text")]));
    assert_eq!(names(&model)[3], "IfcSlab|2O2Fr$t4X7Zf8NOew3FNr2");
}

#[test]
fn a_file_of_names_gives_keys_types_names_and_extras() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("names.json");
    let elements = r#"{"source": "x.ifc", "elements": [{"node": "n1", "guid": "G1", "type": "IfcWall", "name": "North", "tris": 4},
        {"node": "n2", "guid": "G2", "type": "IfcWall", "name": "North"}, {"node": "gone", "guid": "G3"}]}"#;
    fs::write(&path, elements).unwrap();
    let options = SceneOptions { names: Some(path.clone()), ..SceneOptions::default() };
    let nodes = r#""nodes": [{"mesh": 0, "name": "n1", "extras": {"GlobalId": "other", "layer": "7"}}, {"mesh": 0, "name": "n2"},
        {"mesh": 0, "name": "n3"}]"#;
    let model = parse(&document(nodes), &options);
    assert_eq!(keys(&model), ["G1", "G2", "n3"]);
    assert_eq!(names(&model), ["North", "North (2)", "n3"]);
    assert_eq!(model.parts[0].details.kind, "IfcWall");
    let extras: Vec<(&str, &str)> = model.parts[0].details.extras.iter().map(|(a, b)| (&**a, &**b)).collect();
    assert_eq!(extras, [("layer", "7"), ("tris", "4")]);
    let warning = &model.warnings[0];
    assert_eq!((warning.kind, warning.count), (WarningKind::UnknownNames, 1));
    assert!(warning.to_string().ends_with("ignored: 1, at element 2 of the names"), "{warning}");

    for (text, message) in [
        ("{", "names.json, line 1: expected a JSON object with a list of elements"),
        (r#"{"elements": 3}"#, "names.json, line 1: expected a JSON object"),
        (r#"{"elements": [{"node": "a"}, {"guid": "b"}]}"#, "names.json, element 1: expected the name of a node"),
    ] {
        fs::write(&path, text).unwrap();
        let error = parse_scene(document(nodes).as_bytes(), Format::Gltf, &options).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
    fs::remove_file(&path).unwrap();
    let error = load_scene(folder.path().join("absent.glb"), &options).unwrap_err();
    assert!(error.to_string().contains("names.json"), "{error}");
}

#[test]
fn keys_stay_the_same_if_nodes_are_reordered_and_parts_are_added() {
    let parts = [
        r#"{"mesh": 0, "name": "bolt", "translation": [1, 0, 0]}"#,
        r#"{"mesh": 0, "name": "bolt", "translation": [3, 0, 0]}"#,
        r#"{"mesh": 0, "name": "bolt", "translation": [2, 0, 0]}"#,
        r#"{"mesh": 1, "name": "bolt", "translation": [2, 1, 0]}"#,
        r#"{"mesh": 0, "name": "bolt#2"}"#,
        r#"{"mesh": 1}"#,
        r#"{"mesh": 1, "extras": {"id": "x"}, "translation": [0, 0, 1]}"#,
        r#"{"mesh": 1, "extras": {"id": "x"}, "translation": [0, 0, 2]}"#,
    ];
    let key_at_place = |order: &[usize]| {
        let nodes: Vec<&str> = order.iter().map(|&at| parts[at]).collect();
        let model = scene(&nodes.join(","));
        let mut found: Vec<(usize, String)> =
            order.iter().copied().zip(keys(&model).into_iter().map(str::to_owned)).collect();
        found.sort();
        found.into_iter().map(|(_, key)| key).collect::<Vec<_>>()
    };
    let expected = ["bolt", "bolt#5", "bolt#3", "bolt#4", "bolt#2", "b", "x", "x#2"];
    assert_eq!(key_at_place(&[0, 1, 2, 3, 4, 5, 6, 7]), expected);
    assert_eq!(key_at_place(&[7, 6, 5, 4, 3, 2, 1, 0]), expected);
    assert_eq!(key_at_place(&[2, 5, 0, 7, 4, 1, 6, 3]), expected);
    // Without other parts.
    assert_eq!(key_at_place(&[0, 1, 2, 3, 4]), expected[..5]);
    assert_eq!(key_at_place(&[6, 7]), ["x", "x#2"]);
}

#[test]
fn keys_without_an_id_are_the_path_of_nodes() {
    let nodes = r#"{"name": "Plant", "children": [1, 3]}, {"name": "Hall", "children": [2]}, {"mesh": 0, "name": "pump"},
        {"children": [4]}, {"mesh": 0, "name": "pump"}"#;
    let model = scene(nodes);
    assert_eq!(keys(&model), ["Plant/Hall/pump", "Plant/pump"]);
    assert_eq!(names(&model), ["pump", "pump (2)"]);
    assert_eq!(model.parts[0].details.path, ["Plant", "Hall"]);
}

#[test]
fn other_formats_have_a_part_for_each_name() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\no left\nf 1 2 3\no right\nf 4 2 3\no left\nf 4 1 2\n";
    let model = parse_scene(obj.as_bytes(), Format::Obj, &SceneOptions::default()).unwrap();
    // OBJ joins the groups of one name.
    assert_eq!(names(&model), ["left", "right"]);
    assert_eq!(keys(&model), ["left", "right"]);
    assert_eq!(model.meshes.iter().map(|mesh| mesh.positions.len()).collect::<Vec<_>>(), [4, 3]);
    assert_eq!((&model.meshes[0].faces[..], &model.meshes[0].sources[..]), (&[[0, 1, 2], [3, 0, 1]][..], &[0, 2][..]));
    assert_eq!(model.meshes[1].faces, [[2, 0, 1]]);
    assert_eq!(model.meshes[1].positions.get(2), [9.0; 3]);
}

//! Tests with packages written by hand: builds, components, units, parts, and errors.

use std::io::Write;

use impinge::Positions;
use zip::{ZipWriter, write::SimpleFileOptions};

use crate::unit::Unit;

use super::*;

const RELATIONSHIPS: &str = r#"<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
    <Relationship Target="/thumb.png" Id="a" Type="thumbnail"/>
    <Relationship Target="/3D/Model.model" Id="b" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;

/// Reads a package from a file that is not compressed by gzip.
fn read(bytes: &[u8]) -> Result<Model, LoadError> {
    super::read(bytes, bytes.len() as u64, &Limits::default())
}

fn package(entries: &[(&str, &str)]) -> Vec<u8> {
    let entries: Vec<_> = entries.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    package_of_bytes(&entries)
}

fn package_of_bytes(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in entries {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(text).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// Returns a package with only this model.
fn with_model(model: &str) -> Vec<u8> {
    package(&[("_rels/.rels", RELATIONSHIPS), ("3D/model.MODEL", model)])
}

fn model(resources: &str, build: &str) -> String {
    format!("<model unit=\"inch\"><resources>{resources}</resources><build>{build}</build></model>")
}

fn error(resources: &str, build: &str) -> String {
    read(&with_model(&model(resources, build))).unwrap_err().to_string()
}

const MESH: &str = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex z=" 0.5 " y="1e0" x="0"/></vertices>
    <triangles><triangle v1="0" v2="1" v3="2" pid="3"/></triangles></mesh>"#;

#[test]
fn items_and_components_are_placed_by_their_transforms() {
    let resources = format!(
        r#"<basematerials id="9"/><object id="1" name="caf&#233; &amp; bar">{MESH}</object><object id="2">{MESH}</object>
        <object id="3" name="both"><components><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 5 0 0"/>
        <component objectid="2"/></components></object>"#
    );
    let build = r#"<item objectid="3" transform="2 0 0 0 2 0 0 0 2 0 0 1"/><item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>"#;
    let model = read(&with_model(&model(&resources, build))).unwrap();
    let expected = vec![
        [10.0, 0.0, 1.0],
        [10.0, 2.0, 1.0],
        [8.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
        [2.0, 0.0, 1.0],
        [0.0, 2.0, 2.0],
        [0.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.5],
    ];
    assert_eq!(model.positions, Positions::F32(expected));
    assert_eq!(model.faces, [[0, 1, 2], [3, 4, 5], [6, 8, 7]]);
    assert_eq!((&model.sources[..], &model.part_of[..]), (&[0, 1, 2][..], &[0, 1, 2][..]));
    assert_eq!(model.parts, ["café & bar", "both", "café & bar"]);
    assert_eq!(model.unit, Some(Unit::Inch));
}

#[test]
fn prefixes_defaults_and_foreign_elements_are_read() {
    let mesh = MESH.replace("</", "</c:").replace("<v", "<c:v").replace("<t", "<c:t").replace("<m", "<c:m");
    let text = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?><c:model xmlns:c="core" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
        requiredextensions="p"><c:resources><vertex x="nan"/><c:object id="1">{mesh}<c:other><c:mesh><c:vertices><c:vertex/></c:vertices></c:mesh></c:other></c:object>
        </c:resources><c:build><c:item objectid="1"/></c:build></c:model>"#
    );
    let model = read(&with_model(&text)).unwrap();
    assert_eq!((model.faces.len(), model.positions.len(), model.unit), (1, 3, Some(Unit::Millimeter)));
    assert!(read(&with_model("<model/>")).unwrap().faces.is_empty());
}

#[test]
fn models_in_several_parts_are_read() {
    let other = model(&format!("<object id=\"1\" name=\"inner\">{MESH}</object>"), "");
    let start = model(
        r#"<object id="1" name="outer"><components><component p:path="/3D/Objects/o.model" objectid="1"/></components></object>"#,
        r#"<item objectid="1"/><item p:path="/3D/Objects/o.model" objectid="1"/>"#,
    );
    let bytes = package(&[("_rels/.rels", RELATIONSHIPS), ("3D/Model.model", &start), ("3D/Objects/o.model", &other)]);
    assert_eq!(read(&bytes).unwrap().parts, ["inner", "inner"]);
    let error = read(&with_model(&start)).unwrap_err().to_string();
    assert_eq!(error, "/3D/Objects/o.model: expected this part of the package, found nothing");
}

#[test]
fn errors_name_part_and_byte() {
    let object = |mesh: &str| error(&format!("<object id=\"1\">{mesh}</object>"), "<item objectid=\"1\"/>");
    let at = |needle: &str, mesh: &str| {
        let text = model(&format!("<object id=\"1\">{mesh}</object>"), "");
        format!("/3D/Model.model, byte {}: ", text.find(needle).unwrap())
    };
    let bad = MESH.replace("v2=\"1\"", "v2=\"3\"");
    assert_eq!(object(&bad), at("<triangle ", &bad) + "face 0 names vertex 3, but there are 3 vertices");
    let bad = MESH.replace("v2=\"1\"", "v2=\"-1\"");
    assert_eq!(object(&bad), at("<triangle ", &bad) + "face 0 names vertex -1, but there are 3 vertices");
    let bad = MESH.replace("x=\"1\"", "x=\"inf\"");
    assert_eq!(
        object(&bad),
        at("<vertex x=\"inf", &bad) + "vertex 1 has a coordinate that is NaN, infinite or too large"
    );
    let bad = MESH.replace("x=\"1\"", "");
    assert_eq!(object(&bad), at("<vertex  y", &bad) + "expected x, y and z of a vertex, found nothing");
    assert!(object("<mesh>").contains("expected well-formed XML"));
    let missing = "/3D/Model.model, object 7: expected an object with this id, found nothing";
    assert_eq!(error("", "<item objectid=\"7\"/>"), missing);
    assert!(error("<object id=\"1\"/><object id=\"1\"/>", "").contains("expected a new id, found \"object 1 again\""));
    assert!(error("", "<item objectid=\"1\" transform=\"1 2 3\"/>").contains("expected a transform of 12 numbers"));
    let cut = read(&with_model("<model><resources>")).unwrap_err().to_string();
    assert!(cut.contains("(the file is cut off)"), "{cut}");
    let unit = read(&with_model("<model unit=\"furlong\"/>")).unwrap_err().to_string();
    assert!(unit.contains("expected a unit of 3MF, found \"furlong\""));
    let volumes = "http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01";
    let text = format!("<model xmlns:v=\"{volumes}\" requiredextensions=\"v\"/>");
    let text = read(&with_model(&text)).unwrap_err().to_string();
    assert!(text.contains(&format!("needs 3MF extension {volumes}")));
    let twice = error("<object id=\"1\"/>", "<item objectid=\"1\" objectid=\"1\"/>");
    assert!(twice.ends_with("expected attributes of different names, found \"objectid twice\""), "{twice}");
}

#[test]
fn beams_are_skipped_with_a_warning() {
    let lattice = r#"<b:beamlattice radius="1"><b:beams><b:beam v1="0" v2="1"/><b:beam v1="1" v2="2"/></b:beams>
        <b2:balls><b2:ball vindex="0"/></b2:balls></b:beamlattice></mesh>"#;
    let text = model(
        &format!("<object id=\"1\">{}</object><object id=\"2\">{MESH}</object>", MESH.replace("</mesh>", lattice)),
        "<item objectid=\"2\"/><item objectid=\"1\"/>",
    );
    let namespaces = r#"<model xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
        xmlns:b2="http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07" requiredextensions="b b2""#;
    let model = read(&with_model(&text.replace("<model", namespaces))).unwrap();
    assert_eq!(model.faces.len(), 2);
    let warnings: Vec<_> = model.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["beams and balls of lattices, skipped: 3, the first at /3D/Model.model, object 1"]);
}

#[test]
fn parts_may_be_utf16() {
    let text = model(&format!("<object id=\"1\" name=\"caf\u{E9}\">{MESH}</object>"), "<item objectid=\"1\"/>");
    let wide = |text: &str, bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("\u{FEFF}{text}").encode_utf16().flat_map(bytes).collect()
    };
    for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let (relationships, part) = (wide(RELATIONSHIPS, bytes), wide(&text, bytes));
        let package = package_of_bytes(&[("_rels/.rels", &relationships), ("3D/Model.model", &part)]);
        assert_eq!(read(&package).unwrap().parts, ["caf\u{E9}"]);
        let cut = package_of_bytes(&[("3D/3dmodel.model", &part[1..])]);
        assert!(read(&cut).unwrap_err().to_string().starts_with("3D/3dmodel.model: expected "));
    }
}

#[test]
fn archives_that_are_not_packages_are_errors() {
    let error = |bytes: &[u8]| read(bytes).unwrap_err();
    assert_eq!(error(&package(&[("readme.txt", "hello")])).kind().name(), "wrong-content");
    let whole = with_model("<model/>");
    assert!(error(&whole[..whole.len() - 5]).to_string().starts_with("expected a complete ZIP archive"));
}

#[test]
fn hostile_nesting_and_repetition_are_errors() {
    // Twenty doublings in each of three levels: more triangles than the memory of any computer
    // holds.
    let mut resources = format!("<object id=\"0\">{MESH}</object>");
    for id in 1..60 {
        let inner = format!("<component objectid=\"{}\"/>", id - 1);
        resources += &format!("<object id=\"{id}\"><components>{inner}{inner}</components></object>");
    }
    let text = error(&resources, "<item objectid=\"59\"/>");
    assert!(text.contains("exceed the limit of 1048576"), "{text}");
    let text = error(&resources.replace(MESH, ""), "<item objectid=\"59\"/>");
    assert!(text.contains("components exceed the limit"), "{text}");

    let chain = |n: u32| -> String {
        let link =
            |id| format!("<object id=\"{id}\"><components><component objectid=\"{}\"/></components></object>", id - 1);
        format!("<object id=\"0\">{MESH}</object>") + &(1..n).map(link).collect::<String>()
    };
    assert!(read(&with_model(&model(&chain(64), "<item objectid=\"63\"/>"))).is_ok());
    let deep = "expected components nested at most 64 deep, found \"more, or a cycle\"";
    assert!(error(&chain(65), "<item objectid=\"64\"/>").contains(deep));
    // The depth is also limited if the inner chain is known from an earlier item.
    assert!(error(&chain(90), "<item objectid=\"50\"/><item objectid=\"89\"/>").contains(deep));
    let cycle = "<object id=\"1\"><components><component objectid=\"1\"/></components></object>";
    assert!(error(cycle, "<item objectid=\"1\"/>").contains(deep));

    let bomb = format!("<model>{}</model>", " ".repeat(80 << 20));
    let bytes = with_model(&bomb);
    assert!(bytes.len() < 100_000);
    let text = read(&bytes).unwrap_err().to_string();
    assert!(text.contains("unpacked bytes exceed the limit"), "{text}");
}

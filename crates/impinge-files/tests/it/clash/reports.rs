//! Reports as JSON and CSV, and previous reports.

use impinge::clash::{Options, Previous, Report, Side, Status, find};
use impinge::query::batch::Execution;
use impinge::scene::{Details, Scene};
use impinge::{Mesh, Pose};
use impinge_files::{Asked, ReportAbout, SceneAbout, Unit, parse_previous, write_clash_csv, write_clash_json};
use impinge_testkit::generate::solids::cuboid;

fn scene() -> Scene {
    let mut scene = Scene::new();
    let boxes = [
        ("wall \"A\", north", [2.0, 0.125, 1.0], [0.0; 3]),
        ("pipe", [0.125, 1.0, 0.125], [0.0; 3]),
        ("sign", [0.5; 3], [9.0; 3]),
        ("sign 2", [0.5; 3], [9.0; 3]),
        ("shelf", [1.0, 0.125, 0.25], [0.5, 0.28, 0.5]),
    ];
    for (name, half, at) in boxes {
        let plain = cuboid(half.map(|x| -x), half);
        let mesh = Mesh::new(plain.vertices, plain.faces).unwrap();
        let part = scene.add(name, &mesh, Pose::from_translation(at).unwrap()).unwrap();
        let details = Details { key: format!("key {name}"), kind: "IfcThing".to_owned(), ..Details::default() };
        scene.set_details(part, details);
    }
    scene
}

fn report(scene: &Scene, previous: Option<&Previous>) -> Report {
    let sides = [Side { label: "house".to_owned(), scene }];
    let options = Options { clearance: Some(0.1), previous, ..Options::new(1e-3) };
    find(&sides, options, Execution::default()).unwrap()
}

fn about(scene: &Scene) -> ReportAbout<'static> {
    let asked = Asked { tolerance: 1e-3, clearance: Some(0.1), ..Asked::default() };
    ReportAbout { unit: Some(Unit::Meter), scenes: vec![SceneAbout::new("house", scene)], asked, rules: None }
}

pub(super) fn json() -> String {
    let scene = scene();
    let mut out = Vec::new();
    write_clash_json(&mut out, &report(&scene, None), &about(&scene), "0.0.0").unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn a_report_reads_back_as_the_previous_one() {
    let scene = scene();
    let first = report(&scene, None);
    let listed = first.clashes.len() + first.duplicates.len();
    assert!(listed >= 3);
    let previous = parse_previous(json().as_bytes(), Some(Unit::Meter)).unwrap();
    assert_eq!(previous.clashes.len(), listed);
    let second = report(&scene, Some(&previous));
    assert_eq!(second.count_of(Status::Active), listed);
    assert_eq!(second.gone, Some(Vec::new()));
    let clash = |id: &str| previous.clashes.iter().find(|known| known.id == id).unwrap();
    for found in &first.clashes {
        let known = clash(&found.id);
        assert_eq!((known.depth, known.gap, known.kind.as_str()), (found.depth, found.gap, found.kind.name()));
        assert_eq!(known.parts, [found.a.identity(), found.b.identity()]);
    }
    // Lengths are converted to the unit of the scenes.
    let millimeters = parse_previous(json().as_bytes(), Some(Unit::Millimeter)).unwrap();
    let gap = first.clashes.iter().find_map(|found| Some((clash(&found.id).gap?, &found.id))).unwrap();
    let converted = millimeters.clashes.iter().find(|known| &known.id == gap.1).unwrap().gap.unwrap();
    assert!((converted[1] - 1e3 * gap.0[1]).abs() < 1e-9);
}

#[test]
fn a_previous_report_is_read_leniently() {
    let of = |text: &str| parse_previous(text.as_bytes(), None);
    assert_eq!(of(r#"{"schema": "impinge.clash/1"}"#).unwrap(), Previous::default());
    let found = of(r#"{"schema": "impinge.clash/1", "future": [1], "clashes": [{"id": "c-x", "more": 5}]}"#).unwrap();
    assert_eq!((found.clashes[0].id.as_str(), found.clashes[0].status), ("c-x", Status::New));
    for (text, part) in [
        ("", "line 1"),
        ("{}", "schema"),
        (r#"{"schema": "impinge.check/1"}"#, "impinge.clash/1"),
        ("{\"schema\": \"impinge.clash/1\",\n\"clashes\": 5}", "line 2"),
        (r#"{"schema": "impinge.clash/1", "clashes": [{"id": "c-x", "status": "fine"}]}"#, "clash \"c-x\""),
        (r#"{"schema": "impinge.clash/1", "unit": "league"}"#, "unit"),
        (r#"{"schema": "impinge.clash/1", "unit": "mm", "clashes": [{"id": "a", "gap": [0, 1]}]}"#, "unit"),
    ] {
        let error = of(text).unwrap_err().to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
}

#[test]
fn csv_has_one_row_a_clash() {
    let scene = scene();
    let found = report(&scene, None);
    let mut out = Vec::new();
    write_clash_csv(&mut out, &found, &about(&scene)).unwrap();
    let mut reader = csv::Reader::from_reader(&out[..]);
    let head = reader.headers().unwrap().clone();
    let column = |name: &str| head.iter().position(|column| column == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), found.clashes.len() + 1);
    assert_eq!((&rows[0][1], &rows[0][column("a_name")], &rows[0][column("b_name")]), ("duplicate", "sign", "sign 2"));
    let clash = rows.iter().find(|row| &row[1] == "clash").unwrap();
    assert_eq!(&clash[column("b_name")], "wall \"A\", north");
    assert_eq!(&clash[column("a_type")], "IfcThing");
    for (row, clash) in rows[1..].iter().zip(&found.clashes) {
        let lower = &row[column("depth_lower")];
        assert_eq!(lower.parse().ok(), clash.depth.map(|depth| depth[0]));
    }
}

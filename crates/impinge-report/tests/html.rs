//! The page of a report: its blocks say what the report says, and far from the origin nothing is
//! lost.

mod blocks;

use blocks::block;
use impinge::clash::{self, Options, Report, Side};
use impinge::query::batch::Execution;
use impinge::scene::Scene;
use impinge::{Mesh, Pose, Positions};
use impinge_files::{ReportAbout, SceneAbout, write_clash_json};
use impinge_report::html::write_clash_page;
use impinge_report::picture::Axis;
use serde_json::Value;

const FAR: f64 = 500_000.0;

/// Faces of a cuboid. Bit `k` of a corner is set if it is on the upper side of axis `k`.
const FACES: &str = "021 123 456 576 014 154 263 367 042 246 135 375";

/// Returns the cuboid from the origin to a corner.
fn cuboid(high: [f64; 3]) -> Mesh {
    let corners = (0..8).map(|at| std::array::from_fn(|k| if at >> k & 1 == 0 { 0.0 } else { high[k] }));
    let face = |text: &str| -> [u32; 3] { std::array::from_fn(|k| u32::from(text.as_bytes()[k] - b'0')) };
    Mesh::new(Positions::F64(corners.collect()), FACES.split(' ').map(face).collect::<Vec<_>>()).unwrap()
}

/// Returns a row of walls that share a mesh, each 0.1 deep in the next, and a pipe through the
/// first.
fn row_of_walls() -> Scene {
    let (wall, pipe) = (cuboid([1.0, 0.25, 3.0]), cuboid([0.125, 4.0, 0.125]));
    let mut scene = Scene::new();
    for at in 0..4 {
        let place = [FAR + 0.9 * f64::from(at), 0.0, 0.0];
        scene.add(format!("wall {at}"), &wall, Pose::from_translation(place).unwrap()).unwrap();
    }
    scene.add("pipe </script>", &pipe, Pose::from_translation([FAR + 0.3, -2.0, 1.0]).unwrap()).unwrap();
    scene
}

fn answer(scene: &Scene) -> (Report, ReportAbout<'static>) {
    let sides = [Side { label: "house".to_owned(), scene }];
    let report = clash::find(&sides, Options::new(1e-3), Execution::default()).unwrap();
    (report, ReportAbout { scenes: vec![SceneAbout::new("house", scene)], ..ReportAbout::default() })
}

fn page(scene: &Scene) -> String {
    let (report, about) = answer(scene);
    let mut page = Vec::new();
    let sides = [Side { label: "house".to_owned(), scene }];
    write_clash_page(&mut page, &sides, &report, &about, Axis::Y, "1.2.3").unwrap();
    String::from_utf8(page).unwrap()
}

#[test]
fn the_page_has_the_report_as_it_is() {
    let scene = row_of_walls();
    let (report, about) = answer(&scene);
    let mut json = Vec::new();
    write_clash_json(&mut json, &report, &about, "1.2.3").unwrap();
    assert_eq!(block(&page(&scene), "report"), json);
}

#[test]
fn facts_have_a_sentence_for_each_clash_and_a_name_for_each_part() {
    let facts: Value = serde_json::from_slice(&block(&page(&row_of_walls()), "facts")).unwrap();
    let sentences: Vec<&str> =
        facts["sentences"].as_array().unwrap().iter().map(|sentence| sentence.as_str().unwrap()).collect();
    assert_eq!(sentences.len(), 4, "{sentences:?}");
    assert!(sentences.iter().all(|sentence| sentence.contains("enters")), "{sentences:?}");
    assert_eq!(facts["scenes"][0]["parts"][4][0], "pipe </script>");
    assert_eq!((&facts["up"], &facts["boxes"], &facts["curves"]), (&"y".into(), &0.into(), &4.into()));
    // Half of a step of 1/65535 of the box, along three axes, of the longer of both meshes.
    let rounding = facts["rounding"].as_f64().unwrap();
    assert!((2e-5..4e-5).contains(&rounding), "{rounding}");
}

#[test]
fn a_shared_mesh_is_written_once_and_places_are_exact_far_away() {
    let geometry = block(&page(&row_of_walls()), "geometry");
    assert_eq!(geometry[0], 2, "number of meshes");
    let has = |number: f64| geometry.windows(8).any(|bytes| bytes == number.to_le_bytes());
    for at in 0..4 {
        assert!(has(FAR + 0.9 * f64::from(at)));
    }
    // A box in the world would have this corner.
    assert!(!has(FAR + 1.0));
}

#[test]
fn the_same_input_gives_the_same_bytes_for_any_threads() {
    let scene = row_of_walls();
    let with =
        |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| page(&scene));
    assert_eq!(with(1), with(3));
}

#[test]
fn an_empty_report_is_a_page_too() {
    assert_eq!(block(&page(&Scene::new()), "geometry"), [0, 0, 0]);
}

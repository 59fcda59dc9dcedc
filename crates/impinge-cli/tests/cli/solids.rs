//! Tests of `--solid`, `--penetrates`, `--weld` and `--orient`.

use crate::{Folder, cuboid, without_seconds};

/// Writes `open.obj`: `big.obj` without its last side.
fn with_an_open_box(folder: &Folder) {
    let open: Vec<String> = folder.read("big.obj").lines().map(str::to_owned).collect();
    folder.write("open.obj", &(open[..open.len() - 1].join("\n") + "\n"));
}

#[test]
fn a_mesh_inside_a_solid_intersects_it() {
    let folder = Folder::new();
    for (arguments, code) in [
        ("cube.obj big.obj --solid", 1),
        ("cube.obj big.obj --solid=b", 1),
        ("cube.obj big.obj --solid=a", 0),
        ("big.obj cube.obj --solid=a", 1),
        ("big.obj cube.obj --solid=b", 0),
        ("big.obj cube.obj --solid --pose-b 9,0,0", 0),
    ] {
        let run = folder.run(&format!("check {arguments}"));
        assert_eq!((run.code, run.stderr.as_str()), (code, ""), "{arguments}");
        let verdict = if code == 0 { "No intersection\n" } else { "lies inside" };
        assert!(run.stdout.contains(verdict), "{}", run.stdout);
    }
    let refused = folder.run("check cube.obj big.obj --solid=c");
    assert_eq!(refused.code, 2);
}

#[test]
fn json_names_the_contained_mesh_if_there_is_one() {
    let folder = Folder::new();
    let part = |arguments: &str| {
        let run = folder.run(&format!("check {arguments} --json"));
        assert_eq!(run.stderr, "", "{arguments}");
        let text = without_seconds(&run.stdout).to_owned();
        text[text.find("\"intersects\"").unwrap()..].to_owned()
    };
    let contained = |side: &str| format!("\"intersects\":true,\"pairs\":0,\"contained\":\"{side}\"");
    assert_eq!(part("cube.obj big.obj --solid"), contained("a"));
    assert_eq!(part("big.obj cube.obj --solid"), contained("b"));
    assert_eq!(part("big.obj cube.obj --solid=b"), "\"intersects\":false,\"pairs\":0");
    // Each mesh has a small cube inside the large cube of the other.
    folder.write("one.obj", &pair_of_cubes(0.0, 40.0));
    folder.write("two.obj", &pair_of_cubes(40.0, 0.0));
    assert_eq!(part("one.obj two.obj --solid"), contained("both"));
}

#[test]
fn the_distance_of_intersecting_solids_is_zero() {
    let folder = Folder::new();
    let distance = |arguments: &str| {
        let run = folder.run(&format!("check {arguments} --distance --json"));
        let object: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        object["distance"].clone()
    };
    let inside = distance("cube.obj big.obj --solid");
    assert_eq!(inside, serde_json::json!({ "distance": 0.0, "lower": 0.0, "upper": 0.0 }));
    // If only the inner mesh is solid, the surfaces are apart.
    for arguments in ["cube.obj big.obj", "cube.obj big.obj --solid=a", "big.obj cube.obj --solid --pose-b 90,0,0"] {
        let apart = distance(arguments);
        assert!(apart["distance"].as_f64().unwrap() > 0.1 && apart["face_a"].is_u64(), "{arguments}: {apart}");
    }
    let text = folder.run("check cube.obj big.obj --solid --distance");
    assert!(text.stdout.contains("0: one lies inside the other"));
}

/// Returns an OBJ mesh of two cubes centered on the x axis: one of edge 5 at `large_at` and one of
/// edge 1 at `small_at`.
fn pair_of_cubes(large_at: f64, small_at: f64) -> String {
    let mut text = String::new();
    let mut first = 1;
    for (at, half) in [(large_at, 2.5), (small_at, 0.5)] {
        for i in 0..8 {
            let corner = [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { half } else { -half });
            text += &format!("v {} {} {}\n", corner[0] + at, corner[1], corner[2]);
        }
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            text += &format!("f {} {} {} {}\n", face[0] + first, face[1] + first, face[2] + first, face[3] + first);
        }
        first += 8;
    }
    text
}

#[test]
fn touching_is_not_penetrating() {
    let folder = Folder::new();
    let object = |arguments: &str| -> (i32, serde_json::Value) {
        let run = folder.run(&format!("check {arguments} --json"));
        (run.code, serde_json::from_str(&run.stdout).unwrap())
    };
    for (arguments, intersects, penetrates) in [
        ("cube.obj cube.obj --penetrates --pose-b 1,0,0", true, false),
        ("cube.obj cube.obj --penetrates --pose-b 1,1,1", true, false),
        ("cube.obj cube.obj --penetrates --pose-b 0.5,0,0", true, true),
        ("cube.obj cube.obj --penetrates", true, true),
        ("cube.obj big.obj --penetrates", false, true),
        ("cube.obj big.obj --penetrates --pose-b 9,0,0", false, false),
    ] {
        let (code, found) = object(arguments);
        assert_eq!(
            (found["intersects"].as_bool(), found["penetrates"].as_bool()),
            (Some(intersects), Some(penetrates))
        );
        assert_eq!(code, i32::from(penetrates), "{arguments}");
        assert!(found.get("undecided").is_none() && found.get("open").is_none());
    }
    let touching = folder.run("check cube.obj cube.obj --penetrates --pose-b 1,0,0");
    assert!(
        touching.stdout.contains("The meshes touch, but do not penetrate: 62 pairs of faces\n"),
        "{}",
        touching.stdout
    );
    assert!(!folder.run("check cube.obj cube.obj --json").stdout.contains("penetrates"));
}

#[test]
fn open_solids_cause_a_warning() {
    let folder = Folder::new();
    with_an_open_box(&folder);
    let warning = "warning: open.obj: the mesh is not closed, so a point counts as inside if the generalized winding \
                   number exceeds one half (4 edges open)\n";
    let run = folder.run("check cube.obj open.obj --solid --json");
    assert_eq!((run.code, run.stderr.as_str()), (1, warning));
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((found["contained"].as_str(), found["open"][0].as_str()), (Some("a"), Some("b")));
    let undecided = folder.run("check open.obj cube.obj --penetrates --pose-b 0,2.5,0 --json");
    assert_eq!((undecided.code, undecided.stderr.as_str()), (1, warning));
    let found: serde_json::Value = serde_json::from_str(&undecided.stdout).unwrap();
    assert_eq!((found["penetrates"].as_bool(), found["undecided"][0].as_str()), (Some(true), Some("penetrates")));
}

/// Writes a cube with three sides turned, a cube with one corner of one face moved slightly, and a
/// small cube that fits inside both.
fn with_broken_cubes(folder: &Folder) {
    let cube = folder.read("cube.obj");
    let turned = cube.replace("f 1 3 4 2", "f 2 4 3 1").replace("f 1 2 6 5", "f 5 6 2 1");
    folder.write("turned.obj", &turned.replace("f 2 4 8 6", "f 6 8 4 2"));
    folder.write("cracked.obj", &(cube.replace("f 2 4 8 6", "f 2 4 9 6") + "v 1 1 1.0000000001\n"));
    folder.write("inner.obj", &cuboid("inner", [0.25; 3], 0.5));
}

#[test]
fn meshes_are_repaired_on_request_only_and_with_a_note() {
    let folder = Folder::new();
    with_broken_cubes(&folder);
    for (file, option, advice, done) in [
        ("turned.obj", "--orient", "--orient makes the orientation consistent", "turned.obj: repaired: 6 faces turned"),
        ("cracked.obj", "--weld 1e-9", "--weld 1e-9 closes open edges", "cracked.obj: repaired: 1 vertex welded"),
    ] {
        let unrepaired = folder.run(&format!("check {file} inner.obj --solid"));
        assert!(unrepaired.stderr.contains(advice), "{}", unrepaired.stderr);
        assert!(folder.run(&format!("inspect {file}")).stdout.contains(advice));
        let repaired = folder.run(&format!("check {file} inner.obj --solid {option}"));
        assert_eq!(repaired.code, 1);
        assert!(repaired.stderr.contains(done) && !repaired.stderr.contains("warning"), "{}", repaired.stderr);
        let object = folder.run(&format!("check {file} inner.obj --solid --json {option}"));
        let found: serde_json::Value = serde_json::from_str(&object.stdout).unwrap();
        assert_eq!(found["contained"].as_str(), Some("b"));
        let repair = &found["a"]["repair"];
        let changed = [&repair["turned_faces"], &repair["welded_vertices"]].map(|count| count.as_u64().unwrap());
        assert_eq!(changed, if file == "turned.obj" { [6, 0] } else { [0, 1] });
        assert_eq!(folder.run(&format!("bake {file} -o baked.impinge {option}")).code, 0);
        assert!(folder.run("inspect baked.impinge").stdout.contains("closed: each edge has two faces"));
    }
    assert_eq!(folder.run("check turned.obj inner.obj --weld -1").code, 2);
    let sound = folder.run("check cube.obj inner.obj --orient");
    assert!(sound.stderr.contains("note: cube.obj: nothing to repair"), "{}", sound.stderr);
}

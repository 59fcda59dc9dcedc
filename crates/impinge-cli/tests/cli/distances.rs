//! Tests of `--distance` and `--clearance`.

use crate::Folder;

fn json(stdout: &str) -> serde_json::Value {
    serde_json::from_str(stdout).unwrap()
}

#[test]
fn the_distance_of_two_cubes_is_an_interval_with_nearest_points() {
    let folder = Folder::new();
    let run = folder.run("check cube.obj cube.obj --pose-b 4,0.25,0 --distance --json");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    let distance = &json(&run.stdout)["distance"];
    let number = |name: &str| distance[name].as_f64().unwrap();
    assert!(number("lower") <= 3.0 && 3.0 <= number("upper") && number("upper") - number("lower") < 1e-12);
    assert_eq!(number("distance"), number("upper"));
    assert_eq!(distance["point_a"][0].as_f64().unwrap(), 1.0);
    assert_eq!(distance["point_b"][0].as_f64().unwrap(), 4.0);
    assert!(distance["face_a"].as_u64().unwrap() < 12 && distance["face_b"].as_u64().unwrap() < 12);
    let report = folder.run("check cube.obj cube.obj --pose-b 4,0.25,0 --distance");
    assert!(report.stdout.contains("\ndistance  3.000; A face "), "{}", report.stdout);
}

#[test]
fn meshes_that_touch_have_distance_zero() {
    let folder = Folder::new();
    let run = folder.run("check cube.obj cube.obj --pose-b 1,0,0 --distance --json");
    assert_eq!(run.code, 1);
    assert_eq!(json(&run.stdout)["distance"]["distance"].as_f64(), Some(0.0));
}

#[test]
fn a_clearance_is_decided_exactly_at_its_limit() {
    let folder = Folder::new();
    // The gaps along the axes are 3, 4 and 12, so the distance is 13.
    for (clearance, within) in [("13", true), ("13.000000000000002", true), ("12.999999999999998", false)] {
        let run = folder.run(&format!("check cube.obj cube.obj --pose-b 4,5,13 --clearance {clearance} --json"));
        assert_eq!(run.code, i32::from(within), "{clearance}");
        let answer = json(&run.stdout);
        assert_eq!(answer["clearance"]["within"].as_bool(), Some(within));
        assert_eq!(answer["intersects"].as_bool(), Some(false));
        assert!(answer.get("distance").is_none());
    }
    let report = folder.run("check cube.obj cube.obj --pose-b 4,5,13 --clearance 13");
    assert!(report.stdout.contains("\nclearance 13.00 is not kept\n"), "{}", report.stdout);
}

#[test]
fn invalid_clearances_are_errors() {
    let folder = Folder::new();
    for wrong in ["-1", "nan", "inf", "x"] {
        let run = folder.run(&format!("check cube.obj cube.obj --clearance {wrong}"));
        assert_eq!(run.code, 2, "{wrong}");
        assert!(run.stderr.contains("a clearance is a finite number of at least 0"), "{}", run.stderr);
    }
}

#[test]
fn an_empty_mesh_has_no_distance() {
    let folder = Folder::new();
    folder.write("empty.obj", "v 0 0 0\n");
    let run = folder.run("check cube.obj empty.obj --distance --clearance 1000 --json --allow-empty");
    assert_eq!(run.code, 0);
    let answer = json(&run.stdout);
    assert!(answer.get("distance").is_none());
    assert_eq!(answer["clearance"]["within"].as_bool(), Some(false));
}

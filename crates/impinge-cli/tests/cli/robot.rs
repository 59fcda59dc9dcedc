//! `impinge robot`: configurations, paths, clearances, and errors.

use serde_json::Value;

use crate::{Folder, Run};

const GANTRY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/robots/gantry");

fn json(run: &Run) -> Value {
    serde_json::from_str(&run.stdout).unwrap()
}

fn ask(folder: &Folder, question: &str, options: &str) -> Run {
    folder.run(&format!("robot {question} {GANTRY}.urdf --srdf {GANTRY}.srdf {options}"))
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("q.csv", "0,0,0,0,0\n-0.25,3,2.6,0,0\n");
    folder.write("named.csv", "grip,wrist,elbow,shoulder,slide\n0,0,2.6,3,-0.25\n");
    folder.write("path.csv", "0,0,0,0,0\n0,0.5,0.5,0,0\n-0.25,3,2.6,0,0\n");
    folder
}

#[test]
fn inspect_lists_joints_and_pairs() {
    let folder = folder();
    let run = ask(&folder, "inspect", "");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{run:?}");
    assert!(run.stdout.starts_with("gantry  8 links  5 coordinates  11 pairs checked, 10 ignored\n"), "{run:?}");
    let object = json(&ask(&folder, "inspect", "--json"));
    assert_eq!((&object["schema"], &object["robot"]), (&"impinge.robot.inspect/1".into(), &"gantry".into()));
    assert_eq!(object["coordinates"][1]["name"], "shoulder");
    assert_eq!(object["links_without_shape"][0], "tool");
}

#[test]
fn check_finds_the_configurations_that_collide() {
    let folder = folder();
    let run = ask(&folder, "check", "--configs q.csv");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{run:?}");
    assert!(run.stdout.starts_with("1 of 2 configurations collide\n"), "{run:?}");
    let object = json(&ask(&folder, "check", "--configs q.csv --all --json"));
    assert_eq!((&object["schema"], &object["colliding"]), (&"impinge.robot.check/1".into(), &1.into()));
    assert_eq!(object["collisions"][0]["configuration"], 1);
    let named = json(&ask(&folder, "check", "--configs named.csv --all --json"));
    assert_eq!(named["collisions"][0]["pairs"], object["collisions"][0]["pairs"]);
    let drawn = ask(&folder, "check", "--configs q.csv --picture hit.png");
    assert_eq!((drawn.code, drawn.stderr.as_str()), (1, ""), "{drawn:?}");
    assert!(std::fs::read(folder.path("hit.png")).unwrap().starts_with(b"\x89PNG"));
    // A free configuration that is too near to an obstacle.
    folder.write("free.csv", "0,0,0,0,0\n");
    assert_eq!(ask(&folder, "check", "--configs free.csv").code, 0);
    let far = "--configs free.csv --scene cube.obj --padding 9";
    assert_eq!(ask(&folder, "check", far).code, 1);
}

#[test]
fn planning_scenes_are_obstacles() {
    let folder = folder();
    let object = |frame: &str, z: f64| {
        format!(
            "world: {{collision_objects: [{{id: shelf, header: {{frame_id: {frame}}}, primitives: [{{type: box, \
             dimensions: [9, 9, 0.5]}}], primitive_poses: [{{position: [0, 0, {z}]}}]}}]}}\n"
        )
    };
    folder.write("free.csv", "0,0,0,0,0\n");
    folder.write("high.yaml", &object("base", 99.0));
    folder.write("low.yaml", &object("base", 0.5));
    folder.write("far.scene", "far\n* ball\n1\nsphere\n0.5\n99 0 0\n0 0 0 1\n0 0 0 0\n.\n");
    for (scene, code) in [("high.yaml", 0), ("low.yaml", 1), ("far.scene", 0)] {
        let run = ask(&folder, "check", &format!("--configs free.csv --scene {scene} --all --json"));
        assert_eq!((run.code, run.stderr.as_str()), (code, ""), "{scene}: {run:?}");
        assert_eq!(run.stdout.contains("\"other\":\"shelf\""), code == 1, "{run:?}");
    }
    folder.write("high.yaml", &object("world", 99.0));
    let warned = ask(&folder, "check", "--configs free.csv --scene high.yaml");
    assert_eq!(warned.code, 0);
    assert!(warned.stderr.contains("high.yaml, line 1: the frame \"world\" is not known"), "{warned:?}");
    folder.write("bad.yaml", "world:\n  collision_objects:\n  - id: shelf\n    planes: [{}]\n");
    let refused = ask(&folder, "check", "--configs free.csv --scene bad.yaml");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("bad.yaml, line 4: needs the plane of object \"shelf\""), "{refused:?}");
}

#[test]
fn motion_proves_legs_and_finds_the_first_contact() {
    let folder = folder();
    let run = ask(&folder, "motion", "--path path.csv --json");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{run:?}");
    let object = json(&run);
    assert_eq!((&object["schema"], &object["verdict"]), (&"impinge.robot.motion/1".into(), &"collides".into()));
    let legs = object["legs"].as_array().unwrap();
    assert_eq!((&legs[0]["verdict"], &legs[0]["t_free"]), (&"free".into(), &1.0.into()));
    let [free, hit] = [&legs[1]["t_free"], &legs[1]["t_hit"]].map(|time| time.as_f64().unwrap());
    assert!(0.0 < free && free <= hit && hit - free < 1e-9 && hit < 1.0);
    folder.write("free.csv", "0,0,0,0,0\n0,0.5,0.5,0,0\n");
    let run = ask(&folder, "motion", "--path free.csv");
    assert_eq!(run.code, 0);
    assert!(run.stdout.starts_with("The path is free: 1 leg proved\n"), "{run:?}");
}

#[test]
fn audit_proves_pairs_and_writes_an_srdf_file() {
    let folder = folder();
    let run = ask(&folder, "audit", "--samples 500 --out new.srdf --json");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{run:?}");
    let object = json(&run);
    assert_eq!((&object["schema"], &object["samples"]), (&"impinge.robot.audit/1".into(), &500.into()));
    let pairs = object["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 21);
    let of = |finding: &str| pairs.iter().filter(|pair| pair["finding"] == finding).collect::<Vec<_>>();
    assert!(of("witness").iter().all(|pair| pair["witness"].as_array().unwrap().len() == 5));
    assert!(!of("proved_never").is_empty() && !of("witness").is_empty() && of("adjacent").len() >= 6);
    // The file disables the pairs that need no check, and no others.
    let inspected = folder.run(&format!("robot inspect {GANTRY}.urdf --srdf new.srdf --json"));
    let ignored = of("adjacent").len() + of("proved_never").len() + of("always").len();
    assert_eq!(json(&inspected)["ignored"].as_array().unwrap().len(), ignored, "{inspected:?}");
    let run = ask(&folder, "audit", "--samples 500");
    assert!(run.stdout.starts_with("gantry  21 pairs\n") && run.stdout.contains("which is proved\n"), "{run:?}");
}

#[test]
fn clearance_measures_the_nearest_pair() {
    let folder = folder();
    let run = ask(&folder, "clearance", "--configs q.csv --json");
    assert_eq!(run.code, 1, "{run:?}");
    let rows = json(&run)["clearances"].clone();
    assert!(rows[0]["lower"].as_f64().unwrap() > 0.0 && rows[0]["pair"].is_array());
    assert_eq!(rows[1]["lower"], 0.0);
}

#[test]
fn faults_are_named() {
    let folder = folder();
    folder.write("short.csv", "0,0,0,0,0\n1,2\n");
    folder.write("text.csv", "0,0,0,0,0\n0,0,0,zero,0\n");
    folder.write("bad.npy", "no array");
    for (options, part) in [
        ("check --configs short.csv", "short.csv, line 2: a row has 2 values; the robot has 5 coordinates"),
        ("check --configs text.csv", "text.csv, line 2: \"zero\" is not a number"),
        ("check --configs bad.npy", "bad.npy: not an array file of NumPy"),
        ("check --configs q.csv --padding nose=1", "the robot has no link \"nose\""),
        ("check --configs q.csv --padding=-1", "\"-1\" is not a distance"),
        ("motion --path named.csv", "a path has at least two waypoints"),
    ] {
        let (question, options) = options.split_once(' ').unwrap();
        let run = ask(&folder, question, options);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{options}: {run:?}");
        assert!(run.stderr.contains(part), "{part:?} is not in {}", run.stderr);
    }
}

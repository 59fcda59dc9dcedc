//! Tests of `impinge hits`: the report, the JSON object, the contact sheet, and saved plans.

use std::fs;

use crate::Folder;

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/robot.glb");

#[test]
fn a_robot_gets_six_conservative_volumes_a_picture_and_a_plan() {
    let folder = Folder::new();
    let run = folder.run(&format!("hits {ROBOT} --save robot.toml --picture robot.png"));
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    let parts =
        ["head", "torso", "left arm", "right arm", "left leg", "right leg", "6 volumes", "14 animations", "none"];
    for part in parts {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let json = folder.run(&format!("hits {ROBOT} --json"));
    let object: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!((&object["schema"], &object["mode"]), (&"impinge.hits/1".into(), &"conservative".into()));
    let parts = object["parts"].as_array().unwrap();
    assert_eq!(parts.len(), 6);
    for part in parts {
        assert!(part["leak_share"] == 0.0 && part["looseness"].as_f64().unwrap() > 0.99, "{part}");
    }

    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(folder.path("robot.png")).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let colored = pixels.chunks(3).filter(|p| p[0].abs_diff(p[2]) > 60).count();
    let white = pixels.chunks(3).filter(|p| **p == [255; 3]).count();
    assert!(colored > 20_000 && white > pixels.len() / 6, "{colored} {white}");

    let again = folder.run(&format!("hits {ROBOT} --plan robot.toml --mode snug"));
    assert!(again.code == 0 && again.stdout.contains("left arm") && again.stdout.contains(" %"), "{again:?}");
}

#[test]
fn invalid_characters_plans_and_outputs_are_errors() {
    let folder = Folder::new();
    folder.write("plan.toml", "[[part]]\nbones = [\"Tail\"]\n");
    folder.write("plain.gltf", r#"{"asset": {"version": "2.0"}}"#);
    for (arguments, message) in [
        (format!("hits {ROBOT} --picture out.jpg"), "unknown extension for an output file"),
        (format!("hits {ROBOT} --animation Fly --picture out.png"), "there is no animation \"Fly\""),
        (format!("hits {ROBOT} --plan plan.toml"), "a bone of the rig"),
        ("hits cube.obj".to_owned(), "expected a glTF document"),
        ("hits plain.gltf".to_owned(), "at least one face"),
        ("hits missing.glb".to_owned(), "missing.glb"),
    ] {
        let run = folder.run(&arguments);
        assert!(run.code == 2 && run.stdout.is_empty() && run.stderr.contains(message), "{arguments}: {run:?}");
    }
}

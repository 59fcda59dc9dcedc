//! Tests of units: stated, overridden, converted and suspected to be wrong.

use crate::Folder;

/// One triangle, in meters like every glTF file.
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;

fn pose(stdout: &str, side: &str) -> serde_json::Value {
    let json: serde_json::Value = serde_json::from_str(stdout).unwrap();
    json[side]["pose"].clone()
}

#[test]
fn different_units_are_converted_to_the_finer() {
    let folder = Folder::new();
    folder.write("triangle.gltf", GLTF);
    // The far end of the triangle is 1000 mm away.
    let run = folder.run("check triangle.gltf cube.obj --unit-b mm --pose-b 999.5,-0.5,-0.5 --json");
    assert_eq!((run.code, run.stderr.as_str()), (1, "note: A is in m and B in mm: A is scaled by 1000 to mm\n"));
    assert_eq!(pose(&run.stdout, "a")[1], serde_json::json!([0.0, 1000.0, 0.0, 0.0]));
    assert_eq!(pose(&run.stdout, "b")[0], serde_json::json!([1.0, 0.0, 0.0, 999.5]));
    assert!(run.stdout.contains("\"triangles\":1,\"unit\":\"m\",") && run.stdout.contains("\"unit\":\"mm\","));
    let past = folder.run("check triangle.gltf cube.obj --unit-b mm --pose-b 1000.5,-0.5,-0.5");
    assert_eq!(past.code, 0);
}

#[test]
fn a_pose_is_in_the_finer_unit_and_comes_after_the_scale() {
    let folder = Folder::new();
    let run = folder.run("check cube.obj cube.obj --unit-a mm --unit-b in --pose-b -1,0,0,0,0,0,1 --json");
    assert_eq!(run.stderr, "note: B is in in and A in mm: B is scaled by 25.4 to mm\n");
    // Half a turn about z.
    let expected = serde_json::json!([[-25.4, 0.0, 0.0, -1.0], [0.0, -25.4, 0.0, 0.0], [0.0, 0.0, 25.4, 0.0]]);
    assert_eq!(pose(&run.stdout, "b").as_array().unwrap()[..3], expected.as_array().unwrap()[..]);
}

#[test]
fn the_report_is_in_the_finer_unit() {
    let folder = Folder::new();
    let run = folder.run("check cube.obj cube.obj --unit-a cm --unit-b mm --pose-b 9.5,9.5,9.5");
    assert_eq!(run.code, 1);
    assert!(run.stdout.contains("1.000 x 1.000 x 1.000 cm\n") && run.stdout.contains("1.000 x 1.000 x 1.000 mm\n"));
    assert!(run.stdout.contains("curves    1 closed, 0 open; 3.000 mm long in all\n"), "{}", run.stdout);
}

#[test]
fn a_stated_unit_can_be_overridden() {
    let folder = Folder::new();
    folder.write("triangle.gltf", GLTF);
    let run = folder.run("check triangle.gltf cube.obj --unit-a mm --unit-b mm --json");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""));
    assert_eq!(pose(&run.stdout, "a")[0], serde_json::json!([1.0, 0.0, 0.0, 0.0]));
}

#[test]
fn a_missing_unit_is_taken_from_the_other_mesh_with_a_note() {
    let folder = Folder::new();
    folder.write("triangle.gltf", GLTF);
    let run = folder.run("check triangle.gltf cube.obj --json");
    let note = "note: A is in m and B states no unit: it is taken to be in m too (--unit-b overrides it)\n";
    assert_eq!((run.code, run.stderr.as_str()), (1, note));
}

#[test]
fn sizes_that_suggest_a_wrong_unit_cause_a_warning() {
    let folder = Folder::new();
    for (edge, quotient) in
        [(25.4, Some("25.4")), (26.0, Some("25.4")), (900.0, Some("1000")), (10.0, None), (100.0, None)]
    {
        folder.write("other.obj", &crate::cuboid("other", [5.0; 3], edge));
        for arguments in ["check cube.obj other.obj", "check other.obj cube.obj"] {
            let run = folder.run(arguments);
            let larger = if arguments.ends_with("other.obj") { "B" } else { "A" };
            match quotient {
                Some(quotient) => {
                    assert!(run.stderr.starts_with(&format!("warning: {larger} is ")), "{edge}: {}", run.stderr);
                    assert!(
                        run.stderr.contains(&format!(" times as large as the other, and {quotient} is the quotient"))
                    );
                }
                None => assert_eq!(run.stderr, "", "{edge}"),
            }
        }
    }
    folder.write("other.obj", &crate::cuboid("other", [5.0; 3], 25.4));
    // There is no warning if the units are stated, or if a pose makes up for the difference.
    assert_eq!(folder.run("check cube.obj other.obj --unit-a mm --unit-b mm").stderr, "");
    folder.write("scale", "25.4 0 0 0  0 25.4 0 0  0 0 25.4 0  0 0 0 1");
    assert_eq!(folder.run("check cube.obj other.obj --pose-a scale").stderr, "");
}

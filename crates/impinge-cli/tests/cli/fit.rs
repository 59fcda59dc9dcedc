//! Tests of `impinge fit`: one row per volume, finite numbers, and the known sizes for a cube.

use serde_json::Value;

use crate::Folder;

fn object(folder: &Folder, arguments: &str) -> Value {
    let run = folder.run(arguments);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{arguments}");
    assert_eq!(run.stdout.lines().count(), 1);
    assert!(!run.stdout.contains("null"));
    serde_json::from_str(&run.stdout).unwrap()
}

fn volume<'a>(object: &'a Value, name: &str) -> &'a Value {
    let volumes = object["volumes"].as_array().unwrap();
    volumes.iter().find(|volume| volume["name"] == name).unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn volumes_around_a_cube_have_the_expected_sizes() {
    let folder = Folder::new();
    let object = object(&folder, "fit big.obj --json");
    assert_eq!(object["schema"], "impinge.fit/1");
    assert_eq!(object["mesh"]["path"], "big.obj");
    assert_eq!((&object["mesh"]["triangles"], &object["mesh"]["corners"]), (&12.into(), &8.into()));
    let hull = &object["hull"];
    assert_eq!((&hull["vertices"], &hull["volume"], &hull["surface_area"]), (&8.into(), &125.0.into(), &150.0.into()));
    let sphere = 4.0 / 3.0 * std::f64::consts::PI * 0.75_f64.sqrt().powi(3);
    let expected = [
        ("box, min-max", 48, 1.0),
        ("box, min-widths u16", 20, 1.0),
        ("box, centre-radius u8", 16, 1.0),
        ("sphere, mean", 32, sphere),
        ("sphere, minimal", 32, sphere),
        ("oriented box", 120, 1.0),
        ("14-DOP", 112, 1.0),
        ("26-DOP", 208, 1.0),
    ];
    for (name, bytes, size) in expected {
        let volume = volume(&object, name);
        assert_eq!(volume["bytes"], bytes, "{name}");
        let own = volume["volume"].as_f64().unwrap() / 125.0;
        assert!((own / size - 1.0).abs() < 1e-4, "{name}: {own}");
        assert!((volume["relative_volume"].as_f64().unwrap() - own).abs() < 1e-4, "{name}");
    }
    let volumes = object["volumes"].as_array().unwrap();
    assert_eq!(volumes.len(), 20);
    for volume in volumes.iter().chain([&object["hull"]]) {
        for time in ["build_seconds", "overlap_seconds", "follow_seconds"] {
            assert!(volume[time].as_f64().unwrap() > 0.0, "{volume}");
        }
    }
    for volume in volumes {
        assert_eq!(volume.get("radius").is_some(), volume["name"].as_str().unwrap().starts_with("sphere"));
    }
    for purpose in ["static", "spinning", "deforming", "many_copies"] {
        let advice = &object["advice"][purpose];
        assert!(advice["sentence"].as_str().unwrap().starts_with(advice["volume"].as_str().unwrap()), "{advice}");
    }
    assert!(object["seconds"]["load"].as_f64().unwrap() >= 0.0 && object["seconds"]["measure"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_report_has_a_row_per_volume_and_recommendations() {
    let folder = Folder::new();
    let run = folder.run("fit cube.obj");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    for line in [
        "cube.obj\n",
        "12 triangles  8 corners",
        "volume ",
        "capsule ",
        "lozenge ",
        "sphere, minimal ",
        "static ",
        "many copies ",
    ] {
        assert!(run.stdout.contains(line), "{line}: {}", run.stdout);
    }
}

#[test]
fn volumes_are_fitted_to_a_flat_mesh_and_to_a_point() {
    let folder = Folder::new();
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\n");
    let flat = object(&folder, "fit flat.obj --json");
    assert_eq!(flat["mesh"]["corners"], 3, "a vertex that no face uses is no part of the surface");
    assert_eq!(volume(&flat, "box, min-max")["volume"], 0.0);
    assert!(volume(&flat, "box, min-max").get("relative_volume").is_none());
    folder.write("point.obj", "v 1 2 3\nf 1 1 1\n");
    let point = object(&folder, "fit point.obj --json");
    assert_eq!(volume(&point, "sphere, minimal")["radius"], 0.0);
}

#[test]
fn an_empty_or_missing_mesh_is_an_error() {
    let folder = Folder::new();
    folder.write("empty.obj", "v 0 0 0\n");
    let run = folder.run("fit empty.obj --json");
    assert_eq!(run.code, 2);
    let error: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((&error["error"]["kind"], &error["error"]["file"]), (&"empty".into(), &"empty.obj".into()));
    assert!(run.stderr.contains("error: empty.obj: "), "{}", run.stderr);
    assert_eq!(folder.run("fit missing.obj").code, 2);
}

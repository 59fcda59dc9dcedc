//! Tests of `impinge decompose`: hulls of the convex parts of a mesh.

use std::fs;

use serde_json::Value;

use crate::{Folder, cuboid};

/// Returns an L of three unit cubes, which touch each other's sides, as OBJ.
fn angle() -> String {
    // The outline of the L at both heights, and its faces counterclockwise seen from outside.
    let outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    let corners = [0, 1].map(|z| outline.map(|[x, y]| format!("v {x} {y} {z}\n"))).concat();
    let sides = (1..=6).map(|k| [k, k % 6 + 1, k % 6 + 7, k + 6]).map(|[a, b, c, d]| format!("f {a} {b} {c} {d}\n"));
    let ends = ["f 1 4 3 2\n", "f 1 6 5 4\n", "f 7 8 9 10\n", "f 7 10 11 12\n"].map(str::to_owned);
    corners.into_iter().chain(sides).chain(ends).collect()
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn an_angle_becomes_a_file_of_two_boxes() {
    let folder = Folder::new();
    folder.write("angle.obj", &angle());
    let run = folder.run("decompose angle.obj -o parts.obj --concavity 0.1");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{run:?}");
    assert!(run.stdout.starts_with("parts.obj: 2 hulls of 24 triangles, at most 0.0"), "{run:?}");
    let text = folder.read("parts.obj");
    let objects: Vec<&str> = text.lines().filter(|line| line.starts_with("o ")).collect();
    assert_eq!(objects, ["o part_0", "o part_1"]);
    // The hulls are two closed parts, which hold the solid and reach at most 0.1 into its notch.
    let mesh = object(&folder.run("inspect parts.obj --json").stdout);
    assert_eq!((&mesh["triangles"], &mesh["health"]["open_edges"]), (&24.into(), &0.into()), "{mesh}");
    let check = |pose: &str| folder.run(&format!("check parts.obj cube.obj --solid --penetrates --pose-b {pose}")).code;
    assert_eq!((check("1.1,1.1,0"), check("0.9,0.9,0"), check("0,0,1.1")), (0, 1, 0));
}

#[test]
fn a_folder_gets_a_file_for_each_hull() {
    let folder = Folder::new();
    folder.write("angle.obj", &angle());
    for name in ["parts", "empty"] {
        if name == "empty" {
            fs::create_dir(folder.path(name)).unwrap();
        }
        let run = folder.run(&format!("decompose angle.obj -o {name} --concavity 0.1 --json"));
        assert_eq!((run.code, run.stderr.as_str()), (0, ""));
        let mut files: Vec<_> =
            fs::read_dir(folder.path(name)).unwrap().map(|file| file.unwrap().file_name()).collect();
        files.sort();
        assert_eq!(files, ["part_0.obj", "part_1.obj"]);
        let report = object(&run.stdout);
        assert_eq!((&report["schema"], &report["triangles"]), (&"impinge.decompose/1".into(), &20.into()));
        assert!(report["concavity"].as_f64().unwrap() <= 0.1 && report["is_within"] == true, "{report}");
        for (at, hull) in report["hulls"].as_array().unwrap().iter().enumerate() {
            let file = folder.read(&format!("{name}/part_{at}.obj"));
            let count = |letter: &str| file.lines().filter(|line| line.starts_with(letter)).count();
            assert_eq!((&hull["vertices"], &hull["faces"]), (&count("v ").into(), &count("f ").into()));
        }
        assert!(["load", "build", "decompose", "write"].iter().all(|phase| report["seconds"][phase].is_number()));
    }
    let again = folder.run("decompose angle.obj -o parts");
    assert!(again.code == 2 && again.stderr.contains("parts: the folder is not empty"), "{again:?}");
}

#[test]
fn too_few_hulls_are_noted() {
    let folder = Folder::new();
    folder.write("angle.obj", &angle());
    let run = folder.run("decompose angle.obj -o one.obj --max-hulls 1 --concavity 0.1 --json");
    let report = object(&run.stdout);
    assert_eq!((run.code, report["hulls"].as_array().unwrap().len()), (0, 1));
    assert_eq!(report["is_within"], false);
    // The middle of the hull's slope is the farthest from the L: half of an edge.
    let bound = report["concavity"].as_f64().unwrap();
    assert!((0.5..0.5625).contains(&bound), "{bound}");
    assert!(run.stderr.starts_with("note: the hulls reach up to 0.5"), "{}", run.stderr);
}

#[test]
fn open_meshes_and_wrong_names_are_errors() {
    let folder = Folder::new();
    let open: String = cuboid("open", [0.0; 3], 1.0)
        .lines()
        .filter(|&line| line != "f 1 3 4 2")
        .map(|line| format!("{line}\n"))
        .collect();
    folder.write("open.obj", &open);
    fs::create_dir(folder.path("full")).unwrap();
    folder.write("full/file", "");
    for (arguments, kind, message) in [
        ("open.obj -o a.obj", "open", "the mesh is not closed: 4 edges open"),
        ("cube.obj -o cube.obj", "output", "would overwrite"),
        ("cube.obj -o a.stl", "output", "unknown extension"),
        ("cube.obj -o missing/a.obj", "output", "does not exist"),
        ("cube.obj -o missing/folder", "output", "does not exist"),
        ("cube.obj -o full", "output", "not empty"),
        ("cube.obj -o a.obj --concavity -1", "usage", "at least 0"),
        ("cube.obj -o a.obj --max-hulls 0", "usage", "from 1 to 16384"),
    ] {
        let run = folder.run(&format!("decompose {arguments} --json"));
        let error = &object(&run.stdout)["error"];
        assert_eq!((run.code, &error["kind"]), (2, &kind.into()), "{arguments}: {run:?}");
        assert!(error["message"].as_str().unwrap().contains(message), "{arguments}: {error}");
    }
}

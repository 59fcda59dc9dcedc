//! Tests of `impinge bake`: baked files replace meshes.

use std::fs;

use crate::Folder;

#[test]
fn a_baked_mesh_answers_like_the_mesh() {
    let folder = Folder::new();
    for (mesh, baked) in [("cube.obj", "cube.impinge"), ("big.obj", "BIG.IMPINGE")] {
        let run = folder.run(&format!("bake {mesh} -o {baked}"));
        assert_eq!((run.code, run.stderr.as_str()), (0, ""));
        assert!(run.stdout.starts_with(&format!("{baked}: 12 triangles, ")), "{}", run.stdout);
    }
    let check = |a: &str, b: &str, more: &str| folder.run(&format!("check {a} {b} --pose-b 0.5,2.5,0.25 {more}"));
    for (a, b) in [("cube.impinge", "BIG.IMPINGE"), ("cube.impinge", "big.obj"), ("cube.obj", "BIG.IMPINGE")] {
        for more in ["--pairs pairs.csv", "--distance", "--solid --penetrates --clearance 0.5"] {
            let expected = check("cube.obj", "big.obj", more);
            let pairs = more.starts_with("--pairs").then(|| folder.read("pairs.csv"));
            let run = check(a, b, more);
            assert_eq!((run.code, run.stderr), (expected.code, expected.stderr), "{a} {b} {more}");
            assert_eq!(more.starts_with("--pairs").then(|| folder.read("pairs.csv")), pairs, "{a} {b}");
        }
    }
    assert_eq!(check("cube.impinge", "BIG.IMPINGE", "").code, 1);
    // The parts and polygons of the original are preserved.
    check("cube.impinge", "BIG.IMPINGE", "--pairs pairs.csv");
    assert!(folder.read("pairs.csv").lines().nth(1).is_some_and(|line| line.ends_with(",cube,big")));
    let health = |mesh: &str| {
        let run = folder.run(&format!("inspect {mesh} --json"));
        let object: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        (object["health"].clone(), object["hierarchy"].clone())
    };
    assert_eq!(health("cube.impinge"), health("cube.obj"));
    // Baking a baked file gives the same bytes.
    assert_eq!(folder.run("bake cube.impinge -o again.impinge").code, 0);
    assert!(fs::read(folder.path("again.impinge")).unwrap() == fs::read(folder.path("cube.impinge")).unwrap());
    assert_eq!(folder.run("bake cube.obj -o tight.impinge --hierarchy tight").code, 0);
    assert_eq!(check("tight.impinge", "big.obj", "").code, 1);
}

#[test]
fn json_describes_the_baked_file() {
    let folder = Folder::new();
    let run = folder.run("bake cube.obj -o cube.impinge --json");
    let object: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((&object["schema"], &object["triangles"]), (&"impinge.bake/1".into(), &12.into()));
    assert_eq!(object["bytes"], fs::metadata(folder.path("cube.impinge")).unwrap().len());
    assert!(["load", "build", "write"].iter().all(|phase| object["seconds"][phase].as_f64().unwrap() >= 0.0));
}

#[test]
fn a_corrupt_baked_file_is_an_error() {
    let folder = Folder::new();
    folder.run("bake cube.obj -o cube.impinge");
    let whole = fs::read(folder.path("cube.impinge")).unwrap();
    for (at, kind) in [(0, "syntax"), (12, "unsupported-feature"), (70, "corrupt"), (720, "corrupt"), (1100, "corrupt")]
    {
        let mut corrupt = whole.clone();
        corrupt[at] ^= 0x55;
        fs::write(folder.path("corrupt.impinge"), &corrupt).unwrap();
        let run = folder.run("check corrupt.impinge big.obj --json");
        let object: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        assert_eq!((run.code, &object["error"]["kind"]), (2, &kind.into()), "byte {at}: {}", run.stdout);
        assert_eq!(object["error"]["file"], "corrupt.impinge");
    }
    assert_eq!(folder.run("bake cube.obj -o cube.ply").code, 2, "not the name of a baked file");
    assert_eq!(folder.run("bake cube.impinge -o cube.impinge").code, 2, "would overwrite its input");
    assert_eq!(fs::read(folder.path("cube.impinge")).unwrap(), whole);
}

#[test]
fn proxies_are_baked_on_request() {
    let folder = Folder::new();
    let run = folder.run("bake cube.obj -o cube.impinge --proxies");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert!(run.stdout.starts_with("cube.impinge: 12 triangles, a hull of 8 corners, "), "{}", run.stdout);
    let object = |command: &str| -> serde_json::Value {
        serde_json::from_str(&folder.run(&format!("{command} --json")).stdout).unwrap()
    };
    let baked = object("bake cube.obj -o again.impinge --proxies");
    assert_eq!(baked["hull_vertices"], 8);
    assert!(baked["seconds"]["proxies"].as_f64().unwrap() >= 0.0);
    assert!(fs::read(folder.path("again.impinge")).unwrap() == fs::read(folder.path("cube.impinge")).unwrap());
    let plain = object("bake cube.obj -o plain.impinge");
    assert!(plain.get("hull_vertices").is_none() && plain["seconds"].get("proxies").is_none());

    let proxies = &object("inspect cube.impinge")["proxies"];
    assert_eq!((&proxies["hull_vertices"], &proxies["hull_faces"]), (&8.into(), &12.into()));
    let volume = |kind: &str| proxies["volumes"][kind].as_f64().unwrap();
    assert!(volume("box") == 1.0 && (volume("26-DOP") - 1.0).abs() < 1e-12 && volume("sphere") > 2.7, "{proxies}");
    assert!(object("inspect plain.impinge").get("proxies").is_none());
    let report = folder.run("inspect cube.impinge").stdout;
    assert!(report.contains("8 corners, 12 triangles") && report.contains("26-DOP"), "{report}");

    // Corrupt proxies do not matter to `check`, which does not use them. `inspect` validates them.
    let mut corrupt = fs::read(folder.path("cube.impinge")).unwrap();
    let last = corrupt.len() - 1;
    corrupt[last] ^= 1;
    fs::write(folder.path("corrupt.impinge"), &corrupt).unwrap();
    let check = |mesh: &str| folder.run(&format!("check {mesh} big.obj --pose-b 0.5,2.5,0.25")).code;
    assert_eq!((check("cube.impinge"), check("corrupt.impinge")), (1, 1));
    assert_eq!(folder.run("inspect corrupt.impinge").code, 2);
    assert_eq!(object("inspect corrupt.impinge")["error"]["kind"], "corrupt");
}

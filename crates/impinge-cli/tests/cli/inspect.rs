//! Tests of `impinge inspect`: the report, the JSON object and the pictures.

use std::fs;

use crate::Folder;

/// A cube that lacks one face, has one face twice, and has an unused vertex.
const BROKEN: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\nv 9 9 9.1\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 5 6 8\n";

fn object(folder: &Folder, arguments: &str) -> serde_json::Value {
    let run = folder.run(&format!("inspect {arguments} --json"));
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{arguments}");
    assert_eq!(run.stdout.lines().count(), 1);
    serde_json::from_str(&run.stdout).unwrap()
}

#[test]
fn a_closed_mesh_is_reported_without_defects() {
    let folder = Folder::new();
    let run = folder.run("inspect cube.obj");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    for part in
        ["cube.obj", "12 triangles", "8 vertices", "closed: each edge has two faces", "single precision holds every"]
    {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    let object = object(&folder, "cube.obj");
    assert_eq!(object["schema"], "impinge.inspect/1");
    assert_eq!((&object["triangles"], &object["vertices"]), (&12.into(), &8.into()));
    assert_eq!((&object["health"]["closed"], &object["health"]["components"]), (&true.into(), &1.into()));
    let hierarchy = &object["hierarchy"];
    assert_eq!((&hierarchy["nodes"], &hierarchy["leaves"], &hierarchy["depth"]), (&1.into(), &2.into(), &1.into()));
    assert!((hierarchy["leaf_fill"].as_f64().unwrap() - 0.75).abs() < 1e-12);
    assert!(hierarchy["bytes"].as_u64().unwrap() > hierarchy["node_bytes"].as_u64().unwrap());
    assert!(object.get("picture").is_none() && object.get("unit").is_none());
    assert!(["load", "build", "inspect"].iter().all(|phase| object["seconds"][phase].as_f64().unwrap() >= 0.0));
}

#[test]
fn defects_of_a_mesh_are_counted() {
    let folder = Folder::new();
    folder.write("broken.obj", BROKEN);
    let health = &object(&folder, "broken.obj")["health"];
    let expected: [(&str, serde_json::Value); 8] = [
        ("closed", false.into()),
        ("components", 1.into()),
        ("degenerate_faces", 0.into()),
        ("duplicate_faces", 1.into()),
        ("unused_vertices", 1.into()),
        ("duplicate_vertices", 0.into()),
        ("double_coordinates", 1.into()),
        ("misoriented_edges", 1.into()),
    ];
    for (key, value) in expected {
        assert_eq!(health[key], value, "{key}: {health}");
    }
    assert_eq!((&health["open_edges"], &health["non_manifold_edges"]), (&3.into(), &2.into()), "{health}");
    let report = folder.run("inspect broken.obj").stdout;
    assert!(
        report.contains("not closed") && report.contains("double precision is needed for 1 coordinate"),
        "{report}"
    );
}

#[test]
fn an_empty_mesh_is_inspected_with_a_warning() {
    let folder = Folder::new();
    folder.write("empty.obj", "v 0 0 0\n");
    let run = folder.run("inspect empty.obj --picture empty.png --json");
    assert_eq!(
        (run.code, run.stderr.as_str()),
        (0, "warning: empty.obj: the mesh has no faces, so it intersects nothing\n")
    );
    let object: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(object["warnings"][0], "the mesh has no faces, so it intersects nothing");
    assert_eq!((&object["triangles"], &object["hierarchy"]["depth"]), (&0.into(), &0.into()));
    assert_eq!(object["picture"]["boxes"], 0);
    assert!(folder.run("inspect empty.obj").stdout.contains("empty"));
}

#[test]
fn pictures_show_the_mesh_and_boxes_as_png_and_svg() {
    let folder = Folder::new();
    let object = object(&folder, "cube.obj --picture cube.png --level 1");
    assert_eq!(object["picture"], serde_json::json!({"path": "cube.png", "level": 1, "boxes": 2}));
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(folder.path("cube.png")).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(info.width.max(info.height), 1400);
    let count = |is: fn(&[u8]) -> bool| pixels.chunks(3).filter(|pixel| is(pixel)).count();
    let white = count(|p| p == [255; 3]);
    let gray = count(|p| p.iter().all(|&x| (90..235).contains(&x)) && p[0].abs_diff(p[2]) < 20);
    let colored = count(|p| p[0].abs_diff(p[2]) > 60);
    let all = pixels.len() / 3;
    assert!(white > all / 10 && gray > all / 4 && colored > 2_000, "{white} white, {gray} gray, {colored} colored");

    let run = folder.run("inspect cube.obj --picture cube.svg --up z");
    assert!(run.code == 0 && run.stdout.contains("of level 1 in cube.svg"), "{run:?}");
    let svg = folder.read("cube.svg");
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.contains("data:image/png;base64,iVBOR"));
    assert!(svg.matches("<path ").count() >= 2, "a path for each box");
}

#[test]
fn invalid_outputs_are_errors_before_any_work() {
    let folder = Folder::new();
    let before = folder.read("cube.obj");
    for (arguments, message) in [
        ("inspect missing.obj --picture out.gif", "unknown extension for an output file"),
        ("inspect cube.obj --picture ./cube.obj", "would overwrite an input"),
        ("inspect missing.obj", "missing.obj"),
        ("inspect missing.obj --picture nowhere/out.png", "the folder of the output does not exist"),
        ("inspect cube.obj --level 2", "--picture"),
    ] {
        let run = folder.run(arguments);
        assert!(run.code == 2 && run.stdout.is_empty() && run.stderr.contains(message), "{arguments}: {run:?}");
    }
    assert_eq!(folder.read("cube.obj"), before);
}

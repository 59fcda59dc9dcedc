//! Tests of `impinge check`: the verdict, the report and the JSON object.

use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
use impinge_testkit::{Affine, oracle};

use crate::{Folder, without_seconds};

const IDENTITY: &str = "[[1.0,0.0,0.0,0.0],[0.0,1.0,0.0,0.0],[0.0,0.0,1.0,0.0],[0.0,0.0,0.0,1.0]]";

fn side(path: &str, pose: &str) -> String {
    format!("{{\"path\":\"{path}\",\"triangles\":12,\"pose\":{pose}}}")
}

fn object(a: &str, b: &str, rest: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!("{{\"schema\":\"impinge.check/1\",\"version\":\"{version}\",\"a\":{a},\"b\":{b},{rest}")
}

#[test]
fn a_collision_is_reported_with_pairs_and_curves() {
    let folder = Folder::new();
    folder.write("long.obj", &crate::cuboid("long", [0.0; 3], 1234.56));
    let run = folder.run("check cube.obj long.obj --pose-b 0.5,0.5,0.5");
    let (report, times) = run.stdout.split_once("time      load ").unwrap();
    let expected = "\
A  cube.obj
   OBJ  12 triangles  8 vertices  1 part  1.000 x 1.000 x 1.000 (no unit)
B  long.obj
   OBJ  12 triangles  8 vertices  1 part  1235 x 1235 x 1235 (no unit)

The meshes intersect: 18 pairs of faces

curves    1 closed, 0 open; 3.000 long in all
coplanar  0 pairs of faces
";
    assert_eq!(report, expected);
    assert!(times.contains(", build ") && times.contains(", query ") && times.ends_with("s\n"), "{times}");
    assert_eq!(run.code, 1);
}

#[test]
fn meshes_that_are_apart_are_reported_without_intersection() {
    let folder = Folder::new();
    let run = folder.run("check cube.obj cube.obj --pose-b 1.0000001,0,0");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert!(run.stdout.contains("\n\nNo intersection\n\ntime      load "), "{}", run.stdout);
}

#[test]
fn touching_counts_as_intersecting() {
    let folder = Folder::new();
    let corner = folder.run("check cube.obj cube.obj --pose-b 1,1,1");
    assert_eq!(corner.code, 1);
    assert!(corner.stdout.contains("touching  at 1 single point\n"), "{}", corner.stdout);
    let face = folder.run("check cube.obj cube.obj --pose-b 1,0,0");
    assert_eq!(face.code, 1);
    assert!(face.stdout.contains("coplanar  16 pairs of faces\n"), "{}", face.stdout);
}

#[test]
fn json_is_one_object_with_its_keys_in_order() {
    let folder = Folder::new();
    let run = folder.run("check cube.obj cube.obj --json --pose-b -0.5,-0.5,-0.5");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""));
    let moved = "[[1.0,0.0,0.0,-0.5],[0.0,1.0,0.0,-0.5],[0.0,0.0,1.0,-0.5],[0.0,0.0,0.0,1.0]]";
    let (a, b) = (side("cube.obj", IDENTITY), side("cube.obj", moved));
    assert_eq!(without_seconds(&run.stdout), object(&a, &b, "\"intersects\":true,\"pairs\":18"));

    let clear = folder.run("check cube.obj cube.obj --json --pose-a 2,0,0");
    assert_eq!(clear.code, 0);
    let (a, b) = (side("cube.obj", &IDENTITY.replacen("0.0]", "2.0]", 1)), side("cube.obj", IDENTITY));
    assert_eq!(without_seconds(&clear.stdout), object(&a, &b, "\"intersects\":false,\"pairs\":0"));
}

#[test]
fn json_has_curves_and_units_if_they_are_known() {
    let folder = Folder::new();
    let run = folder.run("check cube.obj cube.obj --json --pose-b 0.5,0.5,0.5 --curves c.obj --unit-a mm --unit-b mm");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""));
    let rest = "\"curves\":{\"count\":1,\"closed\":1,\"length\":3.0}";
    assert!(without_seconds(&run.stdout).ends_with(rest), "{}", run.stdout);
    assert_eq!(run.stdout.matches("\"triangles\":12,\"unit\":\"mm\",\"pose\":").count(), 2);
    assert!(!run.stdout.contains("null"));
}

#[test]
fn pairs_equal_those_of_brute_force() {
    let folder = Folder::new();
    let knot = torus_knot(40, 8, TREFOIL);
    let vertices = knot.vertices.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = knot.faces.iter().map(|[i, j, k]| format!("f {} {} {}\n", i + 1, j + 1, k + 1));
    folder.write("knot.obj", &vertices.chain(faces).collect::<String>());
    let run = folder.run("check knot.obj knot.obj --pose-a 0.5,0,-0.125 --pose-b 0,1,0 --pairs pairs.csv");
    let b = knot.at(Affine::translation([0.0, 1.0, 0.0]));
    let expected = oracle::brute_force(knot.at(Affine::translation([0.5, 0.0, -0.125])), b);
    let rows = expected.iter().map(|(i, j)| format!("{i},{j},{i},{j},,\n"));
    let header = "face_a,face_b,source_a,source_b,part_a,part_b\n".to_owned();
    assert_eq!(folder.read("pairs.csv"), std::iter::once(header).chain(rows).collect::<String>());
    assert!(expected.len() > 100 && expected.len() < 1000, "{}", expected.len());
    assert!(run.stdout.contains(&format!("The meshes intersect: {} pairs of faces\n", expected.len())));
}

#[test]
fn swapping_the_meshes_swaps_the_pairs() {
    let folder = Folder::new();
    let forth = folder.run("check cube.obj big.obj --pose-a 2.5,1,0 --json --pairs forth.csv");
    let back = folder.run("check big.obj cube.obj --pose-b 2.5,1,0 --json --pairs back.csv");
    assert_eq!((forth.code, back.code), (1, 1));
    let rows = |name: &str, order: [usize; 2]| -> Vec<[u32; 2]> {
        let text = folder.read(name);
        let faces = |row: &str| -> Vec<u32> { row.split(',').take(2).map(|n| n.parse().unwrap()).collect() };
        let mut rows: Vec<_> = text.lines().skip(1).map(faces).map(|row| order.map(|i| row[i])).collect();
        rows.sort_unstable();
        rows
    };
    assert_eq!(rows("forth.csv", [0, 1]), rows("back.csv", [1, 0]));
    assert!(!rows("forth.csv", [0, 1]).is_empty());
}

#[test]
fn poses_are_read_from_numbers_and_from_files() {
    let folder = Folder::new();
    folder.write("text", "1 0 0 -0.5\n0 0 -1 0\n0 1 0 0\n0 0 0 1\n");
    folder.write("pose.json", "[[1,0,0,-0.5],[0,0,-1,0],[0,1,0,0],[0,0,0,1]]");
    let quarter = format!("-0.5,0,0,{0},{0},0,0", 0.5_f64.sqrt());
    let poses = [quarter.as_str(), "text", "pose.json"].map(|pose| {
        let run = folder.run(&format!("check cube.obj cube.obj --json --pose-b {pose}"));
        assert_eq!((run.code, run.stderr.as_str()), (1, ""));
        let json: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        json["b"]["pose"].clone()
    });
    assert_eq!(poses[0][0], serde_json::json!([1.0, 0.0, 0.0, -0.5]));
    assert_eq!(poses[0][2], serde_json::json!([0.0, 1.0, 0.0, 0.0]));
    assert_eq!(poses[1], poses[0]);
    assert_eq!(poses[2], poses[0]);

    // A pose from the JSON object reads back as the same pose.
    folder.write("again.json", &poses[0].to_string());
    let again = folder.run("check cube.obj cube.obj --json --pose-b again.json");
    assert!(again.stdout.contains(&format!("\"pose\":{}", poses[0])));
}

#[test]
fn a_mesh_inside_another_causes_one_note() {
    let folder = Folder::new();
    let expected = |inner, outer| {
        format!(
            "note: {inner} lies inside {outer}, but only the surfaces were compared; pass --solid to count this as a collision\n"
        )
    };
    let inside = folder.run("check cube.obj big.obj");
    assert_eq!((inside.code, inside.stderr), (0, expected("A", "B")));
    let outside = folder.run("check big.obj cube.obj --json");
    assert_eq!((outside.code, outside.stderr), (0, expected("B", "A")));
    let beside = folder.run("check big.obj cube.obj --pose-b 9,0,0");
    assert_eq!((beside.code, beside.stderr), (0, String::new()));
    let across = folder.run("check big.obj cube.obj --pose-b 2.5,0,0");
    assert_eq!((across.code, across.stderr), (1, String::new()));
}

#[test]
fn an_empty_mesh_intersects_nothing() {
    let folder = Folder::new();
    folder.write("empty.obj", "v 0 0 0\n");
    let refused = folder.run("check empty.obj cube.obj");
    assert_eq!((refused.code, refused.stdout.as_str()), (2, ""));
    assert!(refused.stderr.contains("error: empty.obj: the mesh has no faces"), "{}", refused.stderr);
    assert!(refused.stderr.contains("--allow-empty"), "{}", refused.stderr);
    let run = folder.run("check empty.obj cube.obj --allow-empty");
    assert_eq!(run.code, 0);
    assert_eq!(run.stderr, "warning: empty.obj: the mesh has no faces, so it intersects nothing\n");
    let object = folder.run("check cube.obj empty.obj --allow-empty --json");
    let found: serde_json::Value = serde_json::from_str(&object.stdout).unwrap();
    assert_eq!(found["b"]["warnings"], serde_json::json!(["the mesh has no faces, so it intersects nothing"]));
    assert!(found["a"].get("warnings").is_none());
    assert!(run.stdout.contains("   OBJ   0 triangles    1 vertex  0 parts  empty (no unit)\n"), "{}", run.stdout);
}

#[test]
fn the_answer_does_not_depend_on_the_number_of_threads() {
    let folder = Folder::new();
    let one = folder.run("check cube.obj big.obj --pose-a 2.5,1,0 --pairs one.csv --curves one.obj --json --threads 1");
    let many =
        folder.run("check cube.obj big.obj --pose-a 2.5,1,0 --pairs many.csv --curves many.obj --json --threads 7");
    assert_eq!((one.code, many.code), (1, 1));
    assert_eq!(without_seconds(&one.stdout), without_seconds(&many.stdout));
    assert_eq!(folder.read("one.csv"), folder.read("many.csv"));
    assert_eq!(folder.read("one.obj"), folder.read("many.obj"));
}

#[test]
fn help_and_version_exit_with_zero() {
    let folder = Folder::new();
    let help = folder.run("check --help");
    assert_eq!((help.code, help.stderr.as_str()), (0, ""));
    for option in [
        "--pose-a",
        "--pose-b",
        "--unit-a",
        "--unit-b",
        "--solid",
        "--penetrates",
        "--pairs",
        "--curves",
        "--json",
        "--threads",
    ] {
        assert!(help.stdout.contains(option), "{option}");
    }
    assert_eq!(folder.run("--version").stdout, concat!("impinge ", env!("CARGO_PKG_VERSION"), "\n"));
    let nothing = folder.run("");
    assert_eq!((nothing.code, nothing.stdout.as_str()), (2, ""));
    assert!(nothing.stderr.contains("Usage: impinge"));
}

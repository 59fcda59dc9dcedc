//! Tests of runs without an answer: exit code 2, a message for a person and, with `--json`, a JSON
//! object.

use std::fs;

use crate::Folder;

/// Runs the command with and without `--json` and asserts that both fail in the same way. Returns
/// the object inside `error`, as text, and the message on standard error.
fn error(folder: &Folder, arguments: &str) -> (String, String) {
    let plain = folder.run(arguments);
    assert_eq!((plain.code, plain.stdout.as_str()), (2, ""), "{arguments}");
    let with_json = folder.run(&format!("{arguments} --json"));
    assert_eq!((with_json.code, &with_json.stderr), (2, &plain.stderr), "{arguments}");
    let object = with_json.stdout.strip_prefix("{\"error\":").and_then(|rest| rest.strip_suffix("}\n"));
    let object = object.unwrap_or_else(|| panic!("{arguments}: {}", with_json.stdout)).to_owned();
    let parsed: serde_json::Value = serde_json::from_str(&object).unwrap();
    let keys = ["kind", "file", "where", "message", "hint"];
    let present: Vec<_> = keys.iter().filter(|&&key| parsed.get(key).is_some()).collect();
    assert_eq!(parsed.as_object().unwrap().len(), present.len(), "{object}");
    assert!(present.iter().map(|key| object.find(&format!("\"{key}\":"))).is_sorted(), "{object}");
    assert!(parsed.as_object().unwrap().values().all(serde_json::Value::is_string), "{object}");
    for value in parsed.as_object().unwrap().iter().filter(|(key, _)| *key != "kind").map(|(_, value)| value) {
        assert!(plain.stderr.contains(value.as_str().unwrap()), "{value} is not in {}", plain.stderr);
    }
    (object, plain.stderr)
}

#[test]
fn a_missing_file_is_an_io_error() {
    let folder = Folder::new();
    let (object, message) = error(&folder, "check cube.obj missing.stl");
    assert!(object.starts_with(r#"{"kind":"io","file":"missing.stl","message":""#), "{object}");
    assert!(message.starts_with("error: missing.stl: "), "{message}");
}

#[test]
fn an_unknown_format_is_an_error() {
    let folder = Folder::new();
    folder.write("mesh.xyz", "1 2 3");
    let (object, _) = error(&folder, "check mesh.xyz cube.obj");
    assert!(object.starts_with(r#"{"kind":"unsupported-format","file":"mesh.xyz","#), "{object}");
}

#[test]
fn an_invalid_file_is_named_with_the_line() {
    let folder = Folder::new();
    folder.write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    let (object, message) = error(&folder, "check cube.obj broken.obj");
    let expected = r#"{"kind":"index-out-of-bounds","file":"broken.obj","where":"line 4","message":""#;
    assert!(object.starts_with(expected), "{object}");
    assert!(message.starts_with("error: broken.obj, line 4: "), "{message}");
}

#[test]
fn a_vertex_out_of_range_is_an_error() {
    let folder = Folder::new();
    folder.write("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1e39 0\nf 1 2 3\n");
    let (object, _) = error(&folder, "check far.obj cube.obj");
    let expected = r#"{"kind":"out-of-range","file":"far.obj","message":"vertex 2 is out of range"#;
    assert!(object.starts_with(expected), "{object}");
}

#[test]
fn warnings_are_printed_on_standard_error() {
    let folder = Folder::new();
    folder.write("odd.obj", &(crate::cuboid("odd", [0.0; 3], 1.0) + "f 1 2\n"));
    let run = folder.run("check odd.obj cube.obj --json");
    assert_eq!(run.code, 1);
    assert!(run.stderr.starts_with("warning: odd.obj: "), "{}", run.stderr);
    assert!(run.stderr.contains("line 16"), "{}", run.stderr);
    assert_eq!(run.stderr.lines().count(), 1);
}

#[test]
fn invalid_poses_are_errors() {
    let folder = Folder::new();
    folder.write("few", "1 0 0");
    folder.write("word", "1 0 0 x");
    folder.write("flat", "1 0 0 0  0 1 0 0  0 0 0 0  0 0 0 1");
    folder.write("transposed", "1 0 0 0  0 1 0 0  0 0 1 0  5 0 0 1");
    folder.write("long", &"0 ".repeat(40_000));
    let cases = [
        ("1,2", r#"{"kind":"pose","where":"--pose-b","message":"2 numbers given; a pose has 3 or 7","hint":""#),
        ("nan,0,0", r#"{"kind":"non-finite","where":"--pose-b","message":"pose entry 3 is not finite"}"#),
        ("0,0,0,2,0,0,0", r#"{"kind":"not-unit-quaternion","where":"--pose-b","message":""#),
        ("nowhere", r#"{"kind":"io","file":"nowhere","where":"--pose-b","message":"neither numbers nor a file"#),
        ("few", r#"{"kind":"pose","file":"few","where":"--pose-b","message":"3 numbers found; a 4x4 matrix has 16""#),
        ("word", r#"{"kind":"pose","file":"word","where":"--pose-b","message":"\"x\" is not a number""#),
        ("flat", r#"{"kind":"singular","file":"flat","where":"--pose-b","message":""#),
        ("long", r#"{"kind":"pose","file":"long","where":"--pose-b","message":"the file is too long for a matrix""#),
        ("cube.obj", r#"{"kind":"pose","file":"cube.obj","where":"--pose-b","message":"\"v\" is not a number""#),
    ];
    for (pose, expected) in cases {
        let plain = folder.run(&format!("check cube.obj cube.obj --pose-b {pose}"));
        assert_eq!((plain.code, plain.stdout.as_str()), (2, ""), "{pose}");
        let with_json = folder.run(&format!("check cube.obj cube.obj --pose-b {pose} --json"));
        assert_eq!(with_json.code, 2, "{pose}");
        assert!(with_json.stdout.starts_with(&format!("{{\"error\":{expected}")), "{pose}: {}", with_json.stdout);
    }
    let (object, message) = error(&folder, "check cube.obj cube.obj --pose-a transposed");
    assert!(object.starts_with(r#"{"kind":"not-affine","file":"transposed","where":"--pose-a","#), "{object}");
    assert!(object.ends_with(r#""hint":"looks transposed"}"#), "{object}");
    assert!(message.ends_with("\n hint: looks transposed\n"), "{message}");
}

#[test]
fn invalid_arguments_are_usage_errors() {
    let folder = Folder::new();
    let cases = [
        ("check cube.obj cube.obj --threads 0", "0 is not in 1..=1024"),
        ("check cube.obj cube.obj --threads many", "invalid value 'many' for '--threads <N>'"),
        ("check cube.obj cube.obj --unit-a furlong", "unknown unit"),
        ("check cube.obj cube.obj --prais p.csv", "unexpected argument '--prais' found"),
        ("check cube.obj", "the following required arguments were not provided: <B>"),
        ("chek cube.obj cube.obj", "unrecognized subcommand 'chek'"),
    ];
    for (arguments, expected) in cases {
        let (object, message) = error(&folder, arguments);
        let parsed: serde_json::Value = serde_json::from_str(&object).unwrap();
        assert_eq!(parsed["kind"], "usage");
        assert!(parsed["message"].as_str().unwrap().contains(expected), "{object}");
        assert!(message.starts_with("error: ") && message.contains("\n hint: "), "{message}");
    }
    assert!(error(&folder, "check cube.obj cube.obj --prais p.csv").0.contains("exists: '--pairs'"));
}

#[test]
fn output_names_are_validated_before_any_work() {
    let folder = Folder::new();
    // The meshes are missing, but the names of the outputs are validated first.
    let (object, _) = error(&folder, "check missing.obj missing.obj --pairs pairs.txt");
    assert!(object.starts_with(r#"{"kind":"output","file":"pairs.txt","#), "{object}");
    assert!(object.ends_with(r#""hint":"use a name that ends in .csv or .npy"}"#), "{object}");
    let (object, _) = error(&folder, "check missing.obj missing.obj --curves curves");
    assert!(object.ends_with(r#""hint":"use a name that ends in .obj"}"#), "{object}");
    let before = folder.read("big.obj");
    let (object, _) = error(&folder, "check cube.obj big.obj --curves ./big.obj");
    assert!(object.contains("would overwrite an input"), "{object}");
    fs::hard_link(folder.path("big.obj"), folder.path("also_big.obj")).unwrap();
    let (object, _) = error(&folder, "check cube.obj big.obj --curves also_big.obj");
    assert!(object.contains("would overwrite an input"), "{object}");
    assert_eq!(folder.read("big.obj"), before);
    for command in [
        "check missing.obj missing.obj --pairs out/p.csv",
        "check missing.obj missing.obj --curves out/c.obj",
        "bake missing.obj -o out/m.impinge",
        "inspect missing.obj --picture out/m.png",
        "hits missing.glb --picture out/m.png",
        "world --plot out/w.svg",
    ] {
        let (object, message) = error(&folder, command);
        assert!(object.contains("the folder of the output does not exist"), "{command}: {object}");
        assert!(message.contains("create the folder out first"), "{command}: {message}");
    }
}

#[test]
fn an_output_that_cannot_be_written_is_an_io_error() {
    let folder = Folder::new();
    for option in ["--pairs out.csv", "--pairs out.npy", "--curves out.obj"] {
        fs::create_dir(folder.path(option.split(' ').nth(1).unwrap())).unwrap();
        let (object, message) = error(&folder, &format!("check cube.obj cube.obj {option}"));
        let file = option.split(' ').nth(1).unwrap();
        let expected = format!(r#"{{"kind":"io","file":"{file}","message":"cannot be written: "#);
        assert!(object.starts_with(&expected), "{object}");
        assert!(message.starts_with(&format!("error: {file}: cannot be written: ")), "{message}");
    }
}

//! `impinge clash --pictures` and `--bcf`: what people hand on.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Read, Write};
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::clash::{WALL, folder, json, model};
use crate::{Folder, Run};

const ASKED: &str = "clash house.obj --unit m --clearance 20mm";

fn run(folder: &Folder, more: &str) -> Run {
    let run = folder.run(&format!("{ASKED} {more}"));
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{run:?}");
    run
}

/// Returns the files of an archive by name.
fn files(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(fs::read(path).unwrap())).unwrap();
    (0..archive.len())
        .map(|at| {
            let mut file = archive.by_index(at).unwrap();
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).unwrap();
            (file.name().unwrap().into_owned(), bytes)
        })
        .collect()
}

fn write_archive(path: &Path, files: &BTreeMap<String, Vec<u8>>) {
    let mut archive = zip::ZipWriter::new(fs::File::create(path).unwrap());
    for (name, bytes) in files {
        archive.start_file(name, zip::write::SimpleFileOptions::DEFAULT).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap();
}

fn skipped(why: &str) {
    writeln!(std::io::stderr(), "skipped: {why}").ok();
}

/// Returns the text of the first element with a name.
fn element<'t>(xml: &'t str, name: &str) -> &'t str {
    let (_, rest) = xml.split_once(&format!("<{name}>")).unwrap_or_else(|| panic!("no {name} in {xml}"));
    rest.split_once(&format!("</{name}>")).unwrap().0
}

fn vector(xml: &str, name: &str) -> [f64; 3] {
    let part = element(xml, name);
    ["X", "Y", "Z"].map(|axis| element(part, axis).parse().unwrap())
}

/// Returns the pixels of a PNG file with its width and height.
fn pixels(bytes: &[u8]) -> ([u32; 2], Vec<u8>) {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    ([info.width, info.height], pixels)
}

/// Returns the numbers of blue and of orange pixels.
fn blue_and_orange(pixels: &[u8]) -> [usize; 2] {
    let count = |is: fn(&[u8]) -> bool| pixels.chunks(3).filter(|pixel| is(pixel)).count();
    [count(|p| p[2] > p[0].saturating_add(40)), count(|p| p[0] > p[2].saturating_add(80) && p[1] > p[2])]
}

#[test]
fn each_group_has_a_picture_with_two_colors() {
    let folder = folder();
    let printed = run(&folder, "--pictures out --group none --json=out.json");
    assert!(printed.stdout.contains("\npictures  2\n"), "{}", printed.stdout);
    let report: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    for clash in report["clashes"].as_array().unwrap() {
        let path = folder.path("out").join(format!("{}.png", clash["id"].as_str().unwrap()));
        let (size, pixels) = pixels(&fs::read(&path).unwrap());
        assert_eq!(size, [1280, 960]);
        let [blue, orange] = blue_and_orange(&pixels);
        assert!(blue > 3_000 && orange > 3_000, "{}: {blue} blue, {orange} orange", clash["id"]);
    }
    let before: Vec<_> = fs::read_dir(folder.path("out")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let bytes: Vec<_> = before.iter().map(|path| fs::read(path).unwrap()).collect();
    let grouped = folder.run(&format!("{ASKED} --pictures out"));
    assert!(grouped.stdout.contains("\npictures  1\n"), "{}", grouped.stdout);
    assert!(grouped.stdout.contains(", draw "), "{}", grouped.stdout);
    // One of the two pictures of the first run is not of this report.
    assert!(grouped.stderr.contains("has 1 other picture that this report did not write"), "{}", grouped.stderr);
    assert_eq!(before.iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>(), bytes, "the same bytes again");
}

#[test]
fn bcf_files_have_a_topic_with_viewpoint_and_picture_for_each_group() {
    let folder = folder();
    for (version, list) in [("2.1", ""), ("3.0", "<Viewpoints>")] {
        let printed = run(&folder, &format!("--bcf out.bcfzip --bcf-version {version}"));
        assert!(printed.stdout.contains("\nBCF       1 topic\n"), "{}", printed.stdout);
        let bytes = fs::read(folder.path("out.bcfzip")).unwrap();
        run(&folder, &format!("--bcf out.bcfzip --bcf-version {version} --threads 1"));
        assert_eq!(fs::read(folder.path("out.bcfzip")).unwrap(), bytes, "twice the same run gives the same bytes");

        let files = files(&folder.path("out.bcfzip"));
        let text = |name: &str| String::from_utf8(files[name].clone()).unwrap();
        assert!(text("bcf.version").contains(&format!("VersionId=\"{version}\"")));
        assert_eq!(files.contains_key("extensions.xml"), version == "3.0");
        assert!(files.contains_key("project.bcfp"));
        let topic = files.keys().find_map(|name| name.strip_suffix("/markup.bcf")).unwrap().to_owned();
        let markup = text(&format!("{topic}/markup.bcf"));
        assert!(markup.contains("TopicType=\"Clash\" TopicStatus=\"New\"") && markup.contains(list), "{markup}");
        assert!(markup.contains("<Viewpoint>viewpoint.bcfv</Viewpoint>"), "{markup}");
        assert!(element(&markup, "Title").starts_with("part &apos;wall&apos; meets 2 parts"), "{markup}");
        let description = element(&markup, "Description");
        assert!(description.contains(" clash new, depth 0.12"), "{description}");
        assert!(description.contains(" clearance new, gap 0.0"), "{description}");
        let ([width, height], _) = pixels(&files[&format!("{topic}/snapshot.png")]);
        assert_eq!([width, height], [800, 600]);
        let viewpoint = text(&format!("{topic}/viewpoint.bcfv"));
        let field: f64 = element(&viewpoint, "FieldOfView").parse().unwrap();
        assert!((45.0..=60.0).contains(&field) && !viewpoint.contains("ClippingPlane"));
        assert_eq!(viewpoint.contains("AspectRatio"), version == "3.0");
        assert!(viewpoint.contains("DefaultVisibility=\"true\"") && viewpoint.contains("house/pipe"));
        // The pipe enters the wall around (1.06, 0.2, 1.06); the camera looks there.
        let [eye, away] = ["CameraViewPoint", "CameraDirection"].map(|name| vector(&viewpoint, name));
        let towards = [1.0625 - eye[0], 0.2 - eye[1], 1.0625 - eye[2]];
        let distance = towards.iter().map(|x| x * x).sum::<f64>().sqrt();
        let along: f64 = (0..3).map(|k| towards[k] * away[k]).sum();
        assert!(along > 0.99 * distance && (0.1..3.0).contains(&distance), "{eye:?} {away:?}");
        assert!(vector(&viewpoint, "CameraUpVector")[2] > 0.5, "Z is up");
    }
}

#[test]
fn statuses_that_other_programs_set_come_back() {
    let folder = folder();
    folder.write("rules.toml", "[[rule]]\na = \"*\"\nb = \"*\"\nseverity = \"high\"\n");
    for version in ["2.1", "3.0"] {
        run(&folder, &format!("--bcf old.bcfzip --bcf-version {version} --rules rules.toml"));
        let report = json(&run(&folder, "--previous old.bcfzip --json"));
        assert!(report["clashes"].as_array().unwrap().iter().all(|clash| clash["status"] == "active"), "{report}");

        let mut files = files(&folder.path("old.bcfzip"));
        let markup = files.iter_mut().find(|(name, _)| name.ends_with("markup.bcf")).unwrap().1;
        let text = String::from_utf8(markup.clone()).unwrap();
        assert!(text.contains("<Priority>high</Priority>"), "{text}");
        *markup = text.replace("TopicStatus=\"New\"", "TopicStatus=\"Accepted\"").into_bytes();
        write_archive(&folder.path("old.bcfzip"), &files);
        let again = folder.run(&format!("{ASKED} --previous old.bcfzip --bcf new.bcfzip --json"));
        let report = json(&again);
        assert!(report["clashes"].as_array().unwrap().iter().all(|clash| clash["status"] == "approved"), "{report}");
        assert_eq!(again.code, 0);
        // The statuses stay in the next file, and a deeper clash is active again.
        folder.write("house.obj", &model(&[WALL, ("pipe", [1.0, 0.0625, 1.0], [1.5, 2.0, 1.5])]));
        let deeper = json(&folder.run(&format!("{ASKED} --previous new.bcfzip --json")));
        assert_eq!(deeper["clashes"][0]["status"], "active", "{deeper}");
        assert_eq!(deeper["gone"].as_array().unwrap().len(), 1);
        folder.write("house.obj", &crate::clash::house());
    }
}

#[test]
fn a_model_in_gltf_far_from_the_origin_has_a_camera_in_meters_with_z_up() {
    let folder = Folder::new();
    let far = |[x, y, z]: [f64; 3]| [x + 500_000.0, y + 12.0, z - 4_500_000.0];
    let boxes = [([0.0; 3], [1.0; 3]), ([0.75, 0.25, 0.25], [2.0, 0.5, 0.5])].map(|(min, max)| (far(min), far(max)));
    write_gltf(&folder, &boxes);
    let run = folder.run("clash far.gltf --shift --bcf out.bcfzip --json");
    assert_eq!(run.code, 1, "{run:?}");
    let files = files(&folder.path("out.bcfzip"));
    let (_, bytes) = files.iter().find(|(name, _)| name.ends_with("viewpoint.bcfv")).unwrap();
    let eye = vector(&String::from_utf8(bytes.clone()).unwrap(), "CameraViewPoint");
    // Y of glTF is Z here, and Z is minus Y.
    let near = [500_000.9, 4_499_999.6, 12.4];
    assert!((0..3).all(|k| (eye[k] - near[k]).abs() < 4.0), "{eye:?}");
}

/// Writes `far.gltf` with boxes, each a node that scales and moves one cube.
fn write_gltf(folder: &Folder, boxes: &[([f64; 3], [f64; 3])]) {
    let mut bytes = Vec::new();
    for corner in 0..8_u32 {
        for axis in 0..3 {
            bytes.extend(((corner >> axis & 1) as f32).to_le_bytes());
        }
    }
    let faces: [u16; 36] =
        [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
    bytes.extend(faces.iter().flat_map(|index| index.to_le_bytes()));
    fs::write(folder.path("far.bin"), &bytes).unwrap();
    let node = |at: usize, (min, max): &([f64; 3], [f64; 3])| {
        let scale = [0, 1, 2].map(|k| max[k] - min[k]);
        serde_json::json!({"mesh": 0, "name": format!("box {at}"), "translation": min, "scale": scale})
    };
    let nodes: Vec<Value> = boxes.iter().enumerate().map(|(at, it)| node(at, it)).collect();
    let document = serde_json::json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": (0..nodes.len()).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": bytes.len(), "uri": "far.bin"}],
    });
    folder.write("far.gltf", &document.to_string());
}

#[test]
fn bcf_files_are_valid_by_the_schemas_of_building_smart() {
    let Some(data) = std::env::var_os("IMPINGE_DATA") else {
        return skipped("IMPINGE_DATA names no folder of real files, and the schemas may not be shipped");
    };
    let schemas = Path::new(&data).join("bcf");
    if !schemas.is_dir() || Command::new("xmllint").arg("--version").output().is_err() {
        return skipped("the schemas in IMPINGE_DATA/bcf and xmllint are needed");
    }
    let folder = folder();
    folder.write("house.obj", &model(&[WALL, ("wall & <again>", WALL.1, WALL.2), ("pipe\u{2}", [1.0; 3], [1.5; 3])]));
    let mut checked = 0;
    for version in ["2.1", "3.0"] {
        folder.run(&format!("clash house.obj --unit m --contacts --bcf out.bcfzip --bcf-version {version}"));
        for (name, bytes) in files(&folder.path("out.bcfzip")) {
            let schema = match name.rsplit('/').next().unwrap() {
                "markup.bcf" => "markup.xsd",
                "viewpoint.bcfv" => "visinfo.xsd",
                "project.bcfp" => "project.xsd",
                "bcf.version" => "version.xsd",
                "extensions.xml" => "extensions.xsd",
                _ => continue,
            };
            fs::write(folder.path("file.xml"), &bytes).unwrap();
            let schema = schemas.join(version).join(schema);
            let arguments = ["--nonet", "--noout", "--schema"];
            let run =
                Command::new("xmllint").args(arguments).arg(schema).arg(folder.path("file.xml")).output().unwrap();
            assert!(run.status.success(), "{name}: {}", String::from_utf8_lossy(&run.stderr));
            checked += 1;
        }
    }
    assert!(checked >= 9, "{checked}");
}

#[test]
fn invalid_requests_are_errors() {
    let folder = folder();
    folder.write("file", "");
    folder.write("broken.bcfzip", "no archive");
    for (arguments, message) in [
        ("clash house.obj --bcf out.zip", "unknown extension for an output file"),
        ("clash house.obj --bcf out.bcfzip", "the scenes state no unit"),
        ("clash house.obj --unit m --previous broken.bcfzip", "not a BCF file"),
        ("clash house.obj --previous broken.bcfzip", "the scenes state no unit"),
        ("clash house.obj --pictures file", "the pictures need a folder"),
        ("clash house.obj --pictures nowhere/out", "the folder of the output does not exist"),
        ("clash house.obj --bcf-version 3.0", "--bcf"),
        ("clash house.obj --bcf out.bcfzip --bcf-version 2.0", "2.1"),
    ] {
        let run = folder.run(arguments);
        assert!(run.code == 2 && run.stdout.is_empty() && run.stderr.contains(message), "{arguments}: {run:?}");
    }
}

//! `impinge clash`: reports, files, rules, previous reports, and errors.

use serde_json::Value;

use crate::{Folder, Run};

/// Returns boxes as one OBJ file, each with a name and two corners.
pub(crate) fn model(boxes: &[(&str, [f64; 3], [f64; 3])]) -> String {
    let mut text = String::new();
    for (number, (name, min, max)) in boxes.iter().enumerate() {
        for corner in 0..8 {
            let at = |k: usize| if corner >> k & 1 == 0 { min[k] } else { max[k] };
            text += &format!("v {} {} {}\n", at(0), at(1), at(2));
        }
        text += &format!("o {name}\n");
        for face in ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"] {
            let indices = face.split(' ').map(|index| index.parse::<usize>().unwrap() + 8 * number);
            text += &format!("f{}\n", indices.map(|index| format!(" {index}")).collect::<String>());
        }
    }
    text
}

pub(crate) const WALL: (&str, [f64; 3], [f64; 3]) = ("wall", [0.0; 3], [5.0, 0.25, 3.0]);
const PIPE: (&str, [f64; 3], [f64; 3]) = ("pipe", [1.0, 0.125, 1.0], [1.125, 2.0, 1.125]);
const SHELF: (&str, [f64; 3], [f64; 3]) = ("shelf", [3.0, 0.26, 0.0], [4.0, 0.5, 1.0]);
const LAMP: (&str, [f64; 3], [f64; 3]) = ("lamp", [9.0; 3], [10.0; 3]);

/// Returns the model of most tests.
pub(crate) fn house() -> String {
    model(&[WALL, PIPE, SHELF, LAMP])
}

pub(crate) fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("house.obj", &house());
    folder
}

pub(crate) fn json(run: &Run) -> Value {
    serde_json::from_str(&run.stdout).unwrap()
}

fn clashes(report: &Value) -> Vec<String> {
    let row = |clash: &Value| {
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        [&clash["kind"], &clash["a"]["name"], &clash["b"]["name"], &clash["status"]].map(text).join(" ")
    };
    report["clashes"].as_array().unwrap().iter().map(row).collect()
}

#[test]
fn the_report_names_kinds_depths_and_groups() {
    let folder = folder();
    let run = folder.run("clash house.obj --unit m --clearance 20mm");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{run:?}");
    for part in [
        "house  house.obj  4 parts",
        "common material deeper than 0.1 mm (the default); gaps of at most 20 mm",
        "1 clash, 1 narrow gap",
        "  part 'wall' meets 2 parts; the worst: part 'pipe' enters part 'wall' by 125 mm\n",
        "100 mm to 1 m",
    ] {
        assert!(run.stdout.contains(part), "{part:?} is not in {}", run.stdout);
    }
    // Each line begins with the identity of its clash.
    let ids = json(&folder.run("clash house.obj --unit m --json"));
    let id = ids["clashes"][0]["id"].as_str().unwrap();
    assert!(run.stdout.contains(&format!("\n  {id}  part 'wall'")), "{}", run.stdout);
    let single = folder.run("clash house.obj --unit m --group none");
    assert!(single.stdout.contains(&format!("worst clashes\n  {id}  part 'pipe' enters")), "{}", single.stdout);
    let clear = folder.run("clash house.obj --tolerance 1/4");
    assert_eq!((clear.code, clear.stderr.as_str()), (0, ""));
    assert!(clear.stdout.contains("No clashes"), "{}", clear.stdout);
}

#[test]
fn json_has_what_was_asked_and_the_same_bytes_for_any_threads() {
    let folder = folder();
    let run = folder.run("clash house.obj --unit m --clearance 20mm --json");
    let report = json(&run);
    assert_eq!(report["schema"], "impinge.clash/1");
    assert_eq!(clashes(&report), ["clash pipe wall new", "clearance shelf wall new"]);
    assert_eq!(report["asked"]["clearance"], 0.02);
    assert_eq!(report["scenes"][0]["parts"], 4);
    assert!(report["counts"].get("contact").is_none() && report.get("gone").is_none() && report.get("rules").is_none());
    for threads in ["1", "2"] {
        let again = folder.run(&format!("clash house.obj --unit m --clearance 20mm --json --threads {threads}"));
        assert_eq!(again, run);
    }
    let contacts = json(&folder.run("clash house.obj --unit m --contacts --json"));
    assert_eq!(contacts["counts"]["contact"], 0);
    assert!(contacts["counts"].get("clearance").is_none());
    // The other order of the parts changes nothing but the handles of the parts.
    folder.write("turned.obj", &model(&[LAMP, SHELF, PIPE, WALL]));
    let turned = json(&folder.run("clash house=turned.obj --unit m --clearance 20mm --json"));
    assert_eq!(clashes(&turned), clashes(&report));
    assert_eq!(turned["clashes"][0]["id"], report["clashes"][0]["id"]);
}

#[test]
fn clashes_have_a_direction_faces_and_a_volume() {
    let folder = folder();
    let report = json(&folder.run("clash house.obj --unit m --clearance 20mm --volume --json"));
    let of_kind = |kind: &str| {
        let clashes = report["clashes"].as_array().unwrap();
        clashes.iter().find(|clash| clash["kind"] == kind).unwrap().clone()
    };
    let numbers = |value: &Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    // The pipe enters the wall along y, up to its middle, so both directions are equally short.
    let clash = of_kind("clash");
    assert_eq!([&clash["a"]["name"], &clash["b"]["name"]], ["pipe", "wall"]);
    let common = 0.125_f64.powi(3);
    let [lower, upper] = numbers(&clash["volume"])[..] else { panic!("{clash}") };
    assert!(lower <= common && common <= upper && upper - lower < 1e-9, "{clash}");
    assert!(numbers(&clash["normal"])[1].abs() > 0.9, "{clash}");
    assert!(numbers(&clash["faces"]).iter().all(|face| *face < 12.0), "{clash}");
    let gap = of_kind("clearance");
    assert_eq!([&gap["a"]["name"], &gap["b"]["name"]], ["shelf", "wall"]);
    assert!(numbers(&gap["normal"])[1] < -0.9 && gap["volume"].is_null(), "{gap}");
    assert!(json(&folder.run("clash house.obj --unit m --json"))["clashes"][0]["volume"].is_null());
}

#[test]
fn clashes_have_the_curves_in_which_surfaces_meet() {
    let folder = folder();
    let report = json(&folder.run("clash house.obj --unit m --clearance 20mm --curves --json"));
    assert_eq!(report["asked"]["curves"], true);
    let of_kind =
        |kind: &str| report["clashes"].as_array().unwrap().iter().find(|clash| clash["kind"] == kind).unwrap();
    assert!(of_kind("clearance").get("curves").is_none());
    let clash = of_kind("clash");
    let lines: Vec<Vec<[f64; 3]>> = serde_json::from_value(clash["curves"].clone()).unwrap();
    assert!(!lines.is_empty() && lines.iter().all(|line| line.len() > 4 && line.first() == line.last()), "{clash}");
    // Boxes are rounded outward.
    let [min, max]: [[f64; 3]; 2] = serde_json::from_value(clash["box"].clone()).unwrap();
    let inside = |point: &[f64; 3]| (0..3).all(|k| min[k] <= point[k] && point[k] <= max[k]);
    assert!(lines.iter().flatten().all(inside), "{clash}");
    let without = json(&folder.run("clash house.obj --unit m --json"));
    assert!(without["clashes"][0].get("curves").is_none() && without["asked"].get("curves").is_none());
    assert_eq!(folder.run("clash house.obj --unit m --curves").code, 2);
}

#[test]
fn files_are_written_beside_the_report() {
    let folder = folder();
    let run = folder.run("clash house.obj --unit m --volume --json=out.json --csv out.csv");
    assert_eq!(run.code, 1);
    assert!(run.stdout.contains("1 clash"));
    let report: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    let csv = folder.read("out.csv");
    let rows: Vec<&str> = csv.lines().collect();
    assert_eq!(rows.len(), 2);
    assert!(rows[0].starts_with("id,kind,status,"));
    let clash = &report["clashes"][0];
    assert!(rows[1].starts_with(&format!("{},clash,new,,,m,", clash["id"].as_str().unwrap())));
    assert!(rows[0].ends_with(",volume_lower,volume_upper"));
    let volume = clash["volume"].as_array().unwrap();
    assert!(rows[1].ends_with(&format!(",{},{}", volume[0], volume[1])), "{}", rows[1]);
}

#[test]
fn a_page_has_the_report_and_the_same_bytes_for_any_threads() {
    let folder = folder();
    let run = folder.run("clash house.obj --unit m --view house.html --threads 1");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{run:?}");
    let page = folder.read("house.html");
    assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n"), "{} bytes", page.len());
    for block in ["report", "facts", "geometry"] {
        assert_eq!(page.matches(&format!("<script type=\"application/octet-stream\" id=\"{block}\">")).count(), 1);
    }
    folder.run("clash house.obj --unit m --view again.html --threads 2");
    assert_eq!(folder.read("again.html"), page);

    let wrong = folder.run("clash house.obj --view house.htm");
    assert_eq!(wrong.code, 2);
    assert!(wrong.stderr.contains("use a name that ends in .html"), "{}", wrong.stderr);
}

#[test]
fn two_scenes_are_compared_between_each_other() {
    let folder = folder();
    folder.write("pipes.obj", &model(&[PIPE, ("pipe 2", PIPE.1, PIPE.2)]));
    folder.write("walls.obj", &model(&[WALL]));
    let run = folder.run("clash pipes.obj arch=walls.obj --unit m --between --json");
    assert_eq!(clashes(&json(&run)), ["clash wall pipe new", "clash wall pipe 2 new"]);
    assert_eq!(json(&run)["duplicates"].as_array().unwrap().len(), 0);
    let swapped = folder.run("clash arch=walls.obj pipes.obj --unit m --between --json");
    assert_eq!(json(&swapped)["clashes"], json(&run)["clashes"]);
    let all = json(&folder.run("clash pipes.obj arch=walls.obj --unit m --json"));
    assert_eq!(all["duplicates"][0]["parts"].as_array().unwrap().len(), 2);
    let twice = folder.run("clash walls.obj walls.obj --json");
    assert_eq!((twice.code, json(&twice)["error"]["kind"].as_str()), (2, Some("label")));
}

#[test]
fn rules_select_and_errors_name_file_and_line() {
    let folder = folder();
    folder.write(
        "rules.toml",
        "[sets]\npipes = { name = \"pipe*\" }\nwalls = { name = \"wall\" }\n\n[[rule]]\na = \"pipes\"\nb = \"walls\"\n\
         tolerance = \"1/2m\"\n\n[[rule]]\nname = \"room\"\na = \"walls\"\nb = \"*\"\nclearance = \"2cm\"\nseverity = \"low\"\n",
    );
    let run = folder.run("clash house.obj --unit m --rules rules.toml");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""));
    assert!(run.stdout.contains("pairs by rule") && run.stdout.contains("room"), "{}", run.stdout);
    let report = json(&folder.run("clash house.obj --unit m --rules rules.toml --json"));
    assert_eq!(clashes(&report), ["clearance shelf wall new"]);
    assert_eq!((&report["clashes"][0]["rule"], &report["clashes"][0]["severity"]), (&"room".into(), &"low".into()));
    assert_eq!(report["rules"][1]["pairs"], 1);

    folder.write("empty.toml", "[sets]\nducts = { type = \"IfcDuct*\" }\n[[rule]]\na = \"ducts\"\nb = \"*\"\n");
    let run = folder.run("clash house.obj --unit m --rules empty.toml --json");
    let error = &json(&run)["error"];
    assert_eq!((run.code, &error["file"], &error["where"]), (2, &"empty.toml".into(), &"line 2".into()));
    assert!(error["message"].as_str().unwrap().contains("\"ducts\""));
    folder.write("wrong.toml", "tolerance = \"2mm\"\n\n[[rule]]\na = \"*\"\nb = \"*\"\nclearance = \"2 furlongs\"\n");
    let error = &json(&folder.run("clash house.obj --unit m --rules wrong.toml --json"))["error"];
    assert_eq!((&error["kind"], &error["where"]), (&"syntax".into(), &"line 3".into()));
}

#[test]
fn statuses_carry_over_from_the_previous_report() {
    let folder = folder();
    folder.run("clash house.obj --unit m --clearance 20mm --json=old.json");
    let old = folder.read("old.json");
    folder.write("old.json", &old.replacen("\"status\":\"new\"", "\"status\":\"approved\",\"note\":\"agreed\"", 1));
    // The shelf is removed, a second pipe comes.
    folder.write("house.obj", &model(&[WALL, PIPE, ("pipe 2", [2.0, 0.0, 1.0], [2.125, 2.0, 1.125]), LAMP]));
    let run = folder.run("clash house.obj --unit m --clearance 20mm --previous old.json --json");
    let report = json(&run);
    let mut rows = clashes(&report);
    rows.sort();
    assert_eq!((run.code, rows), (1, vec!["clash pipe 2 wall new".to_owned(), "clash pipe wall approved".to_owned()]));
    assert_eq!(report["gone"][0]["names"], serde_json::json!(["shelf", "wall"]));
    assert_eq!(report["gone"][0]["removed"].as_array().unwrap().len(), 1);
    let text = folder.run("clash house.obj --unit m --clearance 20mm --previous old.json").stdout;
    assert!(text.contains("1 new, 1 approved, 1 gone (1 because a part was removed)"), "{text}");
    // The same unit in other words.
    let millimeters = json(&folder.run("clash house.obj --unit m --previous old.json --json"));
    assert_eq!(clashes(&millimeters)[0].split(' ').next_back(), Some("new"));

    let id = report["clashes"].as_array().unwrap().iter().find(|clash| clash["status"] == "new").unwrap()["id"].clone();
    folder.write("accept.toml", &format!("[[accept]]\nid = {id}\n"));
    let run = folder.run("clash house.obj --unit m --previous old.json --accept accept.toml");
    assert_eq!(run.code, 0, "{}", run.stdout);
    assert!(run.stdout.contains("all approved"));
    let broken = folder.read("old.json").replacen("approved", "aproved", 1);
    folder.write("broken.json", &broken);
    let error = &json(&folder.run("clash house.obj --unit m --previous broken.json --json"))["error"];
    assert!(error["message"].as_str().unwrap().contains("new, active, reviewed, approved and resolved"), "{error}");
}

#[test]
fn notes_tell_of_another_question_and_of_accepted_clashes_that_are_absent() {
    let folder = folder();
    folder.run("clash house.obj --unit m --tolerance 1mm --json=old.json");
    let notes = |command: &str| folder.run(&format!("clash house.obj --previous old.json {command}")).stderr;
    // The same lengths in other units.
    assert_eq!(notes("--unit mm --tolerance 0.1cm"), "");
    let text = notes("--unit m --tolerance 2mm");
    assert!(text.contains("the tolerance was 1 mm in the previous report and is 2 mm now"), "{text}");
    let text = notes("--unit m --tolerance 1mm --clearance 20mm");
    assert!(text.contains("the clearance was none in the previous report and is 20 mm now"), "{text}");
    assert!(!text.contains("tolerance"), "{text}");

    let id = json(&folder.run("clash house.obj --json"))["clashes"][0]["id"].clone();
    folder.write("accept.toml", &format!("[[accept]]\nid = {id}\n\n[[accept]]\nid = \"c-absent\"\n"));
    let text = folder.run("clash house.obj --accept accept.toml").stderr;
    assert!(text.contains("the report does not have 1 accepted clash: c-absent"), "{text}");
}

#[test]
fn lengths_need_a_unit_that_is_known() {
    let folder = folder();
    let run = folder.run("clash house.obj --tolerance 2mm --json");
    let error = json(&run)["error"].clone();
    assert_eq!((run.code, &error["kind"], &error["where"]), (2, &"unit".into(), &"--tolerance".into()));
    assert_eq!(folder.run("clash house.obj --tolerance 0.2 --json").code, 0);
    assert_eq!(folder.run("clash house.obj --tolerance -1").code, 2);
    assert_eq!(folder.run("clash house.obj --tolerance nan").code, 2);
}

#[test]
fn outputs_and_inputs_are_validated_before_any_work() {
    let folder = folder();
    for arguments in [
        "clash house.obj --csv out.txt",
        "clash house.obj --json=out.txt",
        "clash house.obj --rules rules.yaml",
        "clash house.obj --accept a.json",
        "clash house.obj --json=nowhere/out.json",
    ] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments}: {run:?}");
    }
    let run = folder.run("clash model.ifc --json");
    let hint = json(&run)["error"]["hint"].as_str().unwrap().to_owned();
    assert_eq!(hint, "run: python -m impinge.convert model.ifc -o model.glb");
    // An output after a space is taken for a scene.
    let run = folder.run("clash house.obj --json new.json");
    assert_eq!(run.code, 2);
    assert_eq!(json(&run)["error"]["hint"], "to write it, add --json=new.json");
    let run = folder.run("clash house.obj --between --json");
    assert_eq!(json(&run)["error"]["hint"], "name two scenes or more, or leave out --between");
    folder.write("rules.toml", "[[rule]]\na = \"*\"\nb = \"*\"\ntollerance = 3\n");
    let run = folder.run("clash house.obj --rules rules.toml --json");
    let message = json(&run)["error"]["message"].as_str().unwrap().to_owned();
    assert!(message.contains("`tollerance`") && message.contains("`tolerance`"), "{message}");
    assert_eq!(folder.run("clash missing.obj").code, 2);
}

/// The first side of the wall is turned, and the pipe has no end.
#[test]
fn a_repair_closes_the_parts_that_only_have_turned_faces() {
    let folder = folder();
    let turned = house().replacen("f 1 3 4 2", "f 2 4 3 1", 1).replacen("f 13 14 16 15\n", "", 1);
    folder.write("turned.obj", &turned);
    let run = folder.run("clash turned.obj --unit m");
    assert!(run.stdout.contains("2 open parts") && run.stdout.contains("--repair improves 1 of them"), "{run:?}");
    let run = folder.run("clash turned.obj --unit m --repair");
    for part in ["repaired  turned  1 part, 1 closed now: 2 faces turned, 0 vertices welded", "1 open part\n"] {
        assert!(run.stdout.contains(part), "{part}: {run:?}");
    }
    assert!(!run.stdout.contains("--repair improves"), "{run:?}");
    let report = json(&folder.run("clash turned.obj --unit m --repair --json"));
    let scene = &report["scenes"][0];
    assert_eq!(
        scene["repaired"],
        serde_json::json!({ "parts": 1, "closed": 1, "turned_faces": 2, "welded_vertices": 0 })
    );
    assert!(scene["repairable"].is_null() && scene["open"] == 1);
    let whole = json(&folder.run("clash house.obj --unit m --repair --json"));
    assert_eq!(clashes(&report), clashes(&whole));
    assert_eq!(whole["scenes"][0]["repaired"]["parts"], 0);
}

#[test]
fn numbers_may_be_in_another_unit_than_the_file_states() {
    let folder = folder();
    let report = json(&folder.run("clash house.obj --file-unit mm --unit m --tolerance 1um --json"));
    assert_eq!(report["unit"], "m");
    let top = report["scenes"][0]["box"][1][2].as_f64().unwrap();
    assert!((top - 0.01).abs() < 1e-8, "{top}");
    assert_eq!(clashes(&report), ["clash pipe wall new"]);
    let run = folder.run("clash house.obj --file-unit mm");
    assert!(run.stdout.contains("10.00 x 10.00 x 10.00 mm") && run.stdout.contains("by 0.125 mm"), "{run:?}");
}

#[test]
fn shifted_scenes_have_the_same_clashes() {
    let folder = folder();
    let far = |(name, min, max): (&'static str, [f64; 3], [f64; 3])| (name, min.map(|x| x + 3e5), max.map(|x| x + 3e5));
    folder.write("far.obj", &model(&[WALL, PIPE, SHELF, LAMP].map(far)));
    let report = json(&folder.run("clash house=far.obj --unit m --shift --json"));
    assert_eq!(clashes(&report), ["clash pipe wall new"]);
    assert_eq!(report["scenes"][0]["origin"][0], 300_005.0);
    let near = json(&folder.run("clash house.obj --unit m --json"));
    assert_eq!(report["clashes"][0]["id"], near["clashes"][0]["id"]);
}

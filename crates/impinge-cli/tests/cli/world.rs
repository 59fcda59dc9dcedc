//! Tests of `impinge world`: the pairs do not depend on the broad phase, the counts add up, and a
//! plot is drawn.

use serde_json::Value;

use crate::Folder;

fn object(folder: &Folder, arguments: &str) -> Value {
    let run = folder.run(arguments);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{arguments}");
    serde_json::from_str(&run.stdout).unwrap()
}

/// Returns the counts of each step.
fn counts(object: &Value) -> Vec<[u64; 5]> {
    let names = ["moved", "candidates", "pairs", "began", "ended"];
    let steps = object["steps"].as_array().unwrap().iter();
    std::iter::once(&object["first"]).chain(steps).map(|step| names.map(|name| step[name].as_u64().unwrap())).collect()
}

#[test]
fn every_broad_phase_finds_the_same_pairs_in_every_scene() {
    let folder = Folder::new();
    for scene in ["brownian", "fall", "pile"] {
        for sizes in ["like", "spread"] {
            let arguments = format!("world --json --scene {scene} --sizes {sizes} --mix all -n 300 --steps 40");
            let expected = object(&folder, &arguments);
            let found = counts(&expected);
            assert_eq!(found.len(), 41);
            let mut pairs = 0;
            for [_, candidates, now, began, ended] in &found {
                pairs = pairs + began - ended;
                assert!(pairs == *now && now <= candidates);
            }
            assert!(found.iter().map(|step| step[3]).sum::<u64>() > 20, "{scene} {sizes}: {found:?}");
            for broad_phase in ["every", "tree", "columns", "grid"] {
                let other = object(&folder, &format!("{arguments} --broad-phase {broad_phase} --threads 1"));
                assert_eq!(counts(&other), found, "{scene} {sizes} {broad_phase}");
                assert_eq!(other["broad_phase"], broad_phase);
            }
        }
    }
}

#[test]
fn the_report_and_the_plot_name_every_phase() {
    let folder = Folder::new();
    let run = folder.run("world -n 50 --steps 5 --narrow-phase intersections --plot times.svg");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    let plot = folder.read("times.svg");
    for phase in ["realign", "take", "broad", "narrow", "report"] {
        assert!(run.stdout.contains(phase) && plot.contains(phase), "{phase}");
    }
    assert!(run.stdout.contains("50 bodies") && plot.starts_with("<svg") && plot.trim_end().ends_with("</svg>"));
    assert!(!plot.contains("NaN"));
    let object = object(&folder, "world -n 50 --steps 5 --json");
    assert_eq!(
        (&object["schema"], &object["bodies"], &object["threads"]),
        (&"impinge.world/1".into(), &50.into(), &object["threads"])
    );
    assert!(object["seconds"]["step"]["median"].as_f64().unwrap() > 0.0);
}

#[test]
fn invalid_arguments_are_errors() {
    let folder = Folder::new();
    assert_eq!(folder.run("world -n 0").code, 2);
    assert_eq!(folder.run("world -n 5 --scene rain").code, 2);
    let run = folder.run("world -n 5 --steps 1 --plot times.jpg --json");
    assert_eq!(run.code, 2);
    assert!(run.stdout.contains("\"error\""));
}

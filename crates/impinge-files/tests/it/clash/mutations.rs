//! Corrupted rules and reports: no panic, and an error with a place.

use std::collections::BTreeSet;

use impinge::clash::{Options, Side, find};
use impinge::query::batch::Execution;
use impinge_files::{Format, LoadError, RulesFormat, SceneOptions, Unit, parse_previous, parse_rules, parse_scene};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::{reports, rules};
use crate::scenes::document;

/// Changes, removes, inserts or repeats some bytes.
fn mutated(rng: &mut Rng, original: &[u8]) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..rng.integer(1, 4) {
        if bytes.is_empty() {
            break;
        }
        let at = rng.integer(0, bytes.len() as i64 - 1) as usize;
        let end = bytes.len().min(at + rng.integer(1, 12) as usize);
        match rng.integer(0, 4) {
            0 => bytes[at] = rng.integer(0, 255) as u8,
            1 => bytes[at] = rng.choose(b"\"[]=,-9\n"),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
            _ => bytes.truncate(at.max(1)),
        }
    }
    bytes
}

/// Reads 1,000 mutations. Asserts that many are errors, each with a place, and many are not.
fn read_mutations(seed: u64, original: &str, read: impl Fn(&[u8]) -> Result<(), LoadError>) {
    assert!(read(original.as_bytes()).is_ok());
    let mut rng = Rng::new(seed);
    let (mut errors, mut fine) = (0, 0);
    for _ in 0..rounds(1000) {
        let bytes = mutated(&mut rng, original.as_bytes());
        match read(&bytes) {
            Ok(()) => fine += 1,
            Err(error) => {
                errors += 1;
                assert!(error.place().is_some(), "{error}: {:?}", String::from_utf8_lossy(&bytes));
            }
        }
    }
    assert!(errors > 200 && fine > 20, "{errors} errors, {fine} fine");
}

#[test]
fn corrupted_rules_are_errors_with_a_place() {
    for (seed, text, format) in [
        (1, rules::TOML, RulesFormat::Toml),
        (2, rules::MATRIX, RulesFormat::Csv),
        (3, rules::IFC_CLASH, RulesFormat::IfcClash),
    ] {
        read_mutations(seed, text, |bytes| parse_rules(bytes, format, Some(Unit::Meter)).map(drop));
    }
}

#[test]
fn corrupted_previous_reports_are_errors_with_a_place() {
    read_mutations(4, &reports::json(), |bytes| parse_previous(bytes, Some(Unit::Meter)).map(drop));
}

#[test]
fn corrupted_scenes_are_errors_or_have_clashes() {
    let nodes = r#""nodes": [{"mesh": 0, "name": "floor"}, {"mesh": 1, "name": "roof", "translation": [0.25, 0.25, -0.75]},
        {"mesh": 0, "name": "copy"}, {"mesh": 1, "name": "turned", "rotation": [0.0, 0.6, 0.0, 0.8], "scale": [1, 2, 3]}]"#;
    let original = document(nodes);
    let mut rng = Rng::new(6);
    let (mut errors, mut kinds) = (0, BTreeSet::new());
    for _ in 0..rounds(1000) {
        let bytes = mutated(&mut rng, original.as_bytes());
        let model = match parse_scene(&bytes, Format::Gltf, &SceneOptions::default()) {
            Ok(model) => model,
            Err(error) => {
                assert!(!error.to_string().is_empty());
                errors += 1;
                continue;
            }
        };
        let Ok(scene) = model.into_scene(|mesh| mesh.solid().into()) else { continue };
        let sides = [Side { label: "scene".to_owned(), scene: &scene }];
        let options = Options { contacts: true, clearance: Some(0.125), ..Options::new(1e-3) };
        let report = find(&sides, options, Execution::default().sequentially()).unwrap();
        assert!(report.clashes.len() <= report.counts.candidates);
        kinds.extend(report.clashes.iter().map(|clash| clash.kind.name()));
        kinds.extend(report.duplicates.iter().map(|_| "duplicate"));
    }
    assert!(errors > 100, "{errors} errors");
    assert!(kinds.contains("clash") && kinds.contains("duplicate"), "{kinds:?}");
}

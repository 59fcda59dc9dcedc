//! Corrupted rules and reports: no panic, and an error with a place.

use impinge_files::{LoadError, RulesFormat, Unit, parse_previous, parse_rules};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use super::{reports, rules};

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

//! Changed and hostile scenes: an answer or a typed error, in bounded time.

use std::collections::BTreeMap;

use impinge::scene::Question;
use impinge_testkit::{generate::Rng, rounds};

use super::{Folder, NEW_FORM, YAML};
use crate::mutants::mutant;

/// Pieces of YAML that change a text.
const WORDS: [&str; 20] = [
    "nan", "-1e999", "1e400", "-1", "[", "]", "{", "}", ": ", "- ", "*flat", "&flat ", "\n", "  ", "box", "null", "'",
    "\0", "é", "* ",
];

/// Returns a text in which some numbers and words are replaced, so that its form stays.
fn changed_values(rng: &mut Rng, text: &str) -> String {
    const VALUES: [&str; 14] =
        ["nan", "1e400", "-5", "0", "1e39", "box", "sphere", "mesh", "null", "[1, 2]", "{x: 1}", "table", "7", "0.5"];
    let is_part = |letter: char| letter.is_alphanumeric() || matches!(letter, '.' | '-' | '_');
    let mut pieces: Vec<String> = text.split_inclusive(|letter| !is_part(letter)).map(str::to_owned).collect();
    let words: Vec<usize> = (0..pieces.len()).filter(|&at| pieces[at].len() > 1).collect();
    for _ in 0..rng.integer(1, 2) {
        let at = words[rng.integer(0, words.len() as i64 - 1) as usize];
        let end = pieces[at].pop().unwrap_or_default();
        pieces[at] = format!("{}{end}", VALUES[rng.integer(0, VALUES.len() as i64 - 1) as usize]);
    }
    pieces.concat()
}

#[test]
fn changed_files_give_scenes_or_typed_errors() {
    let folder = Folder::new();
    let mut rng = Rng::new(9);
    let (mut fine, mut kinds) = (0, BTreeMap::new());
    let count = rounds(600);
    for round in 0..count {
        let (name, text) = if round % 2 == 0 { ("a.yaml", YAML) } else { ("a.scene", NEW_FORM) };
        let changed = if round % 3 == 0 {
            mutant(&mut rng, text, &WORDS, (3, 20))
        } else {
            changed_values(&mut rng, text).into_bytes()
        };
        match folder.load(name, changed) {
            Ok(loaded) => {
                fine += 1;
                assert!(loaded.scene.pairs(Question::Intersects).is_ok());
            }
            Err(error) => {
                assert!(error.path().starts_with(folder.path("")), "{error}");
                *kinds.entry(error.kind().name()).or_insert(0) += 1;
            }
        }
    }
    assert!(fine > count / 10 && kinds["syntax"] > count / 5 && kinds["broken-object"] > 5, "{fine} {kinds:?}");
}

#[test]
fn aliases_and_nesting_take_bounded_time() {
    let folder = Folder::new();
    // Each list has two aliases of the one before it: 2^40 items.
    let bomb: String = (1..40).map(|k| format!("b{k}: &b{k} [*b{}, *b{}]\n", k - 1, k - 1)).collect();
    let error = folder.load("bomb.yaml", format!("b0: &b0 [1, 1]\n{bomb}collision_objects: *b39\n")).unwrap_err();
    assert_eq!(error.kind().name(), "syntax");
    // Many aliases of one object with many shapes: 10^8 shapes.
    let shapes = "*s, ".repeat(10_000);
    let objects = "*o, ".repeat(10_000);
    let text = format!(
        "s: &s {{type: sphere, dimensions: [1]}}\no: &o {{id: a, operation: append, primitives: [{shapes}]}}\n\
         collision_objects: [{objects}]\n"
    );
    assert_eq!(folder.load("many.yaml", text).unwrap_err().kind().name(), "too-many");
    for text in ["[".repeat(200_000), "{a: ".repeat(200_000), "- ".repeat(100_000), "? ".repeat(100_000)] {
        assert!(folder.load("deep.yaml", text).is_err());
    }
    let itself = "collision_objects: &a\n- *a\n";
    assert_eq!(folder.load("itself.yaml", itself).unwrap_err().kind().name(), "syntax");
}

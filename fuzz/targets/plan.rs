//! Text as a plan of parts and as a saved character of a fixed rig: either, or an error.

#![no_main]

use std::sync::LazyLock;

use impinge::character::{Character, Mode, Rig};
use impinge_files::{character_text, parse_character, parse_plan, parse_rig};
use impinge_fuzz::files::{glb, text_and_data};
use impinge_fuzz::memory::{PER_FILE, within};
use libfuzzer_sys::fuzz_target;

static RIG: LazyLock<Rig> = LazyLock::new(|| {
    let (json, binary) = text_and_data(include_bytes!("../seeds/rig/two_bones"));
    parse_rig(&glb(json, binary)).expect("a rig")
});

/// Maximum memory per byte of a text: each byte may begin a table, an array or a number.
const PER_BYTE: usize = 1000;

fuzz_target!(|text: &str| {
    let rig = &*RIG;
    let max = PER_BYTE * text.len() + PER_FILE;
    if let Ok(plan) = within(max, || parse_plan(text, rig)) {
        let _ = Character::fit(rig, &plan, Mode::Snug);
    }
    if let Ok(character) = within(max, || parse_character(text, rig)) {
        let written = character_text(rig, &character);
        let again = parse_character(&written, rig).expect("a saved character");
        assert_eq!(character_text(rig, &again), written);
    }
});

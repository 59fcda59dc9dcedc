//! Rigged characters from a document and a binary chunk: a rig or an error, within the stated
//! memory. Fitted volumes are written and must read back equal.

#![no_main]

use impinge::character::{Character, Mode, Plan};
use impinge_files::{Format, character_text, parse_character, parse_plan, parse_rig_with};
use impinge_fuzz::files::{glb, limits, max_memory, text_and_data};
use impinge_fuzz::memory::within;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (json, binary) = text_and_data(bytes);
    let bytes = if bytes.starts_with(b"glTF") { bytes.to_vec() } else { glb(json, binary) };
    let Ok(rig) = within(max_memory(&bytes, Format::Glb), || parse_rig_with(&bytes, &limits())) else { return };
    // Fitting takes n log n time, so large rigs would hide slow readers.
    if rig.skin().faces().len() > 100 || rig.skeleton().bones().len() > 20 {
        return;
    }
    let Ok(plan) = Plan::automatic(&rig, 3) else { return };
    let Ok(character) = Character::fit(&rig, &plan, Mode::Conservative) else { return };
    let text = character_text(&rig, &character);
    let again = parse_character(&text, &rig).expect("a saved character");
    assert_eq!(character_text(&rig, &again), text);
    parse_plan(&text, &rig).expect("a saved character is a plan");
});

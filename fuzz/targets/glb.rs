//! GLB files, raw or from a document and a binary chunk: a mesh or an error, within the stated
//! memory.

#![no_main]

use impinge_files::Format;
use impinge_fuzz::files::{check, glb, text_and_data};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if bytes.starts_with(b"glTF") {
        check(bytes, Format::Glb);
    } else {
        let (json, binary) = text_and_data(bytes);
        check(&glb(json, binary), Format::Glb);
    }
});

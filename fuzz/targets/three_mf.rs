//! 3MF packages, raw or from the text of a model: a mesh or an error, within the stated memory.

#![no_main]

use impinge_files::Format;
use impinge_fuzz::files::{check, package};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if bytes.starts_with(b"PK") {
        check(bytes, Format::ThreeMf);
    } else {
        check(&package(bytes), Format::ThreeMf);
    }
});

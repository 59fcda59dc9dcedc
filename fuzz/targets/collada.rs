//! Bytes as a file of format COLLADA: the result must be a mesh or an error,
//! within the stated memory.

#![no_main]

use impinge_files::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| impinge_fuzz::files::check(bytes, Format::Collada));

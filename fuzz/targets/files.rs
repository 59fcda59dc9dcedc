//! Bytes as a file of every format, also packed by gzip: a mesh, a rig or an error, within the
//! stated memory.

#![no_main]

use std::io::Write;

use flate2::{Compression, write::GzEncoder};
use impinge_files::{Format, parse_by_content, parse_rig_with};
use impinge_fuzz::files::{check, limits, max_memory};
use impinge_fuzz::memory::within;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for format in Format::ALL {
        check(bytes, format);
    }
    let _ = parse_by_content(bytes);
    let _ = within(max_memory(bytes, Format::Glb), || parse_rig_with(bytes, &limits()));
    let mut packed = GzEncoder::new(Vec::new(), Compression::none());
    packed.write_all(bytes).expect("memory takes all bytes");
    check(&packed.finish().expect("memory takes all bytes"), Format::Obj);
});

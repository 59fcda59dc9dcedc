//! Bytes as a file of every format: a mesh, a rig or an error.

#![no_main]

use impinge::Mesh;
use impinge_files::{Format, parse, parse_rig};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for format in Format::ALL {
        if let Ok(model) = parse(bytes, format) {
            // Coordinates may be beyond what a mesh takes, which is an error too.
            let _ = Mesh::new(model.positions, model.faces);
        }
    }
    let _ = parse_rig(bytes);
});

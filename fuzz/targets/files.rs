//! Bytes as a file of every format: the result must be a mesh, a rig or an error.

#![no_main]

use impinge::Mesh;
use impinge_files::{Format, parse, parse_rig};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for format in Format::ALL {
        if let Ok(model) = parse(bytes, format) {
            // Coordinates may exceed the range of a mesh, which is an error too.
            let _ = Mesh::new(model.positions, model.faces);
        }
    }
    let _ = parse_rig(bytes);
});

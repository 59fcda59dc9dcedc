//! glTF documents with the buffer `a.bin` beside them: a mesh or an error, within the stated
//! memory. A document may name any path, but only files of its own folder may be read.

#![no_main]

use std::fs;
use std::sync::LazyLock;

use impinge_files::{Format, load_with};
use impinge_fuzz::files::{check, limits, make_mesh, max_memory, text_and_data};
use impinge_fuzz::memory::within;
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

fuzz_target!(|bytes: &[u8]| {
    let (json, data) = text_and_data(bytes);
    if !json.windows(3).any(|text| text == b"bin") {
        return check(json, Format::Gltf);
    }
    let path = FOLDER.path().join("a.gltf");
    fs::write(&path, json).expect("the folder takes files");
    fs::write(FOLDER.path().join("a.bin"), data).expect("the folder takes files");
    if let Ok(model) = within(max_memory(bytes, Format::Gltf), || load_with(&path, &limits())) {
        make_mesh(model);
    }
});

//! Checks that hold for the bytes of any file.

use std::io::{Cursor, Write};

use impinge::Mesh;
use impinge_files::{Format, Limits, Model, parse_with};

use crate::memory::{PER_BYTE, PER_FILE, within};

/// Maximum number of bytes that a file may unpack to. The product with [`PER_BYTE`] bounds the
/// memory of a packed file.
const MAX_UNPACKED: u64 = 1 << 20;

/// Maximum memory for content that a file repeats, in bytes: 2^20 items of up to 100 bytes.
pub const REPEATED: usize = PER_BYTE << 20;

/// Returns the limits of all targets that read files.
#[must_use]
pub fn limits() -> Limits {
    Limits::default().with_max_bytes(MAX_UNPACKED)
}

/// Returns the maximum memory for reading a file that consists of `bytes`.
#[must_use]
pub fn max_memory(bytes: &[u8], format: Format) -> usize {
    let is_packed = bytes.starts_with(&[0x1F, 0x8B]) || bytes.starts_with(b"PK");
    let content = if is_packed { MAX_UNPACKED as usize } else { bytes.len() };
    // The content decides about the format, so text formats may be read as glTF or COLLADA.
    let may_repeat = is_packed
        || matches!(format, Format::Gltf | Format::Glb | Format::ThreeMf | Format::Collada)
        || bytes.iter().any(|byte| b"{<".contains(byte))
        || bytes.starts_with(b"glTF");
    PER_BYTE * content + PER_FILE + if may_repeat { REPEATED } else { 0 }
}

/// Reads bytes as a file of a format. The result must be a model that makes sense, or an error.
///
/// # Panics
/// Panics if a model does not make sense, or if it takes too much memory.
pub fn check(bytes: &[u8], format: Format) {
    let result = within(max_memory(bytes, format), || parse_with(bytes, format, &limits()));
    match result {
        Ok(model) => make_mesh(model),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Makes a mesh of a model. Its coordinates may exceed the range of meshes, which is an error too.
///
/// # Panics
/// Panics if the arrays of the model do not fit each other.
pub fn make_mesh(model: Model) {
    let vertices = model.positions.len();
    assert!(model.faces.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
    assert!(model.part_of.iter().all(|&part| (part as usize) < model.parts.len()));
    assert_eq!((model.sources.len(), model.part_of.len()), (model.faces.len(), model.faces.len()));
    assert!((0..vertices).all(|vertex| model.positions.get(vertex).iter().all(|x| x.is_finite())));
    // Building takes n log n time, so large models would hide slow readers.
    if model.faces.len() <= 1000 {
        let _ = Mesh::new(model.positions, model.faces);
    }
}

/// Splits the input of a target at its first zero byte: text, and binary data that belongs to it.
#[must_use]
pub fn text_and_data(input: &[u8]) -> (&[u8], &[u8]) {
    let end = input.iter().position(|&byte| byte == 0).unwrap_or(input.len());
    (&input[..end], input.get(end + 1..).unwrap_or_default())
}

/// Returns a GLB file of a document and its binary chunk.
#[must_use]
pub fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// Returns a 3MF package with one model. It is stored without compression, so that its checksum is
/// right and the fuzzer sees the text.
///
/// # Panics
/// Panics if the memory is too small.
#[must_use]
pub fn package(model: &[u8]) -> Vec<u8> {
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("3D/3dmodel.model", stored).expect("memory takes all bytes");
    zip.write_all(model).expect("memory takes all bytes");
    zip.finish().expect("memory takes all bytes").into_inner()
}

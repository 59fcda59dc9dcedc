//! Baked files that are changed on purpose.

/// Makes all checksums of a baked file right again after its content was changed, so that the
/// changes reach the validation of the arrays. The file must have a whole header.
pub fn correct_checksums(bytes: &mut [u8]) {
    const FIXED: usize = 64;
    const ENTRY: usize = 24;
    const SECTIONS: usize = 9;
    let long = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes")) as usize;
    for entry in (0..SECTIONS).map(|section| FIXED + ENTRY * section) {
        let (start, len) = (long(bytes, entry + 8), long(bytes, entry + 16));
        if let Some(content) = start.checked_add(len).and_then(|end| bytes.get(start..end)) {
            let checksum = crc32fast::hash(content).to_le_bytes();
            bytes[entry + 4..entry + 8].copy_from_slice(&checksum);
        }
    }
    let mut head = crc32fast::Hasher::new();
    head.update(&bytes[..FIXED - 4]);
    head.update(&bytes[FIXED..FIXED + ENTRY * SECTIONS]);
    bytes[FIXED - 4..FIXED].copy_from_slice(&head.finalize().to_le_bytes());
}

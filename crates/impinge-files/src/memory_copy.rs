//! Files that are read into memory, for builds without memory maps.

use std::{
    fs::File,
    io::{self, Read},
    sync::Arc,
};

use impinge::storage::{AlignedBytes, SharedBytes};

/// Returns a copy of the bytes of a file. What others later do to the file does not change it.
///
/// # Errors
/// If the system refuses, or the file becomes shorter meanwhile.
pub(crate) fn copy(mut file: &File) -> io::Result<SharedBytes> {
    let length = usize::try_from(file.metadata()?.len()).map_err(|_| io::ErrorKind::FileTooLarge)?;
    let mut bytes = AlignedBytes::zeroed(length);
    file.read_exact(bytes.as_mut())?;
    Ok(Arc::new(bytes))
}

//! Reads files into memory, for builds without memory maps.

use std::{
    fs::File,
    io::{self, Read},
    sync::Arc,
};

use impinge::storage::{AlignedBytes, SharedBytes};

/// Returns a copy of the bytes of a file. Later changes of the file do not affect it.
///
/// # Errors
/// Returns an error if the file cannot be read, or becomes shorter while it is read.
pub(crate) fn copy(mut file: &File) -> io::Result<SharedBytes> {
    let length = usize::try_from(file.metadata()?.len()).map_err(|_| io::ErrorKind::FileTooLarge)?;
    let mut bytes = AlignedBytes::zeroed(length);
    file.read_exact(bytes.as_mut())?;
    Ok(Arc::new(bytes))
}

//! Opens regular files only. Other paths may have no end, or may wait for another program forever.

use std::{
    fs::{self, File, FileType},
    io::{self, Read},
    path::Path,
};

use crate::{
    error::{LoadError, LoadErrorKind},
    limits::{Limits, OF_FILE},
};

/// Reads the bytes of a regular file.
///
/// # Errors
/// Returns an error if the path is a pipe, a device, a socket or a folder; if the file has more
/// than [`max_bytes`](Limits::max_bytes); or if it cannot be read. The error names the path.
pub fn read_regular_file(path: impl AsRef<Path>, limits: &Limits) -> Result<Vec<u8>, LoadError> {
    let path = path.as_ref();
    read(path, limits).map_err(|e| e.in_file(path))
}

fn read(path: &Path, limits: &Limits) -> Result<Vec<u8>, LoadError> {
    let (file, len) = open(path)?;
    limits.check_bytes(OF_FILE, len)?;
    // The file may grow while it is read.
    let mut bytes = Vec::new();
    read_up_to(&file, len, limits.max_bytes.map_or(u64::MAX, |max| max.saturating_add(1)), &mut bytes)?;
    limits.check_bytes(OF_FILE, bytes.len() as u64)?;
    Ok(bytes)
}

/// Appends the first `max` bytes of a file whose size is about `len`.
pub(crate) fn read_up_to(file: &File, len: u64, max: u64, bytes: &mut Vec<u8>) -> Result<(), LoadError> {
    let room = usize::try_from(len.min(max)).map_err(|_| LoadError::io(&io::ErrorKind::FileTooLarge.into()))?;
    bytes.try_reserve_exact(room).map_err(|_| LoadError::io(&io::ErrorKind::OutOfMemory.into()))?;
    file.take(max).read_to_end(bytes).map_err(|e| LoadError::io(&e))?;
    Ok(())
}

/// Opens a regular file and returns it with its size in bytes. Anything else is refused before it
/// is opened, because opening a pipe waits until another program writes to it.
pub(crate) fn open(path: &Path) -> Result<(File, u64), LoadError> {
    check(fs::metadata(path).map_err(|e| LoadError::io(&e))?.file_type())?;
    let file = File::open(path).map_err(|e| LoadError::io(&e))?;
    // Another program may have replaced the file in between.
    let metadata = file.metadata().map_err(|e| LoadError::io(&e))?;
    check(metadata.file_type())?;
    Ok((file, metadata.len()))
}

/// Returns an error unless the type is that of a regular file.
fn check(kind: FileType) -> Result<(), LoadError> {
    if kind.is_file() {
        return Ok(());
    }
    if kind.is_dir() {
        return Err(LoadError::io(&io::ErrorKind::IsADirectory.into()));
    }
    let error = LoadError::new(LoadErrorKind::NotAFile { found: name(kind) });
    Err(error.with_hint("read its content first, or pass it to the command by standard input, named -"))
}

#[cfg(unix)]
fn name(kind: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    match () {
        () if kind.is_fifo() => "a pipe",
        () if kind.is_socket() => "a socket",
        () => "a device",
    }
}

#[cfg(not(unix))]
fn name(_: FileType) -> &'static str {
    "a device"
}

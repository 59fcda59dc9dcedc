//! Maps files into memory. This is the only file of the crate with `unsafe` code.

use std::{fs::File, io, sync::Arc};

use impinge::storage::SharedBytes;
use memmap2::Mmap;

/// Maps a file. The system reads its bytes when they are accessed.
///
/// If another program shortens the file while it is mapped, the system may end this process when it
/// accesses the missing bytes. If another program writes to the file, the bytes change. See
/// [`Baked`](crate::Baked) for the consequences.
///
/// # Errors
/// Returns an error if the system cannot map the file.
pub(crate) fn map(file: &File) -> io::Result<SharedBytes> {
    // SAFETY: the map is read-only and private. It lives as long as the bytes are borrowed, because
    // both are in one `Arc`. No operating system can guarantee that other processes leave the file
    // unchanged; the documentation makes that a duty of the caller who opens a baked file. Nothing
    // in the file is trusted: every bit pattern is a valid value of the types that are read from it
    // (`bytemuck::Pod`), and every index is checked where it is used. So bytes that change after
    // validation can cause a wrong answer or a panic, but no access out of bounds.
    #[allow(unsafe_code)]
    let map = unsafe { Mmap::map(file)? };
    Ok(Arc::new(map))
}

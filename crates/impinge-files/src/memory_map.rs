//! Files in memory without reading them: the one place of this crate that needs `unsafe`.

use std::{fs::File, io, sync::Arc};

use impinge::storage::SharedBytes;
use memmap2::Mmap;

/// The bytes of a file, which the system reads when they are looked at.
///
/// Whoever shortens the file while it is mapped makes the system end this process when it looks at what is gone; whoever
/// writes to it changes what is read here. See [`Baked`](crate::Baked) for what that means.
///
/// # Errors
/// Where the system refuses.
pub(crate) fn map(file: &File) -> io::Result<SharedBytes> {
    // SAFETY: the map is read-only and private, and lives as long as the bytes are borrowed, as both are in one `Arc`.
    // That other processes leave the file alone cannot be had from any operating system; it is the documented duty of
    // whoever opens a baked file. Nothing that is read from it is believed: every bit pattern is a valid value of the
    // types that it is read as (`bytemuck::Pod`), and every index in it is checked where it is used, so that bytes
    // which change after they were checked lead to a wrong answer or a panic, and to no access outside of anything.
    #[allow(unsafe_code)]
    let map = unsafe { Mmap::map(file)? };
    Ok(Arc::new(map))
}

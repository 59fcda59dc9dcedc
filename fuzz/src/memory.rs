//! Bounds on the memory of a call, which a counting allocator measures.

use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Maximum memory per byte of a file or of its unpacked content, in bytes. docs/security.md states
/// it.
pub const PER_BYTE: usize = 100;
/// Maximum memory for any file, in bytes: the decompressor and the ZIP reader.
pub const PER_FILE: usize = 1 << 18;

/// Calls `work` and returns its result.
///
/// # Panics
/// Panics if the memory in use grows by more than `max` bytes meanwhile.
pub fn within<T>(max: usize, work: impl FnOnce() -> T) -> T {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let result = work();
    let used = MEMORY.peak_usage().saturating_sub(before);
    assert!(used <= max, "{used} bytes of memory, more than {max}");
    result
}

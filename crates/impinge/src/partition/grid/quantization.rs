//! How coordinates are quantized within a cell.

/// Number of parts of the edge of a cell, as a power of two.
pub(super) const PARTS: u32 = 8;

/// Number of consecutive cells along an axis that have different cell keys.
pub(super) const DISTINCT_KEYS: i64 = 8;

/// Returns the step of a place as seen from the `nth` cell after a cell, given the number of parts from the beginning of that cell.
#[inline(always)]
pub(super) fn quantized_step(parts: i16, nth: usize) -> i16 {
    let part = (parts - ((nth as i16) << PARTS)).clamp(-1, 1 << PARTS);
    // The 256 parts map to 254 steps in the same order.
    1 + part - ((part + 127) >> 7)
}

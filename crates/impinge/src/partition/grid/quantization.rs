//! Quantization of coordinates within a cell.

/// Binary logarithm of the number of parts of a cell's edge.
pub(super) const PART_BITS: u32 = 8;

/// Number of consecutive cells along an axis that have different cell keys.
pub(super) const DISTINCT_KEYS: i64 = 8;

/// Returns the step of a place relative to the `nth` cell after a first cell. `parts` is the
/// distance from the beginning of the first cell, in parts.
#[inline(always)]
pub(super) fn quantized_step(parts: i16, nth: usize) -> i16 {
    let part = (parts - ((nth as i16) << PART_BITS)).clamp(-1, 1 << PART_BITS);
    // The 256 parts map to 254 steps in the same order.
    1 + part - ((part + 127) >> 7)
}

//! How coordinates are quantized within a cell.

/// Parts of the edge of a cell, as a power of two.
pub(super) const PARTS: u32 = 8;

/// Cells along an axis of which no two have the same cell key.
pub(super) const DISTINCT_KEYS: i64 = 8;

/// The step of a place so many parts behind the beginning of a cell as it is seen from the `nth` that follows.
#[inline(always)]
pub(super) fn quantized_step(parts: i16, nth: usize) -> i16 {
    let part = (parts - ((nth as i16) << PARTS)).clamp(-1, 1 << PARTS);
    // Of 256 parts 254 steps are made, which are in order as these are.
    1 + part - ((part + 127) >> 7)
}

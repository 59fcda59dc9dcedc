//! Sets of lanes as the bits of a byte, and sets of pairs of lanes as the bits of eight bytes.

/// A one in each byte.
const EACH_BYTE: u64 = 0x0101_0101_0101_0101;

/// Returns a one in each byte that has any bit set, and zero in the other bytes.
#[inline(always)]
pub(crate) fn nonzero_bytes(bytes: u64) -> u64 {
    const LOW_BITS: u64 = 0x7f * EACH_BYTE;
    ((((bytes & LOW_BITS) + LOW_BITS) | bytes) >> 7) & EACH_BYTE
}

/// Returns the bytes 0xff at each index whose bit is set in `lanes`, and zero bytes elsewhere.
#[inline(always)]
pub(crate) fn spread_to_bytes(lanes: u32) -> u64 {
    const OWN_BIT: u64 = 0x8040_2010_0804_0201;
    nonzero_bytes(each_byte(lanes) & OWN_BIT) * 0xff
}

/// Returns eight copies of the byte `lanes`.
#[inline(always)]
pub(crate) fn each_byte(lanes: u32) -> u64 {
    EACH_BYTE * u64::from(lanes)
}

/// Returns the bitwise or of the eight bytes.
#[inline(always)]
pub(crate) fn any_byte(bytes: u64) -> u32 {
    let half = bytes | bytes >> 32;
    let quarter = half | half >> 16;
    (quarter | quarter >> 8) as u32 & 0xff
}

/// Returns the positions of the bits that are set, the lowest first.
#[inline(always)]
pub(crate) fn bits(mut set: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (set != 0).then(|| {
            let lowest = set.trailing_zeros() as usize;
            set &= set - 1;
            lowest
        })
    })
}

/// Removes the lowest four bits from `set` and returns their positions. If fewer bits are set, the
/// remaining entries are any number below 64.
///
/// A loop over single bits ends unpredictably, so the processor mispredicts its exit. A list that
/// appends four positions at once, and [keeps](extend_some) only the valid ones, rarely loops
/// twice.
#[inline(always)]
pub(crate) fn take_four(set: &mut u64) -> [usize; 4] {
    [0; 4].map(|_| {
        let lowest = set.trailing_zeros() % u64::BITS;
        *set &= set.wrapping_sub(1);
        lowest as usize
    })
}

/// Appends the first `count` of the four elements, or all four if `count` is larger.
#[inline(always)]
pub(crate) fn extend_some<T: Copy>(list: &mut Vec<T>, four: [T; 4], count: usize) {
    let end = list.len() + count;
    list.extend_from_slice(&four);
    list.truncate(end);
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;

    #[test]
    fn lists_get_each_bit_once() {
        let mut rng = Rng::new(9);
        for count in [0, 1, 3, 4, 5, 8, 20, 64] {
            let mut set = (0..count).fold(0, |set, _| set | 1_u64 << rng.integer(0, 63));
            let places: Vec<usize> = (0..64).filter(|place| set >> place & 1 != 0).collect();
            let mut taken = Vec::new();
            while set != 0 {
                let left = set.count_ones() as usize;
                extend_some(&mut taken, take_four(&mut set), left);
            }
            assert_eq!(taken, places);
        }
    }
}

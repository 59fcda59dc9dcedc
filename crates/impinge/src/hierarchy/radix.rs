//! Sorting by one digit.
//!
//! Source: Knuth, *The Art of Computer Programming* 3, 5.2.5.

/// Sorts elements, fewer than 2^32, by one digit below `DIGITS`, those with the same one in the order in which they came, and
/// returns where those with each digit end.
#[inline(always)]
pub(crate) fn scatter<const DIGITS: usize, T: Copy>(
    from: &[T],
    to: &mut [T],
    digit: impl Fn(T) -> usize,
) -> [u32; DIGITS] {
    let mut next = [0; DIGITS];
    for &element in from {
        next[digit(element) % DIGITS] += 1;
    }
    add_up(&mut next);
    for &element in from {
        let next = &mut next[digit(element) % DIGITS];
        to[*next as usize] = element;
        *next += 1;
    }
    next
}

/// How many there are before each, in place of how many there are of each.
#[inline(always)]
pub(super) fn add_up(counts: &mut [u32]) {
    let mut before = 0;
    for count in counts {
        (*count, before) = (before, before + *count);
    }
}

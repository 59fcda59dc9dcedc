//! One pass of a radix sort: a stable counting sort by one digit.
//!
//! Source: Knuth, *The Art of Computer Programming* 3, 5.2.5.

/// Sorts fewer than 2^32 elements by one digit below `DIGITS`. Elements with the same digit keep
/// their order. Returns the end of the elements with each digit.
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

/// Replaces the count of each digit by the number of elements with smaller digits.
#[inline(always)]
pub(super) fn add_up(counts: &mut [u32]) {
    let mut before = 0;
    for count in counts {
        (*count, before) = (before, before + *count);
    }
}

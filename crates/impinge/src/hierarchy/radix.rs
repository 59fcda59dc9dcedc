//! Sorting keys by their codes.
//!
//! Source: Knuth, *The Art of Computer Programming* 3, 5.2.5: dealt out by the leading digit, so that threads have a deal
//! each and a deal fits the cache, then each deal that is long by the next digit, and so on.

use rayon::prelude::*;

use super::cluster::CLUSTER;
use super::curve::{CODE_BITS, Key, code};

/// Bits of a digit; three make a code.
const DIGIT_BITS: u32 = CODE_BITS / 3;
const DIGITS: usize = 1 << DIGIT_BITS;

/// Digit `place` of a key's code, the least being 0.
#[inline(always)]
fn digit(key: Key, place: u32) -> usize {
    (code(key) >> (DIGIT_BITS * place)) as usize % DIGITS
}

/// Sorts keys by their codes as far as it matters to a builder: keys that share their leading digits stay in the order in
/// which they came where they are too few to be more than a cluster, and so do equal codes. `dealt` is room for as many.
pub(crate) fn sort(keys: &mut [Key], dealt: &mut [Key]) {
    let mut starts = starts::<DIGITS, Key>(keys, |key| digit(key, 2)).to_vec();
    starts.push(keys.len() as u32);
    let threads = rayon::current_num_threads();
    let share = keys.len().div_ceil(threads).max(1);
    // Each thread looks for the keys of its own run of deals.
    let mut runs = Vec::new();
    let (mut left, mut first) = (&mut *dealt, 0);
    while first < DIGITS {
        let is_enough = |&end: &usize| (starts[end] - starts[first]) as usize >= share;
        let end = (first + 1..DIGITS).find(is_enough).unwrap_or(DIGITS);
        let (run, after) = left.split_at_mut((starts[end] - starts[first]) as usize);
        runs.push((first..end, run));
        (left, first) = (after, end);
    }
    runs.into_par_iter().for_each(|(deals, run)| {
        let mut next = [0; DIGITS];
        for deal in deals.clone() {
            next[deal] = (starts[deal] - starts[deals.start]) as usize;
        }
        for &key in keys.iter() {
            let deal = digit(key, 2);
            if deals.contains(&deal) {
                run[next[deal]] = key;
                next[deal] += 1;
            }
        }
    });
    let mut deals = Vec::new();
    let (mut left, mut place) = (dealt, keys);
    for ends in starts.windows(2) {
        let len = (ends[1] - ends[0]) as usize;
        let (deal, after) = left.split_at_mut(len);
        let (sorted, place_after) = place.split_at_mut(len);
        (left, place) = (after, place_after);
        deals.push((deal, sorted));
    }
    deals.into_par_iter().for_each(|(deal, sorted)| {
        if deal.len() <= CLUSTER {
            sorted.copy_from_slice(deal);
            return;
        }
        let ends = scatter::<DIGITS, Key>(deal, sorted, |key| digit(key, 1));
        let mut start = 0;
        for end in ends.map(|end| end as usize) {
            if end - start > CLUSTER {
                let (long, room) = (&mut sorted[start..end], &mut deal[start..end]);
                scatter::<DIGITS, Key>(long, room, |key| digit(key, 0));
                long.copy_from_slice(room);
            }
            start = end;
        }
    });
}

/// Where the elements with each digit start when they are sorted by it; digits are below `DIGITS`.
#[inline(always)]
fn starts<const DIGITS: usize, T: Copy>(elements: &[T], digit: impl Fn(T) -> usize) -> [u32; DIGITS] {
    let mut starts = [0; DIGITS];
    for &element in elements {
        starts[digit(element) % DIGITS] += 1;
    }
    let mut before = 0;
    for start in &mut starts {
        (*start, before) = (before, before + *start);
    }
    starts
}

/// Sorts elements, fewer than 2^32, by one digit below `DIGITS`, those with the same one in the order in which they came, and
/// returns where those with each digit end.
#[inline(always)]
pub(crate) fn scatter<const DIGITS: usize, T: Copy>(
    from: &[T],
    to: &mut [T],
    digit: impl Fn(T) -> usize,
) -> [u32; DIGITS] {
    let mut next = starts::<DIGITS, T>(from, &digit);
    for &element in from {
        let place = &mut next[digit(element) % DIGITS];
        to[*place as usize] = element;
        *place += 1;
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    #[test]
    fn long_deals_are_sorted_and_equal_codes_keep_their_order() {
        let mut rng = Rng::new(141);
        let mut seen = [0; 3];
        for (codes, len) in [(1, 5_000), (40, 30_000), (1 << 12, 100_000), (1 << 30, 200_000), (1 << 30, 3), (7, 0)] {
            // Few codes that are far apart, or all of them, in a part of the curve or all over it.
            for part in [0, 7, 14] {
                let step = ((((1_u64 << CODE_BITS) - 1) / codes) >> part).max(1);
                let mut keys: Vec<Key> =
                    (0..len).map(|index| ((rng.integer(0, codes as i64 - 1) as u64 * step) << 32) | index).collect();
                let mut expected = keys.clone();
                expected.sort_by_key(|&key| code(key));
                let mut sorted = keys.clone();
                sort(&mut sorted, &mut keys);
                // One deal after the other: what was too short to be sorted farther lies as it came.
                let sharing = |keys: &[Key], place: u32| {
                    let prefix = |key: Key| code(key) >> (DIGIT_BITS * place);
                    keys.iter().take_while(|&&key| prefix(key) == prefix(keys[0])).count()
                };
                let mut start = 0;
                while start < sorted.len() {
                    let deal = &mut sorted[start..][..sharing(&expected[start..], 2)];
                    let is_long = deal.len() > CLUSTER;
                    let mut at = 0;
                    while at < deal.len() {
                        let cell = &mut deal[at..][..sharing(&expected[start + at..], 1)];
                        at += cell.len();
                        seen[usize::from(is_long) + usize::from(cell.len() > CLUSTER)] += 1;
                        if is_long && cell.len() <= CLUSTER {
                            assert!(cell.is_sorted_by_key(|&key| key as u32), "{codes} codes: not as they came");
                            cell.sort_by_key(|&key| code(key));
                        }
                    }
                    if !is_long {
                        assert!(deal.is_sorted_by_key(|&key| key as u32), "{codes} codes: not as they came");
                        deal.sort_by_key(|&key| code(key));
                    }
                    assert_eq!(*deal, expected[start..start + deal.len()], "{codes} codes in a part of {part}");
                    start += deal.len();
                }
            }
        }
        assert!(seen.iter().all(|&seen| seen > 50), "{seen:?}");
    }
}

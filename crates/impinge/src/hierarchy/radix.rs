//! Sorting keys by their codes.
//!
//! Source: Knuth, *The Art of Computer Programming* 3, 5.2.5: dealt out by the leading digit, so that threads have a deal
//! each and a deal fits the cache, then each deal that is long by the other two digits from the least.

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

/// Sorts keys by their codes as far as it matters to a builder: keys with the same leading digit stay in the order in
/// which they came where they are too few to be more than a cluster, and so do equal codes. They end up in `dealt`, which
/// is as long.
pub(crate) fn sort(keys: &mut [Key], dealt: &mut [Key]) {
    let mut starts = starts::<DIGITS, Key>(keys, |key| digit(key, 2)).to_vec();
    starts.push(keys.len() as u32);
    let threads = rayon::current_num_threads();
    let share = keys.len().div_ceil(threads).max(1);
    // Each thread looks for the keys of its own run of deals.
    let mut runs = Vec::new();
    let (mut rest, mut first) = (&mut *dealt, 0);
    while first < DIGITS {
        let end = (first + 1..DIGITS).find(|&end| (starts[end] - starts[first]) as usize >= share).unwrap_or(DIGITS);
        let (run, after) = rest.split_at_mut((starts[end] - starts[first]) as usize);
        runs.push((first..end, run));
        (rest, first) = (after, end);
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
    let mut long = Vec::new();
    let (mut rest, mut spare) = (dealt, keys);
    for ends in starts.windows(2) {
        let len = (ends[1] - ends[0]) as usize;
        let (deal, after) = rest.split_at_mut(len);
        let (room, room_after) = spare.split_at_mut(len);
        (rest, spare) = (after, room_after);
        if len > CLUSTER {
            long.push((deal, room));
        }
    }
    long.into_par_iter().for_each(|(deal, room)| {
        scatter::<DIGITS, Key>(deal, room, |key| digit(key, 0));
        scatter::<DIGITS, Key>(room, deal, |key| digit(key, 1));
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

/// Sorts elements, fewer than 2^32, by one digit below `DIGITS`, those with the same one in the order in which they came.
#[inline(always)]
pub(crate) fn scatter<const DIGITS: usize, T: Copy>(from: &[T], to: &mut [T], digit: impl Fn(T) -> usize) {
    let mut next = starts::<DIGITS, T>(from, &digit);
    for &element in from {
        let place = &mut next[digit(element) % DIGITS];
        to[*place as usize] = element;
        *place += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    #[test]
    fn long_deals_are_sorted_and_equal_codes_keep_their_order() {
        let mut rng = Rng::new(141);
        for (codes, len) in [(1, 5_000), (40, 30_000), (1 << 12, 100_000), (1 << 30, 200_000), (1 << 30, 3), (7, 0)] {
            // Few codes that are far apart, or all of them.
            let step = ((1_u64 << CODE_BITS) - 1) / codes;
            let keys: Vec<Key> =
                (0..len).map(|index| (rng.integer(0, codes as i64 - 1) as u64 * step) << 32 | index).collect();
            let mut expected = keys.clone();
            expected.sort_by_key(|&key| code(key));
            let mut sorted = vec![0; keys.len()];
            sort(&mut keys.clone(), &mut sorted);
            for (at, window) in sorted.windows(2).enumerate() {
                assert!(digit(window[0], 2) <= digit(window[1], 2), "{codes} codes: dealt wrongly at {at}");
            }
            let deals = |keys: &[Key]| -> Vec<Vec<Key>> {
                keys.chunk_by(|&p, &q| digit(p, 2) == digit(q, 2)).map(<[Key]>::to_vec).collect()
            };
            let (mut long, mut short) = (0, 0);
            for (mut deal, expected) in deals(&sorted).into_iter().zip(deals(&expected)) {
                if deal.len() > CLUSTER {
                    long += 1;
                } else {
                    short += 1;
                    deal.sort_by_key(|&key| code(key));
                }
                assert_eq!(deal, expected, "{codes} codes");
            }
            assert!(len < 5_000 || long > 0 || short > 900, "{codes} codes: {long} long and {short} short deals");
        }
    }
}

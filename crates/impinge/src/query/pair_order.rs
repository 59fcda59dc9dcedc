//! Sorting pairs of faces, the last step of a pair query.
//!
//! A sort by comparisons would take about 10 % of the query.

use crate::hierarchy::scatter;

/// Minimum number of pairs for the radix sort. A sort by comparisons is faster for shorter lists.
const MIN_RADIX_SORT: usize = 1 << 9;

/// Number of bits of a digit.
const DIGIT_BITS: u32 = 11;
/// Number of values of a digit.
const DIGITS: usize = 1 << DIGIT_BITS;

/// Returns the pairs sorted by their first face, then by their second.
///
/// Long lists are sorted by digits, from the least significant digit up (Knuth, *The Art of
/// Computer Programming* 3, 5.2.5). Faces are numbered from zero, so that few digits are in use.
pub(super) fn sorted(mut pairs: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    if pairs.len() < MIN_RADIX_SORT || u32::try_from(pairs.len()).is_err() {
        pairs.sort_unstable();
        return pairs;
    }
    let mut spare = vec![[0; 2]; pairs.len()];
    for which in [1, 0] {
        let used = pairs.iter().fold(0, |used, pair| used | pair[which]);
        for shift in (0..u32::BITS - used.leading_zeros()).step_by(DIGIT_BITS as usize) {
            scatter::<DIGITS, [u32; 2]>(&pairs, &mut spare, |pair| (pair[which] >> shift) as usize);
            std::mem::swap(&mut pairs, &mut spare);
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    #[test]
    fn any_pairs_are_sorted() {
        let mut rng = Rng::new(161);
        for most in [0, 1, 2_047, 2_048, 100_000, i64::from(u32::MAX)] {
            for len in [0, 1, MIN_RADIX_SORT - 1, MIN_RADIX_SORT, 20_000] {
                let pairs: Vec<[u32; 2]> = (0..len).map(|_| [0; 2].map(|_| rng.integer(0, most) as u32)).collect();
                let mut expected = pairs.clone();
                expected.sort();
                assert!(sorted(pairs) == expected, "{len} pairs of numbers up to {most}");
            }
        }
    }
}

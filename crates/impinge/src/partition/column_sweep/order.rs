//! Sorting of the pairs found.

use rayon::prelude::*;

use crate::hierarchy::scatter;

/// Maximum number of pairs that are sorted directly; longer lists are first distributed to buckets.
const MAX_SORTED_DIRECTLY: usize = 1 << 9;

/// Maximum number of pairs that are distributed by 12 bits of their first number; longer lists use
/// 14 bits.
const MAX_COARSELY_DISTRIBUTED: usize = 1 << 15;

/// Maximum size of the largest bucket for which one insertion sort orders the whole list. Each pair
/// then passes few others.
const MAX_INSERTION_BUCKET: u32 = 24;

/// Sorts pairs of numbers below `len` from one list into another. May reorder `from`.
pub(super) fn sort_pairs(from: &mut [[u32; 2]], to: &mut Vec<[u32; 2]>, len: usize) {
    to.clear();
    if from.len() <= MAX_SORTED_DIRECTLY {
        from.sort_unstable();
        to.extend_from_slice(from);
    } else if from.len() <= MAX_COARSELY_DISTRIBUTED {
        distribute_and_sort::<{ 1 << 12 }>(from, to, len);
    } else {
        distribute_and_sort::<{ 1 << 14 }>(from, to, len);
    }
}

/// Distributes pairs to buckets by the leading bits of their first number, and sorts each bucket.
fn distribute_and_sort<const BUCKETS: usize>(from: &[[u32; 2]], to: &mut Vec<[u32; 2]>, len: usize) {
    let shift = len.next_power_of_two().ilog2().saturating_sub(BUCKETS.ilog2());
    let bucket = |pair: [u32; 2]| (pair[0] >> shift) as usize;
    to.resize(from.len(), [0; 2]);
    let ends = scatter::<BUCKETS, [u32; 2]>(from, to, bucket);
    let longest = ends.windows(2).map(|ends| ends[1] - ends[0]).fold(ends[0], u32::max);
    if longest <= MAX_INSERTION_BUCKET {
        return insert_each(to);
    }
    // A bucket ends where the next begins.
    let sort = |bucket: &mut [[u32; 2]]| bucket.sort_unstable_by_key(|&pair| number(pair));
    if rayon::current_num_threads() == 1 {
        to.chunk_by_mut(|one, other| bucket(*one) == bucket(*other)).for_each(sort);
    } else {
        let buckets: Vec<_> = to.chunk_by_mut(|one, other| bucket(*one) == bucket(*other)).collect();
        buckets.into_par_iter().with_min_len(64).for_each(sort);
    }
}

/// Sorts the list by insertion, which is fast if few greater pairs precede each pair.
fn insert_each(pairs: &mut [[u32; 2]]) {
    for at in 1..pairs.len() {
        let pair = pairs[at];
        let mut to = at;
        while to > 0 && number(pairs[to - 1]) > number(pair) {
            pairs[to] = pairs[to - 1];
            to -= 1;
        }
        pairs[to] = pair;
    }
}

#[inline(always)]
fn number(pair: [u32; 2]) -> u64 {
    u64::from(pair[0]) << 32 | u64::from(pair[1])
}

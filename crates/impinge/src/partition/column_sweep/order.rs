//! Pairs in order.

use rayon::prelude::*;

use crate::hierarchy::scatter;

/// Pairs that are sorted as they are; more are dealt out first.
const FEW: usize = 1 << 9;

/// Pairs that are dealt out by 12 bits of their first number; more by 14.
const MANY: usize = 1 << 15;

/// Pairs of the longest deal with which all are put in order at once, each moved past the few that it has to pass.
const SHORT: u32 = 24;

/// Sorts pairs of numbers below `len` from one list into another.
pub(super) fn sort_pairs(from: &mut [[u32; 2]], to: &mut Vec<[u32; 2]>, len: usize) {
    to.clear();
    if from.len() <= FEW {
        from.sort_unstable();
        to.extend_from_slice(from);
    } else if from.len() <= MANY {
        deal_and_sort::<{ 1 << 12 }>(from, to, len);
    } else {
        deal_and_sort::<{ 1 << 14 }>(from, to, len);
    }
}

/// Deals pairs out by the first bits of their first number, and sorts each deal.
fn deal_and_sort<const DEALS: usize>(from: &[[u32; 2]], to: &mut Vec<[u32; 2]>, len: usize) {
    let shift = len.next_power_of_two().ilog2().saturating_sub(DEALS.ilog2());
    let deal = |pair: [u32; 2]| (pair[0] >> shift) as usize;
    to.resize(from.len(), [0; 2]);
    let ends = scatter::<DEALS, [u32; 2]>(from, to, deal);
    let longest = ends.windows(2).map(|ends| ends[1] - ends[0]).fold(ends[0], u32::max);
    if longest <= SHORT {
        return insert_each(to);
    }
    // A deal ends where the next begins.
    let sort = |deal: &mut [[u32; 2]]| deal.sort_unstable_by_key(|&pair| number(pair));
    if rayon::current_num_threads() == 1 {
        to.chunk_by_mut(|one, other| deal(*one) == deal(*other)).for_each(sort);
    } else {
        let deals: Vec<_> = to.chunk_by_mut(|one, other| deal(*one) == deal(*other)).collect();
        deals.into_par_iter().with_min_len(64).for_each(sort);
    }
}

/// Moves each pair before those that are greater, of which there are few.
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

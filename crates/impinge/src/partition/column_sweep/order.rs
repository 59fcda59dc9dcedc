//! Pairs in order.

use rayon::prelude::*;

/// Pairs that are sorted as they are; more are dealt out first.
const FEW: usize = 1 << 11;

/// Deals of pairs by their first number.
const DEALS: usize = 1 << 12;

/// Sorts pairs of numbers below `len` from one list into another.
pub(super) fn sort_pairs(from: &mut [[u32; 2]], to: &mut Vec<[u32; 2]>, len: usize) {
    to.clear();
    if from.len() <= FEW {
        from.sort_unstable();
        to.extend_from_slice(from);
        return;
    }
    let shift = len.next_power_of_two().ilog2().saturating_sub(DEALS.ilog2());
    let deal = |pair: [u32; 2]| (pair[0] >> shift) as usize;
    to.resize(from.len(), [0; 2]);
    crate::hierarchy::scatter::<DEALS, [u32; 2]>(from, to, deal);
    // A deal ends where the next begins; few are long.
    let sort = |deal: &mut [[u32; 2]]| deal.sort_unstable_by_key(|pair| u64::from(pair[0]) << 32 | u64::from(pair[1]));
    if rayon::current_num_threads() == 1 {
        to.chunk_by_mut(|one, other| deal(*one) == deal(*other)).for_each(sort);
    } else {
        let deals: Vec<_> = to.chunk_by_mut(|one, other| deal(*one) == deal(*other)).collect();
        deals.into_par_iter().with_min_len(64).for_each(sort);
    }
}

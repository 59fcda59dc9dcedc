//! The order in which points are put on a hull: random enough for the expected bounds, and near each other for the caches.
//!
//! Source: Amenta, Choi and Rote, *Incremental constructions con BRIO*, 2003: each point is drawn into a round, half of them
//! into the last, half of the rest into the one before and so on; within a round points follow a space-filling curve. Ours
//! draws by a hash of the coordinates rather than from a stream of random numbers, so that the order of the input does not
//! matter and equal points stay together, the first one leading.

use rayon::prelude::*;

/// Bits of the place along the curve for each axis.
const BITS: u32 = 16;

/// The least that a round holds, on average; smaller ones would only cost locality.
const SMALLEST_ROUND: usize = 256;

/// The given points by their numbers in the input, in the order of insertion.
pub(super) fn insertion_order(points: &[([f64; 3], u32)]) -> Vec<u32> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for (point, _) in points {
        for k in 0..3 {
            low[k] = low[k].min(point[k]);
            high[k] = high[k].max(point[k]);
        }
    }
    let cells: [f64; 3] = std::array::from_fn(|k| f64::from(1 << BITS) / (high[k] - low[k]));
    let rounds = (points.len() / SMALLEST_ROUND).checked_ilog2().unwrap_or(0);
    let mut keyed: Vec<(u64, u32, u32)> = points
        .par_iter()
        .zip(0..points.len() as u32)
        .map(|(&(point, number), position)| {
            let hash = point.iter().fold(0, |hash, x| mix(hash ^ x.to_bits()));
            let round = rounds - hash.trailing_zeros().min(rounds);
            // A cast saturates, and takes the NaN of a flat axis to zero.
            let place = (0..3).fold(0, |place, k| place | spread(((point[k] - low[k]) * cells[k]) as u16) << k);
            (u64::from(round) << (3 * BITS) | place, number, position)
        })
        .collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, _, position)| position).collect()
}

/// The finaliser of splitmix64 (Steele, Lea and Flood 2014), after adding its constant.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The bits of a number, two zeros after each.
fn spread(x: u16) -> u64 {
    let x = u64::from(x);
    let x = (x | x << 16) & 0x0000_ff00_00ff;
    let x = (x | x << 8) & 0x00f0_0f00_f00f;
    let x = (x | x << 4) & 0x0c30_c30c_30c3;
    (x | x << 2) & 0x2492_4924_9249
}

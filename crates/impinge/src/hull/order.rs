//! The order in which points are inserted in a hull: random enough for the expected bounds, and
//! local enough for the memory caches.
//!
//! Source: Amenta, Choi and Rote, *Incremental constructions con BRIO*, 2003: each point is drawn
//! into a round, half of the points into the last round, half of the rest into the one before and
//! so on. Within a round the points follow a space-filling curve. Ours draws by a hash of the
//! coordinates instead of a stream of random numbers. So the order of the input does not matter,
//! and equal points stay together, the first one leading.

use rayon::prelude::*;

/// Number of bits of the position along the curve for each axis.
const BITS: u32 = 16;

/// Minimum average number of points in a round. Smaller rounds would only lose locality.
const MIN_ROUND: usize = 256;

/// Returns the order of insertion, as positions in `points`. Each point comes with its number in
/// the input.
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
    let rounds = (points.len() / MIN_ROUND).checked_ilog2().unwrap_or(0);
    let mut keyed: Vec<(u64, u32, u32)> = points
        .par_iter()
        .zip(0..points.len() as u32)
        .map(|(&(point, number), position)| {
            let hash = point.iter().fold(0, |hash, x| mix(hash ^ x.to_bits()));
            let round = rounds - hash.trailing_zeros().min(rounds);
            // A cast saturates, and converts the NaN of a flat axis to zero.
            let place = (0..3).fold(0, |place, k| place | spread(((point[k] - low[k]) * cells[k]) as u16) << k);
            (u64::from(round) << (3 * BITS) | place, number, position)
        })
        .collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, _, position)| position).collect()
}

/// Returns the finalizer of splitmix64 (Steele, Lea and Flood 2014) of `x` plus its constant.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Returns the bits of a number with two zeros after each bit.
fn spread(x: u16) -> u64 {
    let x = u64::from(x);
    let x = (x | x << 16) & 0x0000_ff00_00ff;
    let x = (x | x << 8) & 0x00f0_0f00_f00f;
    let x = (x | x << 4) & 0x0c30_c30c_30c3;
    (x | x << 2) & 0x2492_4924_9249
}

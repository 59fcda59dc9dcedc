//! The two timed queries, all pairs and the first hit, for any engine, with comparison of all
//! answers.

use std::hint::black_box;

use anyhow::{Result, ensure};
use impinge::mesh::{Options, PlacedMesh};
use impinge::query::Query;

use crate::samples::{Samples, timed};

/// Target time of one sample of the first hit, in seconds: far above the clock's resolution and
/// below a time slice.
const BATCH_SECONDS: f64 = 2e-3;

/// Maximum number of calls in one sample of the first hit, as in `bench/rivals.py`.
const MOST_CALLS: f64 = 100.0;

/// Times of an engine, whose answers all agreed.
#[derive(Clone, Debug)]
pub struct Asked {
    /// Intersecting pairs (face of A, face of B), sorted.
    pub pairs: Vec<[u32; 2]>,
    /// Times of all pairs, one query per sample.
    pub all_pairs: Samples,
    /// Times of the first hit. Each sample is the mean time of a call in a batch.
    pub first_hit: Samples,
}

/// Times both queries of an engine `repeats` times, after one untimed run that loads the caches.
/// `all_pairs` must return sorted pairs, and `intersects` whether there are any.
///
/// # Errors
/// Returns an error if two answers disagree: all pairs of two runs, or the first hit and all pairs.
pub fn ask(
    repeats: usize,
    mut all_pairs: impl FnMut() -> Vec<[u32; 2]>,
    mut intersects: impl FnMut() -> bool,
) -> Result<Asked> {
    let reference = all_pairs();
    let meets = intersects();
    ensure!(
        meets != reference.is_empty(),
        "the first hit says {meets} where all pairs are {} in number",
        reference.len()
    );
    let all_pairs = Samples::take(repeats, || {
        let (seconds, found) = timed(&mut all_pairs);
        let (again, before) = (found.len(), reference.len());
        ensure!(found == reference, "asked again, {again} pairs are found that are not the {before} from before");
        Ok(seconds)
    })?;

    let (once, _) = timed(&mut intersects);
    let calls = (BATCH_SECONDS / once).clamp(1.0, MOST_CALLS) as usize;
    let first_hit = Samples::take(repeats, || {
        let (seconds, hits) = timed(|| (0..calls).filter(|_| black_box(intersects())).count());
        ensure!(hits == if meets { calls } else { 0 }, "the first hit says {meets} and then the opposite");
        Ok(seconds / calls as f64)
    })?;
    Ok(Asked { pairs: reference, all_pairs, first_hit })
}

/// Times both queries of impinge for two placed meshes, as [`ask`] does.
///
/// # Errors
/// Returns an error if [`ask`] does.
pub fn ask_impinge(repeats: usize, a: PlacedMesh<'_>, b: PlacedMesh<'_>, options: &Options<'_>) -> Result<Asked> {
    ask(
        repeats,
        || Query::new().with_options(*options).intersecting_pairs(black_box(a), black_box(b)),
        || Query::new().with_options(*options).intersects(black_box(a), black_box(b)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreeing_answers_are_counted() {
        let asked = ask(4, || vec![[0, 1], [2, 3]], || true).unwrap();
        assert_eq!((asked.pairs.len(), asked.all_pairs.seconds().len(), asked.first_hit.seconds().len()), (2, 4, 4));
        assert!(ask(1, Vec::new, || false).unwrap().pairs.is_empty());
    }

    #[test]
    fn disagreeing_answers_are_refused() {
        assert!(ask(1, Vec::new, || true).is_err());
        assert!(ask(1, || vec![[0, 0]], || false).is_err());
        let mut run = 0;
        let differing = || {
            run += 1;
            vec![[0, run / 3]]
        };
        assert!(ask(3, differing, || true).is_err());
        let mut call = 0;
        let fickle = || {
            call += 1;
            call < 3
        };
        assert!(ask(3, || vec![[0, 0]], fickle).is_err());
    }
}

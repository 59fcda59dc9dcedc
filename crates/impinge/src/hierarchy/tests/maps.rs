//! Exact maps and numbers for tests of transformed boxes and slabs.

use dashu_ratio::Relaxed;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::rotation;

pub(in crate::hierarchy) fn exact(x: f64) -> Relaxed {
    Relaxed::try_from(x).expect("finite")
}

/// Returns a multiple of 1/16, at most 1 in magnitude. Such numbers cause ties.
pub(in crate::hierarchy) fn coarse(rng: &mut Rng) -> f64 {
    rng.integer(-16, 16) as f64 / 16.0
}

/// Returns a rotation, or any coarse map, which may be singular.
pub(in crate::hierarchy) fn any_linear(rng: &mut Rng) -> [[f64; 3]; 3] {
    if rng.one_in(3) { [[0; 3]; 3].map(|row| row.map(|_| coarse(rng))) } else { rotation(rng).linear }
}

//! Maps and numbers for the tests of what is carried from one frame into another, exactly.

use dashu_ratio::Relaxed;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::rotation;

pub(in crate::hierarchy) fn exact(x: f64) -> Relaxed {
    Relaxed::try_from(x).expect("finite")
}

/// A sixteenth or some, at most one in magnitude: such numbers tie.
pub(in crate::hierarchy) fn coarse(rng: &mut Rng) -> f64 {
    rng.integer(-16, 16) as f64 / 16.0
}

/// A rotation, or any coarse map, singular ones among them.
pub(in crate::hierarchy) fn any_linear(rng: &mut Rng) -> [[f64; 3]; 3] {
    if rng.one_in(3) { [[0; 3]; 3].map(|row| row.map(|_| coarse(rng))) } else { rotation(rng).linear }
}

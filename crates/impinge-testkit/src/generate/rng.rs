//! Stream of random numbers that never changes.
//!
//! It is PCG64 (O'Neill, *PCG: A Family of Simple Fast Space-Efficient Statistically Good
//! Algorithms*, 2014; XSL-RR 128/64). NumPy's `default_rng` uses it too, so meshes made with NumPy
//! can be reproduced here.

/// PCG64 generator.
#[derive(Clone, Debug)]
pub struct Rng {
    state: u128,
    increment: u128,
}

impl Rng {
    /// Returns the stream of a seed. It differs from NumPy's stream for the same seed.
    pub fn new(seed: u64) -> Self {
        let mut rng = Self::from_state(0, 0x5851_f42d_4c95_7f2d_1405_7b7e_f767_814f);
        rng.state = rng.state.wrapping_add(u128::from(seed));
        rng.next_u64();
        rng
    }

    /// Returns the stream of `numpy.random.PCG64` with this `state` and `inc` (its
    /// `.state["state"]`).
    pub fn from_state(state: u128, inc: u128) -> Self {
        Self { state, increment: inc | 1 }
    }

    /// Returns a uniformly distributed 64-bit number.
    pub fn next_u64(&mut self) -> u64 {
        const MULTIPLIER: u128 = 0x2360_ed05_1fc6_5da4_4385_df64_9fcc_f645;
        self.state = self.state.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
        ((self.state >> 64) as u64 ^ self.state as u64).rotate_right((self.state >> 122) as u32)
    }

    /// Returns a uniformly distributed multiple of 2^-53 in 0 ≤ x < 1.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a uniformly distributed number between `low` and `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns an integer in `low..=high`, uniform except for a bias below 2^-32 for ranges below
    /// 2^32.
    pub fn integer(&mut self, low: i64, high: i64) -> i64 {
        let count = (high - low) as u128 + 1;
        low + ((u128::from(self.next_u64()) * count) >> 64) as i64
    }

    /// Returns a random item.
    ///
    /// # Panics
    /// Panics if there are no items.
    pub fn choose<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.integer(0, items.len() as i64 - 1) as usize]
    }

    /// Returns `true` in one of `n` cases.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.integer(1, n as i64) == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_that_of_numpy() {
        // numpy.random.PCG64(7).state["state"], numpy.random.default_rng(7).random(4)
        let mut rng = Rng::from_state(
            208_745_520_555_909_116_978_795_849_195_383_758_904,
            261_136_684_632_268_670_825_940_853_076_396_136_793,
        );
        let drawn = [rng.unit(), rng.unit(), rng.unit(), rng.unit()];
        let bits = [0x3fe400c8353e3ca9, 0x3fecb5f9b795e4cd, 0x3fe8d26acbf2815f, 0x3fccd396d5eab510];
        assert_eq!(drawn, bits.map(f64::from_bits));
    }

    #[test]
    fn the_stream_of_a_seed_is_fixed() {
        let mut rng = Rng::new(42);
        assert_eq!([rng.next_u64(), rng.next_u64()], [17_096_482_257_289_067_021, 9_005_068_463_966_194_610]);
        assert!((0..1000).map(|_| rng.integer(-2, 2)).all(|x| (-2..=2).contains(&x)));
    }
}

//! How long random tests run.

/// Returns `base` times the integer in the environment variable `IMPINGE_THOROUGH`, which is 1
/// unless it is set: the number of rounds of a random test. Rounds beyond the first `base` go on
/// with the same stream of random numbers.
///
/// # Panics
/// If the variable is set to something else than an integer above zero.
pub fn rounds(base: usize) -> usize {
    let Ok(text) = std::env::var("IMPINGE_THOROUGH") else { return base };
    let factor: usize = text.parse().ok().filter(|&factor| factor > 0).unwrap_or_else(|| {
        panic!("IMPINGE_THOROUGH: `{text}` is not an integer above zero. Set it to 10 to run ten times as many rounds.")
    });
    base.saturating_mul(factor)
}

//! Number of rounds of random tests.

/// Name of the environment variable that multiplies the rounds of random tests.
const THOROUGH: &str = "IMPINGE_THOROUGH";

/// Returns the number of rounds of a random test: `base` times the environment variable
/// `IMPINGE_THOROUGH`, or `base` if it is not set.
///
/// `base` rounds run for every change. They should take a few seconds at most and still find the
/// fault that the test was written for.
///
/// # Panics
/// The variable is not a positive integer.
#[must_use]
pub fn rounds(base: usize) -> usize {
    let Some(factor) = std::env::var_os(THOROUGH) else { return base };
    match factor.to_str().and_then(|factor| factor.parse::<usize>().ok()) {
        Some(factor) if factor > 0 => base * factor,
        _ => panic!("{THOROUGH} is {factor:?}, which is not a positive integer"),
    }
}

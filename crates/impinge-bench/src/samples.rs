//! Times of the same thing, done several times.

use std::time::Instant;

/// Seconds that single runs took, at least one, in the order of the runs.
///
/// The minimum is what the work costs where nothing disturbs it, and repeats best; the median is what to expect.
#[derive(Clone, Debug)]
pub struct Samples(Vec<f64>);

impl Samples {
    /// The times of `repeats` runs, and of one where that is zero.
    ///
    /// # Errors
    /// That of the first run that fails.
    pub fn take<E>(repeats: usize, mut run: impl FnMut() -> Result<f64, E>) -> Result<Self, E> {
        (0..repeats.max(1)).map(|_| run()).collect::<Result<_, _>>().map(Self)
    }

    /// Every time, in seconds.
    #[must_use]
    pub fn seconds(&self) -> &[f64] {
        &self.0
    }

    /// The shortest time, in seconds.
    #[must_use]
    pub fn min(&self) -> f64 {
        self.0.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The middle time, in seconds: the mean of the two middle ones where their number is even.
    #[must_use]
    pub fn median(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let middle = sorted.len() / 2;
        if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) }
    }
}

/// How many seconds `run` takes, and what it returns.
pub fn timed<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = run();
    (start.elapsed().as_secs_f64(), result)
}

/// How many seconds of processor time `run` takes, on all threads of the process together, and what it returns. On one
/// thread that is the time it would take on a machine with nothing else to do, or nearly so.
pub fn processor_timed<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = processor_seconds();
    let result = run();
    (processor_seconds() - start, result)
}

/// Of the process, since some time.
#[cfg(unix)]
fn processor_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Where it cannot be had, the time of the clock on the wall, since the first call.
#[cfg(not(unix))]
fn processor_seconds() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(seconds: &[f64]) -> Samples {
        let mut left = seconds.iter();
        Samples::take(seconds.len(), || left.next().copied().ok_or(())).unwrap()
    }

    #[test]
    fn the_median_stands_in_the_middle() {
        assert_eq!(samples(&[3.0, 1.0, 2.0]).median(), 2.0);
        assert_eq!(samples(&[4.0, 1.0, 2.0, 10.0]).median(), 3.0);
        assert_eq!(samples(&[4.0, 1.0, 2.0, 10.0]).min(), 1.0);
        assert_eq!(samples(&[4.0, 1.0]).seconds(), [4.0, 1.0]);
    }

    #[test]
    fn waiting_takes_no_processor_time() {
        let (waited, ()) = processor_timed(|| std::thread::sleep(std::time::Duration::from_millis(50)));
        let (worked, sum) = processor_timed(|| (0..20_000_000_u64).fold(0, |sum, x| std::hint::black_box(sum ^ x)));
        assert!(waited < 0.04 || cfg!(not(unix)), "{waited}");
        assert!(worked > 1e-4 && sum < 1 << 32, "{worked}");
    }

    #[test]
    fn a_run_that_fails_ends_the_taking() {
        let mut runs = 0;
        let taken = Samples::take(5, || {
            runs += 1;
            if runs < 3 { Ok(1.0) } else { Err("third") }
        });
        assert_eq!((taken.unwrap_err(), runs), ("third", 3));
    }
}

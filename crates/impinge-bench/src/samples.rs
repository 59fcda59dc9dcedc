//! Times of several runs of the same work.

use std::time::Instant;

/// Times of single runs, in seconds, in the order of the runs. There is at least one.
///
/// The minimum is the cost of the work if nothing disturbs it, and varies least between benchmarks.
/// The median is the time to expect.
#[derive(Clone, Debug)]
pub struct Samples(Vec<f64>);

impl Samples {
    /// Calls `run`, which returns its time in seconds, `repeats` times, but at least once.
    ///
    /// # Errors
    /// Returns the error of the first run that fails, without further runs.
    pub fn take<E>(repeats: usize, mut run: impl FnMut() -> Result<f64, E>) -> Result<Self, E> {
        (0..repeats.max(1)).map(|_| run()).collect::<Result<_, _>>().map(Self)
    }

    /// Returns the time of each run, in seconds.
    #[must_use]
    pub fn seconds(&self) -> &[f64] {
        &self.0
    }

    /// Returns the minimum time, in seconds.
    #[must_use]
    pub fn min(&self) -> f64 {
        self.0.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Returns the median time, in seconds. If the number of runs is even, it is the mean of the
    /// two middle times.
    #[must_use]
    pub fn median(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let middle = sorted.len() / 2;
        if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) }
    }
}

/// Returns the wall time of `run` in seconds, and its result.
pub fn timed<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = run();
    (start.elapsed().as_secs_f64(), result)
}

/// Returns the processor time of `run` in seconds, over all threads of the process, and its result.
/// On one thread it is nearly the wall time on a machine that runs nothing else. If the system is
/// not Unix, it is the wall time.
pub fn processor_timed<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = processor_seconds();
    let result = run();
    (processor_seconds() - start, result)
}

/// Returns the processor time that the process has used so far, in seconds.
#[cfg(unix)]
fn processor_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Returns the wall time since the first call, in seconds: the processor time is not available.
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

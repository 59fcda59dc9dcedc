//! Slowest tests of a run.

use std::fmt;

/// Number of listed tests.
const LISTED: usize = 10;

/// Tests and the seconds that each took.
#[derive(Debug, Default)]
pub(crate) struct Slowest(Vec<(f64, String)>);

impl Slowest {
    /// Adds the test of a line that a test program prints, `test laws::swap ... ok <1.204s>`.
    /// Ignores any other line.
    pub(crate) fn read(&mut self, line: &str) {
        let Some((test, seconds)) = line.strip_suffix("s>").and_then(|line| line.rsplit_once(" <")) else { return };
        let Some((name, _)) = test.strip_prefix("test ").and_then(|test| test.split_once(" ... ")) else { return };
        if let Ok(seconds) = seconds.parse() {
            self.0.push((seconds, name.to_owned()));
        }
    }

    /// Adds a test of another source.
    pub(crate) fn add(&mut self, name: &str, seconds: f64) {
        self.0.push((seconds, name.to_owned()));
    }

    /// Adds all tests of another list.
    pub(crate) fn extend(&mut self, others: Self) {
        self.0.extend(others.0);
    }
}

impl fmt::Display for Slowest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut tests: Vec<&(f64, String)> = self.0.iter().collect();
        tests.sort_by(|a, b| b.0.total_cmp(&a.0));
        write!(f, "slowest tests:")?;
        tests.iter().take(LISTED).try_for_each(|(seconds, name)| write!(f, "\n{seconds:8.2} s  {name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_tests_come_first() {
        let mut slowest = Slowest::default();
        for line in
            ["test a::quick ... ok <0.001s>", "test b::slow ... FAILED <12.500s>", "test c ... ignored", "a <1s>"]
        {
            slowest.read(line);
        }
        slowest.add("python/tests/test_x.py::test_y", 1.5);
        let expected =
            "slowest tests:\n   12.50 s  b::slow\n    1.50 s  python/tests/test_x.py::test_y\n    0.00 s  a::quick";
        assert_eq!(slowest.to_string(), expected);
    }
}

//! Rows of a record: the numbers that a benchmark measured, for `cargo xtask bench NAME`.
//!
//! That command sets the environment variable [`ROWS`] to the path of a file, and adds the date,
//! the commit and the command to the rows that the benchmark appends to it. A benchmark that runs
//! without the variable records nothing.

use std::env;
use std::fs::OpenOptions;
use std::path::Path;

use anyhow::{Context, Result};

use crate::samples::Samples;

/// Environment variable that names the file for the rows.
pub const ROWS: &str = "IMPINGE_RECORD";

/// A measured number.
///
/// No two rows of a run share all of case, engine and quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Scene, pose or size that was measured.
    pub case: String,
    /// Library that was measured: `impinge` or another one.
    pub engine: String,
    /// Name of the measured quantity, such as `build median`.
    pub quantity: String,
    /// Unit of the value: `s`, `%`, or `1` for counts and other plain numbers.
    pub unit: &'static str,
    /// Measured number, in this unit.
    pub value: f64,
}

impl Row {
    /// Returns two rows for times of impinge: their median and their minimum, in seconds.
    #[must_use]
    pub fn of_samples(case: &str, quantity: &str, samples: &Samples) -> [Self; 2] {
        [("median", samples.median()), ("minimum", samples.min())].map(|(kind, value)| Self {
            case: case.to_owned(),
            engine: "impinge".to_owned(),
            quantity: format!("{quantity} {kind}"),
            unit: "s",
            value,
        })
    }
}

/// Appends rows to the file that [`ROWS`] names. Does nothing if the variable is not set.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn append(rows: &[Row]) -> Result<()> {
    env::var_os(ROWS).map_or(Ok(()), |path| append_to(Path::new(&path), rows))
}

fn append_to(path: &Path, rows: &[Row]) -> Result<()> {
    let written = || -> Result<()> {
        let mut writer = csv::Writer::from_writer(OpenOptions::new().create(true).append(true).open(path)?);
        for Row { case, engine, quantity, unit, value } in rows {
            writer.write_record([case, engine, quantity, *unit, &format!("{value:e}")])?;
        }
        Ok(writer.flush()?)
    };
    written().with_context(|| format!("writing rows to {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_appended_without_a_header() {
        let path = env::temp_dir().join(format!("impinge_bench_rows_{}.csv", std::process::id()));
        let samples = Samples::take(2, || Ok::<f64, ()>(0.25)).unwrap();
        for case in ["deep", "1, 2"] {
            append_to(&path, &Row::of_samples(case, "build", &samples)).unwrap();
        }
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(
            text,
            "deep,impinge,build median,s,2.5e-1\ndeep,impinge,build minimum,s,2.5e-1\n\
             \"1, 2\",impinge,build median,s,2.5e-1\n\"1, 2\",impinge,build minimum,s,2.5e-1\n"
        );
    }

    #[test]
    fn a_folder_that_does_not_exist_is_an_error() {
        let error = append_to(Path::new("no such folder/rows.csv"), &[]).unwrap_err();
        assert!(error.to_string().contains("no such folder"), "{error}");
    }
}

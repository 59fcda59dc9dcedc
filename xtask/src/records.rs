//! Records of benchmarks: one number for each row of `bench/record/<bench>/<cpu>.csv`.
//!
//! Rows are only ever appended, so a file lists its runs from the oldest to the newest.

use std::fs::{self, OpenOptions};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize, Serializer};

/// Folder of the records, relative to the root of the workspace.
pub(crate) const FOLDER: &str = "bench/record";

/// Number of significant digits of a recorded fraction. No time repeats to more than three.
const DIGITS: usize = 6;

/// When, at which commit and by which command a benchmark ran.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Circumstances {
    /// Date of the run in UTC, as in `2026-11-27`.
    pub(crate) date: String,
    /// Abbreviated commit, with `-dirty` behind it if files were changed.
    pub(crate) commit: String,
    /// Command that repeats the run.
    pub(crate) command: String,
}

/// A number that a benchmark measured, as the benchmark writes it.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Measured {
    /// Scene, pose or size that was measured.
    pub(crate) case: String,
    /// Library that was measured: `impinge` or one beside it.
    pub(crate) engine: String,
    /// Name of the number, such as `all pairs median`.
    pub(crate) quantity: String,
    /// Unit of the value: `s`, `%`, or `1` for counts and other plain numbers.
    pub(crate) unit: String,
    /// Measured number.
    pub(crate) value: f64,
}

/// A row of a record.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Row {
    /// Date, from [`Circumstances`].
    pub(crate) date: String,
    /// Commit, from [`Circumstances`].
    pub(crate) commit: String,
    /// Command, from [`Circumstances`].
    pub(crate) command: String,
    /// Case, from [`Measured`].
    pub(crate) case: String,
    /// Engine, from [`Measured`].
    pub(crate) engine: String,
    /// Quantity, from [`Measured`].
    pub(crate) quantity: String,
    /// Unit, from [`Measured`].
    pub(crate) unit: String,
    /// Measured number. A fraction is rounded to [`DIGITS`].
    #[serde(serialize_with = "without_exponent")]
    pub(crate) value: f64,
}

/// Serializes a number in decimal notation, which is easier to read in a file than an exponent.
fn without_exponent<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

impl Row {
    /// Returns the row of a measured number.
    fn new(circumstances: &Circumstances, measured: Measured) -> Result<Self> {
        let Circumstances { date, commit, command } = circumstances.clone();
        let Measured { case, engine, quantity, unit, value } = measured;
        ensure!(value.is_finite(), "{case}, {engine}, {quantity}: {value} is not a finite number");
        let value = if value.fract() == 0.0 { value } else { format!("{value:.*e}", DIGITS - 1).parse()? };
        Ok(Self { date, commit, command, case, engine, quantity, unit, value })
    }

    /// Reports whether two rows measure the same quantity of the same engine in the same case.
    pub(crate) fn measures_same(&self, other: &Self) -> bool {
        (&self.case, &self.engine, &self.quantity) == (&other.case, &other.engine, &other.quantity)
    }
}

/// A file of records.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Record {
    /// Name of the benchmark.
    pub(crate) bench: String,
    /// Short name of the processor.
    pub(crate) cpu: String,
    /// All rows, from the oldest to the newest.
    pub(crate) rows: Vec<Row>,
}

impl Record {
    /// Returns the rows of each run, from the oldest run to the newest.
    pub(crate) fn runs(&self) -> impl Iterator<Item = &[Row]> {
        self.rows.chunk_by(|a, b| (&a.date, &a.commit, &a.command) == (&b.date, &b.commit, &b.command))
    }
}

/// Returns the path of a record, relative to the root of the workspace.
pub(crate) fn path(bench: &str, cpu: &str) -> PathBuf {
    Path::new(FOLDER).join(bench).join(format!("{cpu}.csv"))
}

/// Reads all records of the workspace, sorted by benchmark and processor.
///
/// # Errors
/// A file cannot be read, or a row does not have the columns of [`Row`].
pub(crate) fn read_all(root: &Path) -> Result<Vec<Record>> {
    let mut records = Vec::new();
    for file in crate::sources::files(&root.join(FOLDER), &["csv"])? {
        let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let (Some(cpu), Some(bench)) = (stem(&file), file.parent().and_then(stem)) else { continue };
        let rows = csv::Reader::from_path(&file)?.deserialize().collect::<csv::Result<_>>();
        records.push(Record { bench, cpu, rows: rows.with_context(|| format!("reading {}", file.display()))? });
    }
    Ok(records)
}

/// Reads the rows that a benchmark wrote, which have the columns of [`Measured`] and no header.
///
/// # Errors
/// The file cannot be read, or a row has other columns.
pub(crate) fn read_measured(file: &Path) -> Result<Vec<Measured>> {
    let reader = csv::ReaderBuilder::new().has_headers(false).from_path(file);
    let rows = reader.and_then(|mut reader| reader.deserialize().collect());
    rows.with_context(|| format!("reading {}", file.display()))
}

/// Appends a run to a file of records, which is created with a header if it does not exist.
///
/// # Errors
/// A value is not finite, or the file cannot be written.
pub(crate) fn append(file: &Path, circumstances: &Circumstances, measured: Vec<Measured>) -> Result<()> {
    let rows: Vec<Row> = measured.into_iter().map(|row| Row::new(circumstances, row)).collect::<Result<_>>()?;
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder).with_context(|| format!("creating {}", folder.display()))?;
    }
    let is_new = !file.exists();
    let opened = OpenOptions::new().create(true).append(true).open(file);
    let opened = opened.with_context(|| format!("opening {}", file.display()))?;
    let mut writer = csv::WriterBuilder::new().has_headers(is_new).from_writer(opened);
    for row in rows {
        writer.serialize(row)?;
    }
    writer.flush().with_context(|| format!("writing {}", file.display()))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Returns a row whose date is that of its commit.
    pub(crate) fn row(commit: &str, case: &str, engine: &str, quantity: &str, value: f64) -> Row {
        let circumstances =
            Circumstances { date: format!("date of {commit}"), commit: commit.into(), command: "run".into() };
        Row::new(&circumstances, measured(case, engine, quantity, value)).unwrap()
    }

    fn measured(case: &str, engine: &str, quantity: &str, value: f64) -> Measured {
        Measured { case: case.into(), engine: engine.into(), quantity: quantity.into(), unit: "s".into(), value }
    }

    #[test]
    fn appended_runs_are_read_in_their_order_with_one_header() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join(path("hulls", "zen5"));
        for (commit, value) in [("a", 2.2231e-5), ("b", 0.1 + 0.2), ("c", 2_130_664.0)] {
            let circumstances =
                Circumstances { date: "2026-11-27".into(), commit: commit.into(), command: "x, y".into() };
            append(&file, &circumstances, vec![measured("a \"knot\"", "impinge", "build", value)]).unwrap();
        }
        let text = fs::read_to_string(&file).unwrap();
        assert_eq!(
            text,
            "date,commit,command,case,engine,quantity,unit,value\n\
             2026-11-27,a,\"x, y\",\"a \"\"knot\"\"\",impinge,build,s,0.000022231\n\
             2026-11-27,b,\"x, y\",\"a \"\"knot\"\"\",impinge,build,s,0.3\n\
             2026-11-27,c,\"x, y\",\"a \"\"knot\"\"\",impinge,build,s,2130664\n"
        );
        let records = read_all(root.path()).unwrap();
        assert_eq!((records.len(), &*records[0].bench, &*records[0].cpu), (1, "hulls", "zen5"));
        let runs: Vec<(&str, f64)> = records[0].runs().map(|run| (&*run[0].commit, run[0].value)).collect();
        assert_eq!(runs, [("a", 2.2231e-5), ("b", 0.3), ("c", 2_130_664.0)]);
    }

    #[test]
    fn rows_of_a_benchmark_have_no_header() {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), "deep,FCL,all pairs median,s,3.5e-2\n").unwrap();
        let rows = read_measured(file.path()).unwrap();
        assert_eq!(rows, [measured("deep", "FCL", "all pairs median", 0.035)]);
    }

    #[test]
    fn broken_files_and_values_are_errors() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join(path("hulls", "zen5"));
        let circumstances = Circumstances { date: String::new(), commit: String::new(), command: String::new() };
        assert!(append(&file, &circumstances, vec![measured("", "", "", f64::NAN)]).is_err());
        assert!(!file.exists());
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, "date,commit\n2026-11-27,a\n").unwrap();
        let message = format!("{:#}", read_all(root.path()).unwrap_err());
        assert!(message.contains("zen5.csv") && message.contains("line: 2"), "{message}");
    }
}

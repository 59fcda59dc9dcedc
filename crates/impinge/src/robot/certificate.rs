//! Certificates of free motions, and their verification.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt;

use super::check::{CheckError, CheckOptions};
use super::interval::{CertificateRow, Scan, Subject};
use super::model::Robot;

/// The proof that a motion is free: intervals that cover it, for each pair of links and for each
/// link and the obstacles.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Configuration at the start of the motion.
    pub start: Vec<f64>,
    /// Configuration at its end.
    pub end: Vec<f64>,
    /// The intervals.
    pub rows: Vec<CertificateRow>,
}

/// The reason why a certificate proves nothing.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CertificateError {
    /// A configuration or a clearance is invalid.
    Check(CheckError),
    /// A row names links that are not checked, or a time that is not between 0 and 1.
    Row {
        /// Index of the row.
        row: usize,
    },
    /// The distance in the middle of an interval does not prove that the interval is free.
    TooNear {
        /// Index of the row.
        row: usize,
    },
    /// No interval of a pair contains a time.
    Gap {
        /// Index of the link.
        link: usize,
        /// Index of the other link; `None` for the obstacles.
        other: Option<usize>,
        /// The time.
        time: f64,
    },
}

/// The intervals that rows cover, by a link and the other link.
type Covered = BTreeMap<(usize, Option<usize>), (Subject, Vec<[f64; 2]>)>;

impl Robot {
    /// Verifies a certificate of [`check_motions`](Self::check_motions): that its rows cover the
    /// whole motion, and that each row holds. The options must be those of the check.
    ///
    /// Bounds of the motion are computed again, and shapes are compared by
    /// [`distance`](crate::query::distance()).
    ///
    /// # Errors
    /// Returns an error if the certificate does not prove that the motion is free.
    ///
    /// # Complexity
    /// One distance for each row, and for each near obstacle of a row.
    pub fn verify(&self, certificate: &Certificate, options: &CheckOptions<'_>) -> Result<(), CertificateError> {
        let Certificate { start, end, rows } = certificate;
        options.validate().map_err(CertificateError::Check)?;
        for values in [start, end] {
            let count = self.check_rows(values).map_err(CheckError::Configuration).map_err(CertificateError::Check)?;
            if count != 1 || values.len() != self.coordinates().len() {
                return Err(CertificateError::Check(CheckError::Lengths { starts: start.len(), ends: end.len() }));
            }
        }
        let scan = Scan::new(self, options);
        let mut state = scan.state();
        scan.begin(&mut state, &[start.clone(), end.clone()]);
        let names = |subject: &Subject| (subject.link, subject.pair.map(|(_, other)| other));
        let mut covered: Covered =
            scan.subjects().into_iter().map(|subject| (names(&subject), (subject, Vec::new()))).collect();
        let mut placed_at = None;
        for (at, row) in rows.iter().enumerate() {
            let invalid = CertificateError::Row { row: at };
            let CertificateRow { link, other, time, half } = *row;
            let [low, high] = [time - half, time + half];
            // Times and lengths are multiples of one number, so these sums are exact.
            let is_exact = low + half == time && high - half == time;
            let is_valid = (0.0..=1.0).contains(&time) && is_exact && low <= high;
            let (subject, intervals) = covered.get_mut(&(link, other)).filter(|_| is_valid).ok_or(invalid)?;
            intervals.push([low, high]);
            if placed_at.replace(time) != Some(time) {
                scan.move_to(&mut state, time);
            }
            if !scan.holds(&mut state, *subject, half) {
                return Err(CertificateError::TooNear { row: at });
            }
        }
        for ((link, other), (_, mut intervals)) in covered {
            intervals.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
            let mut time = 0.0_f64;
            for [low, high] in intervals {
                if low > time {
                    break;
                }
                time = time.max(high);
            }
            if time < 1.0 {
                return Err(CertificateError::Gap { link, other, time });
            }
        }
        Ok(())
    }
}

impl fmt::Display for CertificateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Check(error) => write!(f, "{error}"),
            Self::Row { row } => write!(f, "row {row} is not about a pair that is checked, or has an invalid time"),
            Self::TooNear { row } => write!(f, "row {row} does not hold: the distance is too short for its interval"),
            Self::Gap { link, other: Some(other), time } => {
                write!(f, "no row about the links {link} and {other} contains the time {time}")
            }
            Self::Gap { link, other: None, time } => {
                write!(f, "no row about the link {link} and the obstacles contains the time {time}")
            }
        }
    }
}

impl Error for CertificateError {}

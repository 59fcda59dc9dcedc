//! Certificates of free motions, and their verification.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt;

use super::check::{CheckError, CheckOptions};
use super::interval::{CertificateRow, Scan, State};
use super::links::PlacedLink;
use super::model::Robot;
use crate::query::{Proximity, distance};

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
        let mut covered: BTreeMap<(usize, Option<usize>), Vec<[f64; 2]>> = BTreeMap::new();
        for item in scan.items() {
            covered.insert(self.subject(item as usize), Vec::new());
        }
        let mut placed_at = None;
        for (at, row) in rows.iter().enumerate() {
            let invalid = CertificateError::Row { row: at };
            let CertificateRow { link, other, time, half } = *row;
            let [low, high] = [time - half, time + half];
            // Times of intervals that were halved are exact, so these sums are, too.
            let is_exact = low + half == time && high - half == time;
            let intervals = covered.get_mut(&(link, other)).filter(|_| is_exact && low <= high);
            intervals.ok_or(invalid)?.push([low, high]);
            if placed_at != Some([time, half]) {
                scan.move_to(&mut state, time, half);
                placed_at = Some([time, half]);
            }
            if !self.holds(&scan, &mut state, row) {
                return Err(CertificateError::TooNear { row: at });
            }
        }
        for ((link, other), mut intervals) in covered {
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

    /// Returns the link and the other link of an item of a proof.
    fn subject(&self, item: usize) -> (usize, Option<usize>) {
        match self.pairs().get(item) {
            Some(&[a, b]) => (a, Some(b)),
            None => (item - self.pairs().len(), None),
        }
    }

    /// Reports whether the distances at the current time prove a row.
    fn holds(&self, scan: &Scan<'_>, state: &mut State, row: &CertificateRow) -> bool {
        match row.other {
            Some(other) => {
                let pair = [row.link, other];
                let Ok(at) = self.pairs().binary_search(&pair) else { return false };
                let needed = scan.needed(state, at);
                pair.iter().for_each(|&link| state.links.place(link, self, &state.frames));
                are_apart(pair.map(|link| &state.links.placed[link]), needed)
            }
            None => {
                let needed = scan.needed_of_obstacles(state, row.link);
                if !needed.is_finite() {
                    return false;
                }
                state.links.place(row.link, self, &state.frames);
                let placed = &state.links.placed[row.link];
                scan.obstacles.near((row.link, placed), needed, &mut state.near);
                state.near.iter().all(|&at| are_apart([placed, scan.obstacles.part(at).1], needed))
            }
        }
    }
}

/// Reports whether the lower bound of the distance of two shapes is above a distance.
fn are_apart(placed: [&PlacedLink; 2], needed: f64) -> bool {
    match placed {
        [PlacedLink::Nowhere, _] | [_, PlacedLink::Nowhere] => true,
        [PlacedLink::At(a), PlacedLink::At(b)] => {
            let found = distance(&**a, &**b);
            found.proximity == Proximity::Apart && found.lower > needed
        }
        _ => false,
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

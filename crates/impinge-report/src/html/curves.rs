//! The intersection curves of the two parts of each clash.

use impinge::clash::{self, Clash, Report, Side};
use rayon::prelude::*;

use super::integers::push_integer;
use super::quantized::{Frame, push_points};

/// Maximum number of points of all curves. A point takes about 5 bytes.
const MAX_POINTS: usize = 200_000;

/// Number of clashes whose curves are computed at a time, by all threads.
const CLASHES_PER_STEP: usize = 64;

/// Curves of the worst clashes.
pub(super) struct Curves {
    /// Index of each clash in the report, with its curves, sorted by clash.
    found: Vec<(usize, Vec<Vec<[f64; 3]>>)>,
    /// Number of clashes whose curves were computed.
    pub(super) clashes: usize,
}

impl Curves {
    /// Computes the curves of the first `max_clashes` clashes of a report, or of fewer if their
    /// curves have too many points.
    pub(super) fn of(sides: &[Side<'_>], report: &Report, max_clashes: usize) -> Self {
        let (mut found, mut clashes, mut points) = (Vec::new(), 0, 0);
        let asked = &report.clashes[..report.clashes.len().min(max_clashes)];
        for step in asked.chunks(CLASHES_PER_STEP) {
            let curves: Vec<_> = step.par_iter().map(|clash| polylines(sides, clash)).collect();
            points += curves.iter().flatten().map(Vec::len).sum::<usize>();
            if points > MAX_POINTS {
                break;
            }
            found.extend((clashes..).zip(curves).filter(|(_, lines)| !lines.is_empty()));
            clashes += step.len();
        }
        Self { found, clashes }
    }

    /// Returns no curves.
    pub(super) fn none() -> Self {
        Self { found: Vec::new(), clashes: 0 }
    }

    /// Returns the curves of the only pair of a page, or none if they have too many points.
    pub(super) fn of_pair(lines: &[Vec<[f64; 3]>]) -> Self {
        if lines.is_empty() || lines.iter().map(Vec::len).sum::<usize>() > MAX_POINTS {
            return Self::none();
        }
        Self { found: vec![(0, lines.to_vec())], clashes: 1 }
    }

    /// Appends the number of clashes with curves; then for each its index, a box, the number of
    /// polylines, and for each polyline its number of points and its points.
    pub(super) fn push(&self, bytes: &mut Vec<u8>) {
        push_integer(bytes, self.found.len() as u64);
        for (clash, lines) in &self.found {
            let Some(frame) = Frame::around(lines.iter().flatten().copied()) else { continue };
            push_integer(bytes, *clash as u64);
            frame.push(bytes);
            push_integer(bytes, lines.len() as u64);
            for line in lines {
                push_integer(bytes, line.len() as u64);
                push_points(bytes, &line.iter().map(|&point| frame.steps(point)).collect::<Vec<_>>());
            }
        }
    }
}

/// Returns the curves of a clash, or none if a part is not a mesh.
fn polylines(sides: &[Side<'_>], clash: &Clash) -> Vec<Vec<[f64; 3]>> {
    match &clash.curves {
        Some(traced) => traced.polylines.clone(),
        None => clash::curves(clash, sides).unwrap_or_default().polylines,
    }
}

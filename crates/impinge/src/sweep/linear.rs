//! The first contact of a vertex with a face, and of two edges, while their corners move along lines.
//!
//! The interval of times is halved, earlier half first, until contact is disproved, proved, or neither can be
//! (`polynomials` says by what). Doubles decide nearly all of it, and exact arithmetic the rest.
//!
//! Source: what is halved is time alone, where Wang, Ferguson, Schneider, Jiang, Attene, Panozzo, *A Large Scale
//! Benchmark and an Inclusion-Based Algorithm for Continuous Collision Detection*, ACM TOG 40(5), 2021, halves time
//! and both parameters of the face; so contact that is missed is told from contact however narrowly.

use super::exact::Exact;
use super::floats::{Floats, Judgement, stay_apart};
use super::impact::Impact;
use super::polynomials::Split;
use super::span::{MEETS_LEVEL, Span};
use crate::input::{InputError, InputErrorKind};

/// Intervals that are looked at in doubles, a tenth of a microsecond each, before and after their coefficients are
/// computed exactly. Contact takes about fifty.
const FLOAT_WORK: u32 = 256;

/// Intervals that are looked at in exact arithmetic, some microseconds each.
const EXACT_WORK: u32 = 1024;

/// The largest magnitude of a coordinate, that of a mesh's vertices.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// When a moving vertex and a moving face first touch.
///
/// Rows are the vertex and the three corners of the face, at the start and at the end; each moves from one to the other
/// along a line, evenly. A face without area is the segment or the point that it spans.
///
/// ```
/// use impinge::sweep;
///
/// let start = [[0.2, 0.2, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut end = start;
/// end[0][2] = -1.0;
/// let impact = sweep::vertex_face(&start, &end)?;
/// assert!(impact.t_lower <= 0.5 && 0.5 <= impact.t_upper);
/// end[0][2] = 0.1;
/// assert!(!sweep::vertex_face(&start, &end)?.hit());
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Errors
/// [`NonFinite`](InputErrorKind::NonFinite) and [`OutOfRange`](InputErrorKind::OutOfRange), where a coordinate is not
/// below 2^128; corners at the end are counted on from those at the start.
///
/// # Accuracy The truth about the real motion lies in the interval that is returned: infinite times where there is no
/// contact. Where contact is proved, the interval is at most 2^-30 wide, mostly 2^-40. What is not decided in bounded
/// work has an infinite `t_upper`; that is contact, or a miss by less than 2^-96 of the motion, or one that stays that
/// close for long. Tested against an exact oracle in `tests/it/sweep`.
///
/// # Complexity Constant: well under a microsecond for most that do not touch, some microseconds for those that do,
/// and milliseconds at the worst.
pub fn vertex_face(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4]) -> Result<Impact, InputError> {
    judge(t0, t1)?;
    Ok(first_contact(t0, t1, Split::VertexFace))
}

/// When two moving edges first touch.
///
/// Rows are the ends of one edge, then those of the other. An edge without length is a point.
///
/// ```
/// use impinge::sweep;
///
/// let start = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut end = start;
/// (end[0][2], end[1][2]) = (0.0, 0.0);
/// let impact = sweep::edge_edge(&start, &end)?;
/// assert!(impact.t_lower <= 1.0 && impact.t_upper == 1.0);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Errors
/// As [`vertex_face`], and so are accuracy and complexity.
pub fn edge_edge(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4]) -> Result<Impact, InputError> {
    judge(t0, t1)?;
    Ok(first_contact(t0, t1, Split::EdgeEdge))
}

fn judge(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4]) -> Result<(), InputError> {
    for (index, row) in t0.iter().chain(t1).enumerate() {
        if !row.iter().all(|x| x.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "corner", index }));
        }
        if !row.iter().all(|x| x.abs() < LIMIT) {
            return Err(InputError::new(InputErrorKind::OutOfRange { what: "corner", index, limit: "2^128" }));
        }
    }
    Ok(())
}

/// The first contact of corners that are in range.
pub(super) fn first_contact(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4], split: Split) -> Impact {
    if stay_apart(t0, t1, split) {
        return Impact::NEVER;
    }
    let mut floats = Floats::new(t0, t1, split);
    let mut exact: Option<Exact> = None;
    let (mut float_work, mut exact_work) = (FLOAT_WORK, EXACT_WORK);
    // Each interval with whether areas are known to be of one sign there, and the end of the shortest interval about
    // it that is proved to hold contact.
    let mut stack = [(Span::WHOLE, false, f64::INFINITY); MEETS_LEVEL as usize + 2];
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let (span, mut is_inside, mut t_upper) = stack[height];
        let (low, high) = (span.low(), span.high());
        let judgement = floats.judge(low, high, &mut is_inside);
        match judgement {
            Judgement::Apart => continue,
            Judgement::Meets => t_upper = high,
            Judgement::Open | Judgement::Blind => {}
        }
        let is_worth_halving = span.level < MEETS_LEVEL && judgement != Judgement::Blind;
        if !is_worth_halving && t_upper - low <= WIDEST {
            return Impact { t_lower: low, t_upper };
        }
        if is_worth_halving && float_work > 0 {
            float_work -= 1;
            let [left, right] = span.halves();
            stack[height] = (right, is_inside, t_upper);
            stack[height + 1] = (left, is_inside, t_upper);
            height += 2;
            continue;
        }
        let Some(exact) = &exact else {
            // Doubles once more, but rounded from exact numbers: what cancels in them has cancelled already.
            let known = exact.insert(Exact::new(t0, t1, split));
            floats.sharpen(known.rounded());
            float_work = FLOAT_WORK;
            height += 1;
            continue;
        };
        if let Some(impact) = exact.first_contact(span, &mut exact_work) {
            return impact;
        }
    }
    Impact::NEVER
}

/// How wide an interval that is proved to hold contact may be where doubles do not tell more about it: 2^-30.
const WIDEST: f64 = 1.0 / (1_u64 << 30) as f64;

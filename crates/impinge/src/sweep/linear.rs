//! The first contact of a vertex with a face, and of two edges, when their corners move along
//! lines.
//!
//! The interval of times is halved, earlier half first, until contact is disproved, proved, or
//! undecidable; `polynomials` has the criteria. Doubles decide nearly all cases, and exact
//! arithmetic decides the rest.
//!
//! Source: only time is halved. Wang, Ferguson, Schneider, Jiang, Attene, Panozzo, *A Large Scale
//! Benchmark and an Inclusion-Based Algorithm for Continuous Collision Detection*, ACM TOG 40(5),
//! 2021, halve time and both parameters of the face. So ours distinguishes a miss from contact
//! however narrow it is.
//!
//! The proof is docs/notes/proof.md, L23. The tests are in `tests/it/sweep`, and the benchmark is
//! `ccd` in `impinge-bench`.

use super::exact::Exact;
use super::floats::{Floats, Verdict, are_always_apart};
use super::impact::Impact;
use super::polynomials::Split;
use super::span::{CONTACT_LEVEL, Span};
use crate::input::{InputError, InputErrorKind};

/// Maximum number of intervals evaluated in doubles, before and again after their coefficients are
/// computed exactly. Each costs 0.1 microseconds. Contact takes about 50.
const FLOAT_WORK: u32 = 256;

/// Maximum number of intervals evaluated in exact arithmetic. Each costs some microseconds.
const EXACT_WORK: u32 = 1024;

/// Exclusive limit on the magnitude of a coordinate: 2^128, as for the vertices of a mesh.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// Returns the time at which a moving vertex and a moving face first touch, as a proved interval.
/// Time 0 is the start of the motion and 1 its end.
///
/// `t0` and `t1` hold the vertex and the three corners of the face at the start and at the end. All
/// points are in one frame, and each moves along a line at constant speed. A face without area is
/// the segment or the point that it spans.
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
/// [`NonFinite`](InputErrorKind::NonFinite) if a coordinate is not finite, and
/// [`OutOfRange`](InputErrorKind::OutOfRange) if its magnitude is not below 2^128. The reported row
/// counts the corners of `t0`, then those of `t1`.
///
/// # Accuracy
/// The returned interval holds the true first time of the real motion; both times are infinite if
/// there is no contact. If contact is proved, the interval is at most 2^-30 wide, mostly 2^-40. A
/// result that is not decided within the limit on work has an infinite `t_upper`. Then there is
/// contact, or a miss by less than 2^-96 of the motion, or a miss that stays that close for long.
/// An exact oracle tests this in `tests/it/sweep`.
///
/// # Complexity
/// Constant: well under a microsecond for most pairs that do not touch, some microseconds for pairs
/// that do, and milliseconds in the worst case.
pub fn vertex_face(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4]) -> Result<Impact, InputError> {
    validate(t0, t1)?;
    Ok(first_contact(t0, t1, Split::VertexFace))
}

/// Returns the time at which two moving edges first touch, as a proved interval. Time 0 is the
/// start of the motion and 1 its end.
///
/// `t0` and `t1` hold the ends of one edge, then those of the other, at the start and at the end.
/// All points are in one frame, and each moves along a line at constant speed. An edge without
/// length is a point.
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
/// The errors of [`vertex_face`]. Accuracy and complexity are the same too.
pub fn edge_edge(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4]) -> Result<Impact, InputError> {
    validate(t0, t1)?;
    Ok(first_contact(t0, t1, Split::EdgeEdge))
}

fn validate(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4]) -> Result<(), InputError> {
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

/// Returns the time of first contact of corners that are in range.
pub(super) fn first_contact(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4], split: Split) -> Impact {
    if are_always_apart(t0, t1, split) {
        return Impact::NEVER;
    }
    let mut floats = Floats::new(t0, t1, split);
    let mut exact: Option<Exact> = None;
    let (mut float_work, mut exact_work) = (FLOAT_WORK, EXACT_WORK);
    // Each interval, with two more values: whether areas are known to have one sign there, and the
    // end of the shortest interval around it that is proved to hold contact.
    let mut stack = [(Span::WHOLE, false, f64::INFINITY); CONTACT_LEVEL as usize + 2];
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let (span, mut is_inside, mut t_upper) = stack[height];
        let (low, high) = (span.low(), span.high());
        let verdict = floats.classify(low, high, &mut is_inside);
        match verdict {
            Verdict::Apart => continue,
            Verdict::Contact => t_upper = high,
            Verdict::Undecided | Verdict::Blind => {}
        }
        let is_worth_halving = span.level < CONTACT_LEVEL && verdict != Verdict::Blind;
        if !is_worth_halving && t_upper - low <= MAX_CONTACT_WIDTH {
            return Impact::between(low, t_upper);
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
            // Uses doubles once more, but rounded from exact numbers: cancellation has then already
            // happened exactly.
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

/// Maximum width of an interval with proved contact that is returned if doubles prove nothing more
/// about it: 2^-30.
const MAX_CONTACT_WIDTH: f64 = 1.0 / (1_u64 << 30) as f64;

//! The proposed shortest difference of two cores.
//!
//! Nothing here is proved. A poor proposal costs time, because the iteration then has to answer.
//!
//! # Source
//! Ericson, *Real-Time Collision Detection*, 5.1.2, 5.1.3 and 5.1.9. Ours departs in boxes under
//! any affine map, whose multiples are corrected one after the other until none changes, and in
//! the segment and the box, where the derivative along the segment is piecewise linear and its
//! zero is found by Newton's method.

use super::differences::Differences;
use crate::math::vec3::{Vector, cross, dot};
use crate::primitive::accurate_cross;

/// Maximum number of sweeps over the half edges of a box. Boxes with right angles take one, and a
/// second one to correct rounding.
const MAX_SWEEPS: usize = 12;

/// Maximum change of a multiple that ends the sweeps: 2^-49.
const SETTLED: f64 = 8.0 * f64::EPSILON;

/// Maximum number of steps of Newton's method. Its function has seven pieces.
const MAX_STEPS: usize = 12;

/// Minimum squared sine of the angle between two segments whose cross product is accurate enough
/// in plain floats: 2^-8.
const MIN_SQUARED_SINE: f64 = 1.0 / 256.0;

/// Multiples of the half edges, each within ±1, and the difference that they give.
pub(super) struct Nearest {
    pub(super) shares: [f64; 6],
    pub(super) vector: Vector,
}

/// Returns a difference that is nearly the shortest, or `None` if none is found.
#[inline]
pub(super) fn nearest(differences: &Differences) -> Option<Nearest> {
    let from = &differences.between;
    let shares = match differences.edges_of_each() {
        [[], []] => return Some(Nearest { shares: [0.0; 6], vector: *from }),
        [[edge], []] | [[], [edge]] => filled(&[share(from, edge)]),
        [[one], [other]] => filled(&of_segments(from, one, other)),
        [[x, y, z], []] | [[], [x, y, z]] => filled(&of_box(from, [x, y, z])),
        [[edge], [x, y, z]] => {
            let (along, [x, y, z]) = of_segment_and_box(from, edge, [x, y, z])?;
            filled(&[along, x, y, z])
        }
        [[x, y, z], [edge]] => {
            let (along, [x, y, z]) = of_segment_and_box(from, edge, [x, y, z])?;
            filled(&[x, y, z, along])
        }
        _ => of_boxes(differences),
    };
    Some(Nearest { shares, vector: differences.at(&shares) })
}

#[inline]
fn filled(shares: &[f64]) -> [f64; 6] {
    let mut all = [0.0; 6];
    all[..shares.len()].copy_from_slice(shares);
    all
}

/// Returns the multiple of a half edge that brings a vector nearest to the origin. It is zero for
/// an edge without length.
#[inline]
fn share(from: &Vector, edge: &Vector) -> f64 {
    let squared = dot(edge, edge);
    if squared > 0.0 { (-dot(from, edge) / squared).clamp(-1.0, 1.0) } else { 0.0 }
}

/// Returns the multiples of two half edges. The first comes from the common normal of the lines,
/// which keeps the error of the difference small for nearly parallel edges (see
/// `primitive::segments`).
#[inline]
fn of_segments(from: &Vector, one: &Vector, other: &Vector) -> [f64; 2] {
    let [squared_one, squared_other] = [dot(one, one), dot(other, other)];
    let mut normal = cross(one, other);
    let mut squared = dot(&normal, &normal);
    if squared < MIN_SQUARED_SINE * (squared_one * squared_other) {
        normal = accurate_cross(one, other);
        squared = dot(&normal, &normal);
    }
    let first = if squared > 0.0 { (-dot(&cross(from, other), &normal) / squared).clamp(-1.0, 1.0) } else { 0.0 };
    let second = share(&std::array::from_fn(|k| from[k] + first * one[k]), other);
    if second.abs() < 1.0 && first.abs() < 1.0 {
        return [first, second];
    }
    [share(&std::array::from_fn(|k| from[k] + second * other[k]), one), second]
}

/// Returns the multiples of the half edges of a box.
#[inline]
fn of_box(from: &Vector, edges: [&Vector; 3]) -> [f64; 3] {
    settled(from, edges, MAX_SWEEPS)
}

/// Returns multiples of half edges, corrected one after the other until none changes.
#[inline]
fn settled<const COUNT: usize>(from: &Vector, edges: [&Vector; COUNT], max_sweeps: usize) -> [f64; COUNT] {
    let inverse = edges.map(|edge| inverse_of(dot(edge, edge)));
    let (mut shares, mut rest) = ([0.0; COUNT], *from);
    for _ in 0..max_sweeps {
        let mut change = 0.0_f64;
        for at in 0..COUNT {
            let edge = edges[at];
            let share: f64 = (shares[at] - dot(&rest, edge) * inverse[at]).clamp(-1.0, 1.0);
            let by = share - shares[at];
            rest = std::array::from_fn(|k| rest[k] + by * edge[k]);
            shares[at] = share;
            change = change.max(by.abs());
        }
        if change <= SETTLED {
            break;
        }
    }
    shares
}

fn inverse_of(squared: f64) -> f64 {
    if squared > 0.0 { 1.0 / squared } else { 0.0 }
}

/// Returns the multiple of a segment's half edge, and those of a box. The box is assumed to have
/// right angles while the segment's point is searched.
fn of_segment_and_box(from: &Vector, edge: &Vector, axes: [&Vector; 3]) -> Option<(f64, [f64; 3])> {
    let squared = axes.map(|axis| dot(axis, axis));
    let inverse = squared.map(inverse_of);
    let start: Vector = std::array::from_fn(|i| dot(from, axes[i]) * inverse[i]);
    let slope: Vector = std::array::from_fn(|i| dot(edge, axes[i]) * inverse[i]);
    // The parts of the vectors that a flat box does not reach.
    let (mut flat_rest, mut flat_slope) = (*from, *edge);
    for i in 0..3 {
        flat_rest = std::array::from_fn(|k| flat_rest[k] - start[i] * axes[i][k]);
        flat_slope = std::array::from_fn(|k| flat_slope[k] - slope[i] * axes[i][k]);
    }
    let is_flat = squared.contains(&0.0);
    let [flat, curve] = if is_flat { [dot(&flat_rest, &flat_slope), dot(&flat_slope, &flat_slope)] } else { [0.0; 2] };
    let (mut along, [mut low, mut high]) = (0.0, [-1.0, 1.0]);
    for _ in 0..MAX_STEPS {
        let (mut derivative, mut second) = (flat + along * curve, curve);
        for i in 0..3 {
            let x = start[i] + along * slope[i];
            if x.abs() > 1.0 {
                derivative += squared[i] * slope[i] * (x - x.signum());
                second += squared[i] * slope[i] * slope[i];
            }
        }
        if derivative == 0.0 || second == 0.0 {
            return Some((along, of_box_at(from, edge, axes, along)));
        }
        if derivative > 0.0 {
            high = along;
        } else {
            low = along;
        }
        let next = along - derivative / second;
        let next = if low <= next && next <= high {
            next
        } else if next < low && low == -1.0 || next > high && high == 1.0 {
            next.clamp(-1.0, 1.0)
        } else {
            0.5 * (low + high)
        };
        let is_settled = (next - along).abs() <= SETTLED;
        along = next;
        if is_settled {
            return Some((along, of_box_at(from, edge, axes, along)));
        }
    }
    None
}

fn of_box_at(from: &Vector, edge: &Vector, axes: [&Vector; 3], along: f64) -> [f64; 3] {
    of_box(&std::array::from_fn(|k| from[k] + along * edge[k]), axes)
}

/// Returns the multiples of the half edges of two boxes. The sweeps converge slowly if an edge of
/// one box leans against an edge of the other.
fn of_boxes(differences: &Differences) -> [f64; 6] {
    let edges = differences.edges();
    settled(&differences.between, std::array::from_fn(|at| &edges[at]), 2 * MAX_SWEEPS)
}

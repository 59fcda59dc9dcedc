//! The sum of the solid angles of many faces, by expansions over the nodes of the wide tree.
//!
//! Source: Barill, Dickson, Schmidt, Levin and Jacobson, *Fast Winding Numbers for Soups and
//! Clouds*, ACM Transactions on Graphics 37(4), 2018. As in the paper, a group of faces has moments
//! about a center up to the second order, integrated over the triangles. Ours departs in two ways.
//! Every expansion has an error bound. And groups are opened worst first until the sum of the
//! bounds is small enough, instead of whenever a group is nearer than a multiple of its radius.
//!
//! The bound (docs/notes/proof.md, L17): a face at x = c + y is seen from p through the gradient of
//! 1 /
//! |x - p|. Its Taylor term of order k in y is `D^(k+1)(1/|·|)[y, ..., y, n] / k!` at c - p. A
//! symmetric form is largest, over unit vectors, if all of them are equal (Banach, *Über homogene
//! Polynome in (L²)*, Studia Mathematica 7, 1938). There it is `(k+1)! P / R^(k+2)` with a Legendre
//! polynomial P, at most 1. So with R = |c - p| and |y| <= qR the term is at most `(k+1) q^k / R²`
//! per area, and all terms from the third on are at most `q³ (4 - 3q) / (1 - q)² / R²`.
//!
//! Guarded by `tests/it/solids/winding.rs` and by the benchmark `solids` of `impinge-bench`.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::solid_angle::{AngleSum, Bounded};
use crate::exact::PosedPoint;
use crate::hierarchy::Child;
use crate::math::vec3::{dot, sub};
use crate::mesh::Mesh;
use crate::mesh::derived::moments::{Group, pair};
use crate::mesh::storage::frame::{PACKING_ERROR, PackedFrame};

/// Error bound of a moment, relative to the [size](Group::size) of its group and a unit length:
/// 2^-36. A moment is summed up along the tree, of at most 64 levels with 8 children of about 20
/// roundings each. Its edges are off by 2^-53 of themselves, and its corners by 2^-51 of the packed
/// frame.
const MOMENT_ERROR: f64 = 1.0 / (1_u64 << 36) as f64;

/// Upper bound of the loss of all products that underflow.
const UNDERFLOW: f64 = 1e-280;

/// Ratio of a group's distance to its radius below which the group is opened, whatever its error
/// bound: the bound grows without limit there.
const MIN_DISTANCE_RATIO: f64 = 1.25;

/// A node whose expansion is in the sum. Nodes are ordered by their error bounds.
struct Seen {
    node: u32,
    value: f64,
    error: f64,
}

impl Mesh {
    /// Returns the sum of the solid angles of all faces over 4π, as seen from a point. Stops as
    /// soon as `is_enough` returns `true` for the sum so far, or if every face was summed up by
    /// itself.
    ///
    /// # Complexity
    /// O(log n) for a wide bound far from the faces, and up to O(n log n).
    pub(super) fn solid_angles(&self, point: &PosedPoint<'_>, is_enough: impl Fn(&Bounded) -> bool) -> Bounded {
        let (nodes, groups) = (self.0.tree.nodes(), &self.far_field().groups);
        let eye = Eye::of(&self.0.frame, point);
        let mut faces = AngleSum::default();
        let mut seen = BinaryHeap::new();
        let see = |node: u32| {
            let Bounded { value, error } = eye.sees(&groups[node as usize]);
            Seen { node, value, error }
        };
        let sum = |faces: &AngleSum, seen: &BinaryHeap<Seen>| {
            let near = faces.turns();
            let far = seen.iter().fold(Bounded { value: 0.0, error: 0.0 }, |sum, one| Bounded {
                value: sum.value + one.value,
                error: sum.error + one.error + f64::EPSILON * (one.value.abs() + one.error),
            });
            // The sums so far are at most the sums of magnitudes, and the errors of moments are far
            // larger.
            let rounding = 4.0 * f64::EPSILON * (near.value.abs() + far.value.abs() + near.error + far.error);
            Bounded { value: near.value + far.value, error: near.error + far.error + rounding }
        };
        seen.extend((!nodes.is_empty()).then(|| see(0)));
        let mut until_sum = 1;
        loop {
            until_sum -= 1;
            if until_sum == 0 {
                let total = sum(&faces, &seen);
                if is_enough(&total) || seen.is_empty() {
                    return total;
                }
                // A sum costs time linear in the seen nodes, so it is not computed for every node
                // that is opened.
                until_sum = 1 + seen.len() / 8;
            }
            let Some(worst) = seen.pop() else {
                until_sum = 1;
                continue;
            };
            let node = &nodes[worst.node as usize];
            for lane in 0..node.count() {
                match node.child(lane) {
                    Child::Inner(child) => seen.push(see(child)),
                    Child::Leaf(leaf) => {
                        self.leaf_faces(leaf).for_each(|face| faces.add_face(&self.corners(face), point));
                    }
                }
            }
        }
    }
}

/// The point in the packed frame.
struct Eye {
    at: [f64; 3],
    /// Bound of the sum of the errors of the three coordinates.
    error: f64,
}

impl Eye {
    fn of(frame: &PackedFrame, point: &PosedPoint<'_>) -> Self {
        let at = frame.pack(point.approximate);
        let error = (0..3).map(|k| point.error[k] * frame.scale + f64::EPSILON * at[k].abs() + PACKING_ERROR).sum();
        Self { at, error }
    }

    /// Returns the solid angle of a group over 4π. Its error bound is infinite if the group is
    /// near.
    fn sees(&self, group: &Group) -> Bounded {
        let v = sub(&group.center, &self.at);
        let squared = dot(&v, &v);
        if squared == f64::INFINITY {
            return Bounded { value: 0.0, error: UNDERFLOW };
        }
        let distance = squared.sqrt();
        let nearest = distance * (1.0 - 1e-12) - self.error;
        // A NaN does not count as far.
        let is_far = nearest > MIN_DISTANCE_RATIO * group.radius;
        if !is_far {
            return Bounded { value: 0.0, error: f64::INFINITY };
        }
        let inverse = 1.0 / squared;
        let (first, second) = (&group.first, &group.second);
        let trace = first[0][0] + first[1][1] + first[2][2];
        let along: f64 = (0..3).map(|i| v[i] * dot(&first[i], &v)).sum();
        // Contractions of the second moments with v: the trace of the first two indices, the trace
        // of the last two, and all three along v.
        let (mut traces, mut thrice) = (0.0, 0.0);
        for i in 0..3 {
            let of = |j: usize, k: usize| second[i][pair(j, k)];
            for k in 0..3 {
                traces += 2.0 * of(i, k) * v[k];
            }
            traces += (of(0, 0) + of(1, 1) + of(2, 2)) * v[i];
            let squares = of(0, 0) * v[0] * v[0] + of(1, 1) * v[1] * v[1] + of(2, 2) * v[2] * v[2];
            let mixed = of(1, 2) * v[1] * v[2] + of(2, 0) * v[2] * v[0] + of(0, 1) * v[0] * v[1];
            thrice += v[i] * (squares + 2.0 * mixed);
        }
        let terms = dot(&group.zeroth, &v) + trace - 3.0 * along * inverse - 1.5 * traces * inverse
            + 7.5 * thrice * inverse * inverse;
        let value = terms * inverse / distance;
        let q = group.radius / nearest;
        let left_out = q * q * q * (4.0 - 3.0 * q) / ((1.0 - q) * (1.0 - q));
        // The entries of the moments, 3, 9 and 18 of them, have factors of at most 1, 4 and 12 over
        // the powers of R.
        let moments = group.size * MOMENT_ERROR * (3.0 + 36.0 / nearest + 216.0 / (nearest * nearest));
        // For the point's error: the gradient of a face's contribution is at most 2 / R³ per area
        // at the nearest face.
        let near = nearest - group.radius;
        let moved = 2.0 * group.area * self.error / (near * near * near);
        let error = (group.area * left_out + moments) / (nearest * nearest) + moved;
        const SPHERE: f64 = 2.0 * std::f64::consts::TAU;
        Bounded { value: value / SPHERE, error: error / SPHERE * (1.0 + 1e-9) + UNDERFLOW }
    }
}

impl Ord for Seen {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Seen {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Seen {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Seen {}

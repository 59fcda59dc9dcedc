//! The solid angles of many faces at once, seen from afar: expansions over the nodes of the wide tree.
//!
//! Source: Barill, Dickson, Schmidt, Levin and Jacobson, *Fast Winding Numbers for Soups and Clouds*, ACM Transactions on
//! Graphics 37(4), 2018. As there, a group of faces has moments about a centre up to the second order, integrated over the
//! triangles. Here every expansion has a bound, and groups are opened worst first until the sum of the bounds is as small
//! as was asked for, instead of wherever a group is nearer than a multiple of its radius.
//!
//! The bound: a face at x = c + y is seen from p through the gradient of 1 / |x - p|, whose Taylor term of order k in y is
//! `D^(k+1)(1/|·|)[y, ..., y, n] / k!` at c - p. A symmetric form is largest, over unit vectors, where all of them are equal
//! (Banach, *Über homogene Polynome in (L²)*, Studia Mathematica 7, 1938), and there it is `(k+1)! P / R^(k+2)` with a Legendre
//! polynomial P, at most 1. So with R = |c - p| and |y| <= qR the term is at most `(k+1) q^k / R²` an area, and all terms from
//! the third on at most `q³ (4 - 3q) / (1 - q)² / R²`.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::Mesh;
use super::frame::{PACKING_ERROR, PackedFrame};
use super::solid_angle::{AngleSum, Bounded};
use crate::exact::{Corners, PosedPoint};
use crate::hierarchy::{Child, Node};

/// What moments may be off by, relative to the [size](Group::size) and a unit length: 2^-36. A moment is summed up along the
/// tree, of at most 64 levels with 8 children of some 20 roundings each, from edges that are off by 2^-53 of themselves and
/// corners that are off by 2^-51 of the packed frame.
const MOMENT_ERROR: f64 = 1.0 / (1_u64 << 36) as f64;

/// More than all products that underflow may lose.
const UNDERFLOW: f64 = 1e-280;

/// Nearer than this many times its radius a group is opened, whatever its bound: there the bound grows without end.
const NEAREST: f64 = 1.25;

/// The faces below one node, in the packed frame.
#[derive(Clone, Copy, Debug)]
struct Group {
    centre: [f64; 3],
    /// No point of the faces is farther from the centre.
    radius: f64,
    /// No less than the areas of the faces add up to.
    area: f64,
    /// The products of the lengths of two edges of each face, added up: what rounding an area vector is relative to.
    size: f64,
    /// The sum of the area vectors.
    zeroth: [f64; 3],
    /// `first[i][j]`: the area vectors' component i times the integral of y_j.
    first: [[f64; 3]; 3],
    /// `second[i]`: likewise of y_j y_k, for jk = 00, 11, 22, 12, 20, 01.
    second: [[f64; 6]; 3],
}

/// The groups of all nodes.
#[derive(Debug)]
pub(crate) struct FarField {
    groups: Vec<Group>,
}

/// A node whose expansion is in the sum, worst first.
struct Seen {
    node: u32,
    value: f64,
    error: f64,
}

/// Where an index of a symmetric pair is in [`Group::second`].
fn pair(j: usize, k: usize) -> usize {
    if j == k { j } else { 6 - j - k }
}

impl FarField {
    /// # Complexity
    /// O(n).
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let nodes = mesh.0.tree.nodes();
        let mut groups = vec![Group::EMPTY; nodes.len()];
        // Children come after their parents.
        for index in (0..nodes.len()).rev() {
            let mut group = Group::about_box_of(&nodes[index]);
            for lane in 0..nodes[index].count() {
                match nodes[index].child(lane) {
                    Child::Inner(child) => group.add_group(&groups[child as usize]),
                    Child::Leaf(leaf) => {
                        for face in mesh.leaf_faces(leaf) {
                            group.add_face(&mesh.0.frame, &mesh.corners(face));
                        }
                    }
                }
            }
            groups[index] = group;
        }
        Self { groups }
    }
}

impl Mesh {
    /// The sum of the solid angles of all faces over 4π: `is_enough` is asked of the sum so far until it holds or every face
    /// was summed up by itself.
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
            // The sums so far are at most those of magnitudes, which the errors of moments are far above.
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
                // Summing is linear in what is seen: not for every node that is opened.
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

impl Group {
    const EMPTY: Self = Self {
        centre: [0.0; 3],
        radius: 0.0,
        area: 0.0,
        size: 0.0,
        zeroth: [0.0; 3],
        first: [[0.0; 3]; 3],
        second: [[0.0; 6]; 3],
    };

    /// Without faces, about the middle of the boxes of a node's children.
    fn about_box_of(node: &Node) -> Self {
        let (mut centre, mut squared) = ([0.0; 3], 0.0);
        for axis in 0..3 {
            let lanes = 0..node.count();
            let low = lanes.clone().fold(f64::INFINITY, |low, lane| low.min(f64::from(node.min[axis][lane])));
            let high = lanes.fold(f64::NEG_INFINITY, |high, lane| high.max(f64::from(node.max[axis][lane])));
            centre[axis] = 0.5 * (low + high);
            squared += (0.5 * (high - low)).powi(2);
        }
        // More than what the corners and the root are off by.
        let radius = squared.sqrt() * (1.0 + 1e-12) + 4.0 * PACKING_ERROR;
        Self { centre, radius, ..Self::EMPTY }
    }

    fn add_face(&mut self, frame: &PackedFrame, corners: &Corners) {
        // Edges from the stored corners, so that those of a face as small as packing rounds have a direction.
        let edge = |to: usize| -> [f64; 3] { std::array::from_fn(|k| (corners[to][k] - corners[0][k]) * frame.scale) };
        let (u, v) = (edge(1), edge(2));
        let normal: [f64; 3] = std::array::from_fn(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            0.5 * (u[i] * v[j] - u[j] * v[i])
        });
        let length = |x: &[f64; 3]| (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt();
        let size = length(&u) * length(&v);
        self.size += size;
        self.area += length(&normal) + 8.0 * f64::EPSILON * size;
        let [a, b, c] = corners.map(|corner| -> [f64; 3] {
            let packed = frame.pack(corner);
            std::array::from_fn(|k| packed[k] - self.centre[k])
        });
        // Means over the triangle of y and of y yᵀ, with its corners and their sum.
        let sum: [f64; 3] = std::array::from_fn(|k| a[k] + b[k] + c[k]);
        for j in 0..3 {
            for i in 0..3 {
                self.first[i][j] += normal[i] * (sum[j] / 3.0);
            }
            for k in j..3 {
                let mean = (sum[j] * sum[k] + a[j] * a[k] + b[j] * b[k] + c[j] * c[k]) / 12.0;
                for i in 0..3 {
                    self.second[i][pair(j, k)] += normal[i] * mean;
                }
            }
        }
        for i in 0..3 {
            self.zeroth[i] += normal[i];
        }
    }

    /// Moves the other group's moments to this centre and adds them.
    fn add_group(&mut self, other: &Self) {
        let d: [f64; 3] = std::array::from_fn(|k| other.centre[k] - self.centre[k]);
        for i in 0..3 {
            let (zeroth, first) = (other.zeroth[i], &other.first[i]);
            for j in 0..3 {
                for k in j..3 {
                    self.second[i][pair(j, k)] +=
                        other.second[i][pair(j, k)] + first[j] * d[k] + first[k] * d[j] + zeroth * d[j] * d[k];
                }
                self.first[i][j] += first[j] + zeroth * d[j];
            }
            self.zeroth[i] += zeroth;
        }
        self.area += other.area;
        self.size += other.size;
    }
}

/// The point in the packed frame.
struct Eye {
    at: [f64; 3],
    /// How far it may be off.
    error: f64,
}

impl Eye {
    fn of(frame: &PackedFrame, point: &PosedPoint<'_>) -> Self {
        let at = frame.pack(point.approximate);
        let error = (0..3).map(|k| point.error[k] * frame.scale + f64::EPSILON * at[k].abs() + PACKING_ERROR).sum();
        Self { at, error }
    }

    /// The solid angle of a group over 4π; of infinite error where it is near.
    fn sees(&self, group: &Group) -> Bounded {
        let v: [f64; 3] = std::array::from_fn(|k| group.centre[k] - self.at[k]);
        let squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        if squared == f64::INFINITY {
            return Bounded { value: 0.0, error: UNDERFLOW };
        }
        let distance = squared.sqrt();
        let nearest = distance * (1.0 - 1e-12) - self.error;
        // Not where it is NaN.
        let is_far = nearest > NEAREST * group.radius;
        if !is_far {
            return Bounded { value: 0.0, error: f64::INFINITY };
        }
        let dot = |x: &[f64; 3]| x[0] * v[0] + x[1] * v[1] + x[2] * v[2];
        let inverse = 1.0 / squared;
        let (first, second) = (&group.first, &group.second);
        let trace = first[0][0] + first[1][1] + first[2][2];
        let along: f64 = (0..3).map(|i| v[i] * dot(&first[i])).sum();
        // Of the second moments: the trace of the first two indices, that of the last two, and all three along v.
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
        let terms = dot(&group.zeroth) + trace - 3.0 * along * inverse - 1.5 * traces * inverse
            + 7.5 * thrice * inverse * inverse;
        let value = terms * inverse / distance;
        let q = group.radius / nearest;
        let left_out = q * q * q * (4.0 - 3.0 * q) / ((1.0 - q) * (1.0 - q));
        // The moments' entries, 3, 9 and 18 of them, enter with at most 1, 4 and 12 over the powers of R.
        let moments = group.size * MOMENT_ERROR * (3.0 + 36.0 / nearest + 216.0 / (nearest * nearest));
        // The gradient of what a face adds, for the point's error, is at most 2 / R³ an area at the nearest face.
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

//! Lower bounds of distances along the direction between the witnesses, the nearest points so far.
//! Boxes alone cannot give them.
//!
//! A group of neighboring triangles is thin along its normal, but its box is as thick as the group
//! is wide. Near the nearest points of two smooth surfaces, bounds by boxes therefore prune none of
//! the pairs of groups around them. Along the direction `n` from one witness to the other, the
//! points of two parts are at least `min n·guest - max n·host` apart. These two numbers are
//! computed part by part, once for each direction: for a leaf from its corners, for a node from its
//! box and its slab. This file calls them *reaches*: how far a part reaches beyond its own mesh's
//! witness, towards the other mesh. Every direction gives a valid bound, and an old direction gives
//! a weaker one.
//!
//! Source: the supporting planes of Gilbert, Johnson, Keerthi, *A fast procedure for computing the
//! distance between complex objects in three-dimensional space*, IEEE Journal of Robotics and
//! Automation 4(2), 1988. Ours uses them as lower bounds for parts.
//!
//! Guarded by the test below, and by `tests/it/distance/meshes.rs`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::cache::Cache;
use super::metric::Metric;
use super::scene::{Scene, Valued};
use super::slot::Slot;
use super::support_bound::SupportBound;
use crate::math::vec3::{Vector, dot, length, sub};
use crate::mesh::Mesh;
use crate::mesh::storage::packet::Packet;
use crate::simd::{ALL_LANES, LANES, load, outlined};

/// Number of nodes of either mesh whose reaches are cached, a power of two.
const CACHED_NODES: usize = 256;

/// Relative decrease of the distance after which the reaches of nodes are computed along a new
/// direction: 2^-10. A smaller value computes them more often for little gain: a direction that is
/// off by an angle φ loosens bounds by about φ²/2, which is this value. A larger value leaves the
/// bounds looser.
const MIN_DECREASE: f64 = 1.0 / 1024.0;

/// Bound for the rounding error of the sum of two reaches and of the threshold, relative to the
/// threshold: 2^-21.
const SUM_ROUNDING: f64 = 1.0 / (1_u64 << 21) as f64;

/// The direction between the witnesses in the metric frame, and the reaches of nodes along it.
pub(super) struct DirectionBounds<'m> {
    /// The host and the guest.
    meshes: [&'m Mesh; 2],
    /// Direction between the best witnesses so far. The triangles of leaves are compared along it.
    newest: Option<Direction>,
    /// Direction along which the reaches of nodes are computed. It may be older than `newest`.
    of_nodes: Option<Direction>,
    version: u32,
    nodes: [Cache<Reaches, CACHED_NODES>; 2],
}

/// A direction from the host's witness to the guest's witness.
#[derive(Clone, Copy)]
struct Direction {
    supports: [SupportBound; 2],
    threshold: Threshold,
    /// Distance of the witnesses when the direction was taken, in metric units.
    value: f64,
}

/// Reaches of the children of a node.
#[derive(Clone, Copy)]
struct Reaches {
    node: u32,
    version: u32,
    lanes: [f32; LANES],
}

/// How far eight parts of the host and eight parts of the guest reach beyond their own mesh's
/// witness, towards the other mesh, in metric units.
pub(super) struct Reached {
    host: [f32; LANES],
    guest: [f32; LANES],
    threshold: Threshold,
}

/// Sum of the reaches of two children towards each other, in metric units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Sum of both reaches, in metric units.
    pub(super) both: f32,
    /// Number of the direction along which `both` was computed.
    pub(super) along: u32,
}

/// The values that give the sum of reaches below which two parts are proved to be far apart.
#[derive(Clone, Copy)]
pub(super) struct Threshold {
    /// Distance of the witnesses along the direction, in metric units.
    gap: f64,
    /// Error bound of metric coordinates and of sums of their products.
    error: f64,
}

impl Threshold {
    /// Returns the sum of reaches below which two parts are farther apart than `cut`, in metric
    /// units. The distance of two parts is at least the gap between the witnesses less both
    /// reaches, divided by the length of the direction. That length is one within rounding.
    #[inline(always)]
    pub(super) fn at(self, cut: f64) -> f32 {
        let most = self.gap - cut;
        (most - (8.0 * self.error + 1e-14 * cut + SUM_ROUNDING * most.abs())) as f32
    }
}

impl Reached {
    /// Returns for each guest lane the host lanes that are not proved to be farther away than
    /// `cut`, in metric units, as bits. Returns all lanes if there is no direction.
    #[inline(always)]
    pub(super) fn near<S: Simd>(reached: &Option<Self>, simd: S, cut: f64) -> [u32; LANES] {
        let Some(reached) = reached else { return [ALL_LANES; LANES] };
        let (host, threshold) = (load(simd, &reached.host), f32x8::splat(simd, reached.threshold.at(cut)));
        let mut near = [0; LANES];
        for lane in 0..LANES {
            let sum = host + f32x8::splat(simd, reached.guest[lane]);
            near[lane] = !(sum.simd_lt(threshold).to_bitmask() as u32);
        }
        near
    }

    /// Reports whether two parts are proved to be farther apart than `cut`, in metric units.
    #[inline(always)]
    pub(super) fn are_apart(reached: &Option<Self>, [host_lane, guest_lane]: [usize; 2], cut: f64) -> bool {
        let Some(reached) = reached else { return false };
        reached.host[host_lane] + reached.guest[guest_lane] < reached.threshold.at(cut)
    }

    /// Returns the sum of the reaches of two parts, or infinity if there is no direction.
    #[inline(always)]
    pub(super) fn both(reached: &Option<Self>, [host_lane, guest_lane]: [usize; 2]) -> f32 {
        reached.as_ref().map_or(
            f32::INFINITY,
            #[inline(always)]
            |reached| reached.host[host_lane] + reached.guest[guest_lane],
        )
    }
}

impl<'m> DirectionBounds<'m> {
    pub(super) fn new(meshes: [&'m Mesh; 2]) -> Self {
        Self { meshes, newest: None, of_nodes: None, version: 0, nodes: [Cache::new(), Cache::new()] }
    }

    /// Takes the direction between the witnesses of the best pair so far.
    #[inline(always)]
    pub(super) fn update(&mut self, scene: &Scene<'_>, best: Option<&Valued>) {
        if let Some(best) = best {
            let (sides, on) = (scene.sides(), [&best.witness.on_a, &best.witness.on_b]);
            self.set_direction(sides.map(|side| on[side]), best.value, &scene.metric, sides);
        }
    }

    /// Takes the direction from the host's witness to the guest's, if they are nearer than the last
    /// witnesses. `sides` has the indices of host and guest among the two meshes.
    fn set_direction(&mut self, [on_host, on_guest]: [&Vector; 2], value: f64, metric: &Metric, sides: [usize; 2]) {
        if self.newest.is_some_and(|newest| value >= newest.value) {
            return;
        }
        let between = sub(on_guest, on_host);
        let size = length(&between);
        // Coinciding points have no direction between them.
        if size > f64::MIN_POSITIVE {
            let along = between.map(|x| x / size);
            let [level_host, level_guest] = [dot(&along, on_host), dot(&along, on_guest)];
            let support = |side: usize, along: Vector, level: f64| {
                let map = &metric.maps[sides[side]];
                let column = |j: usize| [map.linear[0][j], map.linear[1][j], map.linear[2][j]];
                let gradient = [0, 1, 2].map(|j| dot(&along, &column(j)) / self.meshes[side].0.frame.scale);
                let size = gradient.iter().map(|x| x.abs()).sum();
                SupportBound { gradient, base: dot(&along, &map.offset) - level, size }
            };
            let supports = [support(0, along, level_host), support(1, along.map(|x| -x), -level_guest)];
            let threshold = Threshold { gap: level_guest - level_host, error: metric.error };
            let newest = Direction { supports, threshold, value };
            self.newest = Some(newest);
            if self.of_nodes.is_none_or(|old| value < old.value * (1.0 - MIN_DECREASE)) {
                self.of_nodes = Some(newest);
                self.version += 1;
            }
        }
    }

    /// Returns the reaches of the children of two nodes, or `None` without a direction.
    #[inline(always)]
    pub(super) fn of_nodes<S: Simd>(&mut self, simd: S, nodes: [u32; 2]) -> Option<Reached> {
        let direction = self.of_nodes?;
        let host = self.reaches(simd, 0, nodes[0], &direction).lanes;
        let guest = self.reaches(simd, 1, nodes[1], &direction).lanes;
        Some(Reached { host, guest, threshold: direction.threshold })
    }

    /// Reports whether two children are proved to be farther apart than `cut`. `reach` is their
    /// reach when they were queued. It is computed again if the direction has changed since.
    #[inline(always)]
    pub(super) fn are_apart<S: Simd>(&mut self, simd: S, reach: Reach, slots: [Slot; 2], cut: f64) -> bool {
        let Some(direction) = self.of_nodes else { return false };
        let both = if reach.along == self.version {
            reach.both
        } else {
            let [host_slot, guest_slot] = slots;
            let host = self.reaches(simd, 0, host_slot.node, &direction).lanes[usize::from(host_slot.lane)];
            let guest = self.reaches(simd, 1, guest_slot.node, &direction).lanes[usize::from(guest_slot.lane)];
            host + guest
        };
        both < direction.threshold.at(cut)
    }

    /// Returns the number of the direction along which nodes reach, or zero without a direction.
    #[inline(always)]
    pub(super) fn along(&self) -> u32 {
        self.version
    }

    /// Returns the reaches of the children of a node of one side, each added to the reach of one
    /// child of the other side. Returns `None` without a direction.
    #[inline(always)]
    pub(super) fn of_one<S: Simd>(
        &mut self,
        simd: S,
        side: usize,
        node: u32,
        other: Slot,
    ) -> Option<(f32x8<S>, Threshold)> {
        let direction = self.of_nodes?;
        let one = self.reaches(simd, 1 - side, other.node, &direction).lanes[usize::from(other.lane)];
        let many = load(simd, &self.reaches(simd, side, node, &direction).lanes);
        Some((many + f32x8::splat(simd, one), direction.threshold))
    }

    /// Returns the reaches of the triangles of two leaves, or `None` without a direction.
    #[inline(always)]
    pub(super) fn of_leaves<S: Simd>(&self, simd: S, leaves: [&Packet<'_>; 2]) -> Option<Reached> {
        let direction = self.newest?;
        let host = direction.supports[0].of_triangles(simd, leaves[0]);
        let guest = direction.supports[1].of_triangles(simd, leaves[1]);
        Some(Reached { host, guest, threshold: direction.threshold })
    }

    /// Returns the reaches of the children of a node of one side, from the cache if they are
    /// current.
    #[inline(always)]
    fn reaches<S: Simd>(&mut self, simd: S, side: usize, node: u32, direction: &Direction) -> &Reaches {
        let (mesh, version, support) = (self.meshes[side], self.version, &direction.supports[side]);
        let is_current = |kept: &Reaches| kept.node == node && kept.version == version;
        self.nodes[side].get_current(
            node,
            is_current,
            #[inline(always)]
            |_| {
                let lanes = outlined(
                    simd,
                    #[inline(always)]
                    || support.of_children(simd, mesh, node),
                );
                Reaches { node, version, lanes }
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::Affine;
    use impinge_testkit::generate::Rng;
    use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
    use impinge_testkit::generate::poses::{large_integer_map, rotation};

    use super::*;
    use crate::hierarchy::Child;
    use crate::math::Pose;
    use crate::mesh::storage::positions::Positions;
    use crate::simd::{dispatch, levels};

    /// Returns how far the faces below a child reach, by their metric corners.
    fn reach(mesh: &Mesh, metric: &Metric, side: usize, along: &Vector, level: f64, child: Child) -> f64 {
        match child {
            Child::Leaf(leaf) => mesh.leaf(leaf).faces.iter().fold(f64::NEG_INFINITY, |most, &face| {
                let corners = mesh.corners(face).map(|corner| dot(along, &metric.maps[side].apply(corner)) - level);
                corners.into_iter().fold(most, f64::max)
            }),
            Child::Inner(node) => {
                let node = &mesh.0.tree.nodes()[node as usize];
                (0..node.count()).fold(f64::NEG_INFINITY, |most, lane| {
                    most.max(reach(mesh, metric, side, along, level, node.child(lane)))
                })
            }
        }
    }

    #[test]
    fn reaches_are_upper_bounds() {
        let knot = torus_knot(96, 24, TREFOIL);
        let mesh = Mesh::new(Positions::F64(knot.vertices), knot.faces).expect("a mesh");
        let mut rng = Rng::new(33);
        let (mut bounded, mut reached, mut parts) = (0.0, 0.0, 0);
        for round in 0..12 {
            let pose = |map: Affine| Pose::new(map.linear, map.translation).expect("a pose");
            let poses = [
                pose(rotation(&mut rng)),
                pose(if round % 3 == 0 { large_integer_map(&mut rng) } else { rotation(&mut rng) }),
            ];
            let metric = Metric::new(mesh.at(poses[0]), mesh.at(poses[1]));
            let mut direction_bounds = DirectionBounds::new([&mesh, &mesh]);
            let on = [0, 1].map(|side| metric.maps[side].apply(mesh.corners(rng.integer(0, 4000) as u32)[0]));
            let between = sub(&on[1], &on[0]);
            let along = between.map(|x| x / length(&between));
            direction_bounds.set_direction([&on[0], &on[1]], length(&between), &metric, [0, 1]);
            for node in 0..mesh.0.tree.nodes().len() as u32 {
                let mut found = Vec::new();
                for (_, level) in levels() {
                    let reached =
                        dispatch!(level, simd => direction_bounds.of_nodes(simd, [node, node])).expect("a direction");
                    found.push([reached.host, reached.guest]);
                }
                assert!(found.iter().all(|reaches| *reaches == found[0]), "the bounds depend on the vector level");
                let of = &mesh.0.tree.nodes()[node as usize];
                for side in [0, 1] {
                    let towards = if side == 0 { along } else { along.map(|x| -x) };
                    for lane in 0..of.count() {
                        let truth = reach(&mesh, &metric, side, &towards, dot(&towards, &on[side]), of.child(lane));
                        let bound = f64::from(found[0][side][lane]);
                        assert!(
                            truth <= bound + 8.0 * metric.error,
                            "round {round}, node {node}: {truth} above {bound}"
                        );
                        if !of.holds_leaves() {
                            (bounded, reached, parts) = (bounded + bound, reached + truth, parts + 1);
                        }
                    }
                }
            }
        }
        let looseness = (bounded - reached) / f64::from(parts);
        assert!(parts > 1000 && looseness < 0.02, "{parts} parts, looser than the truth by {looseness}");
    }
}

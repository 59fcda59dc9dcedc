//! How far leaves reach along the direction between the witnesses: a bound that boxes cannot give.
//!
//! A patch of triangles is thin along its normal, its box is as thick as the patch is wide. Near the nearest points of two
//! smooth surfaces box bounds therefore leave open all patches around, each with each. Along the direction `n` from one
//! witness to the other every point of a pair of leaves is at least `min n·guest - max n·host` apart, and these two
//! numbers are had from the corners, once for a leaf and a direction. Any direction gives a bound; an old one only
//! gives a weaker one.
//!
//! Source: the supporting planes of Gilbert, Johnson, Keerthi, *A fast procedure for computing the distance between complex
//! objects in three-dimensional space*, IEEE Journal of Robotics and Automation 4(2), 1988, here as lower bounds for parts.

use super::AtHand;
use crate::hierarchy::{Child, Node};
use crate::mesh::Mesh;
use crate::mesh::metric::MetricMap;
use crate::primitive::{Vector, dot, length, sub};
use crate::simd::LANES;

/// Nodes of leaves whose reaches are kept, of either mesh; a power of two.
const KEPT: usize = 256;

/// A new direction is taken where the distance has shrunk by more than this since the last: 2^-10. More often would reach
/// for all leaves anew for little; a direction that is off by an angle φ loosens bounds by about φ²/2, which is this.
const STALE: f64 = 1.0 / 1024.0;

/// More than what the sum of two reaches is off by, and this number's own rounding, relative to the sum: 2^-21.
const SUM_ROUNDING: f64 = 1.0 / (1_u64 << 21) as f64;

/// A direction in the metric frame and what is known along it.
pub(super) struct Profiles {
    direction: Option<Direction>,
    version: u32,
    nodes: [AtHand<Reaches>; 2],
}

#[derive(Clone, Copy)]
struct Direction {
    /// Of about unit length.
    along: Vector,
    /// The witnesses, of the host and of the guest, along it; reaches are about them.
    levels: [f64; 2],
    /// The distance at which it was taken.
    value: f64,
}

/// How far the leaves of a node reach along the direction, beyond their mesh's witness and towards the other mesh.
#[derive(Clone, Copy)]
struct Reaches {
    node: u32,
    version: u32,
    lanes: [f32; LANES],
    most: f32,
}

/// The leaves of two nodes, by how far they reach towards each other, and how far that may be.
pub(super) struct Reached<'p> {
    host: &'p [f32; LANES],
    guest: &'p [f32; LANES],
    enough: f32,
}

impl Reached<'_> {
    /// Whether two leaves are proved to be farther apart than matters.
    #[inline(always)]
    pub(super) fn is_apart(&self, host_lane: usize, guest_lane: usize) -> bool {
        self.host[host_lane] + self.guest[guest_lane] < self.enough
    }
}

/// What [`Profiles::reached`] finds.
pub(super) enum Facing<'p> {
    /// All leaves of both nodes are farther apart than matters.
    Apart,
    /// Some may not be.
    Leaves(Reached<'p>),
    /// Nothing is known.
    Unknown,
}

impl Profiles {
    pub(super) fn new() -> Self {
        Self { direction: None, version: 0, nodes: [AtHand::new(KEPT), AtHand::new(KEPT)] }
    }

    /// Takes the direction between two witnesses, where it is new enough.
    pub(super) fn take(&mut self, on_host: &Vector, on_guest: &Vector, value: f64) {
        if value == 0.0 {
            // Where surfaces meet no direction parts them.
            self.direction = None;
            return;
        }
        if self.direction.is_some_and(|direction| value > direction.value * (1.0 - STALE)) {
            return;
        }
        let between = sub(on_guest, on_host);
        let size = length(&between);
        // Points that coincide have none.
        if size > f64::MIN_POSITIVE {
            let along = between.map(|x| x / size);
            self.direction = Some(Direction { along, levels: [dot(&along, on_host), dot(&along, on_guest)], value });
            self.version += 1;
        }
    }

    /// How the leaves of two nodes, all of whose children are leaves, reach towards each other. `cut` is the distance
    /// past which nothing matters, `error` what metric coordinates and sums of their products are off by.
    #[inline(never)]
    pub(super) fn reached(
        &mut self,
        host: (&Mesh, &MetricMap, u32),
        guest: (&Mesh, &MetricMap, u32),
        cut: f64,
        error: f64,
    ) -> Facing<'_> {
        let Some(direction) = &self.direction else { return Facing::Unknown };
        let version = self.version;
        let [at_host, at_guest] = &mut self.nodes;
        let (Some(on_host), Some(on_guest)) = (
            reaches(at_host, host, direction, 1.0, direction.levels[0], version),
            reaches(at_guest, guest, direction, -1.0, direction.levels[1], version),
        ) else {
            return Facing::Unknown;
        };
        // Leaves are apart by the levels' difference, less both reaches, over the length of the direction, which is one
        // within rounding.
        let gap = direction.levels[1] - direction.levels[0];
        let most = gap - cut;
        let enough = (most - (8.0 * error + 1e-14 * cut + SUM_ROUNDING * most.abs())) as f32;
        if on_host.most + on_guest.most < enough {
            return Facing::Apart;
        }
        Facing::Leaves(Reached { host: &on_host.lanes, guest: &on_guest.lanes, enough })
    }
}

/// The reaches of a node's leaves, none where a child is no leaf.
#[inline(always)]
fn reaches<'p>(
    kept: &'p mut AtHand<Reaches>,
    (mesh, map, node): (&Mesh, &MetricMap, u32),
    direction: &Direction,
    towards: f64,
    level: f64,
    version: u32,
) -> Option<&'p Reaches> {
    let of_leaves = &mesh.0.tree.nodes()[node as usize];
    if !has_leaves_alone(of_leaves) {
        return None;
    }
    let make = |_| {
        let along = direction.along.map(|x| x * towards);
        let column = |j: usize| [map.linear[0][j], map.linear[1][j], map.linear[2][j]];
        let local = [0, 1, 2].map(|j| dot(&along, &column(j)));
        let base = dot(&along, &map.offset) - towards * level;
        let mut lanes = [f32::NEG_INFINITY; LANES];
        for (lane, reach) in lanes[..of_leaves.count()].iter_mut().enumerate() {
            let Child::Leaf(leaf) = of_leaves.child(lane) else { continue };
            let faces = &mesh.0.packets[leaf as usize].faces;
            let mut most = f64::NEG_INFINITY;
            for &face in faces {
                for corner in mesh.corners(face) {
                    most = most.max(dot(&local, &sub(&corner, &map.centre)));
                }
            }
            *reach = ((most + base) as f32).next_up();
        }
        let most = lanes.iter().fold(f32::NEG_INFINITY, |most, x| most.max(*x));
        Reaches { node, version, lanes, most }
    };
    Some(kept.get_current(node, |kept| kept.node == node && kept.version == version, make))
}

#[inline(always)]
fn has_leaves_alone(node: &Node) -> bool {
    (0..node.count()).all(|lane| matches!(node.child(lane), Child::Leaf(_)))
}

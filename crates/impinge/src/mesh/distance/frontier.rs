//! The node pairs at which a search ended. The next search resumes at them.
//!
//! A *frontier* has an entry for every two nodes whose children were compared. The entry has a
//! lower bound for each pair of children: of the distance of everything below the two, at that
//! time, by the best of the tests that they passed. The bound is infinite if the two children have
//! an entry of their own. So each pair of triangles is below exactly one pair of children with a
//! finite bound, and the bound holds for it. When the meshes have moved, each bound is reduced by
//! the largest motion of any point below the two children. Only pairs whose bound is then within
//! the distance that matters are processed again, which raises bounds or adds entries. No pair is
//! skipped otherwise (docs/notes/proof.md, L14a).
//!
//! Bounds are in units of the host's packed frame, in which the host does not move.
//!
//! Source: Ehmann, Lin, *Accurate and fast proximity queries between polyhedra using convex surface
//! decomposition*, Eurographics 2001, for frontiers of distance queries. Ours keeps numbers instead
//! of yes and no, so that a frontier outlasts motion.
//!
//! Guarded by `frontier/tests.rs`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::relative_frame::RelativeFrame;
use super::scene::Scene;
use super::slot::Slot;
use crate::hierarchy::{HALF_ULP, Node, lanes_in_use};
use crate::mesh::pairs::sides::Sides;
use crate::mesh::storage::frame::REACH;
use crate::mesh::storage::stamp::Stamp;
use crate::mesh::{HostChoice, Options};
use crate::simd::{LANES, Lanes3, bits, by_axis, dispatch, dot, load, load3};

/// Maximum ratio of the number of entries to the initial number of entries. A larger frontier is
/// dropped, because its old entries cost time.
const MAX_GROWTH: usize = 2;

/// Maximum number of entries, of 260 bytes each. A pair of children without an entry is opened
/// again in each search. A larger number takes more memory, and a smaller one repeats more work.
const MAX_ENTRIES: usize = 1 << 16;

/// Number of further motions like the last one for which bounds should hold. A larger number costs
/// more than it saves, because costly tests are then applied to more distant pairs of triangles.
const MOTIONS_OUTLASTED: f32 = 2.0;

/// Minimum and maximum share of the cut by which pairs of triangles beyond the cut are processed
/// too. The minimum keeps bounds above the cut if nothing moves. If the motion needs more than the
/// maximum, there is no frontier.
const BEYOND: [f32; 2] = [1.0 / 1024.0, 1.0 / 8.0];

/// The node pairs at which a search ended, with lower bounds of their distances.
#[derive(Clone, Debug)]
pub(super) struct Frontier {
    /// Stamps of the first and the second mesh. A mesh whose vertices change gets a new stamp.
    stamps: [Stamp; 2],
    sides: Sides,
    relative: RelativeFrame,
    /// Factor on the cut up to which pairs of triangles are processed, at least 1, so that bounds
    /// outlast some motion.
    beyond: f32,
    entries: Vec<Entry>,
    /// Number of leaf pairs that the search processed when it made the frontier.
    leaf_pairs: usize,
    /// Number of entries when the frontier was first complete. Zero before that.
    initial_entries: usize,
}

/// A node of the host and a node of the guest, with `bounds[guest lane][host lane]` for their
/// children. Unused lanes and pairs with an entry of their own have the bound infinity.
#[derive(Clone, Debug)]
struct Entry {
    nodes: [u32; 2],
    bounds: [[f32; LANES]; LANES],
}

impl Entry {
    /// Returns the entry of the roots, given the number of children of each root. Its bounds are
    /// zero.
    fn of_roots([host, guest]: [usize; 2]) -> Self {
        let mut bounds = [[f32::INFINITY; LANES]; LANES];
        bounds[..guest].iter_mut().for_each(|row| row[..host].fill(0.0));
        Self { nodes: [0; 2], bounds }
    }
}

/// Index that stands for no entry.
pub(super) const NO_ENTRY: u32 = u32::MAX;

impl Frontier {
    /// Creates a frontier at the roots. `since` is the relative frame at the last search, and `cut`
    /// is the distance that matters, in metric units. Returns `None` if the meshes have moved far
    /// since then, or if distances in the host's frame do not bound distances in the world.
    pub(super) fn new(
        scene: &Scene<'_>,
        since: &RelativeFrame,
        nodes: [&[Node]; 2],
        options: &Options<'_>,
        cut: f64,
    ) -> Option<Self> {
        let relative = scene.bounds.relative?;
        let motion = Motion::new(since, &relative);
        let stamps = scene.meshes.map(|mesh| mesh.0.stamp);
        let sides = scene.bounds.sides;
        let roots = Entry::of_roots(nodes.map(|nodes| nodes[0].count()));
        let mut frontier =
            Self { stamps, sides, relative, beyond: 1.0, entries: vec![roots], leaf_pairs: 0, initial_entries: 0 };
        frontier.beyond = frontier.outlasting(&motion, nodes[1], options, cut)?;
        Some(frontier)
    }

    /// Returns the factor on `cut` with which bounds outlast [`MOTIONS_OUTLASTED`] more motions
    /// like this one. Returns `None` if the motion is too large.
    fn outlasting(&self, motion: &Motion, nodes: &[Node], options: &Options<'_>, cut: f64) -> Option<f32> {
        let (level, root) = (options.level, nodes.first()?);
        let motions = dispatch!(level, simd => motion.of_children(simd, root));
        let mut most = BEYOND[0];
        for lane in bits(lanes_in_use(root)) {
            let share = MOTIONS_OUTLASTED * motions[lane] / self.limit(cut);
            // NaN counts as too large.
            if share.is_nan() || share > BEYOND[1] {
                return None;
            }
            most = most.max(share);
        }
        Some(1.0 + most)
    }

    /// Returns the factor on the cut up to which pairs of triangles are processed, at least 1.
    pub(super) fn beyond(&self) -> f32 {
        self.beyond
    }

    /// Records the number of processed leaf pairs when the frontier is first complete.
    pub(super) fn complete(&mut self, leaf_pairs: usize) {
        if self.initial_entries == 0 {
            (self.leaf_pairs, self.initial_entries) = (leaf_pairs, self.entries.len());
        }
    }

    /// Returns the options with the host of this frontier.
    pub(super) fn options<'i>(&self, options: &Options<'i>) -> Options<'i> {
        let [host, _] = self.sides.host_guest([HostChoice::First, HostChoice::Second]);
        Options { host, ..*options }
    }

    /// Adds an entry for two nodes, with all bounds infinite, and returns its index. Returns `None`
    /// if there are too many entries.
    #[inline(always)]
    pub(super) fn add_entry(&mut self, nodes: [u32; 2]) -> Option<u32> {
        let entry = self.entries.len();
        (entry < MAX_ENTRIES).then(|| {
            self.entries.push(Entry { nodes, bounds: [[f32::INFINITY; LANES]; LANES] });
            entry as u32
        })
    }

    /// Stores the bounds of one child of the guest's node and each child of the host's node in
    /// `lanes`, given the squared distances of their boxes.
    #[inline(always)]
    pub(super) fn keep_row<S: Simd>(&mut self, simd: S, entry: u32, guest: usize, lanes: u32, squared: &[f32; LANES]) {
        let bounds: [f32; LANES] = (load(simd, squared).sqrt() * f32x8::splat(simd, BOX_ROUNDING)).into();
        for host in bits(lanes) {
            self.entries[entry as usize].bounds[guest][host] = finite(bounds[host]);
        }
    }

    /// Stores the bound of two children, given the squared distance of their boxes.
    #[inline(always)]
    pub(super) fn keep(&mut self, entry: u32, [host, guest]: [Slot; 2], squared: f32) {
        let bound = finite(squared.sqrt() * BOX_ROUNDING);
        self.entries[entry as usize].bounds[usize::from(guest.lane)][usize::from(host.lane)] = bound;
    }

    /// Raises the bound of two children to a distance in metric units, less twice `error`. A bound
    /// that is higher already stays.
    #[inline(always)]
    pub(super) fn raise(&mut self, entry: u32, [host, guest]: [Slot; 2], metric: f64, error: f64) {
        let packed = self.packed(metric, error);
        if let Some(entry) = self.entries.get_mut(entry as usize) {
            let bound = &mut entry.bounds[usize::from(guest.lane)][usize::from(host.lane)];
            *bound = bound.max(packed);
        }
    }

    /// Converts a lower bound in metric units, less twice `error`, to the host's packed frame.
    #[inline(always)]
    fn packed(&self, metric: f64, error: f64) -> f32 {
        finite(((metric - 2.0 * error) / self.relative.stretch[1] * (1.0 - 16.0 * HALF_ULP)) as f32)
    }

    /// Marks two children as opened: they have an entry of their own.
    #[inline(always)]
    pub(super) fn mark_opened(&mut self, entry: u32, [host, guest]: [Slot; 2]) {
        if let Some(entry) = self.entries.get_mut(entry as usize) {
            entry.bounds[usize::from(guest.lane)][usize::from(host.lane)] = f32::INFINITY;
        }
    }

    /// Returns the number of entries.
    pub(super) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns the limit for bounds: pairs of children whose bound is above it are farther apart
    /// than `cut`, in metric units.
    #[inline(always)]
    pub(super) fn limit(&self, cut: f64) -> f32 {
        // The limit stays finite, so infinite bounds are above it.
        (cut / self.relative.stretch[0] * (1.0 + 16.0 * HALF_ULP)).min(f64::from(f32::MAX)) as f32
    }

    /// Returns the nodes of an entry, and for each guest lane the host lanes whose bound is not
    /// above `limit`, as bits.
    #[inline(always)]
    pub(super) fn near<S: Simd>(&self, simd: S, entry: u32, limit: f32) -> ([u32; 2], [u32; LANES]) {
        let Entry { nodes, bounds } = &self.entries[entry as usize];
        let limit = f32x8::splat(simd, limit);
        let mut near = [0; LANES];
        for lane in 0..LANES {
            near[lane] = !(load(simd, &bounds[lane]).simd_gt(limit).to_bitmask() as u32) & 0xff;
        }
        (*nodes, near)
    }

    /// Moves the frontier to the current poses. Returns `None` if the meshes have changed or if
    /// resuming costs more than a new search. `cut` is the distance that matters, in metric units.
    pub(super) fn moved(mut self, scene: &Scene<'_>, nodes: &[Node], options: &Options<'_>, cut: f64) -> Option<Self> {
        let relative = scene.bounds.relative?;
        let same = self.stamps == scene.meshes.map(|mesh| mesh.0.stamp) && self.sides == scene.bounds.sides;
        if !same || self.entries.len() > MAX_GROWTH * self.initial_entries {
            return None;
        }
        let motion = Motion::new(&self.relative, &relative);
        self.relative = relative;
        self.beyond = self.outlasting(&motion, nodes, options, cut)?;
        let limit = self.limit(cut);
        let level = options.level;
        let near_pairs = dispatch!(level, simd => self.subtract_motion(simd, &motion, nodes, limit));
        (near_pairs <= self.leaf_pairs).then_some(self)
    }

    /// Subtracts the motion of the guest's parts from the bounds. Returns the number of pairs of
    /// children whose bound is not above `limit`.
    #[inline(always)]
    fn subtract_motion<S: Simd>(&mut self, simd: S, motion: &Motion, nodes: &[Node], limit: f32) -> usize {
        let limit = f32x8::splat(simd, limit);
        let less = f32x8::splat(simd, 1.0 - 2.0 * HALF_ULP as f32);
        let mut near_pairs = 0;
        for entry in &mut self.entries {
            let guest = &nodes[entry.nodes[1] as usize];
            let motions = motion.of_children(simd, guest);
            for lane in bits(lanes_in_use(guest)) {
                let bounds = (load(simd, &entry.bounds[lane]) - f32x8::splat(simd, motions[lane])) * less;
                bounds.store_slice(&mut entry.bounds[lane]);
                near_pairs += (!(bounds.simd_gt(limit).to_bitmask() as u32) & 0xff).count_ones() as usize;
            }
        }
        near_pairs
    }
}

/// Maximum finite bound. Its square does not overflow.
const MAX_BOUND: f32 = 1e19;

/// Returns `bound`, limited to [`MAX_BOUND`], because an infinite bound marks children that have an
/// entry.
#[inline(always)]
fn finite(bound: f32) -> f32 {
    // Not by `f32::min`, which ignores NaN.
    if bound > MAX_BOUND { MAX_BOUND } else { bound }
}

/// Factor that pays for the rounding of the distance of two boxes, seven operations and a root: 1 -
/// 2^-20.
const BOX_ROUNDING: f32 = 1.0 - 1.0 / (1_u32 << 20) as f32;

/// Displacement of points of the guest in the host's packed frame: `linear · point + translation`.
struct Motion {
    linear: [[f32; 3]; 3],
    translation: [f32; 3],
    /// Error bound of the displacement, as a length.
    error: f32,
}

impl Motion {
    fn new(from: &RelativeFrame, to: &RelativeFrame) -> Self {
        let linear = by_axis!(i => by_axis!(j => (to.linear[i][j] - from.linear[i][j]) as f32));
        let translation = by_axis!(i => (to.translation[i] - from.translation[i]) as f32);
        let largest = (0..3).fold(0.0, |most: f64, i| {
            let row = linear[i].iter().map(|x| f64::from(x.abs())).sum::<f64>();
            most.max(row * REACH + f64::from(translation[i].abs()))
        });
        let error = 2.0 * (from.error + to.error + 16.0 * HALF_ULP * largest);
        Self { linear, translation, error: (error as f32).next_up() }
    }

    /// Returns for each child of a node an upper bound of the displacement of the points below it,
    /// in units of the host's packed frame.
    #[inline(always)]
    fn of_children<S: Simd>(&self, simd: S, node: &Node) -> [f32; LANES] {
        let (min, max) = (load3(simd, &node.min), load3(simd, &node.max));
        let half = f32x8::splat(simd, 0.5);
        let center: Lanes3<S> = by_axis!(k => (min[k] + max[k]) * half);
        let extent: Lanes3<S> = by_axis!(k => (max[k] - min[k]) * half);
        let most: Lanes3<S> = by_axis!(i => {
            let row: Lanes3<S> = by_axis!(j => f32x8::splat(simd, self.linear[i][j]));
            let size: Lanes3<S> = by_axis!(j => f32x8::splat(simd, self.linear[i][j].abs()));
            (dot(&row, &center) + f32x8::splat(simd, self.translation[i])).abs() + dot(&size, &extent)
        });
        let motion = dot(&most, &most).sqrt() + f32x8::splat(simd, self.error);
        (motion * f32x8::splat(simd, 1.0 + 8.0 * HALF_ULP as f32)).into()
    }
}

#[cfg(test)]
mod tests;

//! Pairs of leaves that the descent reaches. They are queued until their memory is prefetched, and
//! filtered in bulk. Undecided pairs of faces are decided exactly (docs/notes/proof.md, L9).
//!
//! Guarded by the tests in `engine/ways.rs` and `engine/laws.rs`, and by the benchmark `headline`.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::filter::{Candidates, LeafFaces, SlabTest, Verdicts};
use super::guest_cache::GuestCache;
use super::large_leaf::LargeLeaf;
use super::relation::Relation;
use super::sides::Sides;
use super::wanted::{Deciding, Kept, Wanted};
use crate::budget::Budget;
use crate::exact::{Placement, triangles_intersect};
use crate::hierarchy::{APPROACHES_PER_BATCH, Large, LeafVisitor, Node, overlapping};
use crate::mesh::Mesh;
use crate::mesh::storage::packet::Packets;
use crate::simd::{ALL_LANES, LANES, bits, extend_some, load3, outlined, take_four};

/// Minimum number of queued leaf pairs that are left when a batch is processed. Queuing gives the
/// prefetch of the host leaf time to finish; fewer hide less of its latency.
const MIN_QUEUED_LEAF_PAIRS: usize = 4;

/// Number of leaf pairs per batch. A batch of four leaves the processor less work to overlap.
const LEAF_PAIRS_PER_BATCH: usize = 8;

/// Capacity of the queue: a batch and the pairs that stay queued, all pairs of the guest leaves
/// that come in one go, and four that may be written after the last pair.
const QUEUE_CAPACITY: usize =
    (MIN_QUEUED_LEAF_PAIRS + LEAF_PAIRS_PER_BATCH + APPROACHES_PER_BATCH * LANES + 4).next_power_of_two();

/// Number of guest leaves that are cached in the host's frame. It is a power of two and exceeds the
/// number of guest leaves that can be queued. More than half of all guest leaves come again while
/// they are cached; twice as many would fill the L1 cache and save hardly more.
pub(in crate::mesh) const CACHED_GUEST_LEAVES: usize = 32;

/// Maximum number of undecided pairs that wait. While they wait, the filter may prove another pair
/// intersecting, which costs less than an exact decision. If the surfaces only touch, the filter
/// proves none, and longer waiting is wasted.
const MAX_UNDECIDED_PAIRS: usize = 8;

/// Half of the minimum length at which the list of found pairs is trimmed to those that are kept.
/// A larger value skips less, and a smaller one trims more often.
const HALF_MIN_TRIM_LENGTH: usize = 1 << 10;

/// Work between two checks of the budget, about 100 microseconds. One unit is eight classified
/// candidates.
const WORK_PER_BUDGET_CHECK: usize = 1 << 11;

/// Work of one exact decision: about a microsecond, and 40 if the integers have any size.
const WORK_OF_DECISION: usize = 1 << 6;

/// A pair of leaves in the queue: the slot of the guest leaf in the cache, and the host leaf.
#[derive(Clone, Copy, Debug, Default)]
struct LeafPair {
    guest: u32,
    host_leaf: u32,
}

/// Two meshes, the maps between them, and the pairs that are wanted.
#[derive(Clone, Copy)]
pub(super) struct Question<'a> {
    pub(in crate::mesh) host: &'a Mesh,
    pub(in crate::mesh) guest: &'a Mesh,
    /// Map from guest to host, and back.
    pub(in crate::mesh) relation: &'a Relation,
    pub(in crate::mesh) back: &'a Relation,
    pub(in crate::mesh) placement: &'a Placement,
    /// Which mesh is the host.
    pub(in crate::mesh) sides: Sides,
    pub(in crate::mesh) wanted: Wanted,
    pub(super) kept: &'a Kept<'a>,
    pub(super) budget: &'a Budget<'a>,
}

impl Question<'_> {
    /// Returns an empty queue that caches up to `cached_guests` guest leaves, which must be a power
    /// of two. If that is less than the usual queue length, the queue is processed at that length.
    pub(in crate::mesh) fn pairs(&self, cached_guests: usize) -> LeafPairs<'_> {
        LeafPairs {
            question: *self,
            host_packets: self.host.packets(),
            guest_packets: self.guest.packets(),
            process_at: cached_guests.min(MIN_QUEUED_LEAF_PAIRS + LEAF_PAIRS_PER_BATCH),
            batch_size: cached_guests.min(LEAF_PAIRS_PER_BATCH),
            guests: GuestCache::new(cached_guests),
            queue: [LeafPair::default(); QUEUE_CAPACITY],
            oldest: 0,
            queue_len: 0,
            prefetched: 0,
            candidates: Candidates::EMPTY,
            undecided: Vec::new(),
            found: Vec::new(),
            work: 0,
            is_stopped: false,
        }
    }
}

/// A queue of leaf pairs of two meshes, and the pairs of faces found so far.
pub(super) struct LeafPairs<'a> {
    pub(super) question: Question<'a>,
    host_packets: Packets<'a>,
    guest_packets: Packets<'a>,
    guests: GuestCache,
    /// Queue length at which the oldest pairs are processed.
    process_at: usize,
    /// Number of pairs that are processed as one batch, if there are enough.
    batch_size: usize,
    /// The queued pairs as a ring buffer, with the oldest at `oldest`.
    queue: [LeafPair; QUEUE_CAPACITY],
    oldest: usize,
    queue_len: usize,
    /// Number of queued pairs whose host leaf has already been prefetched.
    prefetched: usize,
    candidates: Candidates,
    /// Undecided pairs of faces, if they are decided last; few more than [`MAX_UNDECIDED_PAIRS`].
    undecided: Vec<[u32; 2]>,
    pub(in crate::mesh) found: Vec<[u32; 2]>,
    /// Work since the last check of the budget.
    work: usize,
    /// Whether the budget ended the search.
    pub(super) is_stopped: bool,
}

impl LeafPairs<'_> {
    /// Processes the oldest pairs of the queue as one batch.
    #[inline(always)]
    fn process_oldest<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        let mut tested = [(LeafPair::default(), SlabTest::default()); LEAF_PAIRS_PER_BATCH];
        let left = outlined(
            simd,
            #[inline(always)]
            || self.test_oldest(simd, &mut tested),
        );
        // Most of these pairs have triangles near each other, so their faces are needed next.
        for (LeafPair { guest, host_leaf }, _) in &tested[..left] {
            self.host_packets.prefetch_leaf(*host_leaf);
            self.guest_packets.prefetch_leaf(self.guests.get(*guest as usize).0);
        }
        // Earlier candidates were written a while ago, so reading them does not stall.
        self.classify(simd, LANES)?;
        let sides = self.question.sides;
        for (LeafPair { guest, host_leaf }, slab_test) in &tested[..left] {
            let (guest_leaf, guest) = self.guests.get(*guest as usize);
            let host = self.host_packets.get(simd, *host_leaf);
            let faces = LeafFaces { host: &host.leaf.faces, guest: &self.guest_packets.leaf(guest_leaf).faces, sides };
            guest.push_candidates(simd, &host, slab_test, &faces, &mut self.candidates);
            self.classify_if_full(simd)?;
        }
        ControlFlow::Continue(())
    }

    /// Tests each of the oldest leaf pairs: the triangles of either packet against the slab of the
    /// other packet. Writes the pairs that may intersect to `tested`, and returns their number.
    #[inline(always)]
    fn test_oldest<S: Simd>(&mut self, simd: S, tested: &mut [(LeafPair, SlabTest); LEAF_PAIRS_PER_BATCH]) -> usize {
        let count = self.queue_len.min(self.batch_size);
        let mut left = 0;
        for at in 0..count {
            let pair = self.queue[(self.oldest + at) % QUEUE_CAPACITY];
            let guest = self.guests.take_pending(pair.guest as usize);
            let host = self.host_packets.get(simd, pair.host_leaf);
            let slab_test = guest.test_slabs(simd, &host, ALL_LANES);
            tested[left] = (pair, slab_test);
            left += usize::from(slab_test.pairs != 0);
        }
        self.oldest = (self.oldest + count) % QUEUE_CAPACITY;
        self.queue_len -= count;
        self.prefetched -= count;
        left
    }

    /// Returns those of `lanes` whose pairs with a guest leaf may still be kept.
    #[cold]
    fn lanes_to_keep(&self, guest_leaf: u32, host: &Node, lanes: u32) -> u32 {
        let last_face = self.question.kept.last_face();
        let may_be_kept =
            |packets: &Packets<'_>, leaf: u32| packets.leaf(leaf).faces.iter().any(|&face| face <= last_face);
        if self.question.sides == Sides::SECOND_HOSTS {
            return if may_be_kept(&self.guest_packets, guest_leaf) { lanes } else { 0 };
        }
        let kept = bits(lanes).filter(|&lane| may_be_kept(&self.host_packets, host.index(lane)));
        kept.fold(0, |kept, lane| kept | 1 << lane)
    }

    /// Classifies candidates at once if a batch is a single leaf pair; otherwise only if little
    /// room is left.
    #[inline(always)]
    fn classify_if_full<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        if self.batch_size == 1 {
            self.classify(simd, 1)
        } else if !self.candidates.has_room() {
            self.classify(simd, LANES)
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Classifies candidates, eight at a time, as long as at least `min_count` are left, and
    /// records the intersecting pairs.
    #[inline(always)]
    fn classify<S: Simd>(&mut self, simd: S, min_count: usize) -> ControlFlow<()> {
        let count = self.candidates.count();
        if count < min_count {
            return ControlFlow::Continue(());
        }
        let mut classified = 0;
        while count.saturating_sub(classified) >= min_count {
            let verdicts = self.candidates.classify(simd, classified);
            self.record(&verdicts)?;
            classified += LANES;
        }
        self.candidates.remove_first(classified);
        ControlFlow::Continue(())
    }

    /// Records intersecting pairs of up to eight candidates, and decides or puts off undecided
    /// ones.
    #[inline(never)]
    fn record(&mut self, verdicts: &Verdicts) -> ControlFlow<()> {
        let (mut intersecting, mut undecided) = (u64::from(verdicts.intersecting), u64::from(verdicts.undecided));
        // If some pairs are undecided, all are recorded in order: see `Deciding::AtOnce`.
        while undecided != 0 {
            let lowest = (intersecting | undecided) & (intersecting | undecided).wrapping_neg();
            let pair = verdicts.faces(lowest.trailing_zeros() as usize);
            if intersecting & lowest != 0 {
                self.found.push(pair);
            } else if self.question.wanted.deciding == Deciding::Last {
                self.undecided.push(pair);
                let [a, b] = self.packets();
                a.prefetch_face(pair[0]);
                b.prefetch_face(pair[1]);
            } else if self.decide(pair) {
                self.found.push(pair);
            }
            intersecting &= !lowest;
            undecided &= !lowest;
        }
        while intersecting != 0 {
            let left = intersecting.count_ones() as usize;
            extend_some(&mut self.found, take_four(&mut intersecting).map(|lane| verdicts.faces(lane)), left);
        }
        let kept = self.question.wanted.kept;
        if self.found.len() / 2 > kept.max(HALF_MIN_TRIM_LENGTH) {
            self.question.kept.trim(&mut self.found, kept);
        }
        self.work += 1;
        if self.work >= WORK_PER_BUDGET_CHECK {
            self.check_budget()?;
        }
        // The pairs that one call adds, and those that it decides.
        let few = LANES + 2 * MAX_UNDECIDED_PAIRS;
        if self.found.len() > HALF_MIN_TRIM_LENGTH && !self.question.budget.reserve(&mut self.found, few) {
            return ControlFlow::Break(());
        }
        self.continue_or_stop(MAX_UNDECIDED_PAIRS)
    }

    /// Breaks if the budget ends the search.
    #[cold]
    fn check_budget(&mut self) -> ControlFlow<()> {
        self.work = 0;
        self.is_stopped = self.question.budget.is_spent();
        if self.is_stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Decides the queued pairs if there are more than `max_undecided` of them. Returns
    /// `Break` if enough pairs are found.
    #[inline(always)]
    fn continue_or_stop(&mut self, max_undecided: usize) -> ControlFlow<()> {
        if self.found.len() < self.question.wanted.limit && self.undecided.len() > max_undecided {
            self.decide_undecided();
        }
        if self.found.len() < self.question.wanted.limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    /// Decides the queued pairs until enough pairs are found.
    #[cold]
    fn decide_undecided(&mut self) {
        let [a, b] = self.packets();
        for &[face_a, face_b] in &self.undecided {
            a.prefetch_vertices(face_a);
            b.prefetch_vertices(face_b);
        }
        while self.found.len() < self.question.wanted.limit
            && let Some(pair) = self.undecided.pop()
        {
            if self.decide(pair) {
                self.found.push(pair);
            }
        }
    }

    /// Returns the packets of the first mesh and of the second.
    #[inline(always)]
    fn packets(&self) -> [Packets<'_>; 2] {
        self.question.sides.first_second([self.host_packets, self.guest_packets])
    }

    /// Decides exactly whether two faces, of the first mesh and of the second, intersect.
    #[cold]
    fn decide(&mut self, [face_a, face_b]: [u32; 2]) -> bool {
        let Question { host, guest, placement, sides, .. } = self.question;
        let [a, b] = sides.first_second([host, guest]);
        self.work += WORK_OF_DECISION;
        triangles_intersect(placement, &a.corners(face_a), &b.corners(face_b))
    }
}

impl LeafVisitor for LeafPairs<'_> {
    #[inline(always)]
    fn approach<S: Simd>(&mut self, simd: S, guest_leaf: u32, host: &Node, lanes: u32) {
        let Question { relation, back, .. } = self.question;
        let bounds = self.guests.load(simd, guest_leaf, &self.guest_packets, relation, back);
        let mut near = lanes & overlapping(simd, (&load3(simd, &host.min), &load3(simd, &host.max)), &bounds);
        if self.question.kept.last_face() < u32::MAX {
            near = self.lanes_to_keep(guest_leaf, host, near);
        }
        let guest = self.guests.add_pending(near.count_ones());
        let mut end = self.oldest + self.queue_len;
        self.queue_len += near.count_ones() as usize;
        let mut left = u64::from(near);
        while left != 0 {
            for (at, lane) in take_four(&mut left).into_iter().enumerate() {
                self.queue[(end + at) % QUEUE_CAPACITY] = LeafPair { guest, host_leaf: host.index(lane % LANES) };
            }
            end += 4;
        }
    }

    #[inline(always)]
    fn process<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        for at in self.prefetched..self.queue_len {
            self.host_packets.prefetch(self.queue[(self.oldest + at) % QUEUE_CAPACITY].host_leaf);
        }
        self.prefetched = self.queue_len;
        while self.queue_len >= self.process_at {
            self.process_oldest(simd)?;
        }
        ControlFlow::Continue(())
    }

    fn process_below<S: Simd>(&mut self, simd: S, large: Large, node: u32) -> ControlFlow<()> {
        let Question { relation, back, host, guest, sides, .. } = self.question;
        let host = (host.0.tree.nodes(), self.host_packets);
        let guest = (guest.0.tree.nodes(), self.guest_packets);
        outlined(
            simd,
            #[inline(always)]
            || {
                let (other, own, [onto, from], sides) = match large {
                    Large::Guest(leaf) => (host, guest.1.get(simd, leaf), [relation, back], sides),
                    Large::Host(leaf) => (guest, host.1.get(simd, leaf), [back, relation], sides.exchanged()),
                };
                let large = LargeLeaf::new(simd, &own, onto, from);
                large.descend(
                    simd,
                    other,
                    node,
                    #[inline(always)]
                    |guest, host, slab_test| {
                        let faces = LeafFaces { host: &host.leaf.faces, guest: &own.leaf.faces, sides };
                        guest.push_candidates(simd, host, slab_test, &faces, &mut self.candidates);
                        self.classify_if_full(simd)
                    },
                )
            },
        )
    }

    #[inline(always)]
    fn finish<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        while self.queue_len > 0 {
            self.process_oldest(simd)?;
        }
        self.classify(simd, 1)?;
        self.continue_or_stop(0)
    }

    #[inline(always)]
    fn prefetch_addresses(&self, guest_leaf: u32, host_leaf: u32) {
        self.guest_packets.prefetch_place(guest_leaf);
        self.host_packets.prefetch_place(host_leaf);
    }

    #[inline(always)]
    fn prefetch_guest(&self, leaf: u32) {
        self.guest_packets.prefetch(leaf);
    }
}

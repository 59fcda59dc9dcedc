//! Pairs of leaves that the descent comes to: put off until their memory is at hand, filtered in bulk, and what the filter
//! leaves undecided decided exactly.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::filter::{Candidates, SlabTest, LeafFaces, Verdicts};
use super::large_leaf::LargeLeaf;
use super::relation::Relation;
use super::sides::Sides;
use super::guest_cache::GuestCache;
use crate::exact::{Placement, triangles_intersect};
use crate::hierarchy::{APPROACHED, Large, LeafVisitor, Node, overlapping};
use crate::mesh::Mesh;
use crate::mesh::storage::packet::Packets;
use crate::simd::{ALL_LANES, LANES, bits, extend_some, load3, outlined, take_four};

/// So many pairs of leaves wait for the host leaf's memory, at min_count: fewer hide less of its latency.
const MIN_QUEUED_LEAF_PAIRS: usize = 4;

/// So many pairs of leaves are met in one go: with 4 there is less for the processor to work ahead on.
const LEAF_PAIRS_PER_BATCH: usize = 8;

/// Room for all that wait, for what comes of guest leaves that are taken up in one go, and for what is written after the last, as four are noted at a time.
const QUEUE_CAPACITY: usize = (MIN_QUEUED_LEAF_PAIRS + LEAF_PAIRS_PER_BATCH + APPROACHED * LANES + 4).next_power_of_two();

/// Guest leaves that are kept taken up; a power of two, more than wait. More than half of all come again while they are; twice as
/// many would fill the first cache and hardly save more.
pub(in crate::mesh) const CACHED_GUEST_LEAVES: usize = 32;

/// With more pairs put off than this, they are decided. One takes as long as some leaves to meet, any of which may hold a pair that
/// the filter is sure of; where surfaces touch, none does, and looking on is in vain.
const MAX_UNDECIDED_PAIRS: usize = 8;

/// Half of the pairs that there is always room for, 256 KiB: less would save nothing.
const MIN_TRIM_LENGTH: usize = 1 << 14;

/// When pairs that the filter leaves undecided are decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Deciding {
    /// At once: where only some pairs are wanted, they are the first ones in the order of the descent, which is the same for
    /// every vector unit.
    AtOnce,
    /// Once nothing else is left, or too many wait: their faces and vertices are asked for meanwhile, and the filter may be sure of
    /// another pair; of which, differs between vector units.
    Last,
}

/// Which of the pairs that meet are wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// With so many the descent is over.
    pub(in crate::mesh) limit: usize,
    /// How many of the min_count are kept, of those found.
    pub(in crate::mesh) kept: usize,
    pub(super) deciding: Deciding,
}

impl Wanted {
    pub(in crate::mesh) const ALL: Self = Self { limit: usize::MAX, kept: usize::MAX, deciding: Deciding::Last };
}

/// A guest leaf taken up, by its place among them, and a host leaf that it will meet.
#[derive(Clone, Copy, Debug, Default)]
struct LeafPair {
    guest: u32,
    host_leaf: u32,
}

/// Two meshes, how they lie to each other, and which of their pairs are wanted.
#[derive(Clone, Copy)]
pub(super) struct Question<'a> {
    pub(in crate::mesh) host: &'a Mesh,
    pub(in crate::mesh) guest: &'a Mesh,
    pub(in crate::mesh) relation: &'a Relation,
    pub(in crate::mesh) back: &'a Relation,
    pub(in crate::mesh) placement: &'a Placement,
    /// Which mesh is the host.
    pub(in crate::mesh) sides: Sides,
    pub(in crate::mesh) wanted: Wanted,
}

impl Question<'_> {
    /// No pairs so far; at most so many guest leaves are kept, a power of two, and no more pairs wait.
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
            last_face: u32::MAX,
        }
    }
}

/// Leaf pairs of two meshes, filtered and decided.
pub(super) struct LeafPairs<'a> {
    question: Question<'a>,
    host_packets: Packets<'a>,
    guest_packets: Packets<'a>,
    guests: GuestCache,
    /// With so many put off the oldest are met.
    process_at: usize,
    /// So many of them, where there are.
    batch_size: usize,
    /// Those that are, the oldest at `next`.
    queue: [LeafPair; QUEUE_CAPACITY],
    oldest: usize,
    queue_len: usize,
    /// Of so many of these the host leaf's memory is on its way.
    prefetched: usize,
    candidates: Candidates,
    /// Pairs that the filter left undecided, where they are decided last; few more than [`MAX_UNDECIDED_PAIRS`].
    undecided: Vec<[u32; 2]>,
    pub(in crate::mesh) found: Vec<[u32; 2]>,
    /// The pairs to keep are found already, but for pairs of faces of the first mesh up to this number.
    last_face: u32,
}

impl LeafPairs<'_> {
    /// Meets the pairs that have waited longest.
    #[inline(always)]
    fn process_oldest<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        let mut slab_test = [(LeafPair::default(), SlabTest::default()); LEAF_PAIRS_PER_BATCH];
        let left = outlined(
            simd,
            #[inline(always)]
            || self.test_oldest(simd, &mut slab_test),
        );
        // Most of these have triangles that are near each other, whose faces are looked up then.
        for (LeafPair { guest, host_leaf }, _) in &slab_test[..left] {
            self.host_packets.prefetch_leaf(*host_leaf);
            self.guest_packets.prefetch_leaf(self.guests.get(*guest as usize).0);
        }
        // What the pairs before these came to was written a while ago, and is at hand.
        self.classify(simd, LANES)?;
        let sides = self.question.sides;
        for (LeafPair { guest, host_leaf }, slab_test) in &slab_test[..left] {
            let (guest_leaf, guest) = self.guests.get(*guest as usize);
            let host = self.host_packets.get(simd, *host_leaf);
            let faces = LeafFaces { host: &host.leaf.faces, guest: &self.guest_packets.leaf(guest_leaf).faces, sides };
            guest.push_candidates(simd, &host, slab_test, &faces, &mut self.candidates);
            self.classify_if_full(simd)?;
        }
        ControlFlow::Continue(())
    }

    /// Finds out how the oldest pairs face each other; returns how many may meet.
    #[inline(always)]
    fn test_oldest<S: Simd>(&mut self, simd: S, slab_test: &mut [(LeafPair, SlabTest); LEAF_PAIRS_PER_BATCH]) -> usize {
        let count = self.queue_len.min(self.batch_size);
        let mut left = 0;
        for at in 0..count {
            let pair = self.queue[(self.oldest + at) % QUEUE_CAPACITY];
            let guest = self.guests.take_pending(pair.guest as usize);
            let host = self.host_packets.get(simd, pair.host_leaf);
            let met = guest.test_slabs(simd, &host, ALL_LANES);
            slab_test[left] = (pair, met);
            left += usize::from(met.pairs != 0);
        }
        self.oldest = (self.oldest + count) % QUEUE_CAPACITY;
        self.queue_len -= count;
        self.prefetched -= count;
        left
    }

    /// The host leaves among these whose pairs with a guest leaf may be kept.
    #[cold]
    fn lanes_to_keep(&self, guest_leaf: u32, host: &Node, lanes: u32) -> u32 {
        let may_be_kept =
            |packets: &Packets<'_>, leaf: u32| packets.leaf(leaf).faces.iter().any(|&face| face <= self.last_face);
        if self.question.sides == Sides::SECOND_HOSTS {
            return if may_be_kept(&self.guest_packets, guest_leaf) { lanes } else { 0 };
        }
        let kept = bits(lanes).filter(|&lane| may_be_kept(&self.host_packets, host.index(lane)));
        kept.fold(0, |kept, lane| kept | 1 << lane)
    }

    /// Judges candidates where no pair waits for another, or where there is little room.
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

    /// Judges candidates, eight at a time, while there are so many at min_count, and keeps what meets.
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

    /// Decides what the filter left undecided of candidates, and keeps what meets.
    #[inline(never)]
    fn record(&mut self, verdicts: &Verdicts) -> ControlFlow<()> {
        let (mut intersecting, mut undecided) = (u64::from(verdicts.intersecting), u64::from(verdicts.undecided));
        // Where some are undecided, all are taken in order: see `Deciding::AtOnce`.
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
        if self.found.len() / 2 > kept.max(MIN_TRIM_LENGTH) {
            keep_smallest(&mut self.found, kept);
            if self.found.len() == kept {
                self.last_face = self.found.iter().map(|pair| pair[0]).max().unwrap_or(u32::MAX);
            }
        }
        self.continue_or_stop(MAX_UNDECIDED_PAIRS)
    }

    /// Breaks off where enough is found; before that, decides what was put off where that is more than so many pairs.
    #[inline(always)]
    fn continue_or_stop(&mut self, max_undecided: usize) -> ControlFlow<()> {
        if self.found.len() < self.question.wanted.limit && self.undecided.len() > max_undecided {
            self.decide_undecided();
        }
        if self.found.len() < self.question.wanted.limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    /// Decides the pairs that were put off, until enough meet.
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

    /// The packets of the first mesh and of the second.
    #[inline(always)]
    fn packets(&self) -> [Packets<'_>; 2] {
        self.question.sides.first_second([self.host_packets, self.guest_packets])
    }

    /// Whether two faces, of the first mesh and of the second, meet.
    #[cold]
    fn decide(&self, [face_a, face_b]: [u32; 2]) -> bool {
        let Question { host, guest, placement, sides, .. } = self.question;
        let [a, b] = sides.first_second([host, guest]);
        triangles_intersect(placement, &a.corners(face_a), &b.corners(face_b))
    }
}

impl LeafVisitor for LeafPairs<'_> {
    #[inline(always)]
    fn approach<S: Simd>(&mut self, simd: S, guest_leaf: u32, host: &Node, lanes: u32) {
        let Question { relation, back, .. } = self.question;
        let bounds = self.guests.load(simd, guest_leaf, &self.guest_packets, relation, back);
        let mut near = lanes & overlapping(simd, (&load3(simd, &host.min), &load3(simd, &host.max)), &bounds);
        if self.last_face < u32::MAX {
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
    fn meet<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        for at in self.prefetched..self.queue_len {
            self.host_packets.prefetch(self.queue[(self.oldest + at) % QUEUE_CAPACITY].host_leaf);
        }
        self.prefetched = self.queue_len;
        while self.queue_len >= self.process_at {
            self.process_oldest(simd)?;
        }
        ControlFlow::Continue(())
    }

    fn meet_below<S: Simd>(&mut self, simd: S, large: Large, node: u32) -> ControlFlow<()> {
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
    fn prefetch_places(&self, guest_leaf: u32, host_leaf: u32) {
        self.guest_packets.prefetch_place(guest_leaf);
        self.host_packets.prefetch_place(host_leaf);
    }

    #[inline(always)]
    fn prefetch_guest(&self, leaf: u32) {
        self.guest_packets.prefetch(leaf);
    }
}

/// Leaves the min_count pairs, so many where there are more.
pub(super) fn keep_smallest(pairs: &mut Vec<[u32; 2]>, kept: usize) {
    if pairs.len() > kept {
        pairs.select_nth_unstable(kept);
        pairs.truncate(kept);
    }
}

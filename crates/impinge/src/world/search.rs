//! The search for the candidate pairs that a step changes. It reads the world and changes nothing.

use rayon::prelude::*;

use super::broad::{Among, KnownPairs};
use super::error::WorldError;
use super::outline::Bounds;
use super::pairs::Link;
use super::{Change, Kind, State, World};
use crate::budget::Budget;
use crate::storage::{TryPush, try_concat};

/// Minimum number of bodies or pairs per parallel task. With fewer, starting a task costs more than
/// it saves.
const MIN_TASK: usize = 64;

/// Maximum number of bodies of a step that moves and compares boxes on the caller's thread. Other
/// threads take up to a tenth of a millisecond to wake, and this number of bodies takes twice as
/// long.
pub(super) const MAX_ALONE: usize = 512;

/// Reports whether a loop over `count` items stays on the caller's thread: if there are at most
/// `max_alone`, or if there is only one thread, which would have to wake.
pub(super) fn is_alone(count: usize, max_alone: usize) -> bool {
    count <= max_alone || rayon::current_num_threads() == 1
}

/// Returns the minimum number of items per parallel task of a loop over `count` bodies or pairs of
/// bodies.
pub(super) fn min_task(count: usize) -> usize {
    if is_alone(count, MAX_ALONE) { count.max(1) } else { MIN_TASK }
}

/// The candidate pairs of which a body changed.
#[derive(Debug, Default)]
pub(super) struct Candidates {
    /// Pairs whose boxes ceased to overlap, or that are no longer admitted.
    pub(super) lost: Vec<u32>,
    /// Pairs that persist.
    pub(super) kept: Vec<u32>,
    /// Slots of the bodies of the pairs that are new, each pair once, in the order of reports.
    pub(super) found: Vec<[u32; 2]>,
}

impl World {
    /// Returns the candidate pairs of which a body changed.
    ///
    /// # Errors
    /// Returns [`Stopped`](WorldError::Stopped) if the budget is spent, or if the memory for the
    /// pairs cannot be allocated.
    pub(super) fn changed_candidates(
        &self,
        changed: &[u32],
        known: &KnownPairs,
        budget: &Budget<'_>,
    ) -> Result<Candidates, WorldError> {
        let search = Search { world: self, known, are_bounded: self.state.broad.are_bounded(Among::All) };
        let of_chunk = |changed: &[u32]| -> Result<Candidates, WorldError> {
            let mut candidates = Candidates::default();
            for &place in changed {
                budget.check()?;
                search.of(place, &mut candidates)?;
            }
            Ok(candidates)
        };
        let chunks: Vec<Candidates> =
            changed.par_chunks(min_task(changed.len())).map(of_chunk).collect::<Result<_, _>>()?;
        let known = match known {
            KnownPairs::Nothing => &[],
            KnownPairs::Changes(changes) => changes.began(),
            KnownPairs::All(pairs) => &pairs[..],
        };
        let of_chunk = |known: &[[u32; 2]]| -> Result<Vec<[u32; 2]>, WorldError> {
            let mut found = Vec::new();
            for pairs in known.chunk_by(|one, other| one[0] == other[0]) {
                budget.check()?;
                search.of_known(pairs, &mut found)?;
            }
            Ok(found)
        };
        let new: Vec<Vec<[u32; 2]>> = known.par_chunks(KNOWN_PER_TASK).map(of_chunk).collect::<Result<_, _>>()?;
        let (mut lost, mut kept, mut found) = (Vec::new(), Vec::new(), new);
        for candidates in chunks {
            lost.push(candidates.lost);
            kept.push(candidates.kept);
            found.push(candidates.found);
        }
        let mut found = try_concat(found)?;
        found.par_sort_unstable();
        found.dedup();
        let task = min_task(found.len());
        found.par_iter_mut().with_min_len(task).for_each(|pair| {
            if self.is_before(pair[1], pair[0]) {
                pair.swap(0, 1);
            }
        });
        Ok(Candidates { lost: try_concat(lost)?, kept: try_concat(kept)?, found })
    }

    /// Reports whether the bodies in two slots are admitted as a pair.
    fn may_collide(&self, one: u32, other: u32) -> bool {
        let residents = &self.state.residents;
        let (Some(one), Some(other)) = (residents.at(one), residents.at(other)) else { return false };
        let is_before = (one.1.traits.tag, one.0) < (other.1.traits.tag, other.0);
        if is_before { self.admits(one, other) } else { self.admits(other, one) }
    }

    /// Reports whether the body in one slot is reported before the body in another slot.
    fn is_before(&self, one: u32, other: u32) -> bool {
        let key = |index| self.state.residents.at(index).map(|(id, resident)| (resident.traits.tag, id));
        key(one) < key(other)
    }
}

/// Number of pairs that the broad phase reported and that a task compares with the stored pairs.
/// With fewer, starting a task costs more than it saves; with more, tasks are uneven.
const KNOWN_PER_TASK: usize = 1 << 12;

/// Maximum number of pairs of a body that are searched one by one. Longer lists are sorted first.
const MAX_UNSORTED: usize = 16;

/// The bodies with which a body already forms pairs.
enum Partners<'w> {
    Few(&'w [Link]),
    Sorted(Vec<u32>),
}

impl<'w> Partners<'w> {
    fn of(links: &'w [Link]) -> Self {
        if links.len() <= MAX_UNSORTED {
            return Self::Few(links);
        }
        let mut others: Vec<u32> = links.iter().map(|link| link.other).collect();
        others.sort_unstable();
        Self::Sorted(others)
    }

    fn contain(&self, other: u32) -> bool {
        match self {
            Self::Few(links) => links.iter().any(|link| link.other == other),
            Self::Sorted(others) => others.binary_search(&other).is_ok(),
        }
    }
}

/// Search for the pairs of changed bodies.
struct Search<'w> {
    world: &'w World,
    known: &'w KnownPairs,
    /// Whether a box bounds each body.
    are_bounded: bool,
}

impl Search<'_> {
    fn state(&self) -> &State {
        &self.world.state
    }

    fn kind(&self, index: u32) -> Kind {
        self.state().residents.at(index).map_or_else(Kind::default, |(_, resident)| resident.traits.kind)
    }

    /// Reports whether pairs of the body in this slot must be searched for. If not, the broad phase
    /// has reported them. `is_across` is `true` for pairs of a moving and a guided body.
    fn asks(&self, index: u32, is_across: bool) -> bool {
        let change = self.state().changed.of(index);
        match self.known {
            KnownPairs::Nothing => change > Change::No,
            KnownPairs::Changes(_) => change > if is_across { Change::No } else { Change::Moved },
            KnownPairs::All(_) => false,
        }
    }

    /// Reports whether the pair of a changed body with another body is handled by the other body.
    ///
    /// If both bodies search for the pair, or if both changed and do not search, the body in the
    /// smaller slot handles it. If one body searches, that body handles it.
    fn is_others(&self, index: u32, other: u32) -> bool {
        // The choice depends on the sets only if the broad phase knows the pairs of one set.
        let is_across = matches!(self.known, KnownPairs::Changes(_))
            && (self.kind(index) == Kind::Moving) != (self.kind(other) == Kind::Moving);
        match (self.asks(index, is_across), self.asks(other, is_across)) {
            (false, false) => other < index && self.state().changed.of(other) != Change::No,
            (true, true) => other < index,
            (_, asks) => asks,
        }
    }

    /// Adds the pairs that a changed body handles. Pairs of which no body searches are among the
    /// known pairs, unless one of the bodies has no bounding box.
    fn of(&self, index: u32, candidates: &mut Candidates) -> Result<(), WorldError> {
        let state = self.state();
        let links = state.pairs.of(index);
        let (asks_own, asks_across) = (self.asks(index, false), self.asks(index, true));
        let is_done = !asks_across && self.are_bounded;
        if is_done && links.is_empty() {
            return Ok(()); // the common case if many bodies move
        }
        let bounds = state.bounds_of(index);
        for link in links.iter().filter(|link| !self.is_others(index, link.other)) {
            let is_filtered = || state.changed.of(index).max(state.changed.of(link.other)) == Change::Traits;
            let is_lost = !bounds.overlap(state.bounds_of(link.other))
                || is_filtered() && !self.world.may_collide(index, link.other);
            let list = if is_lost { &mut candidates.lost } else { &mut candidates.kept };
            list.try_push(link.pair)?;
        }
        if is_done {
            return Ok(());
        }
        let partners = Partners::of(links);
        let mut pushed = Ok(());
        let mut offer = |other: u32| {
            if other != index
                && pushed.is_ok()
                && !self.is_others(index, other)
                && bounds.overlap(state.bounds_of(other))
                && self.world.may_collide(index, other)
                && !partners.contain(other)
            {
                pushed = candidates.found.try_push([index.min(other), index.max(other)]);
            }
        };
        let kind = self.kind(index);
        let among = Among::partners_of(kind);
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => {
                let searched = match (asks_own || kind != Kind::Moving, asks_across) {
                    (_, false) => None,
                    (true, true) => Some(among),
                    (false, true) => Some(Among::Guided),
                };
                if let Some(searched) = searched {
                    state.broad.for_each_overlapping(searched, bounds, &mut offer);
                }
                state.broad.for_each_unbounded(among, &mut offer);
            }
            Bounds::Behind(_) | Bounds::Anywhere => state.broad.for_each(among, &mut offer),
        }
        Ok(pushed?)
    }

    /// Adds the new pairs among overlapping pairs that the broad phase reported. All have the same
    /// first body.
    fn of_known(&self, pairs: &[[u32; 2]], found: &mut Vec<[u32; 2]>) -> Result<(), WorldError> {
        let state = self.state();
        let Some(&[one, _]) = pairs.first() else { return Ok(()) };
        let partners = Partners::of(state.pairs.of(one));
        for &[one, other] in pairs {
            let is_changed = state.changed.of(one).max(state.changed.of(other)) != Change::No;
            if is_changed && !partners.contain(other) && self.world.may_collide(one, other) {
                found.try_push([one.min(other), one.max(other)])?;
            }
        }
        Ok(())
    }
}

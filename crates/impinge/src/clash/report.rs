//! The answer of a search: clashes, duplicates, groups and counts.

use std::collections::HashMap;
use std::sync::Arc;

use super::decades::Decades;
use super::groups::{Group, Grouping, groups};
use super::identity::identity;
use super::kinds::{Kind, Why};
use super::sides::Member;
use super::status::{Gone, Status};
use crate::budget::Stopped;
use crate::query::Curves;

/// A pair of parts that a report lists.
#[derive(Clone, Debug, PartialEq)]
pub struct Clash {
    /// Identity, which stays the same from one report to the next. See [`identity`].
    pub id: String,
    /// Kind of the pair.
    pub kind: Kind,
    /// The part whose `label/key` comes first in the alphabet.
    pub a: Arc<Member>,
    /// The other part.
    pub b: Arc<Member>,
    /// Index of the rule that named the pair, or `None` if there are no rules.
    pub rule: Option<usize>,
    /// Severity that the rule states.
    pub severity: Option<String>,
    /// Status, which carries over from the previous report.
    pub status: Status,
    /// Depth or gap at which the clash was reviewed or approved, in world units.
    pub accepted: Option<f64>,
    /// Remark, which carries over from the previous report.
    pub note: Option<String>,
    /// Lower and upper bound of the depth, in world units. The upper bound is infinite if it was
    /// only proved that the depth exceeds the tolerance.
    pub depth: Option<[f64; 2]>,
    /// Lower and upper bound of the gap, in world units.
    pub gap: Option<[f64; 2]>,
    /// Lower and upper bound of the volume of the common material, in cubed world units.
    pub volume: Option<[f64; 2]>,
    /// Curves in which the surfaces of the parts intersect, if
    /// [`trace_curves`](Report::trace_curves) was called. `None` if a part is not a mesh, or if
    /// there is a gap between the parts.
    pub curves: Option<Curves>,
    /// Point that shows where the parts meet, in the world frame.
    pub point: Option<[f64; 3]>,
    /// The nearest faces of `a` and `b` to the point. `None` unless both are meshes.
    pub faces: Option<[u32; 2]>,
    /// Direction of length 1 in which `b` leaves `a` near the point, or faces it across the gap, in
    /// the world frame.
    pub normal: Option<[f64; 3]>,
    /// Lower and upper corner of the box where the boxes of the parts overlap, or of the box
    /// between them, in the world frame. `None` if a part is unbounded.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Whether the kind is proved.
    pub proved: bool,
    /// Reason why the kind is not proved.
    pub why: Option<Why>,
    /// Whether the box of `b` is smaller than that of `a`, so that sentences begin with `b`.
    pub(super) subject_is_b: bool,
}

/// Parts that are the same shape in the same place.
#[derive(Clone, Debug, PartialEq)]
pub struct DuplicateSet {
    /// Identity. For two parts it is that of the pair.
    pub id: String,
    /// The parts, sorted by `label/key`.
    pub parts: Vec<Arc<Member>>,
    /// Index of the rule that named the first pair of the set, or `None` if there are no rules.
    pub rule: Option<usize>,
    /// Severity that the rule states.
    pub severity: Option<String>,
    /// Status, which carries over from the previous report.
    pub status: Status,
    /// Remark, which carries over from the previous report.
    pub note: Option<String>,
}

/// Numbers of pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pairs whose boxes are near each other. All other pairs are clear.
    pub candidates: usize,
    /// Candidates that no rule names.
    pub unchecked: usize,
    /// Candidates that an ignore names.
    pub ignored: usize,
    /// Pairs of duplicates. A set of n duplicates has n (n - 1) / 2 pairs.
    pub duplicate: usize,
    /// Pairs of which one part lies inside the other.
    pub contained: usize,
    /// Pairs that share material deeper than the tolerance.
    pub clash: usize,
    /// Pairs of which nothing was proved.
    pub undecided: usize,
    /// Pairs that touch.
    pub contact: usize,
    /// Pairs whose gap is at most the clearance.
    pub clearance: usize,
    /// Candidates that were checked and are clear.
    pub clear: usize,
}

/// The answer of a search for clashes.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Numbers of pairs by kind.
    pub counts: Counts,
    /// Numbers of pairs by depth.
    pub decades: Decades,
    /// Sets of duplicates, sorted by their first part.
    pub duplicates: Vec<DuplicateSet>,
    /// Groups of clashes, the largest first.
    pub groups: Vec<Group>,
    /// The pairs, the worst first: by kind, then by depth, then by parts. Duplicates are not among
    /// them.
    pub clashes: Vec<Clash>,
    /// Clashes of the previous report that no longer exist; `None` without a previous report.
    pub gone: Option<Vec<Gone>>,
    /// Number of candidates that each rule named.
    pub checked_by_rule: Vec<usize>,
    /// Number of candidates that each ignore named.
    pub ignored_by_rule: Vec<usize>,
    /// The limit of the budget that was reached first. The pairs that were left are undecided.
    pub stopped: Option<Stopped>,
}

impl Counts {
    /// Returns the counter of a kind.
    pub(super) fn of(&mut self, kind: Kind) -> &mut usize {
        match kind {
            Kind::Duplicate => &mut self.duplicate,
            Kind::Contained(_) => &mut self.contained,
            Kind::Clash => &mut self.clash,
            Kind::Undecided => &mut self.undecided,
            Kind::Contact => &mut self.contact,
            Kind::Clearance => &mut self.clearance,
            Kind::Clear => &mut self.clear,
        }
    }
}

impl Report {
    /// Reports whether the scenes are clear: all clashes, duplicates and gaps below the clearance
    /// are approved. Contacts do not count.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        let is_accepted = |status| status == Status::Approved;
        self.clashes.iter().all(|clash| clash.kind == Kind::Contact || is_accepted(clash.status))
            && self.duplicates.iter().all(|set| is_accepted(set.status))
    }

    /// Returns the clashes in groups of any kind. [`groups`](Self::groups) has those of the search.
    #[must_use]
    pub fn grouped(&self, grouping: Grouping) -> Vec<Group> {
        let pairs: Vec<_> = self.clashes.iter().map(|clash| [&clash.a, &clash.b]).collect();
        groups(&pairs, grouping)
    }

    /// Returns the number of clashes and duplicate sets with a status.
    #[must_use]
    pub fn count_of(&self, status: Status) -> usize {
        let clashes = self.clashes.iter().filter(|clash| clash.status == status).count();
        clashes + self.duplicates.iter().filter(|set| set.status == status).count()
    }
}

/// Sorts clashes, the worst first.
pub(super) fn sort(clashes: &mut [Clash]) {
    let worst = |clash: &Clash| match (clash.depth, clash.gap) {
        (Some([lower, _]), _) => -lower,
        (None, Some([_, upper])) => upper,
        (None, None) => 0.0,
    };
    let rank = |kind: Kind| match kind {
        Kind::Contained(_) => Kind::Contained(super::kinds::Inner::A),
        kind => kind,
    };
    clashes.sort_by(|a, b| {
        let by_kind = rank(a.kind).cmp(&rank(b.kind));
        let by_parts =
            || (&a.a.scene, &a.a.key, &a.b.scene, &a.b.key).cmp(&(&b.a.scene, &b.a.key, &b.b.scene, &b.b.key));
        by_kind.then_with(|| worst(a).total_cmp(&worst(b))).then_with(by_parts)
    });
}

/// Joins pairs of duplicates to sets. Pairs are indices of members with the index of a rule,
/// sorted. Each set has its members in order, and the rule of its first pair.
pub(super) fn duplicate_sets(pairs: &[([u32; 2], Option<usize>)]) -> Vec<(Vec<u32>, Option<usize>)> {
    // The least member of a set stands for it.
    let mut parents: HashMap<u32, u32> = HashMap::new();
    fn root(parents: &HashMap<u32, u32>, mut member: u32) -> u32 {
        while let Some(&parent) = parents.get(&member).filter(|&&parent| parent != member) {
            member = parent;
        }
        member
    }
    for &([a, b], _) in pairs {
        let [a, b] = [a, b].map(|member| root(&parents, member));
        parents.insert(a.max(b), a.min(b));
        parents.entry(a.min(b)).or_insert(a.min(b));
    }
    let mut members: Vec<(u32, u32)> = parents.keys().map(|&member| (root(&parents, member), member)).collect();
    members.sort_unstable();
    let mut rules: HashMap<u32, Option<usize>> = HashMap::new();
    for &([a, _], rule) in pairs {
        rules.entry(root(&parents, a)).or_insert(rule);
    }
    let sets = members.chunk_by(|a, b| a.0 == b.0);
    sets.map(|set| (set.iter().map(|&(_, member)| member).collect(), rules[&set[0].0])).collect()
}

/// Returns the identity of parts.
pub(super) fn identity_of<'m>(parts: impl IntoIterator<Item = &'m Arc<Member>>) -> String {
    identity(&parts.into_iter().map(|member| member.identity()).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duplicates_are_joined_to_sets() {
        let pairs =
            [([0, 3], Some(1)), ([0, 5], None), ([1, 2], Some(2)), ([3, 5], None), ([4, 6], None), ([5, 6], None)];
        assert_eq!(duplicate_sets(&pairs), [(vec![0, 3, 4, 5, 6], Some(1)), (vec![1, 2], Some(2))]);
        assert_eq!(duplicate_sets(&[]), []);
    }
}

//! The subject of a picture: two parts, and where they meet.

use impinge::clash::{Clash, DuplicateSet, Inner, Kind, Member};
use impinge::query;

use super::bounds::{self, Bounds, around, radius};
use super::parts::Parts;
use super::vector::Vector;

/// Two parts of some scenes, and where they meet.
pub(super) struct Subject {
    /// Indices of the parts.
    pub(super) parts: [usize; 2],
    /// Index of the part in `parts` that lies around the other, if one does.
    pub(super) outer: Option<usize>,
    /// Box of the curves and the point; or where the boxes of the parts overlap, or between them.
    pub(super) contact: Bounds,
    /// Point that shows where the parts meet.
    pub(super) point: Option<Vector>,
    /// Curves in which the surfaces intersect.
    pub(super) curves: Vec<Vec<Vector>>,
}

impl Subject {
    /// Returns the subject of a clash, or `None` if a part is unbounded.
    pub(super) fn of_clash(parts: &Parts<'_>, clash: &Clash) -> Option<Self> {
        let outer = match clash.kind {
            Kind::Contained(Inner::A) => Some(1),
            Kind::Contained(Inner::B) => Some(0),
            _ => None,
        };
        let subject = Self::new(parts, [&clash.a, &clash.b], clash.point, clash.bounds)?;
        Some(Self { outer, ..subject })
    }

    /// Returns the subject of a set of duplicates, of which it has the first two, or `None` if they
    /// are unbounded.
    pub(super) fn of_duplicates(parts: &Parts<'_>, set: &DuplicateSet) -> Option<Self> {
        let subject = Self::new(parts, [&set.parts[0], &set.parts[1]], None, None)?;
        // The surfaces of duplicates intersect everywhere.
        let contact = parts.get(subject.parts[0]).bounds;
        Some(Self { contact, curves: Vec::new(), ..subject })
    }

    fn new(parts: &Parts<'_>, members: [&Member; 2], point: Option<Vector>, stated: Option<Bounds>) -> Option<Self> {
        let found = [parts.find(members[0])?, parts.find(members[1])?];
        let [a, b] = found.map(|part| parts.get(part));
        let curves = match (a.mesh(), b.mesh()) {
            (Some((a, pose_a)), Some((b, pose_b)))
                if bounds::overlap(&parts.get(found[0]).bounds, &parts.get(found[1]).bounds) =>
            {
                query::intersection_curves(a.at(pose_a), b.at(pose_b)).polylines
            }
            _ => Vec::new(),
        };
        let between = || {
            let sorted = [0, 1, 2].map(|k| {
                let (low, high) = (a.bounds[0][k].max(b.bounds[0][k]), a.bounds[1][k].min(b.bounds[1][k]));
                [low.min(high), low.max(high)]
            });
            [sorted.map(|[low, _]| low), sorted.map(|[_, high]| high)]
        };
        let of_curves = || around(curves.iter().flatten().copied().chain(point));
        let contact = if curves.is_empty() { stated } else { of_curves() }.unwrap_or_else(between);
        Some(Self { parts: found, outer: None, contact, point, curves })
    }

    /// Returns the index in `parts` of the part with the larger box.
    pub(super) fn larger(&self, parts: &Parts<'_>) -> usize {
        let [a, b] = self.parts.map(|part| radius(parts.get(part).bounds));
        usize::from(b > a)
    }
}

//! Statuses of clashes, which carry over from one report to the next.

use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;

use super::kinds::Kind;
use super::rules::Accept;

/// State of a clash in the work of a team.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Status {
    /// The previous report does not have the clash.
    #[default]
    New,
    /// The previous report has the clash too.
    Active,
    /// Somebody looked at the clash.
    Reviewed,
    /// Somebody accepted the clash.
    Approved,
    /// The clash no longer exists.
    Resolved,
}

/// A clash of a previous report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// Identity of the clash.
    pub id: String,
    /// Name of the kind, as [`Kind::name`].
    pub kind: String,
    /// Status in the previous report.
    pub status: Status,
    /// Lower and upper bound of the depth, in world units.
    pub depth: Option<[f64; 2]>,
    /// Lower and upper bound of the gap, in world units.
    pub gap: Option<[f64; 2]>,
    /// Size of the clash when somebody reviewed or approved it.
    pub accepted: Option<f64>,
    /// Remark.
    pub note: Option<String>,
    /// The parts as `label/key`.
    pub parts: Vec<String>,
    /// Names of the parts, in the same order.
    pub names: Vec<String>,
}

/// The clashes of a previous report, and those that had gone then.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Previous {
    /// The clashes and the duplicate sets.
    pub clashes: Vec<Known>,
    /// Tolerance of the search in world units, if the report states it.
    pub tolerance: Option<f64>,
    /// Clearance of the search in world units, if there was one.
    pub clearance: Option<f64>,
}

/// A clash of the previous report that no longer exists.
#[derive(Clone, Debug, PartialEq)]
pub struct Gone {
    /// The clash; its status is [`Status::Resolved`].
    pub clash: Known,
    /// The parts that no longer exist, as `label/key`. If it is empty, all parts still exist, but
    /// they no longer clash or are no longer checked.
    pub removed: Vec<String>,
}

/// Values of a clash that decide its status.
#[derive(Clone, Copy, Debug)]
pub(super) struct Current<'c> {
    pub(super) id: &'c str,
    pub(super) kind: Kind,
    pub(super) depth: Option<[f64; 2]>,
    pub(super) gap: Option<[f64; 2]>,
    /// Growth that does not count, in world units.
    pub(super) tolerance: f64,
}

/// Status of a clash, and the values that carry over with it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Settled {
    pub(super) status: Status,
    pub(super) accepted: Option<f64>,
    pub(super) note: Option<String>,
}

/// Finds the status of each clash.
pub(super) struct Statuses<'p> {
    known: HashMap<&'p str, &'p Known>,
    accepts: HashMap<&'p str, &'p Accept>,
}

impl<'p> Statuses<'p> {
    pub(super) fn new(previous: Option<&'p Previous>, accepts: &'p [Accept]) -> Self {
        let known = previous.map_or(&[][..], |previous| &previous.clashes);
        Self {
            known: known.iter().map(|known| (known.id.as_str(), known)).collect(),
            accepts: accepts.iter().map(|accept| (accept.id.as_str(), accept)).collect(),
        }
    }

    /// Returns the status of a clash. A reviewed or approved clash becomes active again if it has a
    /// worse kind, or has grown by more than the tolerance since then.
    pub(super) fn of(&self, current: &Current<'_>) -> Settled {
        let carried = match self.known.get(current.id) {
            None => Settled::default(),
            Some(known) => {
                let note = known.note.clone();
                match known.status {
                    Status::Reviewed | Status::Approved if !current.has_grown(known) => {
                        Settled { status: known.status, accepted: known.accepted_size(), note }
                    }
                    _ => Settled { status: Status::Active, accepted: None, note },
                }
            }
        };
        match self.accepts.get(current.id) {
            Some(accept) if carried.status != Status::Approved && !current.exceeds(accept) => Settled {
                status: Status::Approved,
                accepted: accept.depth.or(current.size()),
                note: accept.note.clone().or(carried.note),
            },
            _ => carried,
        }
    }
}

impl Known {
    /// Returns the size at which the clash was accepted.
    fn accepted_size(&self) -> Option<f64> {
        let own =
            if self.kind == Kind::Clearance.name() { self.gap.map(|gap| gap[0]) } else { self.depth.map(|d| d[1]) };
        self.accepted.or(own)
    }
}

impl Current<'_> {
    /// Returns the upper bound of the depth, or the lower bound of the gap if there is no depth.
    fn size(&self) -> Option<f64> {
        let size = if self.kind == Kind::Clearance { self.gap.map(|gap| gap[0]) } else { self.depth.map(|d| d[1]) };
        size.filter(|size| size.is_finite())
    }

    fn has_grown(&self, known: &Known) -> bool {
        if rank(self.kind.name()) != rank(&known.kind) {
            return rank(self.kind.name()) < rank(&known.kind);
        }
        match (known.accepted_size(), self.kind, self.depth, self.gap) {
            (Some(accepted), Kind::Clearance, _, Some(gap)) => gap[1] < accepted - self.tolerance,
            (Some(accepted), Kind::Clash, Some(depth), _) => depth[0] > accepted + self.tolerance,
            _ => false,
        }
    }

    fn exceeds(&self, accept: &Accept) -> bool {
        let depth = self.depth.map_or(f64::INFINITY, |depth| depth[0]);
        match self.kind {
            Kind::Clearance | Kind::Contact => false,
            _ => accept.depth.is_some_and(|accepted| depth > accepted + self.tolerance),
        }
    }
}

/// Returns the place of a kind in the order from the worst. Undecided counts as clash.
fn rank(kind: &str) -> usize {
    ["duplicate", "contained", "clash", "contact", "clearance"].iter().position(|&k| k == kind).unwrap_or(2)
}

impl Status {
    /// Every status, in the order of a clash's life.
    pub const ALL: [Self; 5] = [Self::New, Self::Active, Self::Reviewed, Self::Approved, Self::Resolved];

    /// Returns the name of the status in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::New => "new",
            Self::Active => "active",
            Self::Reviewed => "reviewed",
            Self::Approved => "approved",
            Self::Resolved => "resolved",
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The error that a word is not the name of a status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownStatus;

impl fmt::Display for UnknownStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the statuses are new, active, reviewed, approved and resolved")
    }
}

impl std::error::Error for UnknownStatus {}

impl FromStr for Status {
    type Err = UnknownStatus;

    fn from_str(text: &str) -> Result<Self, UnknownStatus> {
        Self::ALL.into_iter().find(|status| status.name() == text).ok_or(UnknownStatus)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 0.1;

    fn status(known: &Known, kind: Kind, depth: Option<f64>, gap: Option<f64>) -> Status {
        let previous = Previous { clashes: vec![known.clone()], ..Previous::default() };
        let pair = |x: f64| [x, x];
        let current = Current { id: "c-a", kind, depth: depth.map(pair), gap: gap.map(pair), tolerance: TOLERANCE };
        Statuses::new(Some(&previous), &[]).of(&current).status
    }

    fn known(kind: Kind, status: Status, depth: Option<f64>, gap: Option<f64>) -> Known {
        let pair = |x: f64| [x, x];
        let (id, kind) = ("c-a".to_owned(), kind.name().to_owned());
        Known { id, kind, status, depth: depth.map(pair), gap: gap.map(pair), ..Known::default() }
    }

    #[test]
    fn a_clash_is_new_then_active_and_keeps_what_people_said() {
        let at = |status| known(Kind::Clash, status, Some(5.0), None);
        for (before, after) in [
            (Status::New, Status::Active),
            (Status::Active, Status::Active),
            (Status::Reviewed, Status::Reviewed),
            (Status::Approved, Status::Approved),
            (Status::Resolved, Status::Active),
        ] {
            assert_eq!(status(&at(before), Kind::Clash, Some(5.0), None), after);
        }
        let other = Known { id: "c-b".to_owned(), ..at(Status::Approved) };
        assert_eq!(status(&other, Kind::Clash, Some(5.0), None), Status::New);
    }

    #[test]
    fn an_accepted_clash_comes_back_if_it_grows() {
        let deep = known(Kind::Clash, Status::Approved, Some(5.0), None);
        assert_eq!(status(&deep, Kind::Clash, Some(5.05), None), Status::Approved);
        assert_eq!(status(&deep, Kind::Clash, Some(5.2), None), Status::Active);
        assert_eq!(status(&deep, Kind::Contained(crate::clash::Inner::A), None, None), Status::Active);
        assert_eq!(status(&deep, Kind::Clearance, None, Some(1.0)), Status::Approved);
        let near = known(Kind::Clearance, Status::Reviewed, None, Some(5.0));
        assert_eq!(status(&near, Kind::Clearance, None, Some(6.0)), Status::Reviewed);
        assert_eq!(status(&near, Kind::Clearance, None, Some(4.0)), Status::Active);
        assert_eq!(status(&near, Kind::Clash, Some(0.2), None), Status::Active);
        // It grows by less than the tolerance each time, but more since it was approved.
        let crept = Known { accepted: Some(5.0), ..known(Kind::Clash, Status::Approved, Some(5.08), None) };
        assert_eq!(status(&crept, Kind::Clash, Some(5.16), None), Status::Active);
    }

    #[test]
    fn accepts_approve_up_to_a_depth() {
        let accepts = [Accept { id: "c-a".to_owned(), depth: Some(5.0), note: Some("agreed".to_owned()) }];
        let at = |depth: f64| {
            let depth = Some([depth, depth]);
            let current = Current { id: "c-a", kind: Kind::Clash, depth, gap: None, tolerance: TOLERANCE };
            Statuses::new(None, &accepts).of(&current)
        };
        assert_eq!(at(5.0), Settled { status: Status::Approved, accepted: Some(5.0), note: Some("agreed".to_owned()) });
        assert_eq!(at(5.5).status, Status::New);
    }
}

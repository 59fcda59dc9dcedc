//! The kind of one pair of solids: duplicate, contained, clash, contact, clearance or clear.
//!
//! Guarded by `tests/it/clash`.

use std::fmt;

use crate::budget::Budget;
use crate::query::{Depth, Distance, Placed, Query};

/// Relation of two solids. Exactly one kind holds for each pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// The solids are the same shape in the same place.
    Duplicate,
    /// One solid lies inside the other.
    Contained(Inner),
    /// The solids share material that is deeper than the tolerance.
    Clash,
    /// Nothing was proved, so the pair counts as a clash.
    Undecided,
    /// The solids touch, or share material that is no deeper than the tolerance.
    Contact,
    /// The gap between the solids is at most the required clearance.
    Clearance,
    /// The solids have no common point and keep the clearance.
    Clear,
}

/// The solid of a pair that lies inside the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Inner {
    /// The first solid lies inside the second.
    A,
    /// The second solid lies inside the first.
    B,
}

/// Question about one pair. Lengths are in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked {
    /// Depth up to which common material counts as contact.
    pub tolerance: f64,
    /// Required gap, or `None` if any gap is allowed.
    pub clearance: Option<f64>,
    /// Whether contacts are listed.
    pub contacts: bool,
}

/// Answer about one pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Kind of the pair.
    pub kind: Kind,
    /// Depth of the common material, if it was computed.
    pub depth: Option<Depth>,
    /// Distance of the solids, if it was computed.
    pub gap: Option<Distance>,
    /// Point that shows where the solids meet, in the world frame.
    pub point: Option<[f64; 3]>,
    /// Whether the kind is proved.
    pub proved: bool,
    /// Reason why the kind is not proved.
    pub why: Option<Why>,
}

/// Reason why the kind of a pair is not proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Why {
    /// A limit on the work of the run or of the pair was reached.
    Budget,
    /// A solid is open.
    NotSolid,
    /// The depth is about the tolerance, or a search ended before it was told from the tolerance.
    AboutTolerance,
}

impl Kind {
    /// Name of the kind in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Duplicate => "duplicate",
            Self::Contained(_) => "contained",
            Self::Clash => "clash",
            Self::Undecided => "undecided",
            Self::Contact => "contact",
            Self::Clearance => "clearance",
            Self::Clear => "clear",
        }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Budget => "a limit on the work was reached",
            Self::NotSolid => "a part is open",
            Self::AboutTolerance => "the depth was not told apart from the tolerance",
        })
    }
}

/// Share of the tolerance up to which the depth of a contact is not told apart from zero.
const SLIGHT: f64 = 1.0 / 1024.0;

/// Width of the interval of a clash's depth, relative to the depth.
const DEPTH_WIDTH: f64 = 1.0 / 32.0;

/// Share of the tolerance that tells rounding from a contact that is nearly a clash.
const ROUGH: f64 = 1.0 / 32.0;

/// Returns the kind of one pair of solids at their poses. It never fails, and the budget limits its
/// work.
pub(super) fn classify(a: &Placed<'_>, b: &Placed<'_>, asked: &Asked, budget: &Budget<'_>) -> Finding {
    let query = || Query::new().with_budget(budget);
    if !query().intersects(a, b) {
        return apart(a, b, asked, budget);
    }
    let tolerance = asked.tolerance;
    // Most pairs are flush: one search with a small threshold decides them and bounds their depth.
    let slight = query().material_beyond(a, b, SLIGHT * tolerance);
    let is_told = slight.lower > tolerance || slight.upper <= tolerance;
    let verdict = if is_told { slight } else { query().material_beyond(a, b, tolerance) };
    let found = |kind| Finding { kind, depth: None, gap: None, point: verdict.point, proved: true, why: None };
    if verdict.upper <= tolerance {
        let depth = if is_told { slight } else { contact(a, b, (slight, verdict), budget) };
        let (proved, why) = (verdict.is_proved, unproved(&verdict));
        return Finding { point: depth.point, depth: Some(depth), proved, why, ..found(Kind::Contact) };
    }
    if verdict.lower <= tolerance {
        let stopped = budget.stopped().map(|_| Why::Budget);
        let why = stopped.or_else(|| unproved(&verdict)).unwrap_or(Why::AboutTolerance);
        return Finding { depth: Some(verdict), proved: false, why: Some(why), ..found(Kind::Undecided) };
    }
    let is_in = |inner: &Placed<'_>, outer: &Placed<'_>| query().is_inside(inner, outer, tolerance);
    let kind = match (is_in(a, b), is_in(b, a)) {
        (true, true) => Kind::Duplicate,
        (true, false) => Kind::Contained(Inner::A),
        (false, true) => Kind::Contained(Inner::B),
        (false, false) => {
            let depth = query().depth_about(a, b, DEPTH_WIDTH);
            // The search for the depth may find less than the search for the threshold did.
            let depth = if depth.lower >= verdict.lower { depth } else { Depth { upper: depth.upper, ..verdict } };
            let point = depth.point.or(verdict.point);
            let proved = depth.is_proved && verdict.is_proved;
            return Finding { depth: Some(depth), point, proved, why: unproved(&depth), ..found(Kind::Clash) };
        }
    };
    Finding { proved: verdict.is_proved, why: unproved(&verdict), ..found(kind) }
}

/// Returns the finding for two solids without a common point.
fn apart(a: &Placed<'_>, b: &Placed<'_>, asked: &Asked, budget: &Budget<'_>) -> Finding {
    let found = |kind| Finding { kind, depth: None, gap: None, point: None, proved: true, why: None };
    let Some(clearance) = asked.clearance else { return found(Kind::Clear) };
    let gap = Query::new().with_budget(budget).distance(a, b);
    let point = gap.witness.map(|w| std::array::from_fn(|k| 0.5 * (w.point_a[k] + w.point_b[k])));
    let kind = if gap.lower <= clearance { Kind::Clearance } else { Kind::Clear };
    Finding { gap: Some(gap), point, ..found(kind) }
}

/// Returns the depth of two solids that share no material deeper than the tolerance, given what the
/// searches with the slight threshold and with the tolerance found. The interval is wide: it tells
/// the decade of the depth.
fn contact(a: &Placed<'_>, b: &Placed<'_>, (slight, verdict): (Depth, Depth), budget: &Budget<'_>) -> Depth {
    let rough = Query::new().with_budget(budget).material_beyond(a, b, ROUGH * verdict.upper);
    let deepest = [slight, verdict, rough].into_iter().max_by(|x, y| x.lower.total_cmp(&y.lower)).unwrap_or(slight);
    Depth { upper: verdict.upper.min(rough.upper).max(deepest.lower), ..deepest }
}

fn unproved(depth: &Depth) -> Option<Why> {
    (!depth.is_proved).then_some(Why::NotSolid)
}

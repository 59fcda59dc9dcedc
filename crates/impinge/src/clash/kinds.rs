//! The kind of one pair of solids: duplicate, contained, clash, contact, clearance or clear.
//!
//! Guarded by `tests/it/clash`.

use std::fmt;

use crate::budget::Budget;
use crate::query::{Deeper, Depth, Distance, Placed, Proximity, Query};

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
    /// A solid is open or intersects itself where it matters.
    NotSolid,
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
            Self::NotSolid => "a part is open or intersects itself there",
        })
    }
}

/// Returns the kind of one pair of solids at their poses. It never fails, and the budget limits its
/// work.
pub(super) fn classify(a: &Placed<'_>, b: &Placed<'_>, asked: &Asked, budget: &Budget<'_>) -> Finding {
    let query = || Query::new().with_budget(budget);
    let found = |kind| Finding { kind, depth: None, gap: None, point: None, proved: true, why: None };
    let gap = query().distance(a, b);
    let point = gap.witness.map(|w| std::array::from_fn(|k| 0.5 * (w.point_a[k] + w.point_b[k])));
    if gap.proximity == Proximity::Apart {
        let is_near = asked.clearance.is_some_and(|clearance| gap.lower <= clearance);
        let kind = if is_near { Kind::Clearance } else { Kind::Clear };
        return Finding { gap: Some(gap), point, ..found(kind) };
    }
    if is_same(a, b) {
        return found(Kind::Duplicate);
    }
    if let (Some(inner), Some(outer)) = (a.mesh(), b.mesh()) {
        let [bare_a, bare_b] = [inner, outer].map(|mesh| mesh.mesh.at(mesh.world_from_mesh));
        if !query().intersects(bare_a, bare_b) {
            let is_in_b = query().intersects(bare_a, outer);
            return found(Kind::Contained(if is_in_b { Inner::A } else { Inner::B }));
        }
    }
    let size = [a, b].map(|placed| placed.mesh().map_or(0, |mesh| mesh.mesh.faces().len()));
    let depth = if size[0] + size[1] < 100 {
        query().depth(a, b)
    } else {
        let (lower, upper) = match query().deeper(a, b, asked.tolerance) {
            Deeper::Yes => (asked.tolerance.next_up(), f64::INFINITY),
            Deeper::No => (0.0, asked.tolerance),
            Deeper::Undecided => (0.0, f64::INFINITY),
        };
        Depth { lower, upper, point: None, is_proved: true }
    };
    let found = Finding { point: depth.point.or(point), depth: Some(depth), ..found(Kind::Contact) };
    match (depth.lower > asked.tolerance, depth.upper <= asked.tolerance) {
        (true, _) => Finding { kind: Kind::Clash, ..found },
        (_, true) => found,
        _ => {
            let why = if budget.stopped().is_some() { Why::Budget } else { Why::NotSolid };
            Finding { kind: Kind::Undecided, proved: false, why: Some(why), ..found }
        }
    }
}

fn is_same(a: &Placed<'_>, b: &Placed<'_>) -> bool {
    let (Some(a), Some(b)) = (a.mesh(), b.mesh()) else { return false };
    let is_one = a.mesh.faces() == b.mesh.faces() && a.mesh.positions() == b.mesh.positions();
    is_one && a.world_from_mesh == b.world_from_mesh
}

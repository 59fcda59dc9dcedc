//! The kind of one pair of solids: duplicate, contained, clash, contact, clearance or clear.
//!
//! Guarded by `tests/it/clash`.

use std::fmt;

use super::meeting::Meeting;
use crate::budget::{Budget, Stopped};
use crate::query::batch::Execution;
use crate::query::{Depth, Effort, Placed, Query};
use crate::shape::PlacedShape;

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
    /// Whether the volume of common material is computed.
    pub volume: bool,
}

/// Answer about one pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Kind of the pair.
    pub kind: Kind,
    /// Lower and upper bound of the depth of the common material, if it was computed.
    pub depth: Option<[f64; 2]>,
    /// Lower and upper bound of the distance of the solids, if it was computed.
    pub gap: Option<[f64; 2]>,
    /// Lower and upper bound of the volume of the common material, if it was computed.
    pub volume: Option<[f64; 2]>,
    /// Point that shows where the solids meet, in the world frame.
    pub point: Option<[f64; 3]>,
    /// The nearest face of each mesh to the point.
    pub faces: Option<[u32; 2]>,
    /// Direction of length 1 in which the second solid leaves the first near the point, or faces it
    /// across the gap, in the world frame.
    pub normal: Option<[f64; 3]>,
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

impl Finding {
    /// Returns the finding of a kind that is proved, and nothing else.
    fn of(kind: Kind) -> Self {
        Self {
            kind,
            depth: None,
            gap: None,
            volume: None,
            point: None,
            faces: None,
            normal: None,
            proved: true,
            why: None,
        }
    }

    /// Returns the finding of a kind with a depth.
    fn deep(kind: Kind, depth: &Depth) -> Self {
        Self { depth: Some([depth.lower, depth.upper]), point: depth.point, ..Self::of(kind) }
    }

    fn meeting(self, meeting: Meeting) -> Self {
        Self { faces: meeting.faces, normal: meeting.normal, ..self }
    }
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

/// Effort of the searches that tell how slight a contact is. Flat parts need a few cells for each
/// face, and parts with many curved faces would need thousands.
const CONTACT: Effort = Effort { cells: 1 << 8, border_edges: 1 << 17, ..Effort::FULL };

/// Effort of the search for the depth of a clash.
const DEPTH: Effort = Effort { relative_width: 1.0 / 16.0, cells: 1 << 12, border_edges: 1 << 17, ..Effort::FULL };

/// Share of the tolerance that tells rounding from a contact that is nearly a clash.
const ROUGH: f64 = 1.0 / 32.0;

/// Returns the findings of some pairs of parts, each with its question, in order. It serves to
/// share out a [`Job`](super::Job): its [`question`](super::Job::question) tells the pairs.
///
/// # Errors
/// Returns an error if the work was canceled, or memory ran out. Once another limit of the budget
/// is reached, the pairs that are left are undecided.
///
/// # Panics
/// Panics if a pair has the index of no part.
///
/// ```
/// use impinge::clash::{Asked, Kind, classify};
/// use impinge::query::batch::Execution;
/// use impinge::{Pose, Shape};
///
/// let ball = Shape::sphere([0.0; 3], 1.0)?;
/// let parts = [ball.at(Pose::IDENTITY)?, ball.at(Pose::from_translation([1.5, 0.0, 0.0])?)?];
/// let asked = Asked { tolerance: 1e-3, clearance: None, contacts: false, volume: false };
/// let found = classify(&parts, &[([0, 1], asked)], Execution::default())?;
/// assert_eq!(found[0].kind, Kind::Clash);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn classify(
    parts: &[PlacedShape],
    pairs: &[([usize; 2], Asked)],
    execution: Execution<'_>,
) -> Result<Vec<Finding>, Stopped> {
    execution.single_rows(pairs.len(), |row| {
        let (pair, asked) = &pairs[row];
        let [a, b] = pair.map(|part| Placed::from(&parts[part]));
        find_kind(&a, &b, asked, execution.budget())
    })
}

/// Returns the kind of one pair of solids at their poses. It never fails, and the budget limits its
/// work.
pub(super) fn find_kind(a: &Placed<'_>, b: &Placed<'_>, asked: &Asked, budget: &Budget<'_>) -> Finding {
    let query = || Query::new().with_budget(budget);
    if !query().intersects(a, b) {
        return apart(a, b, asked, budget);
    }
    let mut found = common(a, b, asked.tolerance, budget);
    if asked.volume && found.kind != Kind::Contact {
        found.volume = query().common_volume(a, b).map(|volume| [volume.lower, volume.upper]);
    }
    let is_listed = found.kind != Kind::Contact || asked.contacts;
    match found.point.filter(|_| is_listed) {
        Some(point) => found.meeting(Meeting::at(&point, a, b)),
        None => found,
    }
}

/// Returns the finding for two solids with a common point, without faces.
fn common(a: &Placed<'_>, b: &Placed<'_>, tolerance: f64, budget: &Budget<'_>) -> Finding {
    let query = || Query::new().with_budget(budget);
    // Most pairs are flush: one search with a small threshold decides them and bounds their depth.
    let slight = query().material_beyond(a, b, SLIGHT * tolerance, CONTACT);
    let is_told = slight.lower > tolerance || slight.upper <= tolerance;
    let verdict = if is_told { slight } else { query().material_beyond(a, b, tolerance, Effort::FULL) };
    if verdict.upper <= tolerance {
        let depth = if is_told { slight } else { contact(a, b, (slight, verdict), budget) };
        return Finding { proved: verdict.is_proved, why: unproved(&verdict), ..Finding::deep(Kind::Contact, &depth) };
    }
    if verdict.lower <= tolerance {
        let stopped = budget.stopped().map(|_| Why::Budget);
        let why = stopped.or_else(|| unproved(&verdict)).unwrap_or(Why::AboutTolerance);
        return Finding { proved: false, why: Some(why), ..Finding::deep(Kind::Undecided, &verdict) };
    }
    let is_in = |inner: &Placed<'_>, outer: &Placed<'_>| query().is_inside(inner, outer, tolerance);
    let kind = match (is_in(a, b), is_in(b, a)) {
        (true, true) => Kind::Duplicate,
        (true, false) => Kind::Contained(Inner::A),
        (false, true) => Kind::Contained(Inner::B),
        (false, false) => Kind::Clash,
    };
    if kind != Kind::Clash {
        let (proved, why) = (verdict.is_proved, unproved(&verdict));
        return Finding { point: verdict.point, proved, why, ..Finding::of(kind) };
    }
    let depth = query().depth_with(a, b, DEPTH);
    // The search for the depth may find less than the search for the threshold did.
    let deepest = if depth.lower >= verdict.lower { depth } else { verdict };
    let depth = Depth {
        upper: depth.upper.max(deepest.lower),
        point: deepest.point.or(verdict.point),
        is_proved: depth.is_proved && verdict.is_proved,
        ..deepest
    };
    Finding { proved: depth.is_proved, why: unproved(&depth), ..Finding::deep(kind, &depth) }
}

/// Returns the finding for two solids without a common point.
fn apart(a: &Placed<'_>, b: &Placed<'_>, asked: &Asked, budget: &Budget<'_>) -> Finding {
    let Some(clearance) = asked.clearance else { return Finding::of(Kind::Clear) };
    let gap = Query::new().with_budget(budget).distance(a, b);
    let kind = if gap.lower <= clearance { Kind::Clearance } else { Kind::Clear };
    let found = Finding { gap: Some([gap.lower, gap.upper]), ..Finding::of(kind) };
    match gap.witness.filter(|_| kind == Kind::Clearance) {
        Some(witness) => {
            let middle = std::array::from_fn(|k| 0.5 * (witness.point_a[k] + witness.point_b[k]));
            Finding { point: Some(middle), ..found.meeting(Meeting::across(&witness)) }
        }
        None => found,
    }
}

/// Returns the depth of two solids that share no material deeper than the tolerance, given what the
/// searches with the slight threshold and with the tolerance found. The interval is wide: it tells
/// the decade of the depth.
fn contact(a: &Placed<'_>, b: &Placed<'_>, (slight, verdict): (Depth, Depth), budget: &Budget<'_>) -> Depth {
    let rough = Query::new().with_budget(budget).material_beyond(a, b, ROUGH * verdict.upper, CONTACT);
    let deepest = [slight, verdict, rough].into_iter().max_by(|x, y| x.lower.total_cmp(&y.lower)).unwrap_or(slight);
    Depth { upper: verdict.upper.min(rough.upper).max(deepest.lower), ..deepest }
}

fn unproved(depth: &Depth) -> Option<Why> {
    (!depth.is_proved).then_some(Why::NotSolid)
}

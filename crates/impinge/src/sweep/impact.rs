//! The time at which two things first touch, with proved bounds.

/// The first time in [0, 1] at which two moving sets have a point in common, as a proved interval.
///
/// Time 0 is the start of the motion and 1 its end. Touching counts as contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Lower bound of the time: nothing touches before it. It is infinite if and only if contact is
    /// disproved for all of [0, 1].
    pub t_lower: f64,
    /// Upper bound of the time: there is contact no later than it. It is infinite if that is not
    /// proved: contact was disproved, or the limit on the work of one query was reached first.
    pub t_upper: f64,
    /// Place of the first touch, at the time `t_lower`. Absent without contact, if the things touch
    /// at the start ([`contacts`](crate::query::contacts) has these contacts), if the limit on the
    /// work was reached, and for [`vertex_face`](super::vertex_face) and
    /// [`edge_edge`](super::edge_edge).
    pub touch: Option<Touch>,
}

/// Place at which two bodies first touch, at the time [`t_lower`](Impact::t_lower).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Point between the two bodies where they are nearest, in the world frame, rounded.
    pub point: [f64; 3],
    /// Unit normal from the first body to the second, in the world frame, rounded. It is the
    /// direction along which the two parts or faces are farthest apart.
    pub normal: [f64; 3],
    /// Index of the part of each body; 0 if it is not a compound.
    pub parts: [u32; 2],
    /// Face of each body that touches, if its part is a mesh.
    pub faces: [Option<u32>; 2],
}

impl Impact {
    /// The impact of sets that do not touch in [0, 1].
    pub const NEVER: Self = Self { t_lower: f64::INFINITY, t_upper: f64::INFINITY, touch: None };

    /// Returns an impact between two times, without a place.
    pub(super) fn between(t_lower: f64, t_upper: f64) -> Self {
        Self { t_lower, t_upper, touch: None }
    }

    /// Reports whether contact is proved or undecided. `false` means that the sets are proved not
    /// to touch.
    #[must_use]
    pub fn hit(&self) -> bool {
        self.t_lower < f64::INFINITY
    }

    /// Reports whether contact is proved or disproved. If neither is proved, [`hit`](Self::hit)
    /// returns `true`, the safe answer.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.t_upper < f64::INFINITY || !self.hit()
    }
}

//! The bodies that a step moves, each in its other placement: after the step until the body moves,
//! and before the step from then on.
//!
//! A step writes all placements before any body moves, and then exchanges them with those of the
//! bodies. So a step that fails can move the bodies back.

use super::body::BodyId;
use super::changed::Change;
use super::outline::{Bounds, Extremes};
use super::placed::OtherPlacement;
use super::state::Resident;
use crate::input::InputError;
use crate::math::Pose;

/// The parts of a body that a step changes, in its other placement.
#[derive(Debug, Default)]
pub(super) struct Other {
    /// Whether the body moves. If not, the other fields are unspecified.
    pub(super) moves: bool,
    pub(super) placement: OtherPlacement,
    pub(super) bounds: Bounds,
    pub(super) extremes: Extremes,
    /// Change of the body before it moved.
    pub(super) change: Change,
}

impl Other {
    /// Writes the placement of a body at another pose.
    ///
    /// # Errors
    /// Returns an error if the shape of the body cannot be placed at the pose.
    pub(super) fn write(&mut self, resident: &Resident, world_from_body: &Pose) -> Result<(), InputError> {
        let now = resident.placed.world_from_body();
        // Most bodies that move do not keep their translation, which takes less time to compare.
        self.moves = now.translation() != world_from_body.translation() || now != world_from_body;
        if self.moves {
            resident.placed.validate_at(world_from_body, &mut self.placement)?;
            self.extremes = resident.extremes;
            let standing = resident.placed.standing(&self.placement);
            self.bounds = resident.outline.bounds(standing, &mut self.extremes).grown(resident.margin);
        }
        Ok(())
    }
}

/// The placements of the bodies that a step moves. A world keeps their memory from step to step,
/// but a copy of the world does not need it.
#[derive(Debug, Default)]
pub(super) struct Spare(pub(super) Vec<Other>);

impl Clone for Spare {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The bodies that a step moves.
pub(super) struct Taken<'t> {
    /// Bodies in ascending order, each with the index of its last move.
    pub(super) order: Vec<(BodyId, u32)>,
    /// The body of each move in its other placement.
    pub(super) others: &'t mut [Other],
}

impl<'t> Taken<'t> {
    pub(super) fn new(moves: &[(BodyId, Pose)], others: &'t mut [Other]) -> Self {
        Self { order: last_of_each(moves), others }
    }

    /// Frees the memory of placements that is not used again.
    pub(super) fn clear(&mut self) {
        self.others
            .iter_mut()
            .filter(|other| other.placement.is_of_compound())
            .for_each(|other| other.placement.clear());
    }
}

/// Returns the bodies that move, in order, each with the index of its last move in the list.
fn last_of_each(moves: &[(BodyId, Pose)]) -> Vec<(BodyId, u32)> {
    let mut order: Vec<(BodyId, u32)> = (0..).zip(moves).map(|(at, &(body, _))| (body, at)).collect();
    if order.is_sorted_by(|one, other| one.0 < other.0) {
        return order;
    }
    order.sort_unstable();
    order.dedup_by(|later, kept| {
        let is_same = later.0 == kept.0;
        if is_same {
            *kept = *later;
        }
        is_same
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;
    use std::collections::BTreeMap;

    #[test]
    fn the_last_move_of_each_body_is_found_in_any_order() {
        let mut rng = Rng::new(47);
        let mut ascending = 0;
        for round in 0..400 {
            let count = rng.integer(0, 6) as usize;
            let moves: Vec<(BodyId, Pose)> = (0..count)
                .map(|at| {
                    let index = if round % 2 == 0 { at as u32 } else { rng.integer(0, 4) as u32 };
                    (BodyId::new(index, rng.integer(0, 1) as u32), Pose::IDENTITY)
                })
                .collect();
            ascending += u32::from(moves.is_sorted_by(|one, other| one.0 < other.0));
            let last: BTreeMap<BodyId, u32> = (0..).zip(&moves).map(|(at, (body, _))| (*body, at)).collect();
            assert_eq!(last_of_each(&moves), last.into_iter().collect::<Vec<_>>());
        }
        assert!((220..350).contains(&ascending), "{ascending}");
    }
}

//! The poses that a shape accepts: rigid ones, to within 1e-4, if it or a part of it is round.

use super::kind::{Kind, Shape};
use super::placed::images_of_radius;
use crate::input::InputError;
use crate::math::Pose;
use crate::volume::stretch;

/// Maximum stretch of a pose that is nearly rigid, 1 + 2^-17.
const NEARLY_RIGID: f64 = 1.0 + 1.0 / (1_u32 << 17) as f64;

/// Maximum magnitude of an entry of the translation of a nearly rigid pose, 2^290.
const MAX_TRANSLATION: f64 = f64::from_bits((1023 + 290) << 52);

/// Test of the poses of one shape. A compound is read once. Each nearly rigid pose then takes
/// constant time if the parts of the compound have nearly rigid poses in it, as most have.
pub(crate) struct Acceptance<'s> {
    shape: &'s Shape,
    /// Whether the shape is a compound in which all poses of parts are nearly rigid.
    has_rigid_parts: bool,
}

impl<'s> Acceptance<'s> {
    pub(crate) fn of(shape: &'s Shape) -> Self {
        let has_rigid_parts = match &shape.0 {
            Kind::Compound(parts) => parts.iter().all(|(_, compound_from_part)| is_nearly_rigid(compound_from_part)),
            _ => false,
        };
        Self { shape, has_rigid_parts }
    }

    /// Checks whether the shape accepts a pose, as [`Shape::check_pose`] does.
    ///
    /// # Accuracy
    /// Let A and B be the linear parts of two poses, with ‖AᵀA - I‖ and ‖BᵀB - I‖ at most 2^-16.
    /// Then ‖(AB)ᵀAB - I‖ ≤ ‖AᵀA - I‖ ‖B‖² + ‖BᵀB - I‖ ≤ 3.1e-5, and rounding the product adds less
    /// than 1e-14. So the product is rigid to within 1e-4, and not singular. Its translation is
    /// below 2^293.
    ///
    /// # Errors
    /// As for [`Shape::at`].
    pub(crate) fn check(&self, world_from_local: &Pose) -> Result<(), InputError> {
        if self.has_rigid_parts && is_nearly_rigid(world_from_local) {
            return Ok(());
        }
        self.shape.check_pose(world_from_local)
    }
}

/// Reports whether a pose is rigid to within 2^-16, and its translation is not extreme.
fn is_nearly_rigid(pose: &Pose) -> bool {
    stretch(pose).is_ok_and(|stretch| stretch <= NEARLY_RIGID)
        && pose.translation().iter().all(|entry| entry.abs() <= MAX_TRANSLATION)
}

impl Shape {
    /// Reports whether the shape accepts every pose: it is a polytope, a half-space, a
    /// height field or a mesh.
    pub(crate) fn is_affine(&self) -> bool {
        matches!(&self.0, Kind::Polytope(_) | Kind::HalfSpace { .. } | Kind::Field(_) | Kind::Mesh { .. })
    }

    /// Checks whether the shape accepts a pose, without placing it.
    ///
    /// # Errors
    /// As for [`at`](Self::at).
    pub(crate) fn check_pose(&self, world_from_local: &Pose) -> Result<(), InputError> {
        match &self.0 {
            Kind::Polytope(_) | Kind::HalfSpace { .. } | Kind::Field(_) | Kind::Mesh { .. } => Ok(()),
            Kind::Round { radius, .. } => images_of_radius(*radius, world_from_local).map(drop),
            Kind::Compound(parts) => parts.iter().try_for_each(|(part, compound_from_part)| {
                part.check_pose(&world_from_local.compose(compound_from_part)?)
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::{Rng, poses};

    /// Returns a turned pose with a scale that is 1, or a little or much less or more, and with a
    /// translation that is small or extreme.
    fn pose(rng: &mut Rng) -> Pose {
        let scale = 1.0 + rng.choose(&[0.0, 2.5e-6, 1e-5, 4e-5]) * rng.choose(&[-1.0, 1.0]);
        let scale = if rng.one_in(40) { 0.5 } else { scale };
        let linear = poses::rotation(rng).linear.map(|row| row.map(|x| x * scale));
        let reach = if rng.one_in(8) { TRANSLATION_NEAR_LIMIT } else { 1.0 };
        Pose::new(linear, [0; 3].map(|_| reach * rng.integer(-2, 2) as f64)).expect("a pose")
    }

    /// A quarter of the limit of translations. The sum of four can be out of range.
    const TRANSLATION_NEAR_LIMIT: f64 = f64::from_bits((1023 + 298) << 52);

    #[test]
    fn a_compound_accepts_what_all_of_its_parts_accept() {
        let mut rng = Rng::new(50);
        let (mut at_once, mut accepted, mut refused) = (0, 0, 0);
        let parts = [Shape::sphere([0.0; 3], 1.0), Shape::cuboid([1.0; 3]), Shape::capsule([0.0; 3], [1.0; 3], 0.5)];
        let parts = parts.map(|part| part.expect("a shape"));
        for _ in 0..4000 {
            let count = rng.integer(1, 3);
            let placed: Vec<_> = (0..count).map(|_| (parts[rng.choose(&[0, 1, 2])].clone(), pose(&mut rng))).collect();
            let compound = Shape::compound(&placed).expect("a compound");
            let acceptance = Acceptance::of(&compound);
            for _ in 0..4 {
                let pose = pose(&mut rng);
                let truth = compound.check_pose(&pose);
                assert_eq!(acceptance.check(&pose), truth, "{placed:?} {pose:?}");
                assert_eq!(compound.at(pose).map(drop), truth);
                at_once += u32::from(acceptance.has_rigid_parts && is_nearly_rigid(&pose));
                accepted += u32::from(truth.is_ok());
                refused += u32::from(truth.is_err());
            }
        }
        assert!(at_once > 1500 && accepted > at_once + 1500 && refused > 1500, "{at_once} {accepted} {refused}");
    }
}

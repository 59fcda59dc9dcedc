//! Characters in a world of bodies: one body for each part.

use crate::input::InputError;
use crate::math::Pose;
use crate::shape::Shape;
use crate::world::{Body, BodyId, Traits, World, WorldError};

use super::posed::Posed;

/// The parts of one character as bodies of a [`World`]. They are inserted, moved and removed
/// together.
///
/// A common owner keeps the parts from colliding with each other. Pairs of parts are reported like
/// those of any other bodies: by the [handles](Self::bodies) of the parts, in the order of their
/// tags.
///
/// ```no_run
/// # fn f(rig: &impinge::character::Rig, character: &impinge::character::Character) -> Result<(), Box<dyn std::error::Error>> {
/// use impinge::{character::{PartBodies, Posed}, world::{Traits, World}};
///
/// let mut world = World::new();
/// let mut posed = Posed::new(character, &rig.pose_at(0, 0.0)?);
/// let boxer = PartBodies::insert(&mut world, &posed, Traits { owner: Some(1), tag: 1000, ..Traits::default() })?;
///
/// posed.set(&rig.pose_at(0, 0.1)?);
/// let mut moves = Vec::new();
/// boxer.moves(&posed, &mut moves)?;
/// for pair in &world.step(&moves)?.began {
///     if let Some(part) = boxer.part(pair.a).or(boxer.part(pair.b)) {
///         println!("{} is struck", character.parts()[part as usize].name);
///     }
/// }
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartBodies {
    bodies: Vec<BodyId>,
    /// Each body with its part, sorted by body.
    sorted: Vec<(BodyId, u32)>,
}

impl PartBodies {
    /// Inserts a body into the world for each part of a character, at the part's pose in `posed`.
    /// All bodies get the given traits, but the tags count up from the given tag, part by part. If
    /// the traits have no owner, overlapping parts of the character collide with each other.
    ///
    /// # Errors
    /// Same as [`World::insert`]; then no part is in the world.
    pub fn insert(world: &mut World, posed: &Posed<'_>, traits: Traits) -> Result<Self, WorldError> {
        let mut placed = Vec::new();
        for (part, frame) in posed.character().parts().iter().zip(posed.frames()) {
            placed.push(part.volume().shape_in(frame.pose()?)?);
        }
        let mut bodies: Vec<BodyId> = Vec::new();
        for ((shape, world_from_shape), part) in placed.into_iter().zip(0_u64..) {
            match world.insert(body(shape, world_from_shape, traits, part)) {
                Ok(id) => bodies.push(id),
                Err(error) => {
                    for id in bodies {
                        world.remove(id)?;
                    }
                    return Err(error);
                }
            }
        }
        let mut sorted: Vec<(BodyId, u32)> = bodies.iter().copied().zip(0..).collect();
        sorted.sort_unstable();
        Ok(Self { bodies, sorted })
    }

    /// Returns the bodies: the body at index `i` is part `i` of the character.
    #[must_use]
    pub fn bodies(&self) -> &[BodyId] {
        &self.bodies
    }

    /// Returns the index of the part that a body of the world stands for, or `None` if the body is
    /// something else.
    ///
    /// # Complexity
    /// O(log n) for n parts.
    #[must_use]
    pub fn part(&self, body: BodyId) -> Option<u32> {
        let at = self.sorted.binary_search_by_key(&body, |&(id, _)| id).ok()?;
        Some(self.sorted[at].1)
    }

    /// Appends the new poses of the bodies to `moves`, for [`World::step`], so that one step can
    /// move a crowd. `posed` is the character in its new pose.
    ///
    /// # Errors
    /// Returns an error if a pose is out of range; then nothing is appended.
    pub fn moves(&self, posed: &Posed<'_>, moves: &mut Vec<(BodyId, Pose)>) -> Result<(), InputError> {
        let before = moves.len();
        for ((&id, part), frame) in self.bodies.iter().zip(posed.character().parts()).zip(posed.frames()) {
            match frame.pose().and_then(|frame| part.volume().pose_in(frame)) {
                Ok(pose) => moves.push((id, pose)),
                Err(error) => {
                    moves.truncate(before);
                    return Err(error);
                }
            }
        }
        Ok(())
    }

    /// Removes the bodies from the world.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if a body is already gone; the others are removed all
    /// the same.
    pub fn remove(self, world: &mut World) -> Result<(), WorldError> {
        let mut removed = Ok(());
        for id in self.bodies {
            removed = removed.and(world.remove(id).map(|_| ()));
        }
        removed
    }
}

fn body(shape: Shape, world_from_shape: Pose, traits: Traits, part: u64) -> Body {
    let body = Body::new(shape).at(world_from_shape).kind(traits.kind).layers(traits.layers);
    let body = body.tag(traits.tag.wrapping_add(part));
    traits.owner.into_iter().fold(body, Body::owner)
}

//! Sequential impulses in substeps: each contact pushes its two bodies until they no longer
//! approach.
//!
//! Source: Catto, *Solver2D*, 2024 ("soft step"), in three dimensions. A step finds contacts once
//! and then solves several times, with the depth that the moved bodies have. Contacts are springs
//! with strong damping, and each substep removes the speed that the springs added. The impulses of
//! the last step are used again for contacts with the same identity.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use impinge::query::{ContactId, Manifold};
use impinge::world::{Body, BodyId, Kind, World, WorldError};
use impinge::{Pose, Shape};

use crate::block::Mass;

/// Seconds in one step.
pub const STEP: f64 = 1.0 / 60.0;

/// Acceleration of gravity.
pub const GRAVITY: DVec3 = DVec3::new(0.0, 0.0, -9.81);

/// Substeps of a step.
const SUBSTEPS: u32 = 32;

/// Passes over all contacts in a substep, and again after the bodies have moved.
const PASSES: usize = 2;

/// Seconds in one substep.
const SUBSTEP: f64 = STEP / SUBSTEPS as f64;

/// Margin of each body, so that contacts are known before they push.
const MARGIN: f64 = 0.01;

/// Depth that is left uncorrected, so that contacts last.
const SLOP: f64 = 1e-5;

/// Maximum speed at which depth is corrected.
const MAX_CORRECTION: f64 = 3.0;

/// Angular frequency of the springs: 480 oscillations a second.
const FREQUENCY: f64 = 960.0 * std::f64::consts::PI;

/// Damping of the springs, as a multiple of the critical damping.
const DAMPING: f64 = 10.0;

/// A rigid body.
#[derive(Clone, Copy, Debug)]
pub struct Rigid {
    /// Center of mass.
    pub position: DVec3,
    /// World from body.
    pub turn: DQuat,
    /// Velocity of the center of mass.
    pub velocity: DVec3,
    /// Angular velocity.
    pub spin: DVec3,
    mass: f64,
    inertia: DMat3,
    inverse_inertia: DMat3,
    body: BodyId,
}

/// Bodies that fall, collide and rest.
pub struct Simulation {
    world: World,
    bodies: Vec<Rigid>,
    friction: f64,
    /// Impulses of the last step.
    impulses: HashMap<Key, DVec3>,
}

/// Identity of a contact: the numbers of two bodies, and their features.
type Key = (u64, u64, ContactId);

/// Number of all bodies that never move.
const STATIC: u64 = u64::MAX;

/// A contact of two bodies. A body that never moves has no number.
struct Contact {
    key: Key,
    bodies: [Option<usize>; 2],
    /// Vectors from the centers of mass to the contact, when it was found.
    arms: [DVec3; 2],
    /// The same in the frames of the bodies.
    anchors: [DVec3; 2],
    /// Two tangents and the normal from the first body to the second.
    axes: [DVec3; 3],
    /// Impulses along the axes that change the speed there by 1.
    inertia: [f64; 3],
    /// Depth when the contact was found.
    depth: f64,
    /// Impulse along each axis.
    impulse: DVec3,
}

impl Simulation {
    /// Returns a simulation without bodies. The coefficient of friction is the same for all.
    #[must_use]
    pub fn new(friction: f64) -> Self {
        Self { world: World::new(), bodies: Vec::new(), friction, impulses: HashMap::new() }
    }

    /// Adds a body that never moves.
    ///
    /// # Errors
    /// Returns an error if the world refuses the body.
    pub fn insert_static(&mut self, shape: Shape) -> Result<(), WorldError> {
        self.world.insert(Body::new(shape).kind(Kind::Static).tag(STATIC)).map(|_| ())
    }

    /// Adds a body at rest whose center of mass is the origin of its shape. Returns its number.
    ///
    /// # Errors
    /// Returns an error if the world refuses the body.
    pub fn insert(&mut self, shape: Shape, mass: &Mass, position: DVec3) -> Result<usize, WorldError> {
        let number = self.bodies.len();
        let pose = Pose::from_translation(position.to_array())?;
        let body = self.world.insert(Body::new(shape).at(pose).tag(number as u64).with_margin(MARGIN))?;
        self.bodies.push(Rigid {
            position,
            turn: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            spin: DVec3::ZERO,
            mass: mass.mass,
            inertia: mass.inertia,
            inverse_inertia: mass.inertia.inverse(),
            body,
        });
        Ok(number)
    }

    /// Returns the bodies that move, by their numbers.
    #[must_use]
    pub fn bodies(&self) -> &[Rigid] {
        &self.bodies
    }

    /// Returns the bodies that move, by their numbers.
    pub fn bodies_mut(&mut self) -> &mut [Rigid] {
        &mut self.bodies
    }

    /// Returns the energy of all bodies: of motion, and of height.
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.bodies.iter().map(Rigid::energy).sum()
    }

    /// Returns the greatest depth of the contacts of the last step.
    #[must_use]
    pub fn deepest(&self) -> f64 {
        let manifolds = self.world.pairs().flat_map(|pair| pair.manifolds);
        manifolds.flat_map(|manifold| &manifold.points).fold(0.0, |deepest, point| point.upper.max(deepest))
    }

    /// Advances time by [`STEP`].
    ///
    /// # Errors
    /// Returns an error if a body left the range of poses.
    pub fn step(&mut self) -> Result<(), WorldError> {
        let mut contacts = self.contacts()?;
        for _ in 0..SUBSTEPS {
            self.bodies.iter_mut().for_each(|body| body.velocity += GRAVITY * SUBSTEP);
            for contact in &contacts {
                (0..3).for_each(|axis| self.push(contact, axis, contact.impulse[axis]));
            }
            (0..PASSES).for_each(|_| self.solve(&mut contacts, true));
            for body in &mut self.bodies {
                body.position += body.velocity * SUBSTEP;
                body.turn = (DQuat::from_scaled_axis(body.spin * SUBSTEP) * body.turn).normalize();
            }
            (0..PASSES).for_each(|_| self.solve(&mut contacts, false));
        }
        self.impulses = contacts.into_iter().map(|contact| (contact.key, contact.impulse)).collect();
        Ok(())
    }

    /// Moves the bodies of the world and returns the contacts of all pairs.
    fn contacts(&mut self) -> Result<Vec<Contact>, WorldError> {
        let pose = |body: &Rigid| Pose::try_from(DAffine3::from_rotation_translation(body.turn, body.position));
        let moves = self.bodies.iter().map(|body| Ok((body.body, pose(body)?)));
        self.world.step(&moves.collect::<Result<Vec<_>, WorldError>>()?)?;
        let mut contacts = Vec::new();
        for pair in self.world.pairs() {
            let tags = [pair.key.tag_a, pair.key.tag_b];
            pair.manifolds.iter().for_each(|manifold| self.add(tags, manifold, &mut contacts));
        }
        Ok(contacts)
    }

    fn add(&self, tags: [u64; 2], manifold: &Manifold, contacts: &mut Vec<Contact>) {
        let bodies = tags.map(|tag| (tag != STATIC).then_some(tag as usize));
        let normal = DVec3::from_array(manifold.normal);
        let (one, other) = normal.any_orthonormal_pair();
        for point in &manifold.points {
            let middle = (DVec3::from_array(point.point_a) + DVec3::from_array(point.point_b)) / 2.0;
            let of = |body: usize| &self.bodies[body];
            let key = (tags[0], tags[1], point.id);
            let arms = bodies.map(|body| middle - body.map_or(middle, |body| of(body).position));
            let anchors = [0, 1].map(|side| bodies[side].map_or(middle, |body| of(body).turn.inverse() * arms[side]));
            let axes = [one, other, normal];
            let yields = |side: usize, axis: DVec3| {
                bodies[side].map_or(0.0, |body| {
                    let turn = arms[side].cross(axis);
                    1.0 / of(body).mass + turn.dot(of(body).spin_from(turn))
                })
            };
            contacts.push(Contact {
                key,
                bodies,
                arms,
                anchors,
                axes,
                inertia: axes.map(|axis| 1.0 / (yields(0, axis) + yields(1, axis))),
                depth: (point.lower + point.upper) / 2.0,
                impulse: self.impulses.get(&key).copied().unwrap_or(DVec3::ZERO),
            });
        }
    }

    /// Returns the depth at a contact after its bodies have moved.
    fn depth(&self, contact: &Contact) -> f64 {
        let point = |side: usize| {
            contact.bodies[side].map_or(contact.anchors[side], |body| {
                self.bodies[body].position + self.bodies[body].turn * contact.anchors[side]
            })
        };
        contact.depth - (point(1) - point(0)).dot(contact.axes[2])
    }

    /// Changes the impulse of each contact so that its bodies no longer approach there, or leave
    /// each other if they are too deep.
    fn solve(&mut self, contacts: &mut [Contact], corrects_depth: bool) {
        let stiffness = SUBSTEP * FREQUENCY * (2.0 * DAMPING + SUBSTEP * FREQUENCY);
        for contact in contacts {
            let depth = self.depth(contact);
            let (mut wanted, mut softness) = (0.0, 0.0);
            if depth < 0.0 {
                // The bodies may approach until they touch.
                wanted = depth / SUBSTEP;
            } else if corrects_depth {
                let rate = FREQUENCY / (2.0 * DAMPING + SUBSTEP * FREQUENCY);
                wanted = ((depth - SLOP).max(0.0) * rate).min(MAX_CORRECTION);
                softness = 1.0 / (1.0 + stiffness);
            }
            for axis in 0..3 {
                let before = contact.impulse[axis];
                if axis == 2 {
                    let change = (wanted - self.approach(contact, axis)) * contact.inertia[axis];
                    contact.impulse.z = (before * (1.0 - softness) + change * (1.0 - softness)).max(0.0);
                } else {
                    // Friction is at most its coefficient times the push.
                    let limit = self.friction * contact.impulse.z;
                    let change = -self.approach(contact, axis) * contact.inertia[axis];
                    contact.impulse[axis] = (before + change).clamp(-limit, limit);
                }
                self.push(contact, axis, contact.impulse[axis] - before);
            }
        }
    }

    /// Returns the speed at which the second body leaves the first along an axis of a contact.
    fn approach(&self, contact: &Contact, axis: usize) -> f64 {
        let speed = |side: usize| {
            let at = |body: usize| self.bodies[body].velocity + self.bodies[body].spin.cross(contact.arms[side]);
            contact.bodies[side].map_or(0.0, |body| at(body).dot(contact.axes[axis]))
        };
        speed(1) - speed(0)
    }

    /// Applies an impulse along an axis of a contact to both bodies.
    fn push(&mut self, contact: &Contact, axis: usize, impulse: f64) {
        for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
            if let Some(body) = contact.bodies[side] {
                let (body, impulse) = (&mut self.bodies[body], contact.axes[axis] * (sign * impulse));
                body.velocity += impulse / body.mass;
                body.spin += body.spin_from(contact.arms[side].cross(impulse));
            }
        }
    }
}

impl Rigid {
    /// Returns the angular velocity that an angular impulse adds.
    fn spin_from(&self, impulse: DVec3) -> DVec3 {
        self.turn * (self.inverse_inertia * (self.turn.inverse() * impulse))
    }

    fn energy(&self) -> f64 {
        let spin = self.turn.inverse() * self.spin;
        let motion = self.mass * self.velocity.length_squared() + spin.dot(self.inertia * spin);
        motion / 2.0 - self.mass * GRAVITY.dot(self.position)
    }
}

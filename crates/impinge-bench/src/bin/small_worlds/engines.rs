//! The two engines that step a world.

use std::collections::HashMap;

use anyhow::Result;
use impinge::Pose;
use impinge::world::{Body, BodyId, NarrowPhase, Options, World};
use impinge_bench::samples::timed;
use rapier3d::prelude as rapier;

use crate::scene::Scene;

/// Engine with a body for each shape of a scene.
pub(crate) trait Engine {
    /// Moves all bodies to a variant of the scene, and returns the time of the step in seconds.
    fn step(&mut self, variant: usize) -> Result<f64>;

    /// Returns the pairs of bodies that intersect, in ascending order.
    fn pairs(&self) -> Vec<[usize; 2]>;
}

pub(crate) struct Impinge {
    world: World,
    ids: HashMap<BodyId, usize>,
    moves: Vec<Vec<(BodyId, Pose)>>,
}

impl Impinge {
    pub(crate) fn new(scene: &Scene, narrow_phase: NarrowPhase) -> Result<Self> {
        let mut world = World::with_options(Options { narrow_phase, ..Options::default() });
        let insert = |(shape, _): &(impinge::Shape, _)| world.insert(Body::new(shape.clone()));
        let ids: Vec<BodyId> = scene.shapes.iter().map(insert).collect::<Result<_, _>>()?;
        let moves = |poses: &Vec<(Pose, _)>| ids.iter().copied().zip(poses.iter().map(|(pose, _)| *pose)).collect();
        let moves = scene.poses.iter().map(moves).collect();
        Ok(Self { world, moves, ids: ids.into_iter().enumerate().map(|(at, id)| (id, at)).collect() })
    }
}

impl Engine for Impinge {
    fn step(&mut self, variant: usize) -> Result<f64> {
        let (seconds, stepped) = timed(|| self.world.step(&self.moves[variant]).map(|_| ()));
        stepped?;
        Ok(seconds)
    }

    fn pairs(&self) -> Vec<[usize; 2]> {
        ascending(self.world.pairs().map(|pair| [pair.key.a, pair.key.b].map(|id| self.ids[&id])))
    }
}

pub(crate) struct Rapier {
    pipeline: rapier::CollisionPipeline,
    islands: rapier::IslandManager,
    broad_phase: rapier::BroadPhaseBvh,
    narrow_phase: rapier::NarrowPhase,
    bodies: rapier::RigidBodySet,
    colliders: rapier::ColliderSet,
    handles: Vec<rapier::ColliderHandle>,
    poses: Vec<Vec<rapier::Pose>>,
}

impl Rapier {
    /// Sensors of rapier3d find intersections only, and its other colliders contacts.
    pub(crate) fn new(scene: &Scene, narrow_phase: NarrowPhase) -> Self {
        let mut colliders = rapier::ColliderSet::new();
        let insert = |(_, shape): &(_, rapier::SharedShape)| {
            let collider = rapier::ColliderBuilder::new(shape.clone())
                .active_collision_types(rapier::ActiveCollisionTypes::all())
                .sensor(narrow_phase == NarrowPhase::Intersections);
            colliders.insert(collider)
        };
        let handles = scene.shapes.iter().map(insert).collect();
        Self {
            pipeline: rapier::CollisionPipeline::new(),
            islands: rapier::IslandManager::new(),
            broad_phase: rapier::BroadPhaseBvh::new(),
            narrow_phase: rapier::NarrowPhase::new(),
            bodies: rapier::RigidBodySet::new(),
            colliders,
            handles,
            poses: scene.poses.iter().map(|poses| poses.iter().map(|(_, pose)| *pose).collect()).collect(),
        }
    }
}

impl Engine for Rapier {
    fn step(&mut self, variant: usize) -> Result<f64> {
        let step = || {
            for (&handle, &pose) in self.handles.iter().zip(&self.poses[variant]) {
                if let Some(collider) = self.colliders.get_mut(handle) {
                    collider.set_position(pose);
                }
            }
            self.pipeline.step(
                0.0,
                &mut self.islands,
                &mut self.broad_phase,
                &mut self.narrow_phase,
                &mut self.bodies,
                &mut self.colliders,
                &(),
                &(),
            );
        };
        Ok(timed(step).0)
    }

    fn pairs(&self) -> Vec<[usize; 2]> {
        let place: HashMap<_, _> = self.handles.iter().enumerate().map(|(at, &handle)| (handle, at)).collect();
        let sensed = self.narrow_phase.intersection_pairs().filter(|pair| pair.2).map(|pair| [pair.0, pair.1]);
        let in_touch =
            |pair: &&rapier::ContactPair| pair.find_deepest_contact().is_some_and(|(_, contact)| contact.dist <= 0.0);
        let touching = self.narrow_phase.contact_pairs().filter(in_touch).map(|pair| [pair.collider1, pair.collider2]);
        ascending(sensed.chain(touching).map(|pair| pair.map(|handle| place[&handle])))
    }
}

/// Returns pairs with the lower number first, in ascending order.
fn ascending(pairs: impl Iterator<Item = [usize; 2]>) -> Vec<[usize; 2]> {
    let mut pairs: Vec<[usize; 2]> = pairs.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    pairs.sort_unstable();
    pairs
}

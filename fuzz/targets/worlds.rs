//! Worlds in which bodies come, move and go: the pairs must be those of all bodies against all
//! others, for every broad phase.

#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use impinge::world::{Body, BodyId, BroadPhase, Layers, NarrowPhase, Options, World};
use impinge::{Pose, Shape, query};
use impinge_fuzz::lattice;
use libfuzzer_sys::fuzz_target;

/// Maximum number of bodies. The comparison takes quadratic time.
const MAX_BODIES: usize = 12;

#[derive(Debug)]
enum Event {
    Insert(Shape, Pose, Layers),
    /// Removes a body, whose index is taken modulo the number of bodies.
    Remove(usize),
    /// Moves a body in the next step.
    Move(usize, Pose),
    /// Places a body at once.
    Place(usize, Pose),
    Step,
}

#[derive(Debug)]
struct Story {
    broad_phase: BroadPhase,
    events: Vec<Event>,
}

impl<'a> Arbitrary<'a> for Story {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let broad_phase = *bytes.choose(&BroadPhase::ALL)?;
        let mut events = Vec::new();
        while !bytes.is_empty() && events.len() < 200 {
            events.push(match bytes.int_in_range(0..=9_u8)? {
                0..=3 => {
                    let bits = |bits: u8| u32::from(bits);
                    let layers = if bytes.ratio(1_u8, 8_u8)? {
                        Layers { on: bits(bytes.arbitrary()?), meets: bits(bytes.arbitrary()?) }
                    } else {
                        Layers::default()
                    };
                    Event::Insert(lattice::shape(bytes)?, lattice::pose(bytes)?, layers)
                }
                4 => Event::Remove(bytes.arbitrary::<u8>()?.into()),
                5 | 6 => Event::Move(bytes.arbitrary::<u8>()?.into(), lattice::pose(bytes)?),
                7 => Event::Place(bytes.arbitrary::<u8>()?.into(), lattice::pose(bytes)?),
                _ => Event::Step,
            });
        }
        events.push(Event::Step);
        Ok(Self { broad_phase, events })
    }
}

/// Returns the pairs of bodies that intersect, by asking each pair.
fn brute_force(world: &World, ids: &[BodyId]) -> Vec<[BodyId; 2]> {
    let body = |id: BodyId| world.body(id).expect("a body of the world");
    let mut pairs = Vec::new();
    for (at, &one) in ids.iter().enumerate() {
        for &other in &ids[at + 1..] {
            let (a, b) = (body(one), body(other));
            if !a.traits().layers.admit(b.traits().layers) {
                continue;
            }
            let placed = |body: &Body| body.shape().at(*body.world_from_body()).expect("a shape in its place");
            if query::intersects(&placed(&a), &placed(&b)) {
                pairs.push([one.min(other), one.max(other)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

fuzz_target!(|story: Story| {
    let options = Options { broad_phase: story.broad_phase, narrow_phase: NarrowPhase::Intersections };
    let mut world = World::with_options(options);
    let (mut ids, mut moves) = (Vec::new(), Vec::new());
    let mut known: Vec<[BodyId; 2]> = Vec::new();
    for event in story.events {
        match event {
            Event::Insert(shape, pose, layers) if ids.len() < MAX_BODIES => {
                ids.extend(world.insert(Body::new(shape).layers(layers).at(pose)));
            }
            Event::Remove(at) if !ids.is_empty() => {
                let id = ids.swap_remove(at % ids.len());
                moves.retain(|&(moved, _)| moved != id);
                world.remove(id).expect("a body of the world");
                assert!(world.pose(id).is_err());
            }
            Event::Move(at, pose) if !ids.is_empty() => moves.push((ids[at % ids.len()], pose)),
            Event::Place(at, pose) if !ids.is_empty() => {
                let _ = world.set_pose(ids[at % ids.len()], pose);
            }
            Event::Step => {
                // Shapes that do not stretch reject poses that are not rigid to the last bit.
                let stepped = world.step(&moves).map(|events| (events.began.clone(), events.ended.clone()));
                moves.clear();
                let Ok((began, ended)) = stepped else { continue };
                let sorted = |a: BodyId, b: BodyId| [a.min(b), a.max(b)];
                let mut found: Vec<_> = world.pairs().map(|pair| sorted(pair.key.a, pair.key.b)).collect();
                found.sort_unstable();
                assert_eq!(found, brute_force(&world, &ids));
                // The events lead from the pairs of the last step to those of this one.
                for key in ended {
                    let pair = sorted(key.a, key.b);
                    assert!(known.contains(&pair), "{pair:?} ended without having begun");
                    known.retain(|&one| one != pair);
                }
                for key in began {
                    let pair = sorted(key.a, key.b);
                    assert!(!known.contains(&pair), "{pair:?} began twice");
                    known.push(pair);
                }
                known.sort_unstable();
                assert_eq!(known, found);
            }
            _ => {}
        }
    }
});

//! Records of worlds: a world made of a record continues as the recorded one, also with changes
//! that no step has reported yet. Inconsistent records are rejected.

use impinge::Pose;
use impinge::query::Proximity;
use impinge::shape::Shape;
use impinge::world::{
    Body, BodyId, BroadPhase, Change, Kind, NarrowPhase, Options, Record, RecordError, Snapshot, Traits, World,
};
use impinge_testkit::generate::Rng;

use super::pose;

/// World with random changes that no step has reported yet.
struct ChangingWorld {
    world: World,
    ids: Vec<BodyId>,
    rng: Rng,
    shapes: Vec<Body>,
}

impl ChangingWorld {
    fn new(options: Options, seed: u64) -> Self {
        let shapes = [
            Shape::cuboid([0.6, 0.5, 0.4]).unwrap(),
            Shape::sphere([0.1, 0.0, 0.0], 0.6).unwrap(),
            Shape::capsule([0.0, 0.0, -0.5], [0.0, 0.0, 0.5], 0.3).unwrap(),
            Shape::half_space([0.0, 0.0, 1.0], -1.5).unwrap(),
        ];
        let shapes = shapes.map(Body::new).to_vec();
        Self { world: World::with_options(options), ids: Vec::new(), rng: Rng::new(seed), shapes }
    }

    /// Makes a random change between two steps.
    fn change(&mut self) {
        let Self { world, ids, rng, shapes } = self;
        match rng.integer(0, 5) {
            _ if ids.len() < 20 => {}
            0 | 1 => {
                let gone = rng.integer(0, ids.len() as i64 - 1) as usize;
                world.remove(ids.swap_remove(gone)).unwrap();
                return;
            }
            2 => {
                let id = ids[rng.integer(0, ids.len() as i64 - 1) as usize];
                world.set_pose(id, pose(rng, 2.0)).unwrap();
                return;
            }
            3 => {
                let id = ids[rng.integer(0, ids.len() as i64 - 1) as usize];
                let owner = rng.one_in(2).then_some(7);
                world.set_traits(id, Traits { owner, ..Traits::default() }).unwrap();
                return;
            }
            _ => {}
        }
        // Half-spaces are rare, and tags are often equal.
        let kind = if rng.one_in(12) { 3 } else { rng.integer(0, 2) as usize };
        let body = shapes[kind].clone().tag(rng.integer(0, 4) as u64).at(pose(rng, 2.0));
        let body = if kind == 3 { body.kind(Kind::Static).at(Pose::IDENTITY) } else { body };
        ids.push(world.insert(body).unwrap());
    }

    fn moves(&mut self) -> Vec<(BodyId, Pose)> {
        let Self { world, ids, rng, .. } = self;
        let moving = ids.iter().filter(|&&id| world.traits(id).unwrap().kind != Kind::Static);
        let moving: Vec<BodyId> = moving.copied().filter(|_| rng.one_in(3)).collect();
        moving.into_iter().map(|id| (id, pose(rng, 2.0))).collect()
    }
}

/// Returns a description of all pairs of a world.
fn described_pairs(world: &World) -> String {
    world.pairs().map(|pair| format!("{pair:?}\n")).collect()
}

#[test]
fn a_world_of_a_record_continues_as_the_recorded_one() {
    let intersections = |broad_phase| Options { broad_phase, narrow_phase: NarrowPhase::Intersections };
    let ways = BroadPhase::ALL.map(intersections).into_iter().chain([Options::default()]);
    let (mut pending, mut departed, mut met) = (0, 0, 0);
    for (seed, options) in ways.enumerate() {
        let mut changing = ChangingWorld::new(options, seed as u64);
        (0..40).for_each(|_| changing.change());
        for _ in 0..12 {
            let moves = changing.moves();
            changing.world.step(&moves).unwrap();
            (0..6).for_each(|_| changing.change());
            let record = changing.world.save().to_record();
            pending += record.bodies.iter().filter(|body| body.change != Change::No).count();
            departed += record.departed.len();
            met += record.pairs.iter().filter(|pair| pair.meeting.is_some()).count();
            let mut other = World::with_options(options);
            other.restore(&Snapshot::from_record(&record, &options).unwrap());
            assert_eq!(described_pairs(&other), described_pairs(&changing.world));
            assert!(other.bodies().eq(changing.world.bodies()));
            // Recording again gives the same record, and the next step gives the same events and
            // work.
            assert_eq!(format!("{:?}", other.save().to_record()), format!("{record:?}"));
            let moves = changing.moves();
            assert_eq!(other.step(&moves).unwrap(), changing.world.step(&moves).unwrap());
            assert_eq!(described_pairs(&other), described_pairs(&changing.world));
            let next = changing.shapes[0].clone();
            assert_eq!(other.insert(next.clone()), changing.world.insert(next), "the same handle");
            changing.ids.push(changing.world.bodies().last().unwrap());
            changing.ids = changing.world.bodies().collect();
        }
    }
    assert!(pending > 300 && departed > 50 && met > 1000, "{pending} changes, {departed} gone, {met} pairs");
}

/// Returns a record of two overlapping spheres, and one that was removed.
fn record() -> Record {
    let ball = Body::new(Shape::sphere([0.0; 3], 1.0).unwrap());
    let mut world = World::new();
    let gone = world.insert(ball.clone()).unwrap();
    world.insert(ball.clone()).unwrap();
    world.insert(ball.at(Pose::from_translation([1.5, 0.0, 0.0]).unwrap())).unwrap();
    world.remove(gone).unwrap();
    world.step(&[]).unwrap();
    world.save().to_record()
}

#[test]
fn inconsistent_records_are_rejected() {
    let flaw = |spoil: &dyn Fn(&mut Record)| {
        let mut record = record();
        spoil(&mut record);
        Snapshot::from_record(&record, &Options::default()).err()
    };
    assert_eq!(flaw(&|_| {}), None);
    let places: [&dyn Fn(&mut Record); 9] = [
        &|record| record.generations.truncate(2),
        &|record| record.generations.push(3),
        &|record| record.generations[1] += 1,
        &|record| record.generations[1] += 2,
        &|record| record.free.clear(),
        &|record| record.free.push(0),
        &|record| record.free.push(1),
        &|record| record.free.push(99),
        &|record| record.bodies[1].id = record.bodies[0].id,
    ];
    for spoil in places {
        assert_eq!(flaw(spoil), Some(RecordError::Places));
    }
    let pairs: [&dyn Fn(&mut Record); 4] = [
        &|record| record.pairs[0].bodies[0] = BodyId::from_bits(0),
        &|record| record.pairs[0].bodies[0] = record.pairs[0].bodies[1],
        &|record| record.pairs[0].bodies.reverse(),
        &|record| record.pairs.insert(0, record.pairs[0].clone()),
    ];
    for (spoil, row) in pairs.into_iter().zip([0, 0, 0, 1]) {
        assert_eq!(flaw(spoil), Some(RecordError::Pair { row }));
    }
    let meetings: [&dyn Fn(&mut Record); 3] = [
        &|record| record.pairs[0].meeting.as_mut().unwrap().0 = Proximity::Apart,
        &|record| record.pairs[0].meeting.as_mut().unwrap().1[0].normal[1] = f64::NAN,
        &|record| record.pairs[0].meeting.as_mut().unwrap().1[0].points[0].lower = f64::NAN,
    ];
    for spoil in meetings {
        assert_eq!(flaw(spoil), Some(RecordError::Contact { row: 0 }));
    }
    let stretched = Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    let refused = flaw(&|record| record.bodies[0].body = record.bodies[0].body.clone().at(stretched));
    assert!(matches!(refused, Some(RecordError::Input { .. })), "{refused:?}");
}

#[test]
fn a_slot_without_unused_handles_stays_unused() {
    let mut spent = record();
    spent.generations[0] = u32::MAX;
    spent.free.clear();
    let mut world = World::new();
    world.restore(&Snapshot::from_record(&spent, world.options()).unwrap());
    let next = world.insert(Body::new(Shape::sphere([0.0; 3], 1.0).unwrap())).unwrap();
    assert_eq!(next.to_bits() >> 32, 3);
}

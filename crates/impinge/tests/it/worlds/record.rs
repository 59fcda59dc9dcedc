//! Records: that a world made of one is the world that was recorded, whatever has not been told yet; and that what
//! contradicts itself is refused.

use impinge::Pose;
use impinge::query::Proximity;
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, Change, Kind, NarrowPhase, Options, Record, RecordFlaw, Snapshot, Traits, World};
use impinge_testkit::generate::Rng;

use super::{BROAD_PHASES, pose};

/// A world in whose bodies something is always changed that no step has told of.
struct Storm {
    world: World,
    ids: Vec<BodyId>,
    rng: Rng,
    shapes: Vec<Body>,
}

impl Storm {
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

    /// Anything that may be done between two steps.
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

/// Everything that a world says of its pairs.
fn said(world: &World) -> String {
    world.pairs().map(|pair| format!("{pair:?}\n")).collect()
}

#[test]
fn a_world_of_a_record_goes_on_as_the_one_that_was_recorded() {
    let intersections = |broad_phase| Options { broad_phase, narrow_phase: NarrowPhase::Intersections };
    let ways = BROAD_PHASES.map(intersections).into_iter().chain([Options::default()]);
    let (mut pending, mut departed, mut met) = (0, 0, 0);
    for (seed, options) in ways.enumerate() {
        let mut storm = Storm::new(options, seed as u64);
        (0..40).for_each(|_| storm.change());
        for _ in 0..12 {
            let moves = storm.moves();
            storm.world.step(&moves).unwrap();
            (0..6).for_each(|_| storm.change());
            let record = storm.world.save().to_record();
            pending += record.bodies.iter().filter(|body| body.change != Change::No).count();
            departed += record.departed.len();
            met += record.pairs.iter().filter(|pair| pair.meeting.is_some()).count();
            let mut other = World::with_options(options);
            other.restore(&Snapshot::from_record(&record, &options).unwrap());
            assert_eq!(said(&other), said(&storm.world));
            assert!(other.bodies().eq(storm.world.bodies()));
            // The record of the record is the same, and so is all that comes after it, the work included.
            assert_eq!(format!("{:?}", other.save().to_record()), format!("{record:?}"));
            let moves = storm.moves();
            assert_eq!(other.step(&moves).unwrap(), storm.world.step(&moves).unwrap());
            assert_eq!(said(&other), said(&storm.world));
            let next = storm.shapes[0].clone();
            assert_eq!(other.insert(next.clone()), storm.world.insert(next), "the same handle");
            storm.ids.push(storm.world.bodies().last().unwrap());
            storm.ids = storm.world.bodies().collect();
        }
    }
    assert!(pending > 300 && departed > 50 && met > 1000, "{pending} changes, {departed} gone, {met} pairs");
}

/// A record of two balls that meet, and one that is gone.
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
fn what_contradicts_itself_is_refused() {
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
        assert_eq!(flaw(spoil), Some(RecordFlaw::Places));
    }
    let pairs: [&dyn Fn(&mut Record); 4] = [
        &|record| record.pairs[0].bodies[0] = BodyId::from_bits(0),
        &|record| record.pairs[0].bodies[0] = record.pairs[0].bodies[1],
        &|record| record.pairs[0].bodies.reverse(),
        &|record| record.pairs.insert(0, record.pairs[0].clone()),
    ];
    for (spoil, row) in pairs.into_iter().zip([0, 0, 0, 1]) {
        assert_eq!(flaw(spoil), Some(RecordFlaw::Pair { row }));
    }
    let meetings: [&dyn Fn(&mut Record); 3] = [
        &|record| record.pairs[0].meeting.as_mut().unwrap().0 = Proximity::Apart,
        &|record| record.pairs[0].meeting.as_mut().unwrap().1[0].normal[1] = f64::NAN,
        &|record| record.pairs[0].meeting.as_mut().unwrap().1[0].points[0].lower = f64::NAN,
    ];
    for spoil in meetings {
        assert_eq!(flaw(spoil), Some(RecordFlaw::Contact { row: 0 }));
    }
    let stretched = Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    let refused = flaw(&|record| record.bodies[0].body = record.bodies[0].body.clone().at(stretched));
    assert!(matches!(refused, Some(RecordFlaw::Input { .. })), "{refused:?}");
}

#[test]
fn a_place_whose_handles_are_spent_stays_so() {
    let mut spent = record();
    spent.generations[0] = u32::MAX;
    spent.free.clear();
    let mut world = World::new();
    world.restore(&Snapshot::from_record(&spent, world.options()).unwrap());
    let next = world.insert(Body::new(Shape::sphere([0.0; 3], 1.0).unwrap())).unwrap();
    assert_eq!(next.to_bits() >> 32, 3);
}

//! Tests of characters whose parts are bodies of a world, against all pairs of parts.

use std::collections::BTreeSet;

use impinge::character::{Mode, PartBodies, Posed};
use impinge::query;
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, Kind, Layers, Traits, World};

use super::{Random, fitted, robot};

type Pairs = BTreeSet<(BodyId, BodyId)>;

fn ordered(a: BodyId, b: BodyId) -> (BodyId, BodyId) {
    (a.min(b), a.max(b))
}

/// Returns all pairs of parts of different characters whose shapes intersect.
fn brute_force(crowd: &[(Posed<'_>, PartBodies)]) -> Pairs {
    let mut pairs = Pairs::new();
    let placed = |posed: &Posed<'_>, part: usize| {
        posed.character().parts()[part].volume().placed(posed.frames()[part].pose().unwrap()).unwrap()
    };
    for (at, (a, of_a)) in crowd.iter().enumerate() {
        for (b, of_b) in &crowd[..at] {
            for (i, &body_a) in of_a.bodies().iter().enumerate() {
                for (j, &body_b) in of_b.bodies().iter().enumerate() {
                    if query::intersects(placed(a, i), placed(b, j)) {
                        pairs.insert(ordered(body_a, body_b));
                    }
                }
            }
        }
    }
    pairs
}

#[test]
fn events_of_parts_equal_those_of_brute_force() {
    let rig = robot();
    let characters = [fitted(&rig, 12, Mode::Conservative), fitted(&rig, 5, Mode::Snug)];
    let mut random = Random(21);
    let mut world = World::new();
    let places: [[f64; 3]; 5] = std::array::from_fn(|_| [3.0 * random.next(), 0.0, 3.0 * random.next()]);
    let mut crowd = Vec::new();
    for (owner, place) in (0..).zip(places) {
        let mut posed = Posed::new(&characters[owner % 2], &rig.rest_pose().unwrap());
        posed.set_at(&rig.rest_pose().unwrap(), place);
        let traits = Traits { owner: Some(owner as u64), tag: 100 * owner as u64, ..Traits::default() };
        let bodies = PartBodies::insert(&mut world, &posed, traits).unwrap();
        assert_eq!(bodies.bodies().len(), posed.character().parts().len());
        for (part, &body) in (0..).zip(bodies.bodies()) {
            assert_eq!(bodies.part(body), Some(part));
            assert_eq!(world.traits(body).unwrap().tag, 100 * owner as u64 + u64::from(part));
        }
        crowd.push((posed, bodies));
    }
    let (mut now, mut began, mut ended) = (Pairs::new(), 0, 0);
    let mut moves = Vec::new();
    for frame in 0..40 {
        moves.clear();
        for (posed, bodies) in &mut crowd {
            let owner = world.traits(bodies.bodies()[0]).unwrap().owner.unwrap() as usize;
            posed.set_at(&rig.pose_at(owner, 0.05 * f64::from(frame)).unwrap(), places[owner]);
            bodies.moves(posed, &mut moves).unwrap();
        }
        let events = world.step(&moves).unwrap();
        for pair in &events.began {
            assert!(now.insert(ordered(pair.a, pair.b)));
        }
        for pair in &events.ended {
            assert!(now.remove(&ordered(pair.a, pair.b)));
        }
        (began, ended) = (began + events.began.len(), ended + events.ended.len());
        assert_eq!(now, brute_force(&crowd), "{frame}");
        // The volumes of one character overlap, but no pair is within one character.
        let owner = |body: BodyId| crowd.iter().position(|(_, bodies)| bodies.part(body).is_some()).unwrap();
        assert!(now.iter().all(|&(a, b)| owner(a) != owner(b)));
    }
    assert!(began > 60 && ended > 30, "{began} {ended}");

    // Removing a character ends all of its pairs, and leaves the others.
    let (_, bodies) = crowd.pop().unwrap();
    let own: BTreeSet<BodyId> = bodies.bodies().iter().copied().collect();
    let clone = bodies.clone();
    bodies.remove(&mut world).unwrap();
    let events = world.step(&[]).unwrap();
    let expected: Vec<_> = now.iter().filter(|(a, b)| own.contains(a) || own.contains(b)).collect();
    assert!(!expected.is_empty() && events.began.is_empty());
    assert_eq!(events.ended.iter().map(|p| ordered(p.a, p.b)).collect::<BTreeSet<_>>().len(), expected.len());
    assert_eq!(world.len(), crowd.iter().map(|(_, bodies)| bodies.bodies().len()).sum::<usize>());
    assert!(clone.remove(&mut world).is_err());
}

#[test]
fn parts_of_one_character_form_pairs_only_without_an_owner() {
    let rig = robot();
    let character = fitted(&rig, 12, Mode::Conservative);
    let posed = Posed::new(&character, &rig.rest_pose().unwrap());
    for (owner, layers, meets) in
        [(None, Layers::ALL, true), (Some(3), Layers::ALL, false), (None, Layers { on: 1, meets: 2 }, false)]
    {
        let mut world = World::new();
        let traits = Traits { owner, layers, kind: Kind::Moving, tag: u64::MAX, surface: None };
        let bodies = PartBodies::insert(&mut world, &posed, traits).unwrap();
        assert_eq!(!world.step(&[]).unwrap().began.is_empty(), meets);
        // Tags wrap around.
        assert_eq!(world.traits(bodies.bodies()[1]).unwrap().tag, 0);
        // A floor intersects the feet, and belongs to no part.
        let floor = Shape::half_space([0.0, 1.0, 0.0], 0.05).unwrap();
        let floor = world.insert(Body::new(floor).kind(Kind::Static).layers(Layers { on: 3, meets: 3 })).unwrap();
        let struck: BTreeSet<&str> = world
            .step(&[])
            .unwrap()
            .began
            .iter()
            .map(|pair| {
                let part = bodies.part(pair.a).or(bodies.part(pair.b)).unwrap();
                character.parts()[part as usize].name.as_str()
            })
            .collect();
        assert!(bodies.part(floor).is_none());
        assert!(struck.iter().any(|name| name.contains("foot") || name.contains("leg")), "{struck:?}");
        assert!(!struck.contains("head"), "{struck:?}");
    }
}

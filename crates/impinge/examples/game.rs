//! A game's collision loop: crates and balls fall onto a floor, a door opens, a ghost passes
//! through it all, and a shot is taken back. `cargo run --release --example game`

#![allow(clippy::print_stdout, reason = "what an example prints is what it is for")]

use impinge::shape::Shape;
use impinge::world::{Body, BodyId, Kind, Layers, World, WorldError};
use impinge::{Mesh, Pose, Positions};

/// Layers are bits: what a body is on, and what it meets.
const SCENERY: u32 = 1;
const THINGS: u32 = 2;

fn main() -> Result<(), WorldError> {
    let mut world = World::new();

    // One shape, many bodies: a body is a recipe, and cloning it shares the shape.
    let things = Layers { on: THINGS, meets: SCENERY | THINGS };
    let crate_ = Body::new(Shape::cuboid([0.5; 3])?).layers(things);
    let ball = Body::new(Shape::sphere([0.0; 3], 0.4)?).layers(things);
    let corners = vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]];
    let floor = Mesh::new(Positions::F32(corners), vec![[0, 1, 2], [0, 2, 3]])?;
    let scenery = Layers { on: SCENERY, meets: u32::MAX };
    world.insert(Body::new(Shape::mesh(&floor)).kind(Kind::Static).layers(scenery))?;
    let door = world.insert(
        Body::new(Shape::cuboid([1.0, 0.1, 2.0])?).kind(Kind::Kinematic).layers(scenery).at(at([0.0, 3.0, 2.0])?),
    )?;
    let ghost = Body::new(Shape::sphere([0.0; 3], 1.0)?).layers(Layers { on: 4, meets: THINGS });
    world.insert(ghost.at(at([0.0, 0.0, 1.0])?))?; // meets nothing: no thing meets layer 4

    let mut falling: Vec<(BodyId, [f64; 3])> = Vec::new();
    for number in 0..8_u32 {
        let place = [f64::from(number % 4) * 1.5 - 2.0, f64::from(number / 4) * 2.5, 3.0 + f64::from(number)];
        let body = if number % 2 == 0 { &crate_ } else { &ball };
        falling.push((world.insert(body.clone().tag(number.into()).at(at(place)?))?, place));
    }

    for frame in 0..240 {
        // The game moves things; the world says what they run into.
        let mut moves = vec![(door, at([f64::from(frame) * 0.01, 3.0, 2.0])?)];
        for (body, place) in &mut falling {
            place[2] -= 0.03;
            moves.push((*body, at(*place)?));
        }
        let events = world.step(&moves)?.clone();
        for key in &events.began {
            println!("frame {frame}: {} meets {}", key.a, key.b);
        }
        // Push things out of what they sank into, along the normal from the first body to the
        // second.
        for (body, place) in &mut falling {
            for pair in world.pairs_of(*body)? {
                let Some(manifold) = pair.manifolds.first() else { continue };
                let depth = manifold.points.iter().map(|point| point.upper).fold(0.0, f64::max);
                let side = if pair.key.a == *body { -1.0 } else { 1.0 };
                (0..3).for_each(|k| place[k] += side * depth * manifold.normal[k]);
            }
        }
    }

    // Rewind: the same steps from here give the same bytes.
    let saved = world.save();
    world.remove(falling[0].0)?;
    world.restore(&saved);
    println!("{} bodies, {} pairs", world.len(), world.pairs().count());
    Ok(())
}

fn at(place: [f64; 3]) -> Result<Pose, WorldError> {
    Ok(Pose::from_translation(place)?)
}

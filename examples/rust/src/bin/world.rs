//! A world of bodies that the caller moves: each step reports which pairs start or stop touching.
//!
//! The tags 0, 1, 2 and so on are the caller's own numbers. Reports are sorted by them.

use std::error::Error;

use impinge::partition::Ray;
use impinge::world::{Body, Kind, World};
use impinge::{Pose, Shape};

fn main() -> Result<(), Box<dyn Error>> {
    let mut world = World::new();
    world.insert(Body::new(Shape::half_space([0.0, 0.0, 1.0], 0.0)?).kind(Kind::Static).tag(0))?;
    let mut heights = [1.0_f64, 2.25, 3.5];
    let crate_ = Body::new(Shape::cuboid([0.5; 3])?);
    let mut bodies = Vec::new();
    for (z, tag) in heights.into_iter().zip(1..) {
        bodies.push(world.insert(crate_.clone().at(Pose::from_translation([0.0, 0.0, z])?).tag(tag))?);
    }
    let balloon = Body::new(Shape::sphere([0.0; 3], 0.25)?).tag(4);
    bodies.push(world.insert(balloon.at(Pose::from_translation([0.625, 0.0, 0.25])?))?);

    for frame in 0..8 {
        // The crates fall, and the balloon rises beside them.
        for (z, least) in heights.iter_mut().zip([0.5, 1.5, 2.5]) {
            *z = (*z - 0.25).max(least);
        }
        let mut places: Vec<[f64; 3]> = heights.iter().map(|&z| [0.0, 0.0, z]).collect();
        places.push([0.625, 0.0, 0.25 + 0.375 * f64::from(frame)]);
        let poses = places.into_iter().map(Pose::from_translation).collect::<Result<Vec<_>, _>>()?;
        let moves: Vec<_> = bodies.iter().copied().zip(poses).collect();
        let step = world.step(&moves)?;
        step.began.iter().for_each(|pair| println!("frame {frame}: {} and {} start touching", pair.tag_a, pair.tag_b));
        step.ended.iter().for_each(|pair| println!("frame {frame}: {} and {} stop touching", pair.tag_a, pair.tag_b));
    }

    for pair in world.pairs() {
        let points: usize = pair.manifolds.iter().map(|manifold| manifold.points.len()).sum();
        let [x, y, z] = pair.manifolds[0].normal;
        let (a, b) = (pair.key.tag_a, pair.key.tag_b);
        println!("{a} touches {b} in {points} points along ({x:.6}, {y:.6}, {z:.6})");
    }

    let ray = Ray::new([0.125, 0.25, 9.0], [0.0, 0.0, -1.0], f64::INFINITY)?;
    let hit = world.ray_cast(&ray, |_| true).ok_or("the ray hits nothing")?;
    println!("a ray from above hits {} at {:.6}", hit.tag, hit.t);

    // A world can return to a saved state.
    let saved = world.save();
    bodies[..3].iter().try_for_each(|&body| world.remove(body).map(|_| ()))?;
    println!("{} bodies without the crates", world.len());
    world.restore(&saved);
    println!("{} bodies, {} pairs", world.len(), world.pairs().count());
    Ok(())
}

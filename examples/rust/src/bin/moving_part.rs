//! A part that moves: when it first touches another part, found without stepping through the
//! motion.
//!
//! No contact is missed, however fast the parts move and however thin they are.

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use impinge::query::batch::{Broadcast, Execution};
use impinge::sweep::{Motion, time_of_impact, times_of_impact};
use impinge::{Mesh, Pose, Shape};

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let human = Mesh::new(model.positions, model.faces)?;
    let rest = Motion::default();

    // A door swings by a quarter turn about its hinge, toward a human who stands in its way.
    let door = Shape::cuboid([0.5, 1.0, 0.03125])?;
    let hinge = [-0.75, 0.0, -0.5];
    let shut = Pose::from_translation([-0.25, 0.0, -0.5])?;
    let swing = Motion::screw(shut, [0.0; 3], [0.0, -FRAC_PI_2, 0.0], Some(hinge))?;
    let impact = time_of_impact(&human, &door, &rest, &swing)?;
    if impact.hit() {
        let t = impact.t_lower;
        println!("the door touches at {t:.6} of its way, after {:.6} degrees", 90.0 * t);
    }

    // Another human walks by: from one pose to another in a straight line.
    let walk = walk_past(0.125)?;
    let impact = time_of_impact(&human, &human, &rest, &walk)?;
    if impact.hit() {
        let t = impact.t_lower;
        let [x, y, z] = *walk.at(t).translation();
        println!("the humans touch at {t:.6} of the walk, at ({x:.6}, {y:.6}, {z:.6})");
    }

    // Many motions in one call: parallel walks, each farther away than the one before.
    let walks = (0..5).map(|lane| walk_past(f64::from(lane) / 8.0)).collect::<Result<Vec<_>, _>>()?;
    let broadcast = Broadcast::new(&[], &[walks.len()])?;
    let impacts = times_of_impact(&human, &human, [&[rest], &walks], &broadcast, Execution::default())?;
    for (lane, impact) in impacts.into_iter().enumerate() {
        match impact? {
            impact if impact.hit() => println!("lane {lane}: touches at {:.6}", impact.t_lower),
            _ => println!("lane {lane}: passes by"),
        }
    }
    Ok(())
}

/// Returns a walk past the human, at a distance along z.
fn walk_past(z: f64) -> Result<Motion, impinge::InputError> {
    Motion::between(Pose::from_translation([-3.0, 0.0, z])?, Pose::from_translation([3.0, 0.0, z])?)
}

//! Worlds: every broad phase finds all pairs, after any additions, removals and moves.

mod boxes;
mod canceled;
mod casts;
mod crowds;
mod events;
mod kinds;
mod laws;
mod margins;
mod nearest;
mod rays;
mod record;
mod shapes;
mod surfaces;
mod tiles;

use impinge::Pose;
use impinge_testkit::generate::{Rng, poses};

/// Returns a rotation and a translation within `reach`. One in four is on a grid, so that boxes
/// touch.
fn pose(rng: &mut Rng, reach: f64) -> Pose {
    if rng.one_in(4) {
        return Pose::from_translation([0; 3].map(|_| (rng.uniform(-reach, reach)).round())).unwrap();
    }
    let turn = poses::rotation(rng);
    Pose::new(turn.linear, turn.translation.map(|x| x * reach * 0.1)).unwrap()
}

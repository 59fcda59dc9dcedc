//! Random boxes in a cube.

use anyhow::Result;
use impinge::Pose;
use impinge::shape::Shape;
use impinge::world::Body;
use impinge_testkit::generate::Rng;

/// Returns a box of about the given size, somewhere in a cube from -`reach` to `reach` on each
/// axis. If `reach` is the cube root of the number of bodies, their mean spacing is 2.
pub(crate) fn boxed(rng: &mut Rng, size: f64, reach: f64) -> Result<Body> {
    let half = [0; 3].map(|_| 0.5 * size * rng.uniform(0.8, 1.0));
    let at = [0; 3].map(|_| rng.uniform(-reach, reach));
    Ok(Body::new(Shape::cuboid(half)?).at(Pose::from_translation(at)?))
}

/// Returns a random size: from 0.5 to 1.5, or with a Pareto distribution over a ratio of 1,000.
pub(crate) fn size(rng: &mut Rng, is_spread: bool) -> f64 {
    if is_spread { (0.1 / (1.0 - rng.unit()).sqrt()).min(100.0) } else { rng.uniform(0.5, 1.5) }
}

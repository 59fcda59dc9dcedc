//! Random boxes and their moves. All coordinates are exact in single precision.

use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;

/// Maximum move of a box per step along each axis, relative to its size.
const STEP: f64 = 0.1;

/// Returns a box with corners rounded to single precision.
fn rounded(low: [f64; 3], size: [f64; 3]) -> MinMax {
    let [low, high] =
        [low, std::array::from_fn(|k| low[k] + size[k])].map(|corner| corner.map(|x| f64::from(x as f32)));
    MinMax::new(low, high).expect("finite and in order")
}

/// Returns boxes of sizes from 0.5 to 1.5 on each axis, at a mean spacing of 2. Each overlaps about
/// one other.
pub(crate) fn like(count: usize, rng: &mut Rng) -> Vec<MinMax> {
    let side = 2.0 * (count as f64).cbrt();
    let place = |rng: &mut Rng| [0; 3].map(|_: i32| rng.uniform(0.0, side));
    (0..count).map(|_| rounded(place(rng), [0; 3].map(|_: i32| rng.uniform(0.5, 1.5)))).collect()
}

/// Returns boxes of sizes from 0.5 to 500, with a Pareto distribution: the share of boxes larger
/// than s is proportional to s^-2. Each overlaps about one other.
pub(crate) fn pareto(count: usize, rng: &mut Rng) -> Vec<MinMax> {
    let side = 6.4 * (count as f64).cbrt();
    (0..count)
        .map(|_| {
            let low = [0; 3].map(|_: i32| rng.uniform(0.0, side));
            let size = 0.5 / rng.uniform(1e-6, 1.0).sqrt();
            rounded(low, [0; 3].map(|_: i32| size * rng.uniform(0.75, 1.25)))
        })
        .collect()
}

/// Returns a box after one random move.
pub(crate) fn nudged(bounds: &MinMax, rng: &mut Rng) -> MinMax {
    let shift = [0; 3].map(|_: i32| rng.uniform(-STEP, STEP));
    let (min, max) = (bounds.min(), bounds.max());
    rounded([0, 1, 2].map(|k| min[k] + shift[k]), [0, 1, 2].map(|k| max[k] - min[k]))
}

/// Returns the same box for parry3d, in single precision.
pub(crate) fn for_parry(bounds: &MinMax) -> Aabb {
    let [low, high] = [bounds.min(), bounds.max()].map(|corner| {
        let [x, y, z] = corner.map(|x| x as f32);
        Vector::new(x, y, z)
    });
    Aabb::new(low, high)
}

//! The bounds of a triangle hold all of its points, and little else.

use impinge_testkit::generate::Rng;

use super::*;
use crate::math::vec3::{Vector, cross, sub};
use crate::simd::{dispatch, levels};

/// Eight triangles relative to a local origin.
struct Trial {
    about: [[[f32; LANES]; 3]; 3],
    local_origin: Vector,
    error: f64,
}

impl Trial {
    /// Makes triangles on a grid, at random, or slivers.
    fn new(rng: &mut Rng) -> Self {
        let kind = rng.integer(0, 2);
        let mut about = [[[0.0; LANES]; 3]; 3];
        for lane in 0..LANES {
            let short = rng.integer(0, 2) as usize;
            for axis in 0..3 {
                for corner in &mut about {
                    corner[axis][lane] =
                        if kind == 0 { 0.125 * rng.integer(-3, 3) as f32 } else { rng.uniform(-0.4, 0.4) as f32 };
                }
                if kind == 2 {
                    about[(short + 1) % 3][axis][lane] = about[short][axis][lane] + rng.uniform(-1e-5, 1e-5) as f32;
                }
            }
        }
        let local_origin = [0; 3].map(|_| if kind == 0 { 0.25 } else { rng.uniform(-0.5, 0.5) });
        Self { about, local_origin, error: [0.0, 1e-5][rng.integer(0, 1) as usize] }
    }

    fn corners(&self, lane: usize) -> [Vector; 3] {
        self.about.map(|corner| std::array::from_fn(|axis| self.local_origin[axis] + f64::from(corner[axis][lane])))
    }

    /// Returns a random point of a triangle or a corner of it, moved by the error.
    fn point(&self, lane: usize, rng: &mut Rng) -> Vector {
        let corners = self.corners(lane);
        let mut point = corners[rng.integer(0, 2) as usize];
        if rng.one_in(2) {
            let (s, t) = (rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0));
            let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
            point = std::array::from_fn(|axis| {
                (1.0 - s - t) * corners[0][axis] + s * corners[1][axis] + t * corners[2][axis]
            });
        }
        point.map(|x| x + [-1.0, 1.0][rng.integer(0, 1) as usize] * self.error)
    }

    /// Returns the boxes around `points` that are near a triangle, as bits, for each vector level.
    fn near(&self, lane: usize, points: &[Vector; LANES]) -> Vec<u32> {
        let mut boxes = BoxLanes::default();
        for (at, point) in points.iter().enumerate() {
            for axis in 0..3 {
                boxes.min[axis][at] = (point[axis] as f32).next_down();
                boxes.max[axis][at] = (point[axis] as f32).next_up();
            }
        }
        let node = Node::of_leaves(&boxes);
        let near = |level| {
            dispatch!(level, simd => {
                let about = by_axis!(corner => load3(simd, &self.about[corner]));
                Bounds::new(simd, &about, self.local_origin, self.error).near(simd, lane, &node)
            })
        };
        levels().into_iter().map(|(_, level)| near(level)).collect()
    }
}

#[test]
fn every_point_of_a_triangle_is_near_it() {
    let mut rng = Rng::new(3021);
    for _ in 0..3_000 {
        let trial = Trial::new(&mut rng);
        let lane = rng.integer(0, 7) as usize;
        let points = [0; LANES].map(|_| trial.point(lane, &mut rng));
        assert!(trial.near(lane, &points).iter().all(|&near| near == 0xff), "{:?}", trial.corners(lane));
    }
}

#[test]
fn boxes_off_a_triangle_are_pruned() {
    let mut rng = Rng::new(3022);
    let (mut all, mut near) = (0, 0);
    for _ in 0..3_000 {
        let trial = Trial::new(&mut rng);
        let lane = rng.integer(0, 7) as usize;
        let [a, b, c] = trial.corners(lane);
        let across = cross(&sub(&b, &a), &sub(&c, &a));
        let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 1e-7 {
            let points = [0; LANES].map(|_| {
                let point = trial.point(lane, &mut rng);
                std::array::from_fn(|axis| point[axis] + 1e-4 / length * across[axis])
            });
            for found in trial.near(lane, &points) {
                all += LANES;
                near += found.count_ones() as usize;
            }
        }
    }
    assert!(all > 15_000 * levels().len() && near < all / 100, "{near} of {all} are not pruned");
}

#[test]
fn nan_and_infinity_prune_nothing() {
    let mut trial = Trial::new(&mut Rng::new(3023));
    trial.error = f64::INFINITY;
    assert!(trial.near(3, &[[9.0; 3]; LANES]).iter().all(|&near| near == 0xff));
    trial.error = f64::NAN;
    assert!(trial.near(3, &[[9.0; 3]; LANES]).iter().all(|&near| near == 0xff));
}

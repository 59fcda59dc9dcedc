//! Random boxes of many kinds, with many ties.

use impinge::partition::Ray;
use impinge::volume::MinMax;
use impinge_testkit::generate::Rng;

use crate::partition::brute::Questions;

/// Distribution of random boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scene {
    /// Corners are integers: faces touch, boxes repeat, and some boxes are flat, lines or points.
    Grid,
    /// Sizes of about 1, distributed uniformly.
    Spread,
    /// Sizes over a ratio of 1e9. The largest boxes overlap nearly everything.
    Sizes,
    /// Far from the origin, where doubles are coarse.
    Far,
    /// Equal boxes, or points in one place.
    Coincident,
    /// A tight cluster, and a few boxes extremely far away.
    Outliers,
}

pub(crate) const ALL: [Scene; 6] =
    [Scene::Grid, Scene::Spread, Scene::Sizes, Scene::Far, Scene::Coincident, Scene::Outliers];

impl Scene {
    /// Returns the origin of the scene and its approximate extent from there.
    pub(crate) fn place(self) -> ([f64; 3], f64) {
        match self {
            Self::Grid => ([0.0; 3], 12.0),
            Self::Spread | Self::Outliers => ([0.0; 3], 16.0),
            Self::Sizes => ([0.0; 3], 100.0),
            Self::Far => ([1e7, -2e7, 3e7], 12.0),
            Self::Coincident => ([1.0, 2.0, 3.0], 1.0),
        }
    }

    pub(crate) fn draw(self, rng: &mut Rng) -> MinMax {
        let (origin, size) = self.place();
        let corners = |low: [f64; 3], extent: [f64; 3]| {
            MinMax::new(low, std::array::from_fn(|k| low[k] + extent[k])).expect("in range")
        };
        match self {
            Self::Grid => {
                let low = [0; 3].map(|_: i32| rng.integer(0, 12) as f64 - if rng.one_in(9) { 0.0 } else { 6.0 });
                corners(low, [0; 3].map(|_: i32| rng.integer(0, 2) as f64))
            }
            Self::Spread | Self::Far => {
                let low = std::array::from_fn(|k| origin[k] + rng.uniform(0.0, size));
                corners(low, [0; 3].map(|_: i32| rng.uniform(0.5, 1.5)))
            }
            Self::Sizes => {
                let extent = 1e-6 * 1e9_f64.powf(rng.unit() * rng.unit());
                let low = [0; 3].map(|_: i32| rng.uniform(-extent, size));
                corners(low, [0; 3].map(|_: i32| extent * rng.uniform(0.5, 1.0)))
            }
            Self::Coincident => corners(origin, if rng.one_in(3) { [0.0; 3] } else { [1.0; 3] }),
            Self::Outliers => {
                let far = if rng.one_in(20) { 2.0_f64.powi(rng.integer(10, 300) as i32) } else { 1.0 };
                let low = [0; 3].map(|_: i32| far * rng.uniform(-4.0, 4.0));
                let large = if rng.one_in(5) { far } else { 1.0 };
                corners(low, [0; 3].map(|_: i32| large * rng.uniform(0.0, 1.5)))
            }
        }
    }

    /// Returns a box near another one, and a little larger or smaller.
    pub(crate) fn nudge(self, bounds: &MinMax, rng: &mut Rng) -> MinMax {
        let step = match self {
            Self::Grid | Self::Coincident => 1.0,
            _ => 0.1,
        };
        let shift = [0; 3].map(|_: i32| step * rng.integer(-1, 1) as f64);
        let (min, max) = (bounds.min(), bounds.max());
        let low = [0, 1, 2].map(|k| min[k] + shift[k]);
        let high = [0, 1, 2].map(|k| (max[k] + shift[k]).max(low[k]));
        MinMax::new(low, high).expect("in range")
    }

    pub(crate) fn questions(self, rng: &mut Rng, count: usize) -> Questions {
        let (origin, size) = self.place();
        let mut questions = Questions::default();
        let place = |rng: &mut Rng| -> [f64; 3] {
            std::array::from_fn(|k| {
                let x = rng.uniform(-0.6 * size, 1.2 * size);
                origin[k] + if rng.one_in(2) { x.round() } else { x }
            })
        };
        for _ in 0..count {
            let low = place(rng);
            let extent = size * rng.choose(&[0.0, 0.1, 0.5, 3.0]);
            questions.boxes.push(MinMax::new(low, low.map(|x| x + extent)).expect("in range"));
            questions.boxes.push(self.draw(rng));
            questions.points.push(place(rng));
            let drawn = self.draw(rng);
            questions.points.push(drawn.min());
            questions.points.push(place(rng).map(|x| 50.0 * x));
            let direction = match rng.integer(0, 3) {
                0 => [1.0, 0.0, 0.0],
                1 => [0.0, -0.5, 0.0],
                2 => [1.0, -1.0, 1.0],
                _ => [0; 3].map(|_: i32| rng.uniform(-1.0, 1.0)),
            };
            let reach = rng.choose(&[f64::INFINITY, 0.3 * size, 0.0]);
            questions.rays.push(Ray::new(place(rng), direction, reach).expect("a ray"));
            let (from, to) = (place(rng), self.draw(rng).max());
            let towards: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
            if let Ok(ray) = Ray::new(from, towards, 2.0) {
                questions.rays.push(ray);
            }
        }
        questions
    }
}

//! Scripted scenes: bodies that move along paths known in advance and pass through each other, so
//! that every broad phase has the same work.
//!
//! Source: Serpa, Rodrigues, *Broadmark: a testing framework for broad-phase collision detection
//! algorithms*, Computer Graphics Forum 38 (2019), for the scenes. Theirs are simulated; ours are
//! scripted, so that a run repeats to the bit.

use clap::ValueEnum;
use impinge::shape::Shape;
use impinge::world::{Body, BodyId, World, WorldError};
use impinge::{InputError, Pose};

/// Time between two steps, in seconds.
const STEP_SECS: f64 = 1.0 / 60.0;

/// Acceleration of falling bodies, in units of length per second squared.
const GRAVITY: f64 = 9.81;

/// How the bodies move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Motion {
    /// All bodies move at random, all the time
    Brownian,
    /// All bodies fall through a shaft and enter it again at the top
    Fall,
    /// Bodies fall onto a pile one after the other and come to rest
    Pile,
}

/// Sizes of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Sizes {
    /// All of size 1
    Equal,
    /// Uniformly distributed between 0.5 and 1.5
    Like,
    /// Pareto distribution from 0.1 to 100: many small bodies, few large ones
    Spread,
}

/// Shapes of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Mix {
    Boxes,
    Spheres,
    /// Boxes, spheres, capsules and cylinders
    All,
}

/// Parameters of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recipe {
    pub(crate) motion: Motion,
    pub(crate) sizes: Sizes,
    pub(crate) mix: Mix,
    pub(crate) bodies: usize,
    pub(crate) seed: u64,
}

/// The moving bodies of a scene.
pub(crate) struct Scene {
    motion: Motion,
    /// Half the edge length of the cube that contains all bodies.
    reach: f64,
    bodies: Vec<MovingBody>,
    random: Random,
}

struct MovingBody {
    id: BodyId,
    at: [f64; 3],
    /// Rotation per step, as a unit quaternion (w, x, y, z).
    turn: [f64; 4],
    /// Rotation so far, as a unit quaternion (w, x, y, z).
    turned: [f64; 4],
    velocity: [f64; 3],
    /// Height at which the body comes to rest in a pile.
    rest: f64,
    /// Step at which the body of a pile starts to fall.
    start: usize,
}

impl Scene {
    /// Inserts the bodies into a world. On average, neighbors are two sizes apart.
    ///
    /// # Errors
    /// Returns an error if there are more bodies than handles.
    pub(crate) fn new(recipe: &Recipe, world: &mut World) -> Result<Self, WorldError> {
        let mut random = Random(recipe.seed);
        let reach = recipe.sizes.mean() * (recipe.bodies as f64).cbrt();
        let mut bodies = Vec::with_capacity(recipe.bodies);
        for number in 0..recipe.bodies {
            let size = recipe.sizes.draw(&mut random);
            let body = Body::new(recipe.mix.shape(number, size, &mut random)?).tag(number as u64);
            let at = [0; 3].map(|_| random.between(-reach, reach));
            let small = [0; 3].map(|_| random.between(-0.02, 0.02));
            let velocity = [0; 3].map(|_| random.between(-1.0, 1.0));
            // The pile is a cone: bodies near the middle rest higher.
            let from_middle = (at[0] * at[0] + at[1] * at[1]).sqrt();
            let rest = (random.unit() * (reach - from_middle).max(0.0)) - reach;
            let id = world.insert(body.at(Pose::from_translation(at)?))?;
            bodies.push(MovingBody {
                id,
                at,
                turn: unit([1.0, small[0], small[1], small[2]]),
                turned: [1.0, 0.0, 0.0, 0.0],
                velocity,
                rest,
                start: random.below(120),
            });
        }
        Ok(Self { motion: recipe.motion, reach, bodies, random })
    }

    /// Returns the new poses of the bodies that move in a step.
    ///
    /// # Errors
    /// Never returns an error for these scenes: no body leaves the range of poses.
    pub(crate) fn moves(&mut self, step: usize) -> Result<Vec<(BodyId, Pose)>, InputError> {
        let (motion, reach) = (self.motion, self.reach);
        let mut moves = Vec::with_capacity(self.bodies.len());
        for body in &mut self.bodies {
            let goes = match motion {
                Motion::Brownian => {
                    body.velocity = body.velocity.map(|v| 0.9 * v + self.random.between(-1.0, 1.0));
                    for k in 0..3 {
                        body.at[k] = (body.at[k] + STEP_SECS * body.velocity[k]).clamp(-reach, reach);
                    }
                    true
                }
                Motion::Fall => {
                    body.velocity[2] -= STEP_SECS * GRAVITY;
                    body.at[2] += STEP_SECS * body.velocity[2];
                    if body.at[2] < -reach {
                        (body.at[2], body.velocity[2]) = (reach, self.random.between(-1.0, 0.0));
                    }
                    true
                }
                Motion::Pile => body.settle(step),
            };
            if goes {
                body.turned = unit(product(body.turn, body.turned));
                moves.push((body.id, Pose::from_quaternion_wxyz(body.at, body.turned)?));
            }
        }
        Ok(moves)
    }
}

impl MovingBody {
    /// Moves a falling body of a pile by one step. Reports whether it moved.
    fn settle(&mut self, step: usize) -> bool {
        if step < self.start || self.at[2] <= self.rest {
            return false;
        }
        self.velocity[2] -= STEP_SECS * GRAVITY;
        self.at[2] = (self.at[2] + STEP_SECS * self.velocity[2]).max(self.rest);
        true
    }
}

impl Sizes {
    /// Returns the mean size, approximately.
    fn mean(self) -> f64 {
        match self {
            Self::Equal | Self::Like => 1.0,
            Self::Spread => 0.2,
        }
    }

    fn draw(self, random: &mut Random) -> f64 {
        match self {
            Self::Equal => 1.0,
            Self::Like => random.between(0.5, 1.5),
            // One size in 100 is at least 10 times the minimum. One in 1,000,000 is 1,000 times the
            // minimum, which is the cap.
            Self::Spread => (0.1 / (1.0 - random.unit()).sqrt()).min(100.0),
        }
    }
}

impl Mix {
    fn shape(self, number: usize, size: f64, random: &mut Random) -> Result<Shape, InputError> {
        let half = 0.5 * size;
        match (self, number % 4) {
            (Self::Boxes, _) | (Self::All, 0) => Shape::cuboid([0; 3].map(|_| half * random.between(0.6, 1.0))),
            (Self::Spheres, _) | (Self::All, 1) => Shape::sphere([0.0; 3], half),
            (Self::All, 2) => Shape::capsule([0.0, 0.0, -0.5 * half], [0.0, 0.0, 0.5 * half], 0.5 * half),
            (Self::All, _) => Shape::cylinder(half, 0.5 * half),
        }
    }
}

/// Pseudorandom numbers that are the same on every machine: SplitMix64 (Steele, Lea, Flood, *Fast
/// splittable pseudorandom number generators*, OOPSLA 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Returns a number from 0 to below 1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

fn product([a, b, c, d]: [f64; 4], [w, x, y, z]: [f64; 4]) -> [f64; 4] {
    [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]
}

fn unit(q: [f64; 4]) -> [f64; 4] {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.map(|x| x / length)
}

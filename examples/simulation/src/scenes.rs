//! The scenes: stacks that should stand, a crate that slides, and a ball that rolls.

use std::f64::consts::PI;

use glam::DVec3;
use impinge::world::WorldError;
use impinge::{InputError, Mesh, Pose, Shape};

use crate::block::{Block, Material};
use crate::solver::Simulation;

/// A floor at height zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Floor {
    /// A half-space.
    Plane,
    /// The triangles of a mesh.
    Mesh,
    /// A compound of flush boxes.
    Tiles,
}

/// Half the length of a side of a floor.
const REACH: i32 = 12;

impl Floor {
    /// Returns the shape of the floor.
    ///
    /// # Errors
    /// Never, as all numbers are constants.
    pub fn shape(self) -> Result<Shape, InputError> {
        match self {
            Self::Plane => Shape::half_space([0.0, 0.0, 1.0], 0.0),
            Self::Mesh => Ok(Shape::mesh(&field(0.375, |_, _| 0.0)?)),
            Self::Tiles => {
                let tile = Shape::cuboid([0.5, 0.5, 0.25])?;
                let places = (-REACH..REACH).flat_map(|x| (-REACH..REACH).map(move |y| (f64::from(x), f64::from(y))));
                let parts = places.map(|(x, y)| Ok((tile.clone(), Pose::from_translation([x, y, -0.25])?)));
                Shape::compound(&parts.collect::<Result<Vec<_>, InputError>>()?)
            }
        }
    }
}

/// Returns a mesh over a grid of squares of a given width, with a height at each corner.
fn field(width: f64, height: impl Fn(f64, f64) -> f64) -> Result<Mesh, InputError> {
    let squares = (2.0 * f64::from(REACH) / width) as u32;
    let at = |step: u32| f64::from(step) * width - f64::from(REACH);
    let steps = || (0..=squares).flat_map(|j| (0..=squares).map(move |i| (i, j)));
    let corners: Vec<[f64; 3]> = steps().map(|(i, j)| [at(i), at(j), height(at(i), at(j))]).collect();
    let faces = steps().filter(|&(i, j)| i < squares && j < squares).flat_map(|(i, j)| {
        let a = j * (squares + 1) + i;
        let b = a + squares + 1;
        [[a, a + 1, b + 1], [a, b + 1, b]]
    });
    Mesh::new(corners, faces.collect::<Vec<_>>())
}

/// A stack of blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stack {
    /// Ten boxes on each other.
    Tower,
    /// Six rows of boxes, each one shorter than the row below.
    Pyramid,
    /// Nine wedges in a half circle.
    Arch,
}

impl Stack {
    /// All stacks.
    pub const ALL: [Self; 3] = [Self::Tower, Self::Pyramid, Self::Arch];

    /// Returns the blocks where they stand.
    #[must_use]
    pub fn blocks(self) -> Vec<Block> {
        let cube = |x: f64, z: f64| Block(Block::cuboid(DVec3::splat(0.5)).0.map(|p| p + DVec3::new(x, 0.0, z + 0.5)));
        match self {
            Self::Tower => (0..10).map(|level| cube(0.0, f64::from(level))).collect(),
            Self::Pyramid => {
                let rows = (0..6).flat_map(|level| (0..6 - level).map(move |at| (f64::from(level), f64::from(at))));
                rows.map(|(level, at)| cube(1.0625 * (at + level / 2.0 - 2.5), level)).collect()
            }
            Self::Arch => (0..9).map(wedge).collect(),
        }
    }

    /// Returns a simulation of the stack on a floor of triangles.
    ///
    /// # Errors
    /// Never, as all numbers are constants.
    pub fn simulation(self, material: Material) -> Result<Simulation, WorldError> {
        let mut simulation = Simulation::new(0.7);
        simulation.insert_static(Floor::Mesh.shape()?)?;
        for block in self.blocks() {
            let (block, center) = block.centered();
            simulation.insert(block.shape(material)?, &block.mass(), center)?;
        }
        Ok(simulation)
    }
}

/// Returns a wedge of the arch. The arch is 1 thick and 3 wide inside its feet.
fn wedge(number: u32) -> Block {
    let corner = |at: usize| {
        let angle = PI * (f64::from(number) + f64::from(at as u32 >> 2 & 1)) / 9.0;
        let radius = if at & 1 == 1 { 4.0 } else { 3.0 };
        let side = if at >> 1 & 1 == 1 { 0.5 } else { -0.5 };
        // The angle grows against y, so that the corners have the order of a box.
        DVec3::new(radius * angle.cos(), side, radius * angle.sin())
    };
    Block(std::array::from_fn(corner))
}

/// Returns a simulation of a crate that slides at 5 units a second.
///
/// # Errors
/// Never, as all numbers are constants.
pub fn slide(material: Material, floor: Floor) -> Result<Simulation, WorldError> {
    let mut simulation = Simulation::new(0.25);
    simulation.insert_static(floor.shape()?)?;
    let cube = Block::cuboid(DVec3::splat(0.5));
    let number = simulation.insert(cube.shape(material)?, &cube.mass(), DVec3::new(-8.0, 0.1, 0.5))?;
    simulation.bodies_mut()[number].velocity = DVec3::new(5.0, 0.3, 0.0);
    Ok(simulation)
}

/// Returns the height of the hills at a place.
#[must_use]
pub fn hill(x: f64, y: f64) -> f64 {
    0.5 * (x * 0.8).sin() * (y * 0.8).cos() + 0.002 * (x * x + y * y)
}

/// Returns a simulation of a ball that rolls over hills made of triangles.
///
/// # Errors
/// Never, as all numbers are constants.
pub fn roll() -> Result<Simulation, WorldError> {
    let mut simulation = Simulation::new(0.7);
    simulation.insert_static(Shape::mesh(&field(0.25, hill)?))?;
    let ball = crate::block::Mass::of_ball(0.4);
    let (x, y) = (2.0, 0.3);
    simulation.insert(Shape::sphere([0.0; 3], 0.4)?, &ball, DVec3::new(x, y, hill(x, y) + 0.4))?;
    Ok(simulation)
}

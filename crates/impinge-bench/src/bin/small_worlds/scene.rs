//! Bodies about their places, and their poses in a few steps, for both engines.

use anyhow::Result;
use impinge::query;
use impinge::{Pose, Shape};
use impinge_testkit::generate::Rng;
use rapier3d::geometry::SharedShape;
use rapier3d::math::{Pose as RapierPose, Rotation, Vector};

/// Maximum distance of a body from its place, along each axis. Bodies are about 1 in size, and
/// their mean spacing is 2.
const PLAY: f64 = 0.05;

/// Number of different steps of a scene, which are repeated in turn.
pub(crate) const VARIANTS: usize = 16;

/// Shapes of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Shapes {
    Spheres,
    Boxes,
}

/// Bodies, and their poses in each variant of a step. Both engines get the same numbers, which
/// single precision holds.
pub(crate) struct Scene {
    pub(crate) shapes: Vec<(Shape, SharedShape)>,
    pub(crate) poses: Vec<Vec<(Pose, RapierPose)>>,
}

impl Scene {
    pub(crate) fn new(count: usize, shapes: Shapes) -> Result<Self> {
        let mut rng = Rng::new(12);
        let reach = (count as f64).cbrt();
        let mut scene = Self { shapes: Vec::new(), poses: vec![Vec::new(); VARIANTS] };
        for _ in 0..count {
            let half = 0.5 * rng.uniform(0.8, 1.2) as f32;
            scene.shapes.push(match shapes {
                Shapes::Spheres => (Shape::sphere([0.0; 3], f64::from(half))?, SharedShape::ball(half)),
                Shapes::Boxes => {
                    let sides = [0; 3].map(|_| half * rng.uniform(0.8, 1.0) as f32);
                    (Shape::cuboid(sides.map(f64::from))?, SharedShape::cuboid(sides[0], sides[1], sides[2]))
                }
            });
            let place = [0; 3].map(|_| rng.uniform(-reach, reach));
            let turn = Rotation::from_array([0; 4].map(|_| rng.uniform(-1.0, 1.0) as f32)).normalize();
            let [x, y, z, w] = turn.to_array().map(f64::from);
            for poses in &mut scene.poses {
                let translation = place.map(|x| (x + rng.uniform(-PLAY, PLAY)) as f32);
                let ours = Pose::from_quaternion_wxyz(translation.map(f64::from), [w, x, y, z])?;
                poses.push((ours, RapierPose::from_parts(Vector::from_array(translation), turn)));
            }
        }
        Ok(scene)
    }

    /// Returns the pairs of bodies that intersect in a variant, in ascending order, by comparing
    /// all of them.
    pub(crate) fn pairs(&self, variant: usize) -> Result<Vec<[usize; 2]>> {
        let place = |((shape, _), (pose, _)): (&(Shape, SharedShape), &(Pose, RapierPose))| shape.at(*pose);
        let placed: Vec<_> = self.shapes.iter().zip(&self.poses[variant]).map(place).collect::<Result<_, _>>()?;
        let all = (0..placed.len()).flat_map(|a| (a + 1..placed.len()).map(move |b| [a, b]));
        Ok(all.filter(|&[a, b]| query::intersects(&placed[a], &placed[b])).collect())
    }
}

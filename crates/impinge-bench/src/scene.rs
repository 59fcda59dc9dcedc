//! The meshes of the benchmarks and where the second one stands.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use impinge::hierarchy::Builder;
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

use crate::samples::{Samples, timed};

/// Quads along the knot and round its tube, in the headline benchmark: two million triangles.
const HEADLINE_SIZE: [u32; 2] = [2000, 500];

/// A mesh before it is built.
#[derive(Clone, Debug)]
pub struct Surface {
    /// The vertices, in the mesh's own frame.
    pub positions: Positions,
    /// Three vertices per triangle.
    pub faces: Vec<[u32; 3]>,
}

impl Surface {
    /// The triangles of a file.
    ///
    /// # Errors
    /// As [`impinge_files::load`].
    pub fn load(path: &Path) -> Result<Self> {
        let model = impinge_files::load(path)?;
        Ok(Self { positions: model.positions, faces: model.faces })
    }

    /// Builds the mesh `repeats` times from copies made beforehand; returns it with the times of the builds alone.
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn build(&self, repeats: usize) -> Result<(Mesh, Samples)> {
        self.build_with(Builder::default(), repeats)
    }

    /// As [`build`](Self::build), by a stated builder.
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn build_with(&self, builder: Builder, repeats: usize) -> Result<(Mesh, Samples)> {
        let mut mesh = None;
        let samples = Samples::take(repeats, || {
            let (positions, faces) = (self.positions.clone(), self.faces.clone());
            drop(mesh.take()); // outside the time, and before the next, so that there are never two
            let (seconds, built) = timed(|| Mesh::with_builder(positions, faces, builder));
            mesh = Some(built?);
            anyhow::Ok(seconds)
        })?;
        Ok((mesh.context("no build was asked for")?, samples))
    }

    /// The corners of the smallest box that holds all vertices; infinite where there are none.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let all = (0..self.positions.len()).map(|vertex| self.positions.get(vertex));
        all.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], vertex| {
            [
                std::array::from_fn(|axis| low[axis].min(vertex[axis])),
                std::array::from_fn(|axis| high[axis].max(vertex[axis])),
            ]
        })
    }
}

/// Which mesh to take, as arguments of a program.
#[derive(Clone, Debug, clap::Args)]
pub struct Choice {
    /// File of the mesh, in place of the knot
    #[arg(long, value_name = "FILE", conflicts_with_all = ["along", "around"])]
    mesh: Option<PathBuf>,
    /// Quads along the knot
    #[arg(long, value_name = "N", default_value_t = HEADLINE_SIZE[0], value_parser = clap::value_parser!(u32).range(3..=100_000))]
    along: u32,
    /// Quads round the tube of the knot
    #[arg(long, value_name = "N", default_value_t = HEADLINE_SIZE[1], value_parser = clap::value_parser!(u32).range(3..=10_000))]
    around: u32,
}

impl Choice {
    /// The chosen mesh: the file, or else the knot.
    ///
    /// # Errors
    /// As [`Surface::load`].
    pub fn surface(&self) -> Result<Surface> {
        match &self.mesh {
            Some(path) => Surface::load(path),
            None => {
                let knot = torus_knot(self.along, self.around, TREFOIL);
                Ok(Surface { positions: Positions::F64(knot.vertices), faces: knot.faces })
            }
        }
    }

    /// Whether the numbers of pairs at the [`Standing::named`] poses are known.
    #[must_use]
    pub fn is_headline(&self) -> bool {
        self.mesh.is_none() && [self.along, self.around] == HEADLINE_SIZE
    }
}

/// Where the second mesh stands.
#[derive(Clone, Debug)]
pub struct Standing {
    /// What tables call it.
    pub name: &'static str,
    /// Maps the second mesh's own frame to that of the first.
    pub world_from_b: Pose,
    /// How many pairs there must be, where that is known.
    pub expected: Option<usize>,
}

impl Standing {
    /// A pose of the user's.
    #[must_use]
    pub fn given(world_from_b: Pose, expected: Option<usize>) -> Self {
        Self { name: "given", world_from_b, expected }
    }

    /// The poses of the headline benchmark, with what two knots of its size have there. The numbers are those of the
    /// grid oracle, in the test `the_headline_knots_have_the_pairs_of_the_grid`.
    ///
    /// # Errors
    /// None, as the poses are constants that [`Pose`] takes.
    pub fn named() -> Result<[Self; 3]> {
        let at = |name, offset, pairs| {
            let world_from_b = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, offset)?;
            anyhow::Ok(Self { name, world_from_b, expected: Some(pairs) })
        };
        Ok([
            at("deep", [0.3, 0.2, 0.1], 14_974)?,
            at("shallow", [4.5, 0.5, 0.3], 6_772)?,
            at("apart", [9.0, 0.0, 0.0], 0)?,
        ])
    }

    /// Compares a number of pairs with that which is known.
    ///
    /// # Errors
    /// Where they differ.
    pub fn check(&self, pairs: usize) -> Result<()> {
        let name = self.name;
        self.expected.map_or(Ok(()), |expected| {
            ensure!(pairs == expected, "pose {name}: {pairs} pairs found where {expected} are expected");
            Ok(())
        })
    }
}

/// Reads a pose as an argument: `tx,ty,tz,qw,qx,qy,qz`.
///
/// # Errors
/// Where it is not seven numbers, or not a pose.
pub fn parse_pose(text: &str) -> Result<Pose> {
    let numbers: Vec<f64> = text.split(',').map(|word| word.trim().parse()).collect::<Result<_, _>>()?;
    let &[x, y, z, qw, qx, qy, qz] = &numbers[..] else {
        anyhow::bail!("{} numbers given, tx,ty,tz,qw,qx,qy,qz are 7", numbers.len());
    };
    Ok(Pose::from_quaternion_wxyz([x, y, z], [qw, qx, qy, qz])?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_read_or_refused() {
        let pose = parse_pose("-1, 2.5,3e-2,0,0,1,0").unwrap();
        assert_eq!(pose, Pose::from_quaternion_wxyz([-1.0, 2.5, 0.03], [0.0, 0.0, 1.0, 0.0]).unwrap());
        for wrong in ["", "1,2,3", "1,2,3,1,0,0,0,0", "1,2,3,x,0,0,0", "1,2,3,2,0,0,0"] {
            assert!(parse_pose(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_wrong_count_is_refused() {
        let known = Standing::given(Pose::IDENTITY, Some(3));
        assert!(known.check(3).is_ok() && known.check(4).is_err());
        assert!(Standing::given(Pose::IDENTITY, None).check(4).is_ok());
    }

    #[test]
    fn bounds_hold_every_vertex() {
        let positions = Positions::F32(vec![[1.0, -2.0, 3.0], [-1.0, 5.0, 3.5]]);
        let surface = Surface { positions, faces: Vec::new() };
        assert_eq!(surface.bounds(), [[-1.0, -2.0, 3.0], [1.0, 5.0, 3.5]]);
    }
}

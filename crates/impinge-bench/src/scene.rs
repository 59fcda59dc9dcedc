//! Meshes of the benchmarks, and poses of the second mesh.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use impinge::hierarchy::Builder;
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

use crate::samples::{Samples, timed};

/// Number of quads along the knot and around its tube in the headline benchmark: two million
/// triangles.
const HEADLINE_SIZE: [u32; 2] = [2000, 500];

/// Mesh before it is built.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Positions of the vertices, in the mesh frame.
    pub positions: Positions,
    /// Vertex indices of each triangle.
    pub faces: Vec<[u32; 3]>,
}

impl Surface {
    /// Loads the triangles of a file.
    ///
    /// # Errors
    /// Returns an error if [`impinge_files::load`] does.
    pub fn load(path: &Path) -> Result<Self> {
        let model = impinge_files::load(path)?;
        Ok(Self { positions: model.positions, faces: model.faces })
    }

    /// Builds the mesh `repeats` times, and returns it with the times of the builds. The time to
    /// copy the arrays is not included.
    ///
    /// # Errors
    /// Returns an error if [`Mesh::new`] does.
    pub fn build(&self, repeats: usize) -> Result<(Mesh, Samples)> {
        self.build_with(Builder::default(), repeats)
    }

    /// Does the same as [`build`](Self::build), with the given builder.
    ///
    /// # Errors
    /// Returns an error if [`Mesh::new`] does.
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

    /// Returns the lower and the upper corner of the smallest box that contains all vertices, in
    /// the mesh frame. They are infinite, the lower above the upper, if there are no vertices.
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

/// Choice of a mesh, as arguments of a program.
#[derive(Clone, Debug, clap::Args)]
pub struct Choice {
    /// File of the mesh, instead of the knot
    #[arg(long, value_name = "FILE", conflicts_with_all = ["along", "around"])]
    mesh: Option<PathBuf>,
    /// Number of quads along the knot
    #[arg(long, value_name = "N", default_value_t = HEADLINE_SIZE[0], value_parser = clap::value_parser!(u32).range(3..=100_000))]
    along: u32,
    /// Number of quads around the tube of the knot
    #[arg(long, value_name = "N", default_value_t = HEADLINE_SIZE[1], value_parser = clap::value_parser!(u32).range(3..=10_000))]
    around: u32,
}

impl Choice {
    /// Loads the chosen file, or makes the knot if no file was chosen.
    ///
    /// # Errors
    /// Returns an error if [`Surface::load`] does.
    pub fn surface(&self) -> Result<Surface> {
        match &self.mesh {
            Some(path) => Surface::load(path),
            None => {
                let knot = torus_knot(self.along, self.around, TREFOIL);
                Ok(Surface { positions: Positions::F64(knot.vertices), faces: knot.faces })
            }
        }
    }

    /// Reports whether the numbers of pairs at the [`Standing::named`] poses are known.
    #[must_use]
    pub fn is_headline(&self) -> bool {
        self.mesh.is_none() && [self.along, self.around] == HEADLINE_SIZE
    }
}

/// Pose of the second mesh, and the expected number of pairs.
#[derive(Clone, Debug)]
pub struct Standing {
    /// Name in tables.
    pub name: &'static str,
    /// Map from the second mesh's frame to the world frame, which is the first mesh's frame.
    pub world_from_b: Pose,
    /// Expected number of intersecting pairs, if it is known.
    pub expected: Option<usize>,
}

impl Standing {
    /// Returns a pose given by the user, with the name `given`.
    #[must_use]
    pub fn given(world_from_b: Pose, expected: Option<usize>) -> Self {
        Self { name: "given", world_from_b, expected }
    }

    /// Returns the poses of the headline benchmark, with the numbers of pairs of two knots of its
    /// size. The numbers are those of the grid oracle, in the test
    /// `the_headline_knots_have_the_pairs_of_the_grid`.
    ///
    /// # Errors
    /// Never returns an error, because the poses are valid constants.
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

    /// Compares a number of pairs with the expected number, if that is known.
    ///
    /// # Errors
    /// Returns an error if they differ.
    pub fn check(&self, pairs: usize) -> Result<()> {
        let name = self.name;
        self.expected.map_or(Ok(()), |expected| {
            ensure!(pairs == expected, "pose {name}: {pairs} pairs found where {expected} are expected");
            Ok(())
        })
    }
}

/// Parses a pose given as an argument, `tx,ty,tz,qw,qx,qy,qz`: a translation and a unit quaternion.
///
/// # Errors
/// Returns an error if the text is not seven numbers, or not a valid pose.
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

//! Blocks with six sides, as convex hulls or as meshes of triangles, and their mass.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use impinge::hull::Hull;
use impinge::{InputError, Mesh, Shape};

/// The corners of each side, counterclockwise seen from outside.
const SIDES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// A solid of six flat sides. The bits of a corner's index tell its side along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block(pub [DVec3; 8]);

/// How the shape of a block is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// The convex hull of the corners.
    Hull,
    /// A closed mesh, as a solid. Each side has this number of squares along its edges, each of two
    /// triangles. Choose a power of two, so that sides meet without rounding.
    Mesh(u32),
}

/// Mass, center of mass and moments of inertia of a solid of density 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Volume.
    pub mass: f64,
    /// Center of mass.
    pub center: DVec3,
    /// Inertia about the center of mass.
    pub inertia: DMat3,
}

impl Block {
    /// Returns an axis-aligned box about the origin.
    #[must_use]
    pub fn cuboid(half_extents: DVec3) -> Self {
        Self(std::array::from_fn(|at| {
            half_extents * DVec3::from_array(std::array::from_fn(|k| if at >> k & 1 == 1 { 1.0 } else { -1.0 }))
        }))
    }

    /// Returns the block moved so that its center of mass is the origin, and where it was.
    #[must_use]
    pub fn centered(&self) -> (Self, DVec3) {
        let center = self.mass().center;
        (Self(self.0.map(|corner| corner - center)), center)
    }

    /// Returns the shape of the block.
    ///
    /// # Errors
    /// Returns an error if a corner is not finite or too far away.
    pub fn shape(&self, material: Material) -> Result<Shape, InputError> {
        match material {
            Material::Hull => Ok(Shape::hull(Hull::new(&self.0.map(|corner| corner.to_array()))?.into())),
            Material::Mesh(squares) => Ok(Shape::solid(&self.mesh(squares)?)),
        }
    }

    /// Returns the surface as a mesh.
    fn mesh(&self, squares: u32) -> Result<Mesh, InputError> {
        let (mut corners, mut faces) = (Vec::new(), Vec::new());
        let part = |at: u32| f64::from(at) / f64::from(squares);
        let between = |p: DVec3, q: DVec3, t: f64| p * (1.0 - t) + q * t;
        for [p, q, r, s] in SIDES.map(|side| side.map(|corner| self.0[corner])) {
            let first = corners.len() as u32;
            let places = (0..=squares).flat_map(|i| (0..=squares).map(move |j| (i, j)));
            corners.extend(places.map(|(i, j)| {
                let (near, far) = (between(p, q, part(j)), between(s, r, part(j)));
                between(near, far, part(i)).to_array()
            }));
            for (i, j) in (0..squares).flat_map(|i| (0..squares).map(move |j| (i, j))) {
                let a = first + i * (squares + 1) + j;
                let b = a + squares + 1;
                faces.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
            }
        }
        Mesh::new(corners, faces)
    }

    /// Returns the mass of the block, by tetrahedra between the origin and the triangles of the
    /// surface.
    #[must_use]
    pub fn mass(&self) -> Mass {
        let (mut mass, mut moment, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for [p, q, r, s] in SIDES.map(|side| side.map(|corner| self.0[corner])) {
            for [a, b, c] in [[p, q, r], [p, r, s]] {
                let (volume, sum) = (a.dot(b.cross(c)) / 6.0, a + b + c);
                mass += volume;
                moment += sum * (volume / 4.0);
                let squares = [a, b, c, sum].map(square);
                second += (squares[0] + squares[1] + squares[2] + squares[3]) * (volume / 20.0);
            }
        }
        let center = moment / mass;
        let second = second - square(center) * mass;
        let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
        Mass { mass, center, inertia: DMat3::IDENTITY * trace - second }
    }
}

impl Mass {
    /// Returns the mass of a ball.
    #[must_use]
    pub fn of_ball(radius: f64) -> Self {
        let mass = 4.0 / 3.0 * PI * radius.powi(3);
        Self { mass, center: DVec3::ZERO, inertia: DMat3::IDENTITY * (0.4 * mass * radius * radius) }
    }
}

/// Returns the matrix of all products of two coordinates.
fn square(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

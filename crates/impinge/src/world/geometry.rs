//! What a body is made of, and that in its place.

use crate::convex::Core;
use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::Mesh;
use crate::shape::{Form, PlacedShape, Shape};

/// What a body is made of, in its own frame; cheap to clone.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// A convex shape or a half-space.
    Shape(Shape),
    /// The surface of a mesh.
    Surface(Mesh),
    /// A mesh and all about which it winds more than half.
    Solid(Mesh),
}

impl From<Shape> for Geometry {
    fn from(shape: Shape) -> Self {
        Self::Shape(shape)
    }
}

impl From<Mesh> for Geometry {
    /// Its surface.
    fn from(mesh: Mesh) -> Self {
        Self::Surface(mesh)
    }
}

impl From<&Mesh> for Geometry {
    /// Its surface.
    fn from(mesh: &Mesh) -> Self {
        Self::Surface(mesh.clone())
    }
}

/// A geometry in the world.
#[derive(Clone, Debug)]
pub(super) enum Placed {
    Shape(Shape, PlacedShape),
    Mesh { mesh: Mesh, is_solid: bool, world_from_mesh: Pose },
}

impl Placed {
    /// # Errors
    /// As [`Shape::at`].
    pub(super) fn new(geometry: &Geometry, world_from_body: Pose) -> Result<Self, InputError> {
        Ok(match geometry {
            Geometry::Shape(shape) => Self::Shape(shape.clone(), shape.at(world_from_body)?),
            Geometry::Surface(mesh) => Self::Mesh { mesh: mesh.clone(), is_solid: false, world_from_mesh: world_from_body },
            Geometry::Solid(mesh) => Self::Mesh { mesh: mesh.clone(), is_solid: true, world_from_mesh: world_from_body },
        })
    }

    /// The same elsewhere.
    ///
    /// # Errors
    /// As [`Shape::at`].
    pub(super) fn moved(&self, world_from_body: Pose) -> Result<Self, InputError> {
        Ok(match self {
            Self::Shape(shape, _) => Self::Shape(shape.clone(), shape.at(world_from_body)?),
            Self::Mesh { mesh, is_solid, .. } => {
                Self::Mesh { mesh: mesh.clone(), is_solid: *is_solid, world_from_mesh: world_from_body }
            }
        })
    }

    pub(super) fn geometry(&self) -> Geometry {
        match self {
            Self::Shape(shape, _) => Geometry::Shape(shape.clone()),
            Self::Mesh { mesh, is_solid: false, .. } => Geometry::Surface(mesh.clone()),
            Self::Mesh { mesh, is_solid: true, .. } => Geometry::Solid(mesh.clone()),
        }
    }

    pub(super) fn world_from_body(&self) -> &Pose {
        match self {
            Self::Shape(_, placed) => placed.world_from_local(),
            Self::Mesh { world_from_mesh, .. } => world_from_mesh,
        }
    }
}

/// What of a geometry a box has to hold.
pub(super) enum Extent {
    /// These points, swept by what the pose makes of a ball.
    Points(Vec<[f64; 3]>),
    /// More than any box holds.
    Unbounded,
}

impl Extent {
    pub(super) fn of(geometry: &Geometry) -> Self {
        match geometry {
            Geometry::Shape(shape) => Self::of_shape(shape),
            Geometry::Surface(mesh) | Geometry::Solid(mesh) => Self::Points(corners(mesh)),
        }
    }

    fn of_shape(shape: &Shape) -> Self {
        // Under the identity no shape is refused.
        let Ok(placed) = shape.at(Pose::IDENTITY) else { return Self::Unbounded };
        match placed.form() {
            Form::HalfSpace { .. } => Self::Unbounded,
            Form::Convex(swept) => Self::Points(match swept.core {
                Core::Points(points) => points.to_vec(),
                Core::Hull(hull) => hull.positions().to_vec(),
                Core::Curved(set) => {
                    let reach = set.reach();
                    (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { reach[k] } else { -reach[k] })).collect()
                }
            }),
        }
    }
}

/// The vertices that some face uses, each once.
fn corners(mesh: &Mesh) -> Vec<[f64; 3]> {
    let positions = mesh.positions();
    let mut is_used = vec![false; positions.len()];
    mesh.faces().iter().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
    (0..positions.len()).filter(|&vertex| is_used[vertex]).map(|vertex| positions.get(vertex)).collect()
}

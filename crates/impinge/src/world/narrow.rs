//! The narrow phase: what two bodies whose boxes overlap have in common.

use super::contact::{Contact, Meeting};
use super::geometry::Placed;
use crate::mesh::Placed as PlacedMesh;
use crate::query::shapes::{self, Proximity};
use crate::query::{self, Solid};
use crate::shape::{PlacedShape, Shape};

/// What is found out about pairs whose boxes overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NarrowPhase {
    /// Nothing: the pairs are those of the boxes. For triggers that may be coarse, and for measuring the broad phase.
    Boxes,
    /// Whether the bodies meet.
    Intersections,
    /// Whether they do, and their contacts.
    #[default]
    Contacts,
}

impl NarrowPhase {
    /// How many pairs are one task at least.
    pub(super) fn least_shared(self) -> usize {
        match self {
            Self::Boxes => 4096,
            // Some microseconds at least, and a millisecond for meshes.
            Self::Intersections | Self::Contacts => 4,
        }
    }

    /// What is to be known about two bodies; none where they are apart.
    pub(super) fn examine(self, a: &Placed, b: &Placed) -> Option<Meeting> {
        let proximity = match self {
            Self::Boxes => return Some(Meeting { proximity: Proximity::Undecided, contacts: Vec::new() }),
            Self::Intersections | Self::Contacts => proximity(a, b),
        };
        if proximity == Proximity::Apart {
            return None;
        }
        let contacts = if self == Self::Contacts { contacts(a, b) } else { Vec::new() };
        Some(Meeting { proximity, contacts })
    }
}

/// Whether two bodies meet.
pub(super) fn proximity(a: &Placed, b: &Placed) -> Proximity {
    match (a, b) {
        (Placed::Shape(_, a), Placed::Shape(_, b)) => shapes::proximity(a, b),
        (
            Placed::Mesh { mesh: a, is_solid: solid_a, world_from_mesh: pose_a },
            Placed::Mesh { mesh: b, is_solid: solid_b, world_from_mesh: pose_b },
        ) => meshes(a.at(*pose_a), b.at(*pose_b), [*solid_a, *solid_b]),
        (Placed::Mesh { mesh, world_from_mesh, .. }, Placed::Shape(_, shape))
        | (Placed::Shape(_, shape), Placed::Mesh { mesh, world_from_mesh, .. }) => {
            mesh_and_shape(mesh.at(*world_from_mesh), shape)
        }
    }
}

fn meshes(a: PlacedMesh<'_>, b: PlacedMesh<'_>, is_solid: [bool; 2]) -> Proximity {
    let meets = match is_solid {
        [false, false] => query::intersects(a, b),
        [true, false] => query::intersects_solid(a, b, Solid::A),
        [false, true] => query::intersects_solid(a, b, Solid::B),
        [true, true] => query::intersects_solid(a, b, Solid::Both),
    };
    if meets { Proximity::Meets } else { Proximity::Apart }
}

fn mesh_and_shape(mesh: PlacedMesh<'_>, shape: &PlacedShape) -> Proximity {
    let mut found = Proximity::Apart;
    for face in 0..mesh.mesh.faces().len() as u32 {
        let Ok(triangle) = Shape::triangle(mesh.mesh.corners(face)).and_then(|t| t.at(mesh.world_from_mesh)) else { continue };
        match shapes::proximity(&triangle, shape) {
            Proximity::Meets => return Proximity::Meets,
            Proximity::Undecided => found = Proximity::Undecided,
            Proximity::Apart => {}
        }
    }
    found
}

fn contacts(a: &Placed, b: &Placed) -> Vec<Contact> {
    match (a, b) {
        (Placed::Shape(_, a), Placed::Shape(_, b)) => shapes::penetration(a, b)
            .map(|found| Contact {
                point_a: found.point_a,
                point_b: found.point_b,
                normal: found.normal,
                depth: found.upper,
                features: [0; 2],
            })
            .into_iter()
            .collect(),
        _ => Vec::new(),
    }
}

//! The narrow phase: what two bodies whose boxes overlap have in common.

use super::geometry::Placed;
use super::mesh_contacts;
use crate::mesh::Placed as PlacedMesh;
use crate::query::shapes::{self, Manifold, Proximity};
use crate::query::{self, Solid};
use crate::shape::{PlacedShape, Shape};

/// What is found out about pairs whose boxes overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NarrowPhase {
    /// Nothing: the pairs are those of the boxes, and all undecided. For triggers that may be coarse, and for measuring the
    /// broad phase.
    Boxes,
    /// Whether the bodies meet.
    Intersections,
    /// Whether they do, and their contacts.
    #[default]
    Contacts,
}

/// A pair that is not proved apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meeting {
    pub(super) proximity: Proximity,
    pub(super) manifolds: Vec<Manifold>,
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
        match (self, a, b) {
            (Self::Boxes, ..) => Some(Meeting { proximity: Proximity::Undecided, manifolds: Vec::new() }),
            (Self::Intersections, ..) => Meeting::of(proximity(a, b), Vec::new),
            (
                Self::Contacts,
                Placed::Mesh { mesh: mesh_a, world_from_mesh: pose_a, .. },
                Placed::Mesh { mesh: mesh_b, world_from_mesh: pose_b, .. },
            ) => {
                // All faces that meet tell whether any do.
                let manifolds = mesh_contacts::contacts(mesh_a.at(*pose_a), mesh_b.at(*pose_b));
                let proximity = if manifolds.is_empty() { enclosure(a, b) } else { Proximity::Meets };
                Meeting::of(proximity, || manifolds)
            }
            (Self::Contacts, ..) => Meeting::of(proximity(a, b), || contacts(a, b)),
        }
    }
}

impl Meeting {
    fn of(proximity: Proximity, manifolds: impl FnOnce() -> Vec<Manifold>) -> Option<Self> {
        (proximity != Proximity::Apart).then(|| Self { proximity, manifolds: manifolds() })
    }
}

/// Whether two meshes meet whose surfaces do not: one is in the other, which is solid.
fn enclosure(a: &Placed, b: &Placed) -> Proximity {
    let is_solid = |placed: &Placed| matches!(placed, Placed::Mesh { is_solid: true, .. });
    if is_solid(a) || is_solid(b) { proximity(a, b) } else { Proximity::Apart }
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

/// Whether the surface of a mesh, face by face, meets a shape.
fn mesh_and_shape(mesh: PlacedMesh<'_>, shape: &PlacedShape) -> Proximity {
    let faces = faces(&mesh).map(|(_, face)| shapes::proximity(&face, shape));
    faces.fold(Proximity::Apart, |found, face| match (found, face) {
        (Proximity::Meets, _) | (_, Proximity::Meets) => Proximity::Meets,
        (Proximity::Apart, face) => face,
        (Proximity::Undecided, _) => Proximity::Undecided,
    })
}

fn faces<'m>(mesh: &'m PlacedMesh<'_>) -> impl Iterator<Item = (u32, PlacedShape)> + 'm {
    let placed = |face| Shape::triangle(mesh.mesh.corners(face)).and_then(|face| face.at(mesh.world_from_mesh));
    (0..mesh.mesh.faces().len() as u32).filter_map(move |face| Some((face, placed(face).ok()?)))
}

fn contacts(a: &Placed, b: &Placed) -> Vec<Manifold> {
    match (a, b) {
        (Placed::Shape(_, a), Placed::Shape(_, b)) => shapes::contacts(a, b),
        (Placed::Mesh { .. }, Placed::Mesh { .. }) => Vec::new(),
        (Placed::Mesh { mesh, world_from_mesh, .. }, Placed::Shape(_, shape)) => {
            let mesh = mesh.at(*world_from_mesh);
            let found = faces(&mesh).flat_map(|(number, face)| {
                let manifolds = shapes::contacts(&face, shape).into_iter();
                manifolds.map(move |mut manifold| {
                    manifold.points.iter_mut().for_each(|point| point.id.part_a = number);
                    manifold
                })
            });
            found.collect()
        }
        (Placed::Shape(_, shape), Placed::Mesh { mesh, world_from_mesh, .. }) => {
            let mesh = mesh.at(*world_from_mesh);
            let found = faces(&mesh).flat_map(|(number, face)| {
                let manifolds = shapes::contacts(shape, &face).into_iter();
                manifolds.map(move |mut manifold| {
                    manifold.points.iter_mut().for_each(|point| point.id.part_b = number);
                    manifold
                })
            });
            found.collect()
        }
    }
}

//! The boxes of bodies in the world, computed in the way that each body chooses.

use std::sync::Arc;

use super::plane::Plane;
use crate::convex::Core;
use crate::hull::Hull;
use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::Mesh;
use crate::shape::{Form, PlacedShape, Shape, Stand};
use crate::volume::realign::{ClimbingHull, LooseBox, Realign, RotatedBox, TightHull};
use crate::volume::{BoundingVolume, MinMax};

/// How the box of a body follows the body when it rotates (see
/// [`realign`](crate::volume::realign)). A tighter box gives fewer candidate pairs. No result
/// depends on it. Compounds and half-spaces always use [`Own`](Self::Own).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Realignment {
    /// The shape's own box, [`PlacedShape::bounds`](crate::shape::PlacedShape::bounds): tight for
    /// convex shapes; for meshes, the box around the rotated box.
    #[default]
    Own,
    /// The box around the rotated box, for any shape. It takes a few nanoseconds, and its edges are
    /// up to √3 times too long.
    Rotated,
    /// The box around a sphere that is centered at the origin of the body's frame and contains the
    /// body. Its size never changes if the body moves rigidly.
    Loose,
    /// A tight box, computed from all vertices of the convex hull.
    Hull,
    /// A tight box, computed by climbing on the convex hull from the last extreme vertices. For
    /// bodies that rotate little per step.
    Climbing,
}

/// Precomputed data of a shape, to bound it in any pose. All bodies with the same shape share it.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    realignment: Realignment,
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    Own,
    Rotated(RotatedBox),
    Loose(LooseBox),
    Hull(Arc<Hull>),
    Climbing(Arc<Hull>),
}

/// The region of the world in which a body may be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Bounds {
    /// Nowhere: the body is empty, or there is no body.
    #[default]
    Nowhere,
    /// In a box.
    Box(MinMax),
    /// In a half-space.
    Behind(Plane),
    /// Anywhere: a part of the body is a half-space.
    Anywhere,
}

/// Extreme vertices at which the last climb ended; zero if there was none.
pub(super) type Extremes = [[u32; 2]; 3];

impl Outline {
    /// Returns the outline that uses the shape's own box.
    pub(super) fn new() -> Self {
        Self { realignment: Realignment::Own, way: Way::Own }
    }

    /// Computes the outline for a way of realignment.
    ///
    /// # Errors
    /// Returns the error of [`Hull::new`] if the way needs a hull.
    pub(super) fn by(shape: &Shape, realignment: Realignment) -> Result<Self, InputError> {
        let points = if realignment == Realignment::Own { Vec::new() } else { points(shape)? };
        let way = match realignment {
            _ if points.is_empty() => Way::Own,
            Realignment::Own => Way::Own,
            Realignment::Rotated => Way::Rotated(RotatedBox::new(&MinMax::of(&points)?)),
            Realignment::Loose => Way::Loose(LooseBox::new(&points, [0.0; 3])?),
            Realignment::Hull => Way::Hull(Arc::new(Hull::new(&points)?)),
            Realignment::Climbing => Way::Climbing(Arc::new(Hull::new(&points)?)),
        };
        Ok(Self { realignment, way })
    }

    pub(super) fn realignment(&self) -> Realignment {
        self.realignment
    }

    /// Returns the bounds of a body with this shape at this pose. Updates `extremes` if the way
    /// climbs on a hull.
    pub(super) fn bounds(&self, (shape, stand): (&PlacedShape, &Stand), extremes: &mut Extremes) -> Bounds {
        let pose = stand.world_from_local();
        let core = match &self.way {
            Way::Own => return own(shape, stand),
            &Way::Rotated(mut rotated) => rotated.realign(pose),
            &Way::Loose(mut loose) => loose.realign(pose),
            Way::Hull(hull) => TightHull::new(hull).realign(pose),
            Way::Climbing(hull) => {
                let mut climbing = ClimbingHull::resume(hull, *extremes);
                let bounds = climbing.realign(pose);
                *extremes = climbing.extremes();
                bounds
            }
        };
        swept(&core, shape, stand)
    }
}

impl Bounds {
    /// Returns bounds that hold all points within a distance of these bounds.
    pub(super) fn grown(self, by: f64) -> Self {
        match self {
            _ if by == 0.0 => self,
            Self::Nowhere => Self::Nowhere,
            Self::Box(bounds) => bounds.grown(by).map_or(Self::Anywhere, Self::Box),
            Self::Behind(plane) => Self::Behind(plane.raised(by)),
            Self::Anywhere => Self::Anywhere,
        }
    }

    /// Returns `false` if the two bodies are proved apart, and `true` otherwise.
    pub(super) fn overlap(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Nowhere, _) | (_, Self::Nowhere) => false,
            (Self::Box(a), Self::Box(b)) => a.overlaps(b),
            (Self::Box(bounds), Self::Behind(plane)) | (Self::Behind(plane), Self::Box(bounds)) => {
                plane.reaches(bounds)
            }
            (Self::Behind(_), Self::Behind(_)) | (Self::Anywhere, _) | (_, Self::Anywhere) => true,
        }
    }
}

/// Returns the points whose hull is the core of a shape or contains it. Returns an empty list if
/// the shape has several parts or no box bounds it.
fn points(shape: &Shape) -> Result<Vec<[f64; 3]>, InputError> {
    let placed = shape.at(Pose::IDENTITY)?;
    let [part] = placed.parts() else { return Ok(Vec::new()) };
    // The part of a compound of one part may have a pose of its own.
    if part.world_from_local() != &Pose::IDENTITY {
        return Ok(Vec::new());
    }
    Ok(match part.form() {
        Form::HalfSpace(_) => Vec::new(),
        Form::Surface(surface) => corners(surface.mesh),
        Form::Field(field) => field
            .mesh
            .local_bounds()
            .map_or(Vec::new(), |bounds| (0..8).map(|i| [0, 1, 2].map(|k| bounds[i >> k & 1][k])).collect()),
        Form::Convex(swept) => match swept.core {
            Core::Points(points) | Core::Cuboid(points) => points.to_vec(),
            Core::Hull(hull) => hull.positions().to_vec(),
            Core::Turned(_) | Core::Curved(_) => {
                let reach = swept.core.reach();
                (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { reach[k] } else { -reach[k] })).collect()
            }
        },
    })
}

/// Returns the vertices that at least one face uses, each once.
fn corners(mesh: &Mesh) -> Vec<[f64; 3]> {
    let positions = mesh.positions();
    let mut is_used = vec![false; positions.len()];
    mesh.faces().iter().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
    (0..positions.len()).filter(|&vertex| is_used[vertex]).map(|vertex| positions.get(vertex)).collect()
}

/// Returns the bounds by the shape's own box.
fn own(shape: &PlacedShape, stand: &Stand) -> Bounds {
    if let Some([min, max]) = stand.bounds() {
        // Shapes and poses are in range, so boxes around them are valid. A body whose box is not
        // may be anywhere.
        return MinMax::new(min, max).map_or(Bounds::Anywhere, Bounds::Box);
    }
    if let [_] = shape.parts()
        && let Form::HalfSpace(half_space) = shape.form_at(stand)
    {
        return Bounds::Behind(Plane::of(&half_space));
    }
    if shape.is_unbounded() { Bounds::Anywhere } else { Bounds::Nowhere }
}

/// Returns the bounds of a shape whose core is in a box: the box enlarged by the radius of the
/// shape's sphere.
fn swept(core: &MinMax, shape: &PlacedShape, stand: &Stand) -> Bounds {
    let radius = match shape.form_at(stand) {
        Form::Convex(swept) => swept.radius[1],
        Form::HalfSpace(_) | Form::Surface(_) | Form::Field(_) => 0.0,
    };
    if radius == 0.0 {
        return Bounds::Box(*core);
    }
    core.grown(radius).map_or(Bounds::Anywhere, Bounds::Box)
}

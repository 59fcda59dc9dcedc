//! The boxes of bodies in the world, found in the way that each body asks for.

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

/// How the box of a body follows it when it turns (see [`realign`](crate::volume::realign)). A tighter box makes fewer
/// pairs whose shapes have to be looked at; no answer depends on it. Compounds and half-spaces always have their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Realignment {
    /// The shape's own, [`PlacedShape::bounds`](crate::shape::PlacedShape::bounds): tight for convex shapes, that of the turned
    /// box for meshes.
    #[default]
    Own,
    /// The box of the turned box, for any shape: some nanoseconds, and up to √3 times too long.
    Rotated,
    /// The box of the sphere about the body's origin: it keeps its size.
    Loose,
    /// Tight, by all vertices of the hull.
    Hull,
    /// Tight, by climbing on the hull from where the last extremes were: for bodies that turn little in a step.
    Climbing,
}

/// What is kept of a shape, to bound it in any pose; shared by all bodies of one shape.
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

/// Where in the world a body may be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Bounds {
    /// It is empty, or there is none.
    #[default]
    Nowhere,
    Box(MinMax),
    /// Behind a plane.
    Behind(Plane),
    /// A part of it is behind a plane.
    Anywhere,
}

/// Where the last climb ended; zero where there was none.
pub(super) type Extremes = [[u32; 2]; 3];

impl Outline {
    /// By the shape's own box.
    pub(super) fn new() -> Self {
        Self { realignment: Realignment::Own, way: Way::Own }
    }

    /// # Errors
    /// As [`Hull::new`], for ways that need one.
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

    /// Where a body of this shape is that stands so.
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
    /// Whether two bodies are not proved apart.
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

/// The points whose hull is the core of a shape, or holds it; none where the shape has several parts or no box bounds it.
fn points(shape: &Shape) -> Result<Vec<[f64; 3]>, InputError> {
    let placed = shape.at(Pose::IDENTITY)?;
    let [part] = placed.parts() else { return Ok(Vec::new()) };
    // A compound of one part, too, may be elsewhere than its part.
    if part.world_from_local() != &Pose::IDENTITY {
        return Ok(Vec::new());
    }
    Ok(match part.form() {
        Form::HalfSpace(_) => Vec::new(),
        Form::Surface(surface) => corners(surface.mesh),
        Form::Convex(swept) => match swept.core {
            Core::Points(points) => points.to_vec(),
            Core::Hull(hull) => hull.positions().to_vec(),
            Core::Curved(set) => {
                let reach = set.reach();
                (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { reach[k] } else { -reach[k] })).collect()
            }
        },
    })
}

/// The vertices that some face uses, each once.
fn corners(mesh: &Mesh) -> Vec<[f64; 3]> {
    let positions = mesh.positions();
    let mut is_used = vec![false; positions.len()];
    mesh.faces().iter().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
    (0..positions.len()).filter(|&vertex| is_used[vertex]).map(|vertex| positions.get(vertex)).collect()
}

/// By the shape's own box.
fn own(shape: &PlacedShape, stand: &Stand) -> Bounds {
    if let Some([min, max]) = stand.bounds() {
        // Shapes and poses are in range, and so are boxes about them; what were not may be anywhere.
        return MinMax::new(min, max).map_or(Bounds::Anywhere, Bounds::Box);
    }
    if let [_] = shape.parts()
        && let Form::HalfSpace(half_space) = shape.form_at(stand)
    {
        return Bounds::Behind(Plane::of(&half_space));
    }
    if shape.is_unbounded() { Bounds::Anywhere } else { Bounds::Nowhere }
}

/// About the core that a box holds, swept by the shape's ball.
fn swept(core: &MinMax, shape: &PlacedShape, stand: &Stand) -> Bounds {
    let radius = match shape.form_at(stand) {
        Form::Convex(swept) => swept.radius[1],
        Form::HalfSpace(_) | Form::Surface(_) => 0.0,
    };
    if radius == 0.0 {
        return Bounds::Box(*core);
    }
    let (min, max) = (core.min().map(|x| (x - radius).next_down()), core.max().map(|x| (x + radius).next_up()));
    MinMax::new(min, max).map_or(Bounds::Anywhere, Bounds::Box)
}

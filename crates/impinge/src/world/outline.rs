//! The boxes of bodies in the world, found in the way that each body asks for.

use std::sync::Arc;

use super::geometry::{Extent, Geometry, Placed};
use super::plane::Plane;
use crate::hull::Hull;
use crate::input::InputError;
use crate::shape::Form;
use crate::volume::realign::{ClimbingHull, LooseBox, Realign, RotatedBox, TightHull};
use crate::volume::{BoundingVolume, MinMax};

/// How the box of a body follows it when it turns (see [`realign`](crate::volume::realign)). A tighter box makes fewer
/// pairs whose shapes have to be looked at; no answer depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Realignment {
    /// The box of the turned box: some nanoseconds, and up to √3 times too long.
    #[default]
    Rotated,
    /// The box of the sphere about the body's origin: it keeps its size.
    Loose,
    /// Tight, by all vertices of the hull.
    Hull,
    /// Tight, by climbing on the hull from where the last extremes were: for bodies that turn little in a step.
    Climbing,
}

/// What is kept of a geometry, to bound it in any pose; shared by all bodies of one shape.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    realignment: Realignment,
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    /// There is nothing that a box could hold.
    None,
    Rotated(RotatedBox),
    Loose(LooseBox),
    Hull(Arc<Hull>),
    Climbing(Arc<Hull>),
}

/// Where in the world a body may be.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Bounds {
    /// It is empty.
    Nowhere,
    Box(MinMax),
    /// Behind a plane.
    Behind(Plane),
}

/// Where the last climb ended; zero where there was none.
pub(super) type Extremes = [[u32; 2]; 3];

impl Outline {
    /// By the box of the turned box.
    pub(super) fn new(geometry: &Geometry) -> Self {
        let way = match Extent::of(geometry) {
            Extent::Unbounded => Way::None,
            // Geometries were judged, so that only an empty one has no box.
            Extent::Points(points) => MinMax::of(&points).map_or(Way::None, |bounds| Way::Rotated(RotatedBox::new(&bounds))),
        };
        Self { realignment: Realignment::Rotated, way }
    }

    /// # Errors
    /// As [`Hull::new`], for ways that need one.
    pub(super) fn by(geometry: &Geometry, realignment: Realignment) -> Result<Self, InputError> {
        let way = match Extent::of(geometry) {
            Extent::Unbounded => Way::None,
            Extent::Points(points) if points.is_empty() => Way::None,
            Extent::Points(points) => match realignment {
                Realignment::Rotated => Way::Rotated(RotatedBox::new(&MinMax::of(&points)?)),
                Realignment::Loose => Way::Loose(LooseBox::new(&points, [0.0; 3])?),
                Realignment::Hull => Way::Hull(Arc::new(Hull::new(&points)?)),
                Realignment::Climbing => Way::Climbing(Arc::new(Hull::new(&points)?)),
            },
        };
        Ok(Self { realignment, way })
    }

    pub(super) fn realignment(&self) -> Realignment {
        self.realignment
    }

    /// Where the body is.
    pub(super) fn bounds(&self, placed: &Placed, extremes: &mut Extremes) -> Bounds {
        let pose = placed.world_from_body();
        if let Placed::Shape(_, shape) = placed
            && let Form::HalfSpace { normal, level, pose } = shape.form()
        {
            return Bounds::Behind(Plane::new(normal, level, pose));
        }
        let core = match &self.way {
            Way::None => return Bounds::Nowhere,
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
        Bounds::Box(swept(&core, placed))
    }
}

impl Bounds {
    /// Whether two bodies are not proved apart.
    pub(super) fn overlap(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Nowhere, _) | (_, Self::Nowhere) => false,
            (Self::Box(a), Self::Box(b)) => a.overlaps(b),
            (Self::Box(bounds), Self::Behind(plane)) | (Self::Behind(plane), Self::Box(bounds)) => plane.reaches(bounds),
            (Self::Behind(_), Self::Behind(_)) => true,
        }
    }
}

/// The box about a core, about the core swept by its ball.
fn swept(core: &MinMax, placed: &Placed) -> MinMax {
    let Placed::Shape(_, shape) = placed else { return *core };
    let Form::Convex(swept) = shape.form() else { return *core };
    let radius = swept.radius[1];
    if radius == 0.0 {
        return *core;
    }
    let (min, max) = (core.min().map(|x| (x - radius).next_down()), core.max().map(|x| (x + radius).next_up()));
    // Poses and shapes are in range, and so are boxes about them.
    MinMax::new(min, max).unwrap_or(*core)
}

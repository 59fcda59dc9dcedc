//! Shapes in the world.

use std::sync::Arc;

use super::form::Form;
use super::kind::{Kind, RoundCore, Shape};
use super::part_tree::PartTree;
use crate::convex::{Core, Faceted, HalfSpace, Surface, Swept};
use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::PlacedMesh;
use crate::simd::prefetch;
use crate::volume::stretch;

/// Corners of which the memory is asked for: those of a box.
const MOST_ASKED: usize = 8;

/// A shape in the world.
#[derive(Clone, Debug)]
pub struct PlacedShape {
    pub(super) kind: Kind,
    pub(super) stand: Stand,
    /// Of a compound.
    pub(super) parts: Option<Arc<Parts>>,
}

/// The parts of a placed compound, which are no compounds.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) all: Vec<PlacedShape>,
    tree: Option<PartTree>,
}

impl Parts {
    pub(super) fn new(all: Vec<PlacedShape>) -> Self {
        let tree = PartTree::of(all.iter().map(PlacedShape::bounds));
        Self { all, tree }
    }
}

/// Where a shape stands, and what comes of it; the parts of a compound have places of their own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stand {
    pub(super) world_from_local: Pose,
    /// The radius of a ball that is in the image of the shape's, and of one that holds it.
    pub(super) radius: [f64; 2],
    /// Holds the shape, where that is finite.
    pub(super) bounds: Option<[[f64; 3]; 2]>,
}

impl Stand {
    /// Before anything is known but the pose.
    pub(super) fn at(world_from_local: Pose) -> Self {
        Self { world_from_local, radius: [0.0; 2], bounds: None }
    }

    pub(crate) fn world_from_local(&self) -> &Pose {
        &self.world_from_local
    }

    /// As [`PlacedShape::bounds`].
    pub(crate) fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.bounds
    }
}

impl Shape {
    /// This shape in the world.
    ///
    /// # Errors
    /// [`NotRigid`](crate::InputErrorKind::NotRigid) where a pose is more than 1e-4 from a rigid motion, for spheres, capsules,
    /// cylinders, cones, ellipsoids and custom sets. All others are at home under any affine map. For a compound, where its pose
    /// cannot be composed with a part's.
    pub fn at(&self, world_from_local: Pose) -> Result<PlacedShape, InputError> {
        let parts = match &self.0 {
            Kind::Compound(shapes) => {
                let place = |(shape, compound_from_part): &(Self, Pose)| {
                    shape.at(world_from_local.compose(compound_from_part)?)
                };
                Some(Arc::new(Parts::new(shapes.iter().map(place).collect::<Result<_, _>>()?)))
            }
            _ => None,
        };
        let mut placed = PlacedShape { kind: self.0.clone(), stand: Stand::at(world_from_local), parts };
        match placed.stand_at(&world_from_local)? {
            Some(stand) => placed.follow(stand),
            None => placed.stand.bounds = placed.world_bounds(),
        }
        Ok(placed)
    }
}

impl Shape {
    /// Reports whether the shape can stand at any pose: it is a polytope, a half-space or a mesh.
    pub(crate) fn is_affine(&self) -> bool {
        matches!(&self.0, Kind::Polytope(_) | Kind::HalfSpace { .. } | Kind::Mesh { .. })
    }

    /// Reports whether the shape can stand at a pose, without placing it.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub(crate) fn judge(&self, world_from_local: &Pose) -> Result<(), InputError> {
        match &self.0 {
            Kind::Polytope(_) | Kind::HalfSpace { .. } | Kind::Mesh { .. } => Ok(()),
            Kind::Round { radius, .. } => images_of_radius(*radius, world_from_local).map(drop),
            Kind::Compound(parts) => parts
                .iter()
                .try_for_each(|(part, compound_from_part)| part.judge(&world_from_local.compose(compound_from_part)?)),
        }
    }
}

impl PlacedShape {
    /// Where the shape is.
    #[must_use]
    pub fn world_from_local(&self) -> &Pose {
        &self.stand.world_from_local
    }

    /// A box in the world frame, its least corner and its greatest, that holds the shape; none where the shape is or has a
    /// half-space, and where there is nothing to hold.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.stand.bounds
    }

    /// Where it stands.
    pub(crate) fn stand(&self) -> &Stand {
        &self.stand
    }

    /// Whether the shape is or has a half-space.
    pub(crate) fn is_unbounded(&self) -> bool {
        self.parts().iter().any(|part| matches!(part.kind, Kind::HalfSpace { .. }))
    }

    /// The parts that verbs are asked of: this shape, or those of a compound.
    pub(crate) fn parts(&self) -> &[Self] {
        self.parts.as_ref().map_or(std::slice::from_ref(self), |parts| &parts.all)
    }

    /// Returns the one mesh that the shape is made of; none if it is something else.
    pub(crate) fn as_mesh(&self) -> Option<PlacedMesh<'_>> {
        let [part] = self.parts() else { return None };
        match &part.kind {
            Kind::Mesh { mesh, is_solid } => {
                Some(PlacedMesh { mesh, world_from_mesh: part.stand.world_from_local, is_solid: *is_solid })
            }
            Kind::Polytope(_) | Kind::Round { .. } | Kind::HalfSpace { .. } | Kind::Compound(_) => None,
        }
    }

    /// This shape elsewhere.
    ///
    /// # Errors
    /// As [`Shape::at`].
    pub(crate) fn moved_to(&self, world_from_local: Pose) -> Result<Self, InputError> {
        Shape(self.kind.clone()).at(world_from_local)
    }

    /// How the shape stands elsewhere; none for a compound, of which each part does.
    ///
    /// # Errors
    /// As [`Shape::at`].
    pub(crate) fn stand_at(&self, world_from_local: &Pose) -> Result<Option<Stand>, InputError> {
        let mut stand = Stand::at(*world_from_local);
        match &self.kind {
            Kind::Compound(_) => return Ok(None),
            Kind::Round { radius, .. } => stand.radius = images_of_radius(*radius, world_from_local)?,
            Kind::Polytope(_) | Kind::HalfSpace { .. } | Kind::Mesh { .. } => {}
        }
        stand.bounds = match self.form_at(&stand) {
            Form::Convex(swept) => Some(swept.world_bounds()),
            Form::Surface(surface) => surface.world_bounds(),
            Form::HalfSpace(_) => None,
        };
        Ok(Some(stand))
    }

    /// Moves the shape to where it stands by [`stand_at`](Self::stand_at).
    pub(crate) fn follow(&mut self, stand: Stand) {
        self.stand = stand;
    }

    /// Asks for the memory where the corners of a polytope are said to be.
    pub(crate) fn prefetch(&self) {
        if let Kind::Polytope(corners) | Kind::Round { core: RoundCore::Few(corners), .. } = &self.kind {
            corners.prefetch();
        }
    }

    /// Asks for the memory of a few corners, which reads where they are.
    pub(crate) fn prefetch_corners(&self) {
        if let Kind::Polytope(corners) | Kind::Round { core: RoundCore::Few(corners), .. } = &self.kind
            && let Core::Points(points) = corners.core()
        {
            points.iter().take(MOST_ASKED).step_by(2).for_each(prefetch);
        }
    }

    /// What a part is; a compound, which is asked part by part, counts as its first.
    pub(crate) fn form(&self) -> Form<'_> {
        self.form_at(&self.stand)
    }

    /// As [`form`](Self::form), if the shape stood so.
    pub(crate) fn form_at<'a>(&'a self, stand: &'a Stand) -> Form<'a> {
        let (pose, radius) = (&stand.world_from_local, stand.radius);
        let core = match &self.kind {
            Kind::Polytope(corners) | Kind::Round { core: RoundCore::Few(corners), .. } => corners.core(),
            Kind::Round { core: RoundCore::Curved(set), .. } => Core::Curved(&**set),
            Kind::HalfSpace { normal, level } => {
                return Form::HalfSpace(Box::new(HalfSpace::new(*normal, *level, pose)));
            }
            Kind::Mesh { mesh, is_solid } => return Form::Surface(Surface { mesh, pose, is_solid: *is_solid }),
            Kind::Compound(_) => return self.parts()[0].form(),
        };
        Form::Convex(Swept { core, pose, radius })
    }

    /// A swept core of this shape with its facets, where it is a polytope.
    pub(crate) fn faceted<'a>(&'a self, swept: Swept<'a>) -> Faceted<'a> {
        let facets = match &self.kind {
            Kind::Polytope(corners) | Kind::Round { core: RoundCore::Few(corners), .. } => corners.facets(),
            _ => None,
        };
        Faceted { swept, facets }
    }

    /// The numbers of the parts that may be within a distance of a box, ascending; all of them for what has no box.
    pub(crate) fn parts_near(&self, bounds: Option<[[f64; 3]; 2]>, reach: f64) -> Vec<u32> {
        let near = self.part_tree().and_then(|tree| tree.near(bounds, reach));
        near.unwrap_or_else(|| (0..self.parts().len() as u32).collect())
    }

    /// A part whose box is as near to a point as any, where there is a tree to tell.
    pub(crate) fn part_nearest(&self, point: [f64; 3]) -> Option<u32> {
        self.part_tree()?.nearest(point)
    }

    fn part_tree(&self) -> Option<&PartTree> {
        self.parts.as_deref()?.tree.as_ref()
    }

    fn world_bounds(&self) -> Option<[[f64; 3]; 2]> {
        let mut all: Option<[[f64; 3]; 2]> = None;
        for part in self.parts() {
            let [min, max] = match part.form() {
                Form::Convex(swept) => swept.world_bounds(),
                Form::Surface(surface) => match surface.world_bounds() {
                    Some(bounds) => bounds,
                    None => continue,
                },
                Form::HalfSpace(_) => return None,
            };
            let [low, high] = all.unwrap_or([min, max]);
            all = Some([std::array::from_fn(|k| low[k].min(min[k])), std::array::from_fn(|k| high[k].max(max[k]))]);
        }
        all
    }
}

impl From<PlacedMesh<'_>> for PlacedShape {
    fn from(placed: PlacedMesh<'_>) -> Self {
        let kind = Kind::Mesh { mesh: placed.mesh.clone(), is_solid: placed.is_solid };
        let mut shape = Self { kind, stand: Stand::at(placed.world_from_mesh), parts: None };
        shape.stand.bounds = shape.world_bounds();
        shape
    }
}

/// The radius of a ball that the image of a ball holds, and of one that holds it; both are the ball's own where the pose is
/// exactly orthogonal.
///
/// # Accuracy
/// With s the bound of the greatest singular value and δ = ‖RᵀR - I‖, s - 1 is at least δ/2, and the least singular value is at
/// least √(1 - δ) ≥ 1 - δ/2 - δ²/2.
pub(super) fn images_of_radius(radius: f64, pose: &Pose) -> Result<[f64; 2], InputError> {
    let beyond = stretch(pose)? - 1.0;
    if beyond == 0.0 {
        return Ok([radius; 2]);
    }
    let rounding = 4.0 * f64::EPSILON * radius;
    Ok([(radius * (1.0 - beyond - 2.0 * beyond * beyond) - rounding).max(0.0), radius * (1.0 + beyond) + rounding])
}

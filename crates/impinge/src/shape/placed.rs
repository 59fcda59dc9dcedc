//! Shapes placed in the world.

use std::sync::Arc;

use super::form::Form;
use super::kind::{Kind, RoundCore, Shape};
use super::part_finder::PartFinder;
use super::stand::{Bounds, Stand};
use crate::convex::{Core, Faceted, HalfSpace, Surface, Swept};
use crate::input::InputError;
use crate::math::Pose;
use crate::mesh::PlacedMesh;
use crate::simd::prefetch;
use crate::volume::stretch;

/// Maximum number of corners that are prefetched: those of a box.
const MAX_PREFETCHED_CORNERS: usize = 8;

/// A [`Shape`] at a pose in the world. Round shapes and custom sets need a rigid pose, to within
/// 1e-4 (see [`Shape::at`]).
#[derive(Clone, Debug)]
pub struct PlacedShape {
    pub(super) kind: Kind,
    pub(super) stand: Stand,
    /// Placed parts, if the shape is a compound.
    pub(super) parts: Option<Arc<Parts>>,
}

/// Parts of a placed compound. No part is a compound itself.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) all: Vec<PlacedShape>,
    finder: PartFinder,
}

impl Parts {
    pub(super) fn new(all: Vec<PlacedShape>) -> Self {
        Self { all, finder: PartFinder::default() }
    }

    fn boxes(&self) -> impl ExactSizeIterator<Item = Option<[[f64; 3]; 2]>> {
        self.all.iter().map(PlacedShape::bounds)
    }
}

impl Shape {
    /// Returns this shape at a pose in the world. The pose maps the shape's frame to the world
    /// frame.
    ///
    /// # Errors
    /// [`NotRigid`](crate::InputErrorKind::NotRigid) if the pose is more than 1e-4 from a rigid
    /// motion and the shape is a sphere, capsule, cylinder, cone, ellipsoid or custom set. All
    /// other shapes accept any affine pose. For a compound also the errors of [`Pose::compose`], if
    /// its pose cannot be composed with the pose of a part.
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
        if placed.parts.is_some() {
            placed.stand.bounds = Bounds::of(placed.world_bounds());
        } else {
            placed.stand.radius = placed.images_of_radius_at(&world_from_local)?;
            placed.stand.bounds = placed.bounds_at(&placed.stand);
        }
        Ok(placed)
    }
}

impl PlacedShape {
    /// Returns the pose of the shape, which maps its frame to the world frame.
    #[must_use]
    pub fn world_from_local(&self) -> &Pose {
        &self.stand.world_from_local
    }

    /// Returns the lower and the upper corner of a box in the world frame that contains the shape.
    /// Returns `None` if the shape is or contains a half-space, or if it is empty.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.stand.bounds()
    }

    /// Returns the pose and the values that follow from it.
    pub(crate) fn stand(&self) -> &Stand {
        &self.stand
    }

    /// Reports whether the shape is or contains a half-space.
    pub(crate) fn is_unbounded(&self) -> bool {
        self.parts().iter().any(|part| matches!(part.kind, Kind::HalfSpace { .. }))
    }

    /// Returns the parts that queries compare: the parts of a compound, or else this shape alone.
    pub(crate) fn parts(&self) -> &[Self] {
        self.parts.as_ref().map_or(std::slice::from_ref(self), |parts| &parts.all)
    }

    /// Returns the one mesh that the shape is made of, or `None` if it is something else.
    pub(crate) fn as_mesh(&self) -> Option<PlacedMesh<'_>> {
        let [part] = self.parts() else { return None };
        match &part.kind {
            Kind::Mesh { mesh, is_solid } => {
                Some(PlacedMesh { mesh, world_from_mesh: part.stand.world_from_local, is_solid: *is_solid })
            }
            Kind::Polytope(_) | Kind::Round { .. } | Kind::HalfSpace { .. } | Kind::Field(_) | Kind::Compound(_) => {
                None
            }
        }
    }

    /// Returns this shape at another pose.
    ///
    /// # Errors
    /// As for [`Shape::at`].
    pub(crate) fn moved_to(&self, world_from_local: Pose) -> Result<Self, InputError> {
        Shape(self.kind.clone()).at(world_from_local)
    }

    /// Returns the values that follow from another pose, or `None` for a compound, whose parts have
    /// them.
    ///
    /// # Errors
    /// As for [`Shape::at`].
    fn stand_at(&self, world_from_local: &Pose) -> Result<Option<Stand>, InputError> {
        let mut stand = Stand::at(*world_from_local);
        Ok(self.write_stand(world_from_local, &mut stand)?.then_some(stand))
    }

    /// Writes another pose, and the values that follow from it, to a stand. Returns `false` for a
    /// compound, whose parts have these values. The stand is unspecified then, and after an error.
    ///
    /// # Errors
    /// As for [`Shape::at`].
    pub(crate) fn write_stand(&self, world_from_local: &Pose, stand: &mut Stand) -> Result<bool, InputError> {
        if self.parts.is_some() {
            return Ok(false);
        }
        stand.radius = self.images_of_radius_at(world_from_local)?;
        stand.world_from_local = *world_from_local;
        stand.bounds = Bounds::Unknown;
        stand.bounds = self.bounds_at(stand);
        Ok(true)
    }

    /// Returns the bounds of a part at a pose, of which only the bounds are not known yet.
    fn bounds_at(&self, stand: &Stand) -> Bounds {
        match self.form_at(stand) {
            Form::Convex(swept) => Bounds::Box(swept.world_bounds()),
            Form::Surface(surface) => Bounds::of(surface.world_bounds()),
            Form::Field(field) => Bounds::of(field.world_bounds()),
            Form::HalfSpace(plane) => {
                let (direction, _, level) = plane.rounded();
                Bounds::Plane(direction, level)
            }
        }
    }

    /// Returns [`images_of_radius`], or zeros if the part has no radius. They depend on the linear
    /// part of the pose alone, and are known if it does not change. A shape that is not placed yet
    /// has no radius.
    fn images_of_radius_at(&self, pose: &Pose) -> Result<[f64; 2], InputError> {
        let Kind::Round { radius, .. } = &self.kind else { return Ok([0.0; 2]) };
        let is_known = self.stand.radius[1] > 0.0 && self.stand.world_from_local.linear() == pose.linear();
        if is_known { Ok(self.stand.radius) } else { images_of_radius(*radius, pose) }
    }

    /// Moves the shape to a pose whose values [`write_stand`](Self::write_stand) wrote, and exchanges
    /// them with those of the pose before.
    pub(crate) fn swap_stand(&mut self, stand: &mut Stand) {
        std::mem::swap(&mut self.stand, stand);
    }

    /// Moves the shape to another pose, as [`Shape::at`] places it, without allocating memory for
    /// its parts again.
    ///
    /// # Errors
    /// As for [`Shape::at`]. The parts may be at either pose then.
    pub(crate) fn move_to(&mut self, world_from_local: &Pose) -> Result<(), InputError> {
        if let Some(stand) = self.stand_at(world_from_local)? {
            self.stand = stand;
        }
        if let (Kind::Compound(shapes), Some(parts)) = (&self.kind, &mut self.parts) {
            let Parts { all, finder } = Arc::make_mut(parts);
            for ((_, compound_from_part), part) in shapes.iter().zip(&mut *all) {
                part.move_to(&world_from_local.compose(compound_from_part)?)?;
            }
            *finder = PartFinder::default();
            self.stand = Stand::at(*world_from_local);
            self.stand.bounds = Bounds::of(self.world_bounds());
        }
        Ok(())
    }

    /// Prefetches the pointer to the corners of a polytope.
    pub(crate) fn prefetch(&self) {
        if let Kind::Polytope(corners) | Kind::Round { core: RoundCore::Polytope(corners), .. } = &self.kind {
            corners.prefetch();
        }
    }

    /// Prefetches a few corners. This reads the pointer to them.
    pub(crate) fn prefetch_corners(&self) {
        if let Kind::Polytope(corners) | Kind::Round { core: RoundCore::Polytope(corners), .. } = &self.kind
            && let Core::Points(points) | Core::Cuboid(points) = corners.core()
        {
            points.iter().take(MAX_PREFETCHED_CORNERS).step_by(2).for_each(prefetch);
        }
    }

    /// Returns the representation of a part. A compound has none of its own and returns that of its
    /// first part.
    pub(crate) fn form(&self) -> Form<'_> {
        self.form_at(&self.stand)
    }

    /// Returns the representation that the part would have at another pose.
    pub(crate) fn form_at<'a>(&'a self, stand: &'a Stand) -> Form<'a> {
        let (pose, radius) = (&stand.world_from_local, stand.radius);
        let core = match &self.kind {
            Kind::Polytope(corners) | Kind::Round { core: RoundCore::Polytope(corners), .. } => corners.core(),
            Kind::Round { core: RoundCore::Turned(set), .. } => Core::Turned(set),
            Kind::Round { core: RoundCore::Curved(set), .. } => Core::Curved(&**set),
            Kind::HalfSpace { normal, level } => {
                return Form::HalfSpace(match stand.bounds {
                    Bounds::Plane(direction, along) => HalfSpace::known((*normal, *level), pose, (direction, along)),
                    Bounds::Box(_) | Bounds::Unknown => HalfSpace::new(*normal, *level, pose),
                });
            }
            Kind::Mesh { mesh, is_solid } => return Form::Surface(Surface { mesh, pose, is_solid: *is_solid }),
            Kind::Field(field) => return Form::Field(Surface { mesh: field, pose, is_solid: false }),
            Kind::Compound(_) => return self.parts()[0].form(),
        };
        Form::Convex(Swept { core, pose, radius })
    }

    /// Returns a swept core of this shape with its facets, if it is a polytope.
    pub(crate) fn faceted<'a>(&'a self, swept: Swept<'a>) -> Faceted<'a> {
        let facets = match &self.kind {
            Kind::Polytope(corners) | Kind::Round { core: RoundCore::Polytope(corners), .. } => corners.facets(),
            _ => None,
        };
        Faceted { swept, facets, has_all_facets: false }
    }

    /// Returns the indices of the parts that may be within `reach` of a box, in ascending order.
    /// Returns all parts if there is no box.
    pub(crate) fn parts_near(&self, bounds: Option<[[f64; 3]; 2]>, reach: f64) -> Vec<u32> {
        let near = self.parts.as_ref().and_then(|parts| parts.finder.near(parts.boxes(), bounds, reach));
        near.unwrap_or_else(|| (0..self.parts().len() as u32).collect())
    }

    /// Returns a part whose box is nearest to a point, or `None` if there are few parts, or if none
    /// has a box.
    pub(crate) fn part_nearest(&self, point: [f64; 3]) -> Option<u32> {
        let parts = self.parts.as_ref()?;
        parts.finder.nearest(parts.boxes(), point)
    }

    /// Returns the box of all parts, which are placed, if they are bounded.
    fn world_bounds(&self) -> Option<[[f64; 3]; 2]> {
        let mut all: Option<[[f64; 3]; 2]> = None;
        for part in self.parts() {
            let [min, max] = match part.stand.bounds {
                Bounds::Box(bounds) => bounds,
                Bounds::Unknown => continue,
                Bounds::Plane(..) => return None,
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
        let surface = Surface { mesh: placed.mesh, pose: &placed.world_from_mesh, is_solid: placed.is_solid };
        let bounds = Bounds::of(surface.world_bounds());
        Self { kind, stand: Stand { bounds, ..Stand::at(placed.world_from_mesh) }, parts: None }
    }
}

/// Returns the radius of a sphere that the image of a sphere contains, and of a sphere that
/// contains the image. Both are equal to `radius` if the pose is exactly orthogonal.
///
/// # Accuracy
/// With s the bound of the largest singular value and δ = ‖RᵀR - I‖, s - 1 is at least δ/2, and the
/// smallest singular value is at least √(1 - δ) ≥ 1 - δ/2 - δ²/2.
pub(super) fn images_of_radius(radius: f64, pose: &Pose) -> Result<[f64; 2], InputError> {
    let beyond = stretch(pose)? - 1.0;
    if beyond == 0.0 {
        return Ok([radius; 2]);
    }
    let rounding = 4.0 * f64::EPSILON * radius;
    Ok([(radius * (1.0 - beyond - 2.0 * beyond * beyond) - rounding).max(0.0), radius * (1.0 + beyond) + rounding])
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::{Rng, poses};

    /// Poses are a little stretched, so that the radii of a moved sphere are not those of the
    /// shape, and many have the linear part of the pose before.
    #[test]
    fn a_moved_shape_has_the_radii_of_one_placed_there() {
        let mut rng = Rng::new(48);
        let (mut stretched, mut kept) = (0, 0);
        let capsule = Shape::capsule([0.0; 3], [0.0, 0.0, 1.0], 0.3).expect("a capsule");
        let mut moved = capsule.at(Pose::IDENTITY).expect("a rigid pose");
        for _ in 0..400 {
            let scale = 1.0 + 1e-5 * rng.integer(-2, 2) as f64;
            let turned = poses::rotation(&mut rng).linear.map(|row| row.map(|x| x * scale));
            let keeps = rng.one_in(2);
            let linear = if keeps { *moved.world_from_local().linear() } else { turned };
            let to = Pose::new(linear, [0; 3].map(|_| rng.integer(-3, 3) as f64)).expect("a pose");
            let placed = capsule.at(to).expect("a rigid pose");
            let mut stand = Stand::default();
            assert_eq!(moved.write_stand(&to, &mut stand), Ok(true));
            moved.swap_stand(&mut stand);
            assert_eq!(moved.stand.radius.map(f64::to_bits), placed.stand.radius.map(f64::to_bits));
            assert_eq!(moved.bounds(), placed.bounds());
            stretched += u32::from(moved.stand.radius[1] > 0.3 * (1.0 + 1e-6));
            kept += u32::from(keeps);
        }
        assert!(stretched > 200 && (150..250).contains(&kept), "{stretched} {kept}");
    }
}

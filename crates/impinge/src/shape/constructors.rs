//! Constructors of shapes, which validate their numbers.

use std::sync::Arc;

use super::corners::Corners;
use super::kind::{Kind, RoundCore, Shape};
use super::round::{ErodedEllipsoid, Tapered};
use crate::convex::{Support, Turned};
use crate::hull::Hull;
use crate::input::{InputError, InputErrorKind};
use crate::math::dyadic::{self, Dyadic};
use crate::math::{Pose, Sign};
use crate::mesh::{ConvexParts, HeightField, Mesh, SolidMesh};

/// Coordinates and lengths must be below this magnitude, 2^128. The proofs hold below it, as for
/// meshes.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// Maximum number of parts of a compound. Placing a compound copies each part, about 300 bytes, so
/// a placed compound takes at most some hundred megabytes. Compounds of compounds multiply their
/// parts: without a limit, 30 nested calls would exhaust any memory.
const MAX_PARTS: usize = 1 << 20;

impl Shape {
    /// Returns a sphere about a center, in the frame of the shape. A radius of zero gives a point.
    ///
    /// # Errors
    /// For this and all other constructors: [`NonFinite`](InputErrorKind::NonFinite) for NaN and
    /// infinity, [`OutOfRange`](InputErrorKind::OutOfRange) for a magnitude of 2^128 or more, and
    /// [`Negative`](InputErrorKind::Negative) for a negative length.
    pub fn sphere(center: [f64; 3], radius: f64) -> Result<Self, InputError> {
        check_points("center", &[center])?;
        check_lengths("radius", &[radius])?;
        Ok(Self(Kind::Round { core: RoundCore::Polytope(Corners::few(&[center])), radius }))
    }

    /// Returns a capsule, in the frame of the shape: the points within `radius` of a segment. The
    /// ends of the segment may be equal.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn capsule(start: [f64; 3], end: [f64; 3], radius: f64) -> Result<Self, InputError> {
        check_points("capsule end", &[start, end])?;
        check_lengths("radius", &[radius])?;
        Ok(Self(Kind::Round { core: RoundCore::Polytope(Corners::few(&[start, end])), radius }))
    }

    /// Returns a tapered capsule, in the frame of the shape: the convex hull of two spheres, whose
    /// centers are `start` and `end`. Two equal radii give a [`capsule`](Self::capsule). If one
    /// sphere contains the other, which is decided exactly, the shape is the larger
    /// [`sphere`](Self::sphere).
    ///
    /// ```
    /// use impinge::{Pose, Shape, query};
    ///
    /// let arm = Shape::tapered_capsule([0.0; 3], [0.0, 0.0, 5.0], [4.0, 1.0])?.at(Pose::IDENTITY)?;
    /// let marble = Shape::sphere([3.0, 4.0, 5.0], 1.0)?.at(Pose::IDENTITY)?;
    /// let found = query::distance(&arm, &marble);
    /// assert!(found.lower <= 2.0 && 2.0 <= found.upper && found.upper - found.lower < 1e-9);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn tapered_capsule(start: [f64; 3], end: [f64; 3], radii: [f64; 2]) -> Result<Self, InputError> {
        check_points("capsule end", &[start, end])?;
        check_lengths("end radius", &radii)?;
        let [(center, radius), (tip, least)] = if radii[0] < radii[1] {
            [(end, radii[1]), (start, radii[0])]
        } else {
            [(start, radii[0]), (end, radii[1])]
        };
        if radius == least {
            return Self::capsule(start, end, radius);
        }
        if contains([(&center, radius), (&tip, least)]) {
            return Self::sphere(center, radius);
        }
        let set = Tapered { center, radius: radius - least, tip };
        Ok(Self(Kind::Round { core: RoundCore::Curved(Arc::new(set)), radius: least }))
    }

    /// Returns a box about the origin of the shape's frame, with edges along the axes. It reaches
    /// from minus to plus the half-extent along each axis; a half-extent may be zero.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn cuboid(half_extents: [f64; 3]) -> Result<Self, InputError> {
        check_lengths("half-extent", &half_extents)?;
        Ok(Self(Kind::Polytope(Corners::cuboid(half_extents))))
    }

    /// Returns a cylinder about the z axis of the shape's frame, from z = -`half_height` to z =
    /// `half_height`.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn cylinder(half_height: f64, radius: f64) -> Result<Self, InputError> {
        check_lengths("half-height", &[half_height])?;
        check_lengths("radius", &[radius])?;
        Ok(Self::turned(Turned { half_height, radius, is_cone: false }))
    }

    /// Returns a cone about the z axis of the shape's frame. Its base has the given radius and lies
    /// at z = -`half_height`; its tip lies at z = `half_height`.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn cone(half_height: f64, radius: f64) -> Result<Self, InputError> {
        check_lengths("half-height", &[half_height])?;
        check_lengths("radius", &[radius])?;
        Ok(Self::turned(Turned { half_height, radius, is_cone: true }))
    }

    /// Returns an ellipsoid about the origin of the shape's frame, with its axes along the
    /// coordinate axes. `half_axes` are half the lengths of its axes, which may be zero. Three
    /// equal half-axes give a sphere.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn ellipsoid(half_axes: [f64; 3]) -> Result<Self, InputError> {
        check_lengths("half-axis", &half_axes)?;
        if half_axes == [half_axes[0]; 3] {
            return Self::sphere([0.0; 3], half_axes[0]);
        }
        let (core, radius) = ErodedEllipsoid::of(half_axes);
        Ok(Self(Kind::Round { core: RoundCore::Curved(Arc::new(core)), radius }))
    }

    /// Returns the shape of a convex hull, with its interior. The hull's frame is the frame of the
    /// shape.
    #[must_use]
    pub fn hull(hull: Arc<Hull>) -> Self {
        Self(Kind::Polytope(Corners::hull(hull)))
    }

    /// Returns the shape of one point, in the frame of the shape.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn point(point: [f64; 3]) -> Result<Self, InputError> {
        Self::few("point", &[point])
    }

    /// Returns a segment, in the frame of the shape. Its ends may be equal.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn segment(ends: [[f64; 3]; 2]) -> Result<Self, InputError> {
        Self::few("end", &ends)
    }

    /// Returns a triangle, in the frame of the shape. It may have no area.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere).
    pub fn triangle(corners: [[f64; 3]; 3]) -> Result<Self, InputError> {
        Self::few("corner", &corners)
    }

    /// Returns a half-space: the points x of the shape's frame with `normal`·x ≤ `level`. The
    /// normal may have any length except zero.
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere), and [`ZeroAxis`](InputErrorKind::ZeroAxis) for a normal of
    /// zero.
    pub fn half_space(normal: [f64; 3], level: f64) -> Result<Self, InputError> {
        check_points("normal", &[normal])?;
        check_points("level", &[[level, 0.0, 0.0]])?;
        if normal == [0.0; 3] {
            return Err(InputError::new(InputErrorKind::ZeroAxis));
        }
        Ok(Self(Kind::HalfSpace { normal, level }))
    }

    /// Returns a shape for any convex set with a support function, in the frame of the shape.
    /// Accuracy is that of round shapes, and poses must be rigid ([`at`](Self::at)).
    ///
    /// ```
    /// use std::sync::Arc;
    /// use impinge::{Pose, Shape, convex::Support, query};
    ///
    /// /// |x| + |y| + |z| ≤ 1.
    /// #[derive(Debug)]
    /// struct Octahedron;
    ///
    /// impl Support for Octahedron {
    ///     fn support(&self, direction: [f64; 3]) -> [f64; 3] {
    ///         let axis = (0..3).max_by(|&i, &j| direction[i].abs().total_cmp(&direction[j].abs())).unwrap_or(0);
    ///         std::array::from_fn(|k| if k == axis { 1_f64.copysign(direction[k]) } else { 0.0 })
    ///     }
    ///
    ///     fn reach(&self) -> [f64; 3] {
    ///         [1.0; 3]
    ///     }
    /// }
    ///
    /// let octahedron = Shape::custom(Arc::new(Octahedron))?.at(Pose::IDENTITY)?;
    /// let point = Shape::point([1.0, 1.0, 1.0])?.at(Pose::IDENTITY)?;
    /// let distance = query::distance(&octahedron, &point);
    /// assert!((distance.upper - 2.0 / 3_f64.sqrt()).abs() < 1e-12);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Errors
    /// As for [`sphere`](Self::sphere), if a length that [`Support::reach`] returns is invalid.
    pub fn custom(set: Arc<dyn Support>) -> Result<Self, InputError> {
        check_lengths("reach", &set.reach())?;
        Ok(Self::curved(set))
    }

    /// Returns the surface of a mesh as a shape, in the mesh frame. All shapes made of a mesh share
    /// its memory.
    #[must_use]
    pub fn mesh(mesh: &Mesh) -> Self {
        Self(Kind::Mesh { mesh: mesh.clone(), is_solid: false })
    }

    /// Returns a mesh as a solid shape, in the mesh frame: its surface and all points whose winding
    /// number is above one half.
    ///
    /// ```
    /// use impinge::{Mesh, Pose, Positions, Shape, query};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
    /// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    /// let marble = Shape::sphere([1.0; 3], 0.5)?.at(Pose::IDENTITY)?;
    /// assert!(!query::intersects(&Shape::mesh(&mesh).at(Pose::IDENTITY)?, &marble));
    /// assert!(query::intersects(&Shape::solid(&mesh).at(Pose::IDENTITY)?, &marble));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    #[must_use]
    pub fn solid(mesh: &Mesh) -> Self {
        Self(Kind::Mesh { mesh: mesh.clone(), is_solid: true })
    }

    /// Returns the surface of a height field as a shape, in the frame of the field. All shapes made
    /// of a field share its memory.
    ///
    /// Queries answer as for the mesh of the same triangles. Contacts, and queries about a mesh or
    /// another field, make a mesh of the triangles that are near. Only [`penetration`] differs: it
    /// takes a mesh as a solid, but a height field has no inside.
    ///
    /// [`penetration`]: crate::query::penetration()
    #[must_use]
    pub fn height_field(field: &HeightField) -> Self {
        Self(Kind::Field(field.clone()))
    }

    /// Returns the mesh that the shape is made of, and whether it is solid. Returns `None` for any
    /// other shape.
    #[must_use]
    pub fn as_mesh(&self) -> Option<(&Mesh, bool)> {
        match &self.0 {
            Kind::Mesh { mesh, is_solid } => Some((mesh, *is_solid)),
            _ => None,
        }
    }

    /// Returns a compound: the union of some shapes, each at a pose in the frame of the compound.
    /// Contacts name parts by their index in `parts`. A compound among the parts is replaced by its
    /// own parts, each of which has an index of its own.
    ///
    /// ```
    /// use impinge::{Pose, Shape, query};
    ///
    /// let end = Shape::sphere([0.0; 3], 0.5)?;
    /// let bar = Shape::cuboid([1.0, 0.125, 0.125])?;
    /// let at = |x| Pose::from_translation([x, 0.0, 0.0]);
    /// let dumbbell = Shape::compound(&[(end.clone(), at(-1.0)?), (bar, at(0.0)?), (end, at(1.0)?)])?.at(Pose::IDENTITY)?;
    /// let between = Shape::point([0.0, 0.25, 0.0])?.at(Pose::IDENTITY)?;
    /// assert!(!query::intersects(&dumbbell, &between));
    /// assert!((query::distance(&dumbbell, &between).upper - 0.125).abs() < 1e-12);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// The pose of a part in the world is the product of its pose and the compound's pose, rounded
    /// ([`Pose::compose`]). Answers about the compound are answers about its parts at these poses.
    ///
    /// # Errors
    /// [`Empty`](InputErrorKind::Empty) if there are no parts, and
    /// [`TooMany`](InputErrorKind::TooMany) if there are more than 2^20 parts, those of nested
    /// compounds included. The errors of [`Pose::compose`], if the poses of nested compounds cannot
    /// be composed.
    pub fn compound(parts: &[(Self, Pose)]) -> Result<Self, InputError> {
        if parts.is_empty() {
            return Err(InputError::new(InputErrorKind::Empty { what: "parts" }));
        }
        let count = parts.iter().map(|(shape, _)| shape.part_count()).fold(0, usize::saturating_add);
        if count > MAX_PARTS {
            let kind = InputErrorKind::TooMany { what: "parts", count, limit: MAX_PARTS };
            return Err(InputError::new(kind).with_hint("a compound repeats the parts of the compounds in it"));
        }
        let mut single = Vec::with_capacity(count);
        for (shape, compound_from_part) in parts {
            match &shape.0 {
                Kind::Compound(inner) => {
                    for (shape, part_from_inner) in &**inner {
                        single.push((shape.clone(), compound_from_part.compose(part_from_inner)?));
                    }
                }
                _ => single.push((shape.clone(), *compound_from_part)),
            }
        }
        Ok(Self(Kind::Compound(single.into())))
    }

    /// Returns the number of parts that the shape has as a part of a compound.
    pub(crate) fn part_count(&self) -> usize {
        if let Kind::Compound(parts) = &self.0 { parts.len() } else { 1 }
    }

    /// Returns the convex hull of a few points.
    fn few(what: &'static str, points: &[[f64; 3]]) -> Result<Self, InputError> {
        check_points(what, points)?;
        Ok(Self(Kind::Polytope(Corners::few(points))))
    }

    /// Returns a cylinder or a cone.
    fn turned(set: Turned) -> Self {
        Self(Kind::Round { core: RoundCore::Turned(set), radius: 0.0 })
    }

    /// Returns a shape of a round set without a radius.
    fn curved(set: Arc<dyn Support>) -> Self {
        Self(Kind::Round { core: RoundCore::Curved(set), radius: 0.0 })
    }
}

impl From<&Shape> for Shape {
    fn from(shape: &Shape) -> Self {
        shape.clone()
    }
}

impl From<&Mesh> for Shape {
    /// Returns the surface of the mesh.
    fn from(mesh: &Mesh) -> Self {
        Self::mesh(mesh)
    }
}

impl From<&HeightField> for Shape {
    fn from(field: &HeightField) -> Self {
        Self::height_field(field)
    }
}

impl From<&ConvexParts> for Shape {
    /// Returns the compound of the hulls, with the parts in their order.
    fn from(parts: &ConvexParts) -> Self {
        let hulls = parts.parts().iter().map(|part| (Self::hull(part.hull.clone()), Pose::IDENTITY));
        Self(Kind::Compound(hulls.collect()))
    }
}

impl From<SolidMesh<'_>> for Shape {
    fn from(solid: SolidMesh<'_>) -> Self {
        Self::solid(solid.0)
    }
}

/// Reports whether the first of two spheres contains the second. Its radius must be greater.
fn contains([(center, radius), (other, least)]: [(&[f64; 3], f64); 2]) -> bool {
    let between = [0, 1, 2].map(|k| &Dyadic::from_f64(other[k]) - &Dyadic::from_f64(center[k]));
    let reach = &Dyadic::from_f64(radius) - &Dyadic::from_f64(least);
    (&dyadic::dot(&between, &between) - &(&reach * &reach)).sign() != Sign::Positive
}

fn check_points(what: &'static str, points: &[[f64; 3]]) -> Result<(), InputError> {
    for (index, point) in points.iter().enumerate() {
        if !point.iter().all(|x| x.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what, index }));
        }
        if !point.iter().all(|x| x.abs() < LIMIT) {
            return Err(InputError::new(InputErrorKind::OutOfRange { what, index, limit: "2^128" }));
        }
    }
    Ok(())
}

pub(super) fn check_lengths(what: &'static str, lengths: &[f64]) -> Result<(), InputError> {
    for (index, &length) in lengths.iter().enumerate() {
        if !length.is_finite() {
            return Err(InputError::new(InputErrorKind::NonFinite { what, index }));
        }
        if length < 0.0 {
            return Err(InputError::new(InputErrorKind::Negative { what, index }));
        }
        if length >= LIMIT {
            return Err(InputError::new(InputErrorKind::OutOfRange { what, index, limit: "2^128" }));
        }
    }
    Ok(())
}

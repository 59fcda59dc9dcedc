//! The shapes that can be made, and the validation of their numbers.

use std::sync::Arc;

use super::corners::Corners;
use super::kind::{Kind, RoundCore, Shape};
use super::round::{Cone, Cylinder, Ellipsoid};
use crate::convex::Support;
use crate::hull::Hull;
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::mesh::{Mesh, SolidMesh};

/// Coordinates and lengths stay below this magnitude: the range of the proofs, that of meshes.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

impl Shape {
    /// The ball about a centre; a radius of zero makes it that point.
    ///
    /// # Errors
    /// As all constructors here: [`NonFinite`](InputErrorKind::NonFinite), [`OutOfRange`](InputErrorKind::OutOfRange) (not
    /// below 2^128), [`Negative`](InputErrorKind::Negative) for lengths.
    pub fn sphere(centre: [f64; 3], radius: f64) -> Result<Self, InputError> {
        judge_points("centre", &[centre])?;
        judge_lengths("radius", &[radius])?;
        Ok(Self(Kind::Round { core: RoundCore::Few(Corners::few(&[centre])), radius }))
    }

    /// The points within `radius` of a segment, whose ends may be equal.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn capsule(start: [f64; 3], end: [f64; 3], radius: f64) -> Result<Self, InputError> {
        judge_points("capsule end", &[start, end])?;
        judge_lengths("radius", &[radius])?;
        Ok(Self(Kind::Round { core: RoundCore::Few(Corners::few(&[start, end])), radius }))
    }

    /// The box about the origin that reaches as far along each axis as its half-extent says, which may be zero.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn cuboid(half_extents: [f64; 3]) -> Result<Self, InputError> {
        judge_lengths("half-extent", &half_extents)?;
        let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { half_extents[k] } else { -half_extents[k] });
        Self::few("corner", &[0, 1, 2, 3, 4, 5, 6, 7].map(corner))
    }

    /// The cylinder about the z axis, from -`half_height` to `half_height`.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn cylinder(half_height: f64, radius: f64) -> Result<Self, InputError> {
        judge_lengths("half-height", &[half_height])?;
        judge_lengths("radius", &[radius])?;
        Ok(Self::curved(Arc::new(Cylinder { half_height, radius })))
    }

    /// The cone about the z axis with its base of `radius` at -`half_height` and its tip at `half_height`.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn cone(half_height: f64, radius: f64) -> Result<Self, InputError> {
        judge_lengths("half-height", &[half_height])?;
        judge_lengths("radius", &[radius])?;
        Ok(Self::curved(Arc::new(Cone { half_height, radius })))
    }

    /// The ellipsoid about the origin with these half-lengths of its axes, which may be zero; a sphere where all are equal.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn ellipsoid(half_axes: [f64; 3]) -> Result<Self, InputError> {
        judge_lengths("half-axis", &half_axes)?;
        if half_axes == [half_axes[0]; 3] {
            return Self::sphere([0.0; 3], half_axes[0]);
        }
        Ok(Self::curved(Arc::new(Ellipsoid { half_axes })))
    }

    /// A convex hull.
    #[must_use]
    pub fn hull(hull: Arc<Hull>) -> Self {
        Self(Kind::Polytope(Corners::hull(hull)))
    }

    /// A point.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn point(point: [f64; 3]) -> Result<Self, InputError> {
        Self::few("point", &[point])
    }

    /// A segment, whose ends may be equal.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn segment(ends: [[f64; 3]; 2]) -> Result<Self, InputError> {
        Self::few("end", &ends)
    }

    /// A triangle, which may have no area.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere).
    pub fn triangle(corners: [[f64; 3]; 3]) -> Result<Self, InputError> {
        Self::few("corner", &corners)
    }

    /// The points x with `normal`·x ≤ `level`; the normal needs no length of 1.
    ///
    /// # Errors
    /// As [`sphere`](Self::sphere), and [`ZeroAxis`](InputErrorKind::ZeroAxis) for a normal of zero.
    pub fn half_space(normal: [f64; 3], level: f64) -> Result<Self, InputError> {
        judge_points("normal", &[normal])?;
        judge_points("level", &[[level, 0.0, 0.0]])?;
        if normal == [0.0; 3] {
            return Err(InputError::new(InputErrorKind::ZeroAxis));
        }
        Ok(Self(Kind::HalfSpace { normal, level }))
    }

    /// Any convex set with a support function, which is taken as round.
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
    /// As [`sphere`](Self::sphere), of the set's reach.
    pub fn custom(set: Arc<dyn Support>) -> Result<Self, InputError> {
        judge_lengths("reach", &set.reach())?;
        Ok(Self::curved(set))
    }

    /// A mesh as its surface; the mesh is shared by all shapes that are made of it.
    #[must_use]
    pub fn mesh(mesh: &Mesh) -> Self {
        Self(Kind::Mesh { mesh: mesh.clone(), is_solid: false })
    }

    /// A mesh with all that it winds round more than half.
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

    /// The mesh that the shape is, and whether it is solid; none where it is something else.
    #[must_use]
    pub fn as_mesh(&self) -> Option<(&Mesh, bool)> {
        match &self.0 {
            Kind::Mesh { mesh, is_solid } => Some((mesh, *is_solid)),
            _ => None,
        }
    }

    /// All of some shapes, each at its place in the frame of the compound. Contacts name parts by their row here; the parts of
    /// a compound among them count one by one.
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
    /// A part's place in the world is the product of its pose and the compound's, rounded ([`Pose::compose`]); what is said of
    /// the compound is said of its parts there.
    ///
    /// # Errors
    /// [`Empty`](InputErrorKind::Empty) without shapes; where poses of compounds in compounds cannot be composed.
    pub fn compound(parts: &[(Self, Pose)]) -> Result<Self, InputError> {
        if parts.is_empty() {
            return Err(InputError::new(InputErrorKind::Empty { what: "parts" }));
        }
        let mut single = Vec::with_capacity(parts.len());
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

    fn few(what: &'static str, points: &[[f64; 3]]) -> Result<Self, InputError> {
        judge_points(what, points)?;
        Ok(Self(Kind::Polytope(Corners::few(points))))
    }

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
    /// The surface of the mesh.
    fn from(mesh: &Mesh) -> Self {
        Self::mesh(mesh)
    }
}

impl From<SolidMesh<'_>> for Shape {
    fn from(solid: SolidMesh<'_>) -> Self {
        Self::solid(solid.0)
    }
}

fn judge_points(what: &'static str, points: &[[f64; 3]]) -> Result<(), InputError> {
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

fn judge_lengths(what: &'static str, lengths: &[f64]) -> Result<(), InputError> {
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

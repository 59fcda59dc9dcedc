//! Shapes with closed forms of their support heights, which share no code with the library; and
//! conversions of meshes and poses.

use std::sync::Arc;

use impinge::hull::Hull;
use impinge::shape::Shape;
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::{Affine, Mesh as Plain};

pub(crate) const IDENTITY: Affine =
    Affine { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

/// Shape whose height along a direction has a closed form.
#[derive(Clone, Debug)]
pub(crate) enum Known {
    Points(Vec<[f64; 3]>),
    Hull(Vec<[f64; 3]>),
    Capsule([[f64; 3]; 2], f64),
    Cuboid([f64; 3]),
    Cylinder(f64, f64),
    Cone(f64, f64),
    Ellipsoid([f64; 3]),
    Custom(Vec<[f64; 3]>),
    HalfSpace([f64; 3], f64),
    /// The hull of two spheres, by their centers and radii.
    Tapered([[f64; 3]; 2], [f64; 2]),
    /// A shape grown by a radius.
    Rounded(Box<Known>, f64),
}

#[derive(Debug)]
struct Corners(Vec<[f64; 3]>);

impl impinge::convex::Support for Corners {
    fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        *self.0.iter().max_by(|p, q| dot(&direction, p).total_cmp(&dot(&direction, q))).expect("not empty")
    }

    fn reach(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.0.iter().map(|p| p[k].abs()).fold(0.0, f64::max))
    }
}

pub(crate) fn engine(mesh: &Plain) -> Mesh {
    Mesh::new(Positions::F64(mesh.vertices.clone()), mesh.faces.clone()).expect("a legal mesh")
}

pub(crate) fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).expect("in range")
}

pub(crate) fn dot(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

impl Known {
    /// Returns one shape of every kind, all of about the same size.
    pub(crate) fn all() -> Vec<Self> {
        let tetrahedron = vec![[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]];
        vec![
            Self::Points(vec![[0.25, 0.5, -0.125]]),
            Self::Points(vec![[-0.5, 0.0, 0.25], [0.75, 0.5, 0.25]]),
            Self::Points(vec![[1.0, 0.0, 0.0], [-0.5, 0.75, 0.0], [-0.5, -0.75, 0.25]]),
            Self::Capsule([[0.25, 0.0, 0.0]; 2], 0.75),
            Self::Capsule([[0.0, 0.0, -0.75], [0.0, 0.25, 0.75]], 0.375),
            Self::Cuboid([0.5, 0.75, 1.0]),
            Self::Cylinder(0.75, 0.5),
            Self::Cone(0.75, 0.5),
            Self::Ellipsoid([0.5, 0.75, 1.0]),
            Self::Hull(tetrahedron.clone()),
            Self::Custom(tetrahedron.clone()),
            Self::HalfSpace([1.0, -2.0, 0.5], 0.25),
            Self::Tapered([[0.0, 0.0, -0.5], [0.25, 0.0, 0.75]], [0.625, 0.25]),
            Self::Rounded(Box::new(Self::Cuboid([0.5, 0.25, 0.75])), 0.25),
            Self::Rounded(Box::new(Self::Hull(tetrahedron.iter().map(|p| p.map(|x| 0.75 * x)).collect())), 0.125),
            Self::Rounded(Box::new(Self::Cone(0.5, 0.5)), 0.25),
        ]
    }

    pub(crate) fn shape(&self) -> Shape {
        let shape = match self {
            Self::Points(points) => match points[..] {
                [point] => Shape::point(point),
                [start, end] => Shape::segment([start, end]),
                [a, b, c] => Shape::triangle([a, b, c]),
                _ => panic!("no shape of {} points", points.len()),
            },
            Self::Hull(points) => Ok(Shape::hull(Arc::new(Hull::new(points).expect("points")))),
            Self::Capsule([start, end], radius) if start == end => Shape::sphere(*start, *radius),
            Self::Capsule([start, end], radius) => Shape::capsule(*start, *end, *radius),
            Self::Cuboid(half) => Shape::cuboid(*half),
            Self::Cylinder(half_height, radius) => Shape::cylinder(*half_height, *radius),
            Self::Cone(half_height, radius) => Shape::cone(*half_height, *radius),
            Self::Ellipsoid(half_axes) => Shape::ellipsoid(*half_axes),
            Self::Custom(points) => Shape::custom(Arc::new(Corners(points.clone()))),
            Self::HalfSpace(normal, level) => Shape::half_space(*normal, *level),
            Self::Tapered([start, end], radii) => Shape::tapered_capsule(*start, *end, *radii),
            Self::Rounded(inner, radius) => inner.shape().rounded(*radius),
        };
        shape.expect("in range")
    }

    /// Reports whether queries between two such shapes are always decided.
    pub(crate) fn is_exact(&self) -> bool {
        matches!(self, Self::Points(_) | Self::Hull(_) | Self::Cuboid(_) | Self::HalfSpace(..))
    }

    /// Returns the maximum of n·x over the shape.
    pub(crate) fn height(&self, n: &[f64; 3]) -> f64 {
        let across = (n[0] * n[0] + n[1] * n[1]).sqrt();
        let greatest = |points: &[[f64; 3]]| points.iter().map(|p| dot(n, p)).fold(f64::NEG_INFINITY, f64::max);
        match self {
            Self::Points(points) | Self::Hull(points) | Self::Custom(points) => greatest(points),
            Self::Capsule(ends, radius) => greatest(ends) + radius * dot(n, n).sqrt(),
            Self::Cuboid(half) => (0..3).map(|k| half[k] * n[k].abs()).sum(),
            Self::Cylinder(half_height, radius) => half_height * n[2].abs() + radius * across,
            Self::Cone(half_height, radius) => (half_height * n[2]).max(radius * across - half_height * n[2]),
            Self::Ellipsoid(half_axes) => (0..3).map(|k| (half_axes[k] * n[k]).powi(2)).sum::<f64>().sqrt(),
            Self::HalfSpace(..) => f64::INFINITY,
            Self::Tapered(ends, radii) => {
                let height = |end: usize| dot(n, &ends[end]) + radii[end] * dot(n, n).sqrt();
                height(0).max(height(1))
            }
            Self::Rounded(inner, radius) => inner.height(n) + radius * dot(n, n).sqrt(),
        }
    }
}

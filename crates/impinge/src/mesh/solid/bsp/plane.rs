//! Planes that cut space, across an axis or of a face: where points are to them, and where rays pass those across an axis.

use crate::exact::{WidePlane, orient3d};
use crate::math::Sign;
use crate::mesh::Mesh;

#[derive(Clone, Copy, Debug)]
pub(super) enum CutPlane {
    /// Points whose coordinate along an axis is this number.
    Across { axis: usize, at: f64 },
    /// The plane of a face, above it being where its corners turn left.
    OfFace(u32),
}

/// How a ray passes a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// Whether it comes from below.
    pub(super) ascends: bool,
    /// Between which parameters it is on the plane: none where it never is, all where that is not certain.
    pub(super) between: [f64; 2],
}

/// Where nothing is certain.
const ANYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Where it never is, as it stays where it starts.
const NEVER: [f64; 2] = [f64::INFINITY, f64::INFINITY];

impl CutPlane {
    /// On which side a point is, exactly. `planes` are those of the faces.
    pub(super) fn side(&self, mesh: &Mesh, planes: &[WidePlane], point: &[f64; 3]) -> Sign {
        match *self {
            Self::Across { axis, at } if point[axis] < at => Sign::Negative,
            Self::Across { axis, at } if point[axis] > at => Sign::Positive,
            Self::Across { .. } => Sign::Zero,
            Self::OfFace(face) => planes[face as usize].side(point).unwrap_or_else(|| {
                let [p, q, r] = mesh.corners(face);
                // Most points that a plane leaves open are corners that faces share.
                if [p, q, r].contains(point) { Sign::Zero } else { orient3d(&p, &q, &r, point) }
            }),
        }
    }
}

/// How a ray with this coordinate of its origin and its direction passes the plane across the axis at another.
///
/// The difference and the quotient are rounded once each, and what vanishes is below the least normal number.
pub(super) fn across(at: f64, origin: f64, direction: f64) -> Passage {
    if direction == 0.0 {
        return Passage { ascends: origin < at, between: if origin == at { ANYWHERE } else { NEVER } };
    }
    let t = (at - origin) / direction;
    let doubt = 4.0 * f64::EPSILON * t.abs() + f64::MIN_POSITIVE;
    Passage { ascends: direction > 0.0, between: if t.is_finite() { [t - doubt, t + doubt] } else { ANYWHERE } }
}

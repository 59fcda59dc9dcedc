//! Planes that cut space, axis-aligned or of a face: the sides of points, exactly, and the
//! parameters at which rays pass axis-aligned planes.

use crate::exact::{WidePlane, orient3d};
use crate::math::Sign;
use crate::mesh::Mesh;

/// A plane that cuts space, in the mesh's own frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum CutPlane {
    /// The axis-aligned plane of the points whose coordinate along `axis` is `at`.
    Across { axis: usize, at: f64 },
    /// The plane of a face. The side from which its corners are counterclockwise is above.
    OfFace(u32),
}

/// How a ray passes a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// Whether the ray comes from below.
    pub(super) ascends: bool,
    /// Interval of the parameters at which the ray may be on the plane.
    pub(super) between: [f64; 2],
}

/// Interval if nothing is certain.
const ANYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Interval of a ray parallel to the plane: it stays on the side on which it starts.
const NEVER: [f64; 2] = [f64::INFINITY, f64::INFINITY];

impl CutPlane {
    /// Returns the side of the plane on which a point is, exactly. `planes` has the planes of all
    /// faces.
    pub(super) fn side(&self, mesh: &Mesh, planes: &[WidePlane], point: &[f64; 3]) -> Sign {
        match *self {
            Self::Across { axis, at } if point[axis] < at => Sign::Negative,
            Self::Across { axis, at } if point[axis] > at => Sign::Positive,
            Self::Across { .. } => Sign::Zero,
            Self::OfFace(face) => planes[face as usize].side(point).unwrap_or_else(|| {
                let [p, q, r] = mesh.corners(face);
                orient3d(&p, &q, &r, point)
            }),
        }
    }
}

/// Returns how a ray passes the axis-aligned plane at coordinate `at`, given the ray's origin and
/// direction along that axis.
///
/// The difference and the quotient are rounded once each. A result that vanishes is below the least
/// normal number.
pub(super) fn across(at: f64, origin: f64, direction: f64) -> Passage {
    if direction == 0.0 {
        return Passage { ascends: origin < at, between: if origin == at { ANYWHERE } else { NEVER } };
    }
    let t = (at - origin) / direction;
    let doubt = 4.0 * f64::EPSILON * t.abs() + f64::MIN_POSITIVE;
    Passage { ascends: direction > 0.0, between: if t.is_finite() { [t - doubt, t + doubt] } else { ANYWHERE } }
}

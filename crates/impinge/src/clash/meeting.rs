//! Where two solids meet: the nearest face of each, and the direction in which they part.
//!
//! Guarded by `tests/it/clash/reports.rs`.

use crate::math::vec3::{scale, sub, unit};
use crate::query::{Placed, Witness, nearest_face};

/// Faces and direction at the point where two solids meet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Meeting {
    pub(super) faces: Option<[u32; 2]>,
    pub(super) normal: Option<[f64; 3]>,
}

impl Meeting {
    /// Returns how two meshes meet at a point that is in both. The way from the point to the nearer
    /// part of the surface that it is deep in leads out.
    pub(super) fn at(point: &[f64; 3], a: &Placed<'_>, b: &Placed<'_>) -> Self {
        let nearest = [a, b].map(|placed| nearest_face(&placed.mesh()?, point));
        let [Some(in_a), Some(in_b)] = nearest else { return Self::default() };
        // Moving the second solid out of the first, or the first out of the second.
        let way_out = if in_a.distance >= in_b.distance {
            unit(&sub(&in_a.foot, point))
        } else {
            unit(&sub(&in_b.foot, point)).map(|way| scale(&way, -1.0))
        };
        Self { faces: Some([in_a.face, in_b.face]), normal: way_out.map(without_negative_zero) }
    }

    /// Returns how two things face each other across their distance.
    pub(super) fn across(witness: &Witness) -> Self {
        let across = unit(&sub(&witness.point_b, &witness.point_a));
        Self { faces: witness.faces, normal: across.map(without_negative_zero) }
    }
}

/// Returns a vector whose zeros are positive, as people read them.
fn without_negative_zero(vector: [f64; 3]) -> [f64; 3] {
    vector.map(|x| x + 0.0)
}

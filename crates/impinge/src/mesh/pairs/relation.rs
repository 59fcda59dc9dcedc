//! The map from one mesh's packed frame to the other's, by which the descent and the filter carry
//! boxes and corners, with bounds of its error (docs/notes/proof.md, L3).

use super::sides::Sides;
use crate::hierarchy::{BoxMap, EdgeCrossAxes, HALF_ULP, SlabMap};
use crate::math::RelativeMap;
use crate::mesh::storage::frame::{PACKING_ERROR, PackedFrame, REACH};
use crate::mesh::{HostChoice, PlacedMesh};
use crate::simd::by_axis;

/// Minimum corner error that the filter assumes, in the unit of the packed frame. The head of
/// `filter/classify.rs` gives the reason.
const MIN_ERROR: f64 = 1.0 / (1_u64 << 40) as f64;

/// Maximum stretch or translation of a map for which boxes are compared. Beyond it every box
/// overlaps, so no overflow goes unnoticed.
const LARGEST_FOR_BOXES: f64 = (1_u128 << 100) as f64;

/// Maximum stretch or translation of a map for which the filter classifies triangles. Beyond it all
/// pairs are left to the exact decision. Determinants are cubic in the size of triangles, and the
/// cube of four times this leaves room in single precision for their sums.
const LARGEST_FOR_TRIANGLES: f64 = (1_u64 << 36) as f64;

/// The maps between the packed frames of two meshes, in both directions.
pub(crate) struct Relations {
    /// Maps the packed frame of the guest to that of the host.
    pub(crate) relation: Relation,
    /// Maps the packed frame of the host to that of the guest.
    pub(crate) back: Relation,
    /// Which mesh is the host.
    pub(crate) sides: Sides,
}

impl Relations {
    /// Computes both maps, and chooses the host by `choice`.
    pub(crate) fn new(a: PlacedMesh<'_>, b: PlacedMesh<'_>, a_from_b: &RelativeMap, choice: HostChoice) -> Self {
        let (frame_a, frame_b) = (&a.mesh.0.frame, &b.mesh.0.frame);
        let by_a = Relation::new(a_from_b, frame_a, frame_b);
        let by_b = Relation::new(&RelativeMap::a_from_b(&b.world_from_mesh, &a.world_from_mesh), frame_b, frame_a);
        let sides = match choice {
            HostChoice::First => Sides::FIRST_HOSTS,
            HostChoice::Second => Sides::SECOND_HOSTS,
            HostChoice::SmallerError => {
                // The error enlarges boxes of the guest. Dividing by the stretch converts it to
                // units of the guest.
                let blur = |relation: &Relation| f64::from(relation.boxes.slack()) / relation.stretch;
                let is_b_better = blur(&by_b) / frame_a.scale < blur(&by_a) / frame_b.scale;
                if is_b_better { Sides::SECOND_HOSTS } else { Sides::FIRST_HOSTS }
            }
        };
        let [relation, back] = sides.host_guest([by_a, by_b]);
        Self { relation, back, sides }
    }
}

/// The map from the guest's packed frame to the host's, in double precision, with bounds of its
/// error.
#[derive(Clone, Debug)]
pub(crate) struct Relation {
    pub(crate) linear: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
    /// Error bound of the image of a packed point on any axis, before it is rounded. It is infinite
    /// if nothing is known.
    pub(crate) error: f64,
    /// Maximum sum of magnitudes in a row, rounded up: an image of a vector is at most this times
    /// the vector's largest component.
    pub(crate) stretch: f64,
    /// Error bound of the corners of a guest packet in the host's frame.
    pub(crate) corner_error: CornerError,
    /// Carries boxes from the packed frame of the guest to that of the host.
    pub(crate) boxes: BoxMap,
    /// Carries slabs of the host to the packed frame of the guest.
    pub(crate) slabs: SlabMap,
}

impl Relation {
    /// Computes the map between two packed frames.
    ///
    /// # Accuracy
    /// The relative map has error bounds of its own. The two changes of frame add five roundings of
    /// terms of at most |linear|·|guest origin| + |translation| + |host origin| on an axis. Scales
    /// are powers of two and round nothing.
    pub(crate) fn new(host_from_guest: &RelativeMap, host: &PackedFrame, guest: &PackedFrame) -> Self {
        /// Bound for the roundings of the changes of frame, relative to their terms: eight for the
        /// five that occur.
        const ROUNDING: f64 = 8.0 * (f64::EPSILON / 2.0);
        /// Covers the rounding of the bounds themselves.
        const OUTWARD: f64 = 1.0 + 1e-12;
        let local = host_from_guest;
        let ratio = host.scale / guest.scale;
        let linear = local.linear.map(|row| row.map(|x| x * ratio));
        let mut translation = [0.0; 3];
        let mut error = [0.0; 3];
        for axis in 0..3 {
            let (row, row_error) = (&local.linear[axis], &local.linear_error[axis]);
            let moved = (row[0] * guest.origin[0] + row[1] * guest.origin[1]) + row[2] * guest.origin[2];
            translation[axis] = ((moved + local.translation[axis]) - host.origin[axis]) * host.scale;
            let mut terms = local.translation[axis].abs() + host.origin[axis].abs();
            let mut carried = local.translation_error[axis];
            let mut per_unit = 0.0;
            for from in 0..3 {
                terms += row[from].abs() * guest.origin[from].abs();
                carried += row_error[from] * guest.origin[from].abs();
                per_unit += row_error[from];
            }
            let total = ((ROUNDING * terms + carried) * host.scale + per_unit * ratio * REACH) * OUTWARD;
            // Nothing is known about an entry that overflowed; infinity times zero is NaN.
            error[axis] = if total.is_nan() { f64::INFINITY } else { total };
        }
        let stretch = linear.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max) * OUTWARD;
        let largest = translation.iter().fold(stretch, |largest, x| largest.max(x.abs()));
        if largest >= LARGEST_FOR_BOXES {
            error = [f64::INFINITY; 3];
        }
        let boxes = BoxMap::new(&linear, &translation, &error, REACH);
        let slabs = SlabMap::new(&linear, &translation, &error, REACH);
        let error = error.into_iter().fold(0.0, f64::max);
        let of_corners = if largest < LARGEST_FOR_TRIANGLES { error } else { f64::INFINITY };
        let corner_error = CornerError::new(&translation, of_corners, stretch);
        Self { linear, translation, error, stretch, corner_error, boxes, slabs }
    }

    /// Returns the test along edge-cross axes, which proves long boxes apart that pass each other.
    pub(crate) fn edge_cross(&self) -> EdgeCrossAxes {
        EdgeCrossAxes::new(&self.linear, &self.translation, self.error, REACH)
    }

    /// Returns the normal in the guest's frame of planes whose normal in the host's frame is
    /// `normal`. It is rounded, which is harmless, as a slab may have any direction.
    #[inline(always)]
    pub(crate) fn turn_back(&self, normal: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = normal;
        let [along_x, along_y, along_z] = &self.linear;
        by_axis!(axis => (f64::from(x) * along_x[axis] + f64::from(y) * along_y[axis] + f64::from(z) * along_z[axis]) as f32)
    }

    /// Returns the image of a packed point, rounded to nearest.
    #[inline(always)]
    pub(crate) fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        by_axis!(axis => {
            let row = &self.linear[axis];
            row[0] * x + row[1] * y + row[2] * z + self.translation[axis]
        })
    }
}

/// Factor by which an error bound is enlarged before it is added to a smaller number, to cover the
/// rounding of the sum.
pub(crate) const ERROR_GROWTH: f32 = 1.0 + 1e-5;

/// Error bound of the corners of a guest packet after they are mapped into the host's frame and
/// moved to the local origin of a host packet, in the host's unit. For a guest packet of radius r
/// it is `per_radius · r + constant`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerError {
    /// Error per unit of the guest packet's radius, from single precision. It covers the rounding
    /// of the packed corner, of the matrix, three of the sum, and two of the sum with an offset.
    /// The offset is below both radii, as packets are only compared if their bounds overlap.
    pub(crate) per_radius: f32,
    /// Constant part of the error, from double precision: of the map, of packing, and of the image
    /// of the local origin with its five roundings.
    pub(crate) constant: f32,
    /// Additional error of the bounds of a packet, beyond [`ERROR_GROWTH`] times the error of its
    /// corners: of the local origin and two sums in single precision.
    pub(crate) of_bounds: f32,
}

impl CornerError {
    /// Computes the bounds for a map with this translation, error and stretch.
    fn new(translation: &[f64; 3], map_error: f64, stretch: f64) -> Self {
        let reach = stretch * REACH + translation.iter().fold(0.0, |most, x| x.abs().max(most));
        let constant = map_error + PACKING_ERROR * (1.0 + 2.0 * stretch + 2.0 * reach) + MIN_ERROR;
        let up = |x: f64| (x as f32).next_up();
        Self {
            per_radius: up(9.0 * HALF_ULP * stretch),
            constant: up(constant),
            of_bounds: up(4.0 * HALF_ULP * (reach + stretch)),
        }
    }
}

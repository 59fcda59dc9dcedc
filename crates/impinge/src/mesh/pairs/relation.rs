//! How one mesh's packed frame lies in the other's: the map that the descent and the filter carry boxes and corners by.

use super::sides::Sides;
use crate::hierarchy::{Askew, BoxMap, HALF_ULP, SlabMap};
use crate::math::RelativeMap;
use crate::mesh::storage::frame::{PACKING_ERROR, PackedFrame, REACH};
use crate::mesh::{HostChoice, PlacedMesh};
use crate::simd::by_axis;

/// Least error that the filter assumes; the head of its file says why.
const MIN_ERROR: f64 = 1.0 / (1_u64 << 40) as f64;

/// Boxes carried by maps that stretch or move by more than this are not compared: nothing may overflow unnoticed.
const LARGEST_FOR_BOXES: f64 = (1_u128 << 100) as f64;

/// Triangles carried by maps that stretch or move by more than this are left to the exact stage: determinants are cubic
/// in their size, and the cube of four times this is a single precision number with room for their sums.
const LARGEST_FOR_TRIANGLES: f64 = (1_u64 << 36) as f64;

/// How two meshes lie to each other.
pub(crate) struct Relations {
    /// Of the guest to the host.
    pub(crate) relation: Relation,
    /// Of the host to the guest.
    pub(crate) back: Relation,
    /// Which mesh is the host.
    pub(crate) sides: Sides,
}

impl Relations {
    /// The relations by the frame that the choice names.
    pub(crate) fn new(a: PlacedMesh<'_>, b: PlacedMesh<'_>, a_from_b: &RelativeMap, choice: HostChoice) -> Self {
        let (frame_a, frame_b) = (&a.mesh.0.frame, &b.mesh.0.frame);
        let by_a = Relation::new(a_from_b, frame_a, frame_b);
        let by_b = Relation::new(&RelativeMap::a_from_b(&b.world_from_mesh, &a.world_from_mesh), frame_b, frame_a);
        let sides = match choice {
            HostChoice::First => Sides::FIRST_HOSTS,
            HostChoice::Second => Sides::SECOND_HOSTS,
            HostChoice::SmallerError => {
                // The error in units of the guest, whose boxes it blurs: a stretch of one unit of the guest is one unit.
                let blur = |relation: &Relation| f64::from(relation.boxes.slack()) / relation.stretch;
                let is_b_better = blur(&by_b) / frame_a.scale < blur(&by_a) / frame_b.scale;
                if is_b_better { Sides::SECOND_HOSTS } else { Sides::FIRST_HOSTS }
            }
        };
        let [relation, back] = sides.host_guest([by_a, by_b]);
        Self { relation, back, sides }
    }
}

/// The map from the guest's packed frame into the host's, in double precision, and how far it may be off.
#[derive(Clone, Debug)]
pub(crate) struct Relation {
    pub(crate) linear: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
    /// How far the image of a packed point may be off on an axis, before it is rounded; infinite where nothing is known.
    pub(crate) error: f64,
    /// The greatest sum of magnitudes in a row: no image of a vector is larger than this times the vector.
    pub(crate) stretch: f64,
    /// What the corners of a guest packet of radius r may be off by: `per_radius · r + constant`.
    pub(crate) corner_error: CornerError,
    pub(crate) boxes: BoxMap,
    pub(crate) slabs: SlabMap,
}

impl Relation {
    /// # Accuracy
    /// The relative map brings its own bound. The two changes of frame add five roundings of terms of at most
    /// |linear|·|guest origin| + |translation| + |host origin| on an axis; scales are powers of two and round nothing.
    pub(crate) fn new(host_from_guest: &RelativeMap, host: &PackedFrame, guest: &PackedFrame) -> Self {
        const ROUNDING: f64 = 8.0 * (f64::EPSILON / 2.0);
        /// Makes up for the evaluation of the bounds themselves.
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
            // Of an entry that is beyond range nothing is known, and infinity times zero is not a number.
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

    /// What tells long boxes apart that pass each other.
    pub(crate) fn askew(&self) -> Askew {
        Askew::new(&self.linear, &self.translation, self.error, REACH)
    }

    /// A direction of the host's frame in the guest's, such that what lies between two planes across the one lies
    /// between two planes across the other; nearly so, which is enough for a direction.
    #[inline(always)]
    pub(crate) fn turn_back(&self, normal: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = normal;
        let [along_x, along_y, along_z] = &self.linear;
        by_axis!(axis => (f64::from(x) * along_x[axis] + f64::from(y) * along_y[axis] + f64::from(z) * along_z[axis]) as f32)
    }

    /// The image of a packed point, to nearest.
    #[inline(always)]
    pub(crate) fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        by_axis!(axis => {
            let row = &self.linear[axis];
            row[0] * x + row[1] * y + row[2] * z + self.translation[axis]
        })
    }
}

/// Pays for the rounding of sums with an error that is larger than what it is added to.
pub(crate) const ERROR_GROWTH: f32 = 1.0 + 1e-5;

/// How far off the corners of a packet may be once they are turned into the host's frame and moved to a host's anchor,
/// in the host's unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerError {
    /// The part that grows with the guest packet's radius. Of single precision: the packed corner's rounding, the
    /// matrix's, three of the sum, and two of the sum with an offset; a host packet is only met where the bounds
    /// overlap, which keeps the offset below both radii.
    pub(crate) per_radius: f32,
    /// Of double precision: the map's, packing's, and those of the anchor's image with its five roundings.
    pub(crate) constant: f32,
    /// What bounds of the packet need beyond [`ERROR_GROWTH`] times this: the anchor and two sums in single precision.
    pub(crate) of_bounds: f32,
}

impl CornerError {
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

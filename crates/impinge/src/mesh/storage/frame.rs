//! The packed frame, in which the boxes and packets of a mesh are stored. In it the mesh is near
//! the origin and about one unit large, whatever its own unit and position. So single precision is
//! equally accurate for meshes of every size.
//!
//! Guarded by the tests below and, for the whole engine, by the tests in `engine/laws.rs`.

use std::ops::{Add, Mul};

use crate::hierarchy::{HALF_ULP, WideTree};
use crate::math::vec3::Vector;
use crate::simd::{by_axis, prefetch_at};

/// The map `packed = (local − origin) · scale` from the mesh frame. The scale is a power of two, so
/// multiplying by it rounds nothing.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub(crate) struct PackedFrame {
    pub(crate) origin: [f64; 3],
    pub(crate) scale: f64,
}

/// Maximum magnitude of a packed coordinate: one, and a margin for rounding.
pub(crate) const REACH: f64 = 1.0 + 1e-6;

/// Error bound of a packed coordinate in double precision. It covers two roundings of numbers of at
/// most [`REACH`], the relative error of a subtraction, and, for differences below the range of
/// doubles, the smallest subnormal number.
pub(crate) const PACKING_ERROR: f64 = 1.0 / (1_u64 << 51) as f64;

/// Minimum magnitude of a bound of a box. It is far below [`PACKING_ERROR`], so boxes hardly grow.
/// It is large enough that its products with the entries of a pose's map are not subnormal: those
/// take 70 times as long on a Xeon, and all bounds of a flat mesh along its normal would give such
/// products.
const MIN_BOUND: f32 = 1.0 / (1_u64 << 60) as f32;

/// Returns a float above every packed coordinate that was rounded to `rounded`: the next float up,
/// or [`MIN_BOUND`] if `rounded` is smaller than that in magnitude.
#[inline(always)]
pub(in crate::mesh) fn outward(rounded: f32) -> f32 {
    // The bits of a negative float decrease when the float increases.
    let bits = rounded.to_bits().cast_signed();
    let next = f32::from_bits(bits.wrapping_add(bits >> 31 | 1).cast_unsigned());
    if rounded.abs() < MIN_BOUND { MIN_BOUND } else { next }
}

impl PackedFrame {
    /// Returns the frame in which all vertices between these extremes are at most [`REACH`] in
    /// magnitude. Without vertices it is the identity.
    pub(in crate::mesh) fn over(extremes: &Extremes) -> Self {
        let Extremes { min, max } = extremes;
        if *extremes == Extremes::NONE {
            return Self { origin: [0.0; 3], scale: 1.0 };
        }
        let origin: [f64; 3] = std::array::from_fn(|axis| min[axis] + (max[axis] - min[axis]) / 2.0);
        let extent = (0..3).map(|axis| (max[axis] - origin[axis]).max(origin[axis] - min[axis])).fold(0.0, f64::max);
        Self { origin, scale: reciprocal_power_of_two(extent) }
    }

    /// Maps a point of the mesh frame to the packed frame, with an error of at most
    /// [`PACKING_ERROR`] for vertices.
    #[inline(always)]
    pub(crate) fn pack(&self, vertex: [f64; 3]) -> [f64; 3] {
        by_axis!(axis => (vertex[axis] - self.origin[axis]) * self.scale)
    }

    /// Maps a packed point to the mesh frame, rounded to nearest.
    #[inline(always)]
    pub(super) fn unpack(&self, packed: [f64; 3]) -> [f64; 3] {
        by_axis!(axis => packed[axis] / self.scale + self.origin[axis])
    }

    /// Returns the maximum distance of the mesh from `origin` on each axis, in the mesh frame and
    /// its unit. It is rounded up, and zero for an empty tree.
    pub(in crate::mesh) fn half_extents(&self, tree: &WideTree) -> Vector {
        let Some(root) = tree.nodes().first() else { return [0.0; 3] };
        [0, 1, 2].map(|k| {
            let largest = (0..root.count())
                .fold(0.0_f32, |most, lane| most.max(root.min[k][lane].abs()).max(root.max[k][lane].abs()));
            (f64::from(largest) * (1.0 + HALF_ULP) + PACKING_ERROR) / self.scale
        })
    }
}

/// The minimum and maximum coordinates of some vertices, in the mesh frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::mesh) struct Extremes {
    min: [f64; 3],
    max: [f64; 3],
}

impl Extremes {
    /// The extremes of no vertices.
    pub(in crate::mesh) const NONE: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// Returns the extremes of vertices. They are NaN if a coordinate is NaN or infinite.
    pub(in crate::mesh) fn of<T>(vertices: &[[T; 3]]) -> Self
    where
        T: Copy + PartialOrd + From<f32> + Into<f64> + Add<Output = T> + Mul<Output = T>,
    {
        /// Number of coordinates per step: those of four vertices, so that the compiler vectorizes
        /// the step.
        const COORDINATES_PER_STEP: usize = 12;
        /// Prefetch distance in bytes. The processor prefetches later by itself, and not across its
        /// pages.
        const PREFETCH_BYTES: usize = 2048;
        let mut min = [T::from(f32::INFINITY); COORDINATES_PER_STEP];
        let mut max = [T::from(f32::NEG_INFINITY); COORDINATES_PER_STEP];
        // NaN in a lane if one of its coordinates is not finite, else zero.
        let mut zero = [T::from(0.0); COORDINATES_PER_STEP];
        let mut take = |lane: usize, x: T| {
            min[lane] = if x < min[lane] { x } else { min[lane] };
            max[lane] = if x > max[lane] { x } else { max[lane] };
            zero[lane] = zero[lane] + x * T::from(0.0);
        };
        let (together, rest) = vertices.as_flattened().as_chunks::<COORDINATES_PER_STEP>();
        for (at, coordinates) in together.iter().enumerate() {
            prefetch_at(together, at + PREFETCH_BYTES / size_of_val(coordinates));
            (0..COORDINATES_PER_STEP).for_each(|lane| take(lane, coordinates[lane]));
        }
        rest.iter().enumerate().for_each(|(lane, &x)| take(lane, x));
        let zero: f64 = zero.into_iter().fold(T::from(0.0), Add::add).into();
        let Self { min, max } = (0..COORDINATES_PER_STEP / 3).fold(Self::NONE, |all, vertex| {
            let of_vertex = |bound: &[T; COORDINATES_PER_STEP]| by_axis!(axis => bound[3 * vertex + axis].into());
            all.union(Self { min: of_vertex(&min), max: of_vertex(&max) })
        });
        Self { min: min.map(|x| x + zero), max: max.map(|x| x + zero) }
    }

    /// Reports whether all coordinates are below `limit` in magnitude; `false` if an extreme is
    /// NaN.
    pub(in crate::mesh) fn are_below(&self, limit: f64) -> bool {
        self.min.iter().all(|&x| x > -limit) && self.max.iter().all(|&x| x < limit)
    }

    /// Returns the extremes of both sets of vertices.
    pub(in crate::mesh) fn union(self, Self { min, max }: Self) -> Self {
        let lesser = |a: f64, b: f64| if a < b { a } else { b };
        let greater = |a: f64, b: f64| if a > b { a } else { b };
        Self {
            min: by_axis!(axis => lesser(min[axis], self.min[axis])),
            max: by_axis!(axis => greater(max[axis], self.max[axis])),
        }
    }
}

/// Returns the power of two that scales `extent` into (1/2, 1], and 1 for zero. Its exponent is
/// limited to ±900, so that products with it stay in the range of double precision.
pub(in crate::mesh) fn reciprocal_power_of_two(extent: f64) -> f64 {
    const EXPONENT_LIMIT: i32 = 900;
    if extent == 0.0 {
        return 1.0;
    }
    let bits = extent.to_bits();
    let biased = (bits >> 52) as i32;
    let is_power_of_two = bits << 12 == 0;
    let exponent = biased - 1023 + i32::from(!is_power_of_two);
    f64::from_bits(((1023 - exponent.clamp(-EXPONENT_LIMIT, EXPONENT_LIMIT)) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;

    #[test]
    fn packed_positions_stay_within_reach() {
        for (offset, size) in [(0.0, 1.0), (1e7, 1e-3), (-1e30, 1e30), (0.0, 1e-310), (3.0, 0.0), (1e38, 2e38)] {
            let corners = [[offset; 3], [offset + size; 3], [offset, offset - size, offset]];
            let frame = PackedFrame::over(&Extremes::of(&corners));
            for corner in corners {
                for packed in frame.pack(corner) {
                    assert!(packed.abs() <= REACH, "{corner:?} packs to {packed}");
                }
            }
        }
        assert_eq!(reciprocal_power_of_two(1.0), 1.0);
        assert_eq!(reciprocal_power_of_two(1.5), 0.5);
        assert_eq!(reciprocal_power_of_two(0.5), 2.0);
    }

    #[test]
    fn outward_is_beyond_and_never_next_to_zero() {
        let mut near_zero = 0;
        for x in (-120..1).flat_map(|power| [1.0, 1.1, 1.9].map(|x| x * 2.0_f32.powi(power))) {
            for x in [x, -x, 0.0, -0.0, x.next_down(), -x.next_down(), f32::from_bits(1), -f32::from_bits(1)] {
                let beyond = outward(x);
                // A number that was rounded to `x` is at most half way to the next float.
                assert!(beyond >= x.next_up() && beyond.abs() > 2.0_f32.powi(-61), "{x} to {beyond}");
                near_zero += usize::from(beyond > x.next_up());
                assert!(beyond == x.next_up() || x.abs() < MIN_BOUND && beyond == MIN_BOUND, "{x} to {beyond}");
            }
        }
        assert!(near_zero > 1_000, "{near_zero} were near zero");
    }

    /// Vertex counts with and without a remainder after whole steps, and every vertex at and beyond
    /// a limit.
    #[test]
    fn extremes_are_those_of_each_vertex() {
        let mut rng = Rng::new(154);
        for count in 1..30 {
            let vertices: Vec<[f32; 3]> = (0..count).map(|_| [0; 3].map(|_| rng.uniform(-9.0, 9.0) as f32)).collect();
            let of_all = vertices.iter().map(|vertex| vertex.map(f64::from));
            let plain = of_all.fold(Extremes::NONE, |all, vertex| all.union(Extremes { min: vertex, max: vertex }));
            let wide: Vec<[f64; 3]> = vertices.iter().map(|vertex| vertex.map(f64::from)).collect();
            assert_eq!((Extremes::of(&vertices), Extremes::of(&wide)), (plain, plain));
            assert!(plain.are_below(9.0));
            for (at, axis) in (0..count).flat_map(|at| [(at, 0), (at, 1), (at, 2)]) {
                let with = |x: f64| {
                    let mut changed = wide.clone();
                    changed[at][axis] = x;
                    Extremes::of(&changed)
                };
                for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 9.0, -9.0] {
                    assert!(!with(x).are_below(9.0), "{x} at {at}");
                }
                assert!(with(9.0_f64.next_down()).are_below(9.0) && with(f64::MIN_POSITIVE).are_below(9.0));
                let mut changed = vertices.clone();
                for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                    changed[at][axis] = x;
                    assert!(!Extremes::of(&changed).are_below(f64::MAX), "{x} at {at}");
                }
            }
        }
    }
}

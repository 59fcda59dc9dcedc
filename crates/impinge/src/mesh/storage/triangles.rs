//! The packed triangles of a leaf: single precision corners relative to a local origin, in SoA
//! layout, and a slab that bounds them. The filter uses them to prove pairs of triangles apart or
//! intersecting in bulk. Undecided pairs are decided exactly from the stored vertices.
//!
//! Guarded by `triangles_are_where_their_corners_are` below and by the benchmark `headline`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::frame::PACKING_ERROR;
use super::leaf::Leaf;
use super::stored_corners::{Points, StoredCorners};
use crate::hierarchy::HALF_ULP;
use crate::simd::{LANES, Lanes3, across, by_axis, load3, store3, sub};

/// Coordinates of the corners of eight triangles, `[corner][axis][lane]`.
pub(crate) type CornerLanes = [[[f32; LANES]; 3]; 3];

/// Up to eight triangles; unused lanes repeat the first one.
///
/// In the packed frame, a corner is the local origin plus its entry of `corners`. The error is at
/// most `HALF_ULP · radius` for the rounding to single precision, plus [`PACKING_ERROR`] for the
/// arithmetic before that (docs/notes/proof.md, L4).
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(64))]
pub(crate) struct Triangles {
    /// Local origin: a point in the middle of the triangles, in the frame that [`StoredCorners`]
    /// chooses.
    pub(in crate::mesh) local_origin: [f32; 3],
    /// Maximum magnitude of the coordinates in `corners`, rounded up; in the unit of the packed
    /// frame.
    pub(crate) radius: f32,
    /// Minimum and maximum height of the corners above the local origin along
    /// [`normal`](Self::normal). Rounded outward, without the errors of the corners themselves.
    pub(crate) heights: [f32; 2],
    /// Direction of the slab, in units of [`NORMAL_STEP`].
    normal: [i16; 3],
    /// Number of lanes in use.
    count: u16,
    /// Corners relative to the local origin, in the unit of the packed frame.
    pub(crate) corners: CornerLanes,
}

/// Unit of the components of a normal. It is a power of two, so they convert to `f32` without
/// rounding.
const NORMAL_STEP: f32 = 1.0 / (1 << 14) as f32;

impl Triangles {
    /// Returns the lanes that hold a triangle, as bits.
    #[inline(always)]
    pub(crate) fn lanes_in_use(&self) -> u32 {
        (1 << usize::from(self.count).min(LANES)) - 1
    }

    /// Returns the direction of the slab that bounds the corners, which is near the average
    /// direction in which the triangles face. No component is larger than 1 in magnitude, and none
    /// is rounded. It is zero if the triangles have no area.
    #[inline(always)]
    pub(crate) fn normal(&self) -> [f32; 3] {
        by_axis!(axis => f32::from(self.normal[axis]) * NORMAL_STEP)
    }

    /// Returns the normal and the minimum and maximum height of all triangles along it, relative to
    /// the local origin in the packed frame. The heights include all errors of the corners.
    #[inline(always)]
    pub(crate) fn slab(&self) -> ([f64; 3], [f64; 2]) {
        let [low, high] = self.heights.map(f64::from);
        let error = 3.0 * (HALF_ULP * f64::from(self.radius) + PACKING_ERROR);
        (self.normal().map(f64::from), [low - error, high + error])
    }
}

/// Packs the triangles of up to eight leaves; the packets after the last leaf are zero. Each step
/// is done for all leaves before the next step starts. Within one leaf every step waits for the
/// previous one, and one vector holds a number of all eight leaves.
///
/// No operation is fused, so the bits are the same on every vector unit.
#[inline(always)]
pub(in crate::mesh) fn of_leaves<S: Simd>(
    simd: S,
    leaves: &[Leaf],
    stored: &impl StoredCorners,
) -> Box<[Triangles; LANES]> {
    leaves.iter().flat_map(|leaf| leaf.faces).for_each(|face| stored.faces().prefetch(face));
    let mut rows = [[[0; 4]; LANES]; LANES];
    for (rows, leaf) in rows.iter_mut().zip(leaves) {
        stored.faces().look_up(simd, leaf, rows);
        rows.as_flattened().iter().for_each(|&vertex| stored.prefetch_vertex(vertex));
    }
    let mut gathered = [stored.gather(simd, &rows[0]); LANES];
    for lane in 1..leaves.len().min(LANES) {
        gathered[lane] = stored.gather(simd, &rows[lane]);
    }
    let mut extremes = [stored.extremes_of(&gathered[0]); LANES];
    for lane in 1..leaves.len().min(LANES) {
        extremes[lane] = stored.extremes_of(&gathered[lane]);
    }
    let extremes = stored.extremes(&extremes);
    let local_origins = stored.local_origins(&extremes, &stored.bounds(&extremes));
    let mut origins = [[0.0; LANES]; 3];
    let mut areas = [[f32x8::splat(simd, 0.0); LANES]; 3];
    let mut made: Box<[Triangles; LANES]> = bytemuck::zeroed_box();
    for (lane, leaf) in leaves.iter().enumerate() {
        let triangles = &mut made[lane];
        triangles.local_origin = by_axis!(axis => local_origins[axis][lane]);
        triangles.count = leaf.count() as u16;
        let origin = stored.origin_in_mesh_frame(triangles.local_origin);
        let corners = stored.about(simd, &gathered[lane], origin);
        store_corners(&corners, &mut triangles.corners);
        let vectors = doubled_area_vectors(&corners);
        for axis in 0..3 {
            origins[axis][lane] = origin[axis];
            areas[axis][lane] = vectors[axis];
        }
    }
    let radii = radii(&extremes, &origins, stored.frame().scale);
    let areas: Lanes3<S> = by_axis!(axis => across(
        &areas[axis],
        #[inline(always)]
        |a, b| a + b,
    ));
    let normals = normals(&areas);
    for (lane, triangles) in made.iter_mut().take(leaves.len()).enumerate() {
        triangles.radius = radii[lane];
        triangles.normal = by_axis!(axis => normals[axis][lane] as i16);
        let corners = load_corners(simd, &triangles.corners);
        let [low, high] = heights(simd, &corners, triangles.normal());
        // A height is a sum of three products of at most the radius, with five roundings.
        let error = 20.0 * HALF_ULP as f32 * triangles.radius + f32::MIN_POSITIVE;
        triangles.heights = [low.reduce_min() - error, high.reduce_max() + error];
    }
    made
}

/// Returns the maximum distance of corners with these extremes from an origin on any axis, for each
/// leaf. It is in the unit of the packed frame, and rounded up. Differences of extremes are rounded
/// like those of corners, and then once more if corners are in single precision.
#[inline(always)]
fn radii([least, greatest]: &[Points<f64>; 2], origins: &Points<f64>, scale: f64) -> [f32; LANES] {
    let mut radii = [0.0; LANES];
    for lane in 0..LANES {
        let mut reach = 0.0_f64;
        for axis in 0..3 {
            let (below, above) = (origins[axis][lane] - least[axis][lane], greatest[axis][lane] - origins[axis][lane]);
            reach = reach.max(below).max(above);
        }
        radii[lane] = ((reach * scale) as f32).next_up();
    }
    radii
}

/// Returns the directions of vectors in units of [`NORMAL_STEP`], scaled so that the largest
/// component is about one. A vector that is zero or not finite gives zero.
#[inline(always)]
fn normals<S: Simd>(vectors: &Lanes3<S>) -> Points<i32> {
    let mut normals = [[0; LANES]; 3];
    for lane in 0..LANES {
        let [x, y, z] = by_axis!(axis => vectors[axis][lane].abs());
        let largest = x.max(y).max(z);
        let scale = 1.0 / (largest * NORMAL_STEP);
        let scale = if scale.is_finite() && largest.is_finite() { scale } else { 0.0 };
        for axis in 0..3 {
            normals[axis][lane] = (vectors[axis][lane] * scale) as i32;
        }
    }
    normals
}

/// Returns twice the area of each triangle as a vector in the direction in which it faces. No
/// operation is fused.
#[inline(always)]
pub(in crate::mesh) fn doubled_area_vectors<S: Simd>(corners: &[Lanes3<S>; 3]) -> Lanes3<S> {
    let (e, f) = (sub(&corners[1], &corners[0]), sub(&corners[2], &corners[0]));
    [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
}

/// Returns the minimum and maximum height of the corners of each triangle along a direction. No
/// operation is fused.
#[inline(always)]
pub(in crate::mesh) fn heights<S: Simd>(simd: S, corners: &[Lanes3<S>; 3], normal: [f32; 3]) -> [f32x8<S>; 2] {
    let normal: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, normal[axis]));
    let [p, q, r]: [f32x8<S>; 3] = by_axis!(corner => {
        let at = &corners[corner];
        normal[0] * at[0] + normal[1] * at[1] + normal[2] * at[2]
    });
    [p.min(q).min(r), p.max(q).max(r)]
}

#[inline(always)]
pub(in crate::mesh) fn load_corners<S: Simd>(simd: S, lanes: &CornerLanes) -> [Lanes3<S>; 3] {
    by_axis!(corner => load3(simd, &lanes[corner]))
}

#[inline(always)]
pub(in crate::mesh) fn store_corners<S: Simd>(corners: &[Lanes3<S>; 3], lanes: &mut CornerLanes) {
    for corner in 0..3 {
        store3(&corners[corner], &mut lanes[corner]);
    }
}

#[cfg(test)]
pub(in crate::mesh) mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::mesh::Positions;
    use crate::mesh::storage::frame::{Extremes, PackedFrame};
    use crate::mesh::storage::positions::VertexSlice;
    use crate::mesh::storage::stored_corners::Corners;
    use crate::simd::dispatch;
    use crate::simd::levels;

    /// Returns the same positions in the three kinds of storage: double precision, single
    /// precision, and single precision at a scale that needs double precision arithmetic.
    pub(in crate::mesh) fn kinds(vertices: &[[f64; 3]]) -> [Positions; 3] {
        let single = |scale: f64| Positions::F32(vertices.iter().map(|v| v.map(|x| (scale * x) as f32)).collect());
        [Positions::F64(vertices.to_vec()), single(1.0), single(2.0_f64.powi(-110))]
    }

    fn frame_over(vertices: VertexSlice<'_>) -> PackedFrame {
        PackedFrame::over(&match vertices {
            VertexSlice::F32(vertices) => Extremes::of(vertices),
            VertexSlice::F64(vertices) => Extremes::of(vertices),
        })
    }

    /// Packs leaves of all sizes together. Corners, radius and slab are within their documented
    /// bounds, and equal at every vector level.
    #[test]
    fn triangles_are_where_their_corners_are() {
        let mut rng = Rng::new(151);
        let mut ways = [0; 3];
        for round in 0..300 {
            let beside = rng.integer(1, 8) as usize;
            let (center, size) = ([0; 3].map(|_| rng.uniform(-9.0, 9.0)), 2.0_f64.powi(-(round % 20)));
            let mut vertices: Vec<[f64; 3]> =
                (0..24 * 8).map(|_| std::array::from_fn(|axis| center[axis] + rng.uniform(-size, size))).collect();
            vertices.extend([[-10.0; 3], [10.0; 3]]);
            let faces: Vec<[u32; 3]> = (0..64).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let held: Vec<Vec<u32>> =
                (0..beside as u32).map(|leaf| (8 * leaf..).take(rng.integer(1, 8) as usize).collect()).collect();
            let leaves: Vec<Leaf> = held.iter().map(|held| Leaf::holding(held)).collect();
            for positions in kinds(&vertices) {
                let frame = frame_over(positions.slice());
                let corners = Corners::of(positions.slice(), &faces, frame);
                ways[match corners {
                    Corners::Single(_) => 0,
                    Corners::SingleWidened(_) => 1,
                    Corners::Double(_) => 2,
                }] += 1;
                let made: Vec<Box<[Triangles; LANES]>> = levels()
                    .into_iter()
                    .map(|(_, level)| {
                        dispatch!(level, simd => match &corners {
                            Corners::Single(stored) => of_leaves(simd, &leaves, stored),
                            Corners::SingleWidened(stored) => of_leaves(simd, &leaves, stored),
                            Corners::Double(stored) => of_leaves(simd, &leaves, stored),
                        })
                    })
                    .collect();
                for other in &made {
                    assert_eq!(
                        bytemuck::cast_slice::<_, u8>(&other[..]),
                        bytemuck::cast_slice::<_, u8>(&made[0][..]),
                        "other bits"
                    );
                }
                assert!(made[0][leaves.len()..].iter().all(|none| *none == bytemuck::Zeroable::zeroed()));
                for ((triangles, leaf), held) in made[0].iter().zip(&leaves).zip(&held) {
                    assert_eq!((leaf.held(), triangles.lanes_in_use()), (&held[..], (1 << held.len()) - 1));
                    let normal = triangles.normal();
                    assert!(
                        normal.iter().any(|x| x.abs() > 0.99) && normal.iter().all(|x| x.abs() <= 1.0),
                        "{normal:?}"
                    );
                    let local_origin = match &corners {
                        Corners::Single(stored) => frame.pack(stored.origin_in_mesh_frame(triangles.local_origin)),
                        Corners::SingleWidened(stored) => {
                            frame.pack(stored.origin_in_mesh_frame(triangles.local_origin))
                        }
                        Corners::Double(stored) => frame.pack(stored.origin_in_mesh_frame(triangles.local_origin)),
                    };
                    let ([x, y, z], [low, high]) = triangles.slab();
                    for lane in 0..LANES {
                        for corner in 0..3 {
                            let vertex = faces[leaf.faces[lane] as usize][corner];
                            let exact = frame.pack(positions.get(vertex as usize));
                            let about: [f64; 3] = std::array::from_fn(|axis| exact[axis] - local_origin[axis]);
                            for axis in 0..3 {
                                let relative = triangles.corners[corner][axis][lane];
                                assert!(relative.abs() <= triangles.radius);
                                let off = (f64::from(relative) - about[axis]).abs();
                                assert!(off <= HALF_ULP * f64::from(triangles.radius) + PACKING_ERROR, "off by {off}");
                            }
                            let height = x * about[0] + y * about[1] + z * about[2];
                            assert!(low <= height && height <= high, "{height} is not in {low}..{high}");
                        }
                    }
                    assert!(high - low < 8.0 * f64::from(triangles.radius), "a slab as thick as {}", high - low);
                }
            }
        }
        assert_eq!(ways, [300; 3], "each way of gathering");
    }
}

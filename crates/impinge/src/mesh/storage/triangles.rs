//! The triangles of one leaf side by side for the vector unit, in single precision about an anchor of their own, for rejecting
//! and confirming in bulk; and a slab about them. What they leave open is decided on the stored vertices.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::frame::PACKING_ERROR;
use super::leaf::Leaf;
use super::stored_corners::{Points, StoredCorners};
use crate::hierarchy::HALF_ULP;
use crate::simd::{LANES, Lanes3, across, by_axis, load3, store3, sub};

/// `[corner][axis][lane]`.
pub(crate) type CornerLanes = [[[f32; LANES]; 3]; 3];

/// Up to eight triangles; unused lanes repeat the first one.
///
/// A corner is `anchor + corners[..]` in the packed frame, up to `HALF_ULP · radius` for its rounding to single precision and
/// [`PACKING_ERROR`] for the arithmetic before that (docs/proof.md, L4).
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C, align(64))]
pub(crate) struct Triangles {
    /// A point amid the triangles, as [`StoredCorners`] keeps it.
    pub(in crate::mesh) anchor: [f32; 3],
    /// No coordinate of the corners about the anchor, in the packed frame, is larger in magnitude.
    pub(crate) radius: f32,
    /// The slab about the corners: their least and greatest height about the anchor along [`normal`](Self::normal).
    pub(crate) heights: [f32; 2],
    /// In units of [`NORMAL_STEP`].
    normal: [i16; 3],
    count: u16,
    /// Relative to the anchor.
    pub(crate) corners: CornerLanes,
}

/// The unit of a normal.
const NORMAL_STEP: f32 = 1.0 / (1 << 14) as f32;

impl Triangles {
    /// The bits of the lanes that hold a triangle.
    #[inline(always)]
    pub(crate) fn lanes_in_use(&self) -> u32 {
        (1 << usize::from(self.count).min(LANES)) - 1
    }

    /// The direction of the slab about the corners, mostly that in which the triangles face; no component is larger than
    /// one in magnitude, and none is rounded.
    #[inline(always)]
    pub(crate) fn normal(&self) -> [f32; 3] {
        by_axis!(axis => f32::from(self.normal[axis]) * NORMAL_STEP)
    }

    /// The normal, and the least and greatest height along it of all triangles, about the anchor, outward.
    #[inline(always)]
    pub(crate) fn slab(&self) -> ([f64; 3], [f64; 2]) {
        let [low, high] = self.heights.map(f64::from);
        let error = 3.0 * (HALF_ULP * f64::from(self.radius) + PACKING_ERROR);
        (self.normal().map(f64::from), [low - error, high + error])
    }
}

/// The triangles of up to eight leaves, and zeros in the places after them: each step is taken for all of them before the next, as
/// every number of a leaf waits for the one before, and one vector holds it for eight.
///
/// No operation is fused, so that the bits are the same on every vector unit.
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
    let anchors = stored.anchors(&extremes, &stored.bounds(&extremes));
    let mut places = [[0.0; LANES]; 3];
    let mut areas = [[f32x8::splat(simd, 0.0); LANES]; 3];
    let mut made: Box<[Triangles; LANES]> = bytemuck::zeroed_box();
    for (lane, leaf) in leaves.iter().enumerate() {
        let triangles = &mut made[lane];
        triangles.anchor = by_axis!(axis => anchors[axis][lane]);
        triangles.count = leaf.count() as u16;
        let place = stored.place(triangles.anchor);
        let corners = stored.about(simd, &gathered[lane], place);
        store_corners(&corners, &mut triangles.corners);
        let facing = facing(&corners);
        for axis in 0..3 {
            places[axis][lane] = place[axis];
            areas[axis][lane] = facing[axis];
        }
    }
    let radii = radii(&extremes, &places, stored.frame().scale);
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
        // Five roundings of sums of three products of at most the radius.
        let error = 20.0 * HALF_ULP as f32 * triangles.radius + f32::MIN_POSITIVE;
        triangles.heights = [low.reduce_min() - error, high.reduce_max() + error];
    }
    made
}

/// How far corners with these extremes reach about these places on any axis, rounded outward: differences of extremes are rounded
/// as those of corners are, and then once more where these are in single precision.
#[inline(always)]
fn radii([least, greatest]: &[Points<f64>; 2], places: &Points<f64>, scale: f64) -> [f32; LANES] {
    let mut radii = [0.0; LANES];
    for lane in 0..LANES {
        let mut reach = 0.0_f64;
        for axis in 0..3 {
            let (below, above) = (places[axis][lane] - least[axis][lane], greatest[axis][lane] - places[axis][lane]);
            reach = reach.max(below).max(above);
        }
        radii[lane] = ((reach * scale) as f32).next_up();
    }
    radii
}

/// The directions of these vectors in units of [`NORMAL_STEP`], so long that the largest component is about one; zero where
/// there is none.
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

/// Twice the area of each triangle, as a vector in the direction in which it faces; not fused.
#[inline(always)]
pub(in crate::mesh) fn facing<S: Simd>(corners: &[Lanes3<S>; 3]) -> Lanes3<S> {
    let (e, f) = (sub(&corners[1], &corners[0]), sub(&corners[2], &corners[0]));
    [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
}

/// The least and the greatest height of the corners of each triangle along a direction, not fused.
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

    /// Where positions are, in both precisions, and of a scale at which single precision is not enough.
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

    /// Leaves of all sizes beside each other: corners, radius and slab are within what is said of them, at every vector level the same.
    #[test]
    fn triangles_are_where_their_corners_are() {
        let mut rng = Rng::new(151);
        let mut ways = [0; 3];
        for round in 0..300 {
            let beside = rng.integer(1, 8) as usize;
            let (centre, size) = ([0; 3].map(|_| rng.uniform(-9.0, 9.0)), 2.0_f64.powi(-(round % 20)));
            let mut vertices: Vec<[f64; 3]> =
                (0..24 * 8).map(|_| std::array::from_fn(|axis| centre[axis] + rng.uniform(-size, size))).collect();
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
                    let anchor = match &corners {
                        Corners::Single(stored) => frame.pack(stored.place(triangles.anchor)),
                        Corners::SingleWidened(stored) => frame.pack(stored.place(triangles.anchor)),
                        Corners::Double(stored) => frame.pack(stored.place(triangles.anchor)),
                    };
                    let ([x, y, z], [low, high]) = triangles.slab();
                    for lane in 0..LANES {
                        for corner in 0..3 {
                            let vertex = faces[leaf.faces[lane] as usize][corner];
                            let exact = frame.pack(positions.get(vertex as usize));
                            let about: [f64; 3] = std::array::from_fn(|axis| exact[axis] - anchor[axis]);
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

//! Gathers the corners of a leaf's triangles from the stored vertices, and maps them to the packed
//! frame, relative to a local origin.
//!
//! Vertices in single precision are mapped in single precision with one rounding: the difference of
//! two of them, times a power of two. Double precision is used if vertices are stored in it, or if
//! that product could leave the range of single precision (docs/notes/proof.md, L4).
//!
//! Guarded by `triangles_are_where_their_corners_are` in `triangles.rs`, the tests of
//! `lifecycle/fit.rs`, and the benchmark `headline`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, f64x4};

use super::eight_triangles::{corners_of, twice_centers_of, twice_packed_centers_of, widened_rows};
use super::faces::{Faces, VertexRows};
use super::frame::{PackedFrame, REACH, outward};
use super::positions::{Vertex, VertexSlice};
use crate::hierarchy::BoxLanes;
use crate::simd::{LANES, Lanes3, Rows, across, by_axis, prefetch_at, transposed};
use crate::volume::Aabb;

/// The faces and vertices of a mesh, by the way in which corners are mapped to the packed frame.
#[derive(Clone, Copy)]
pub(in crate::mesh) enum Corners<'a> {
    Single(Singles<'a>),
    /// Single precision vertices whose scale is unsafe for single precision arithmetic.
    SingleWidened(Doubles<'a, f32>),
    Double(Doubles<'a, f64>),
}

impl<'a> Corners<'a> {
    /// Chooses the way of mapping from the precision of the vertices and the scale of the frame.
    pub(in crate::mesh) fn of(vertices: VertexSlice<'a>, faces: &'a [[u32; 3]], frame: PackedFrame) -> Self {
        /// Maximum scale for single precision, and the reciprocal of the minimum. Beyond them
        /// products of scale and coordinates may overflow or underflow.
        const LARGEST_SCALE: f64 = (1_u128 << 100) as f64;
        let faces = Faces::of(faces);
        match vertices {
            VertexSlice::F32(vertices) if (1.0 / LARGEST_SCALE..=LARGEST_SCALE).contains(&frame.scale) => {
                Self::Single(Singles { vertices: Rows::of(vertices), faces, frame })
            }
            VertexSlice::F32(vertices) => Self::SingleWidened(Doubles::of(Rows::of(vertices), faces, frame)),
            VertexSlice::F64(vertices) => Self::Double(Doubles::of(Rows::of(vertices), faces, frame)),
        }
    }
}

/// Coordinates of eight points, `[axis][lane]`. There is one point per leaf or per triangle.
pub(in crate::mesh) type Points<T> = [[T; LANES]; 3];

/// Access to corners, and their map to the packed frame.
///
/// Corners are stored relative to a local origin in single precision. It is in the mesh frame for
/// single precision vertices, else in the packed frame.
pub(in crate::mesh) trait StoredCorners: Copy + Sync {
    /// Corners of up to eight triangles, as they are stored.
    type Gathered<S: Simd>: Copy;

    /// Minimum and maximum coordinates of gathered corners, not yet reduced over all lanes.
    type Extremes<S: Simd>: Copy;

    fn frame(&self) -> &PackedFrame;

    fn faces(&self) -> &Faces<'_>;

    fn prefetch_vertex(&self, vertex: u32);

    /// Prefetches the vertices of a face.
    #[inline(always)]
    fn prefetch_vertices(&self, face: u32) {
        self.faces().all()[face as usize].iter().for_each(|&vertex| self.prefetch_vertex(vertex));
    }

    /// Returns the corners of eight triangles.
    fn gather<S: Simd>(&self, simd: S, triangles: &VertexRows) -> Self::Gathered<S>;

    /// Returns a vertex, in the mesh frame.
    fn vertex(&self, vertex: u32) -> [f64; 3];

    /// Returns the minimum and maximum coordinates of a leaf's corners.
    fn extremes_of<S: Simd>(&self, gathered: &Self::Gathered<S>) -> Self::Extremes<S>;

    /// Returns the minimum and maximum coordinates of eight leaves side by side, in the mesh frame.
    fn extremes<S: Simd>(&self, each: &[Self::Extremes<S>; LANES]) -> [Points<f64>; 2];

    /// Returns local origins amid eight leaves, given their extremes and their packed bounds.
    fn local_origins(&self, extremes: &[Points<f64>; 2], bounds: &BoxLanes) -> Points<f32>;

    /// Returns a local origin in the mesh frame, rounded to the precision of the vertices.
    fn origin_in_mesh_frame(&self, local_origin: [f32; 3]) -> [f64; 3];

    /// Returns the corners relative to `origin`, which is in the mesh frame, as `[corner][axis]` in
    /// the unit of the packed frame.
    ///
    /// # Accuracy
    /// A corner is the returned value plus `origin` [as packed](PackedFrame::pack). Its error is at
    /// most one rounding to single precision and [`PACKING_ERROR`](super::frame::PACKING_ERROR),
    /// which is four units of 2^-53: one is for the packed origin, and two for a difference of up
    /// to twice the reach.
    fn about<S: Simd>(&self, simd: S, gathered: &Self::Gathered<S>, origin: [f64; 3]) -> [Lanes3<S>; 3];

    /// Returns twice the box centers of eight faces, one vector per face, up to rounding. They are
    /// in the mesh or packed frame, as the implementation chooses. The fourth lanes have no
    /// meaning.
    fn twice_centers<S: Simd>(&self, simd: S, faces: &[[u32; 3]; LANES]) -> [[f32x4<S>; 4]; 2];

    /// Returns bounds of twice the box centers of all faces, in the same frame as
    /// [`twice_centers`](Self::twice_centers). They may be larger than necessary.
    fn twice_reach(&self) -> Aabb;

    /// Returns the boxes between extremes in the packed frame, rounded to nearest and then outward
    /// (docs/notes/proof.md, L1).
    #[inline(always)]
    fn bounds(&self, [least, greatest]: &[Points<f64>; 2]) -> BoxLanes {
        let PackedFrame { origin, scale } = *self.frame();
        let mut bounds = BoxLanes::default();
        for axis in 0..3 {
            for lane in 0..LANES {
                bounds.min[axis][lane] = -outward(-((least[axis][lane] - origin[axis]) * scale) as f32);
                bounds.max[axis][lane] = outward(((greatest[axis][lane] - origin[axis]) * scale) as f32);
            }
        }
        bounds
    }
}

/// Vertices in single precision, mapped to the packed frame in single precision.
#[derive(Clone, Copy)]
pub(in crate::mesh) struct Singles<'a> {
    vertices: Rows<'a, f32>,
    faces: Faces<'a>,
    frame: PackedFrame,
}

impl StoredCorners for Singles<'_> {
    type Gathered<S: Simd> = [Lanes3<S>; 3];

    /// Extremes of the triangle in each lane.
    type Extremes<S: Simd> = [Lanes3<S>; 2];

    #[inline(always)]
    fn frame(&self) -> &PackedFrame {
        &self.frame
    }

    #[inline(always)]
    fn faces(&self) -> &Faces<'_> {
        &self.faces
    }

    #[inline(always)]
    fn prefetch_vertex(&self, vertex: u32) {
        prefetch_at(self.vertices.all(), vertex as usize);
    }

    #[inline(always)]
    fn vertex(&self, vertex: u32) -> [f64; 3] {
        self.vertices.all()[vertex as usize].widened()
    }

    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, triangles: &VertexRows) -> [Lanes3<S>; 3] {
        let vertices: &[u32; 4 * LANES] = bytemuck::cast_ref(triangles);
        if let Some(inside) = self.vertices.inside(simd, vertices) {
            corners_of(
                #[inline(always)]
                |at| f32x4::from_slice(simd, inside.row(at)),
            )
        } else {
            corners_of(
                #[inline(always)]
                |at| f32x4::from_slice(simd, self.vertices.row(vertices[at])),
            )
        }
    }

    #[inline(always)]
    fn extremes_of<S: Simd>(&self, [p, q, r]: &[Lanes3<S>; 3]) -> [Lanes3<S>; 2] {
        [by_axis!(axis => p[axis].min(q[axis]).min(r[axis])), by_axis!(axis => p[axis].max(q[axis]).max(r[axis]))]
    }

    #[inline(always)]
    fn extremes<S: Simd>(&self, each: &[[Lanes3<S>; 2]; LANES]) -> [Points<f64>; 2] {
        let mut extremes = [[[0.0; LANES]; 3]; 2];
        for axis in 0..3 {
            let (mut least, mut greatest) = ([each[0][0][axis]; LANES], [each[0][1][axis]; LANES]);
            for lane in 1..LANES {
                (least[lane], greatest[lane]) = (each[lane][0][axis], each[lane][1][axis]);
            }
            let least = across(
                &least,
                #[inline(always)]
                |a, b| a.min(b),
            );
            let greatest = across(
                &greatest,
                #[inline(always)]
                |a, b| a.max(b),
            );
            for lane in 0..LANES {
                extremes[0][axis][lane] = f64::from(least[lane]);
                extremes[1][axis][lane] = f64::from(greatest[lane]);
            }
        }
        extremes
    }

    #[inline(always)]
    fn local_origins(&self, [least, greatest]: &[Points<f64>; 2], _: &BoxLanes) -> Points<f32> {
        let mut local_origins = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                // Adding zero makes -0.0 positive: vector units differ in the minimum of two zeros.
                local_origins[axis][lane] = (0.5 * (least[axis][lane] + greatest[axis][lane])) as f32 + 0.0;
            }
        }
        local_origins
    }

    #[inline(always)]
    fn origin_in_mesh_frame(&self, local_origin: [f32; 3]) -> [f64; 3] {
        local_origin.widened()
    }

    #[inline(always)]
    fn about<S: Simd>(&self, simd: S, gathered: &[Lanes3<S>; 3], origin: [f64; 3]) -> [Lanes3<S>; 3] {
        let scale = f32x8::splat(simd, self.frame.scale as f32);
        let origin: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, origin[axis] as f32));
        by_axis!(corner => by_axis!(axis => (gathered[corner][axis] - origin[axis]) * scale))
    }

    #[inline(always)]
    fn twice_centers<S: Simd>(&self, simd: S, faces: &[[u32; 3]; LANES]) -> [[f32x4<S>; 4]; 2] {
        let vertices: &[u32; 3 * LANES] = bytemuck::cast_ref(faces);
        if let Some(inside) = self.vertices.inside(simd, vertices) {
            twice_centers_of(
                #[inline(always)]
                |at| f32x4::from_slice(simd, inside.row(at)),
            )
        } else {
            twice_centers_of(
                #[inline(always)]
                |at| f32x4::from_slice(simd, self.vertices.row(vertices[at])),
            )
        }
    }

    fn twice_reach(&self) -> Aabb {
        let [min, max] = [-REACH, REACH].map(|reach| self.frame.unpack([reach; 3]).map(|x| (2.0 * x) as f32));
        Aabb { min, max }
    }
}

/// Vertices in either precision, mapped to the packed frame in double precision.
#[derive(Clone, Copy)]
pub(in crate::mesh) struct Doubles<'a, T> {
    vertices: Rows<'a, T>,
    faces: Faces<'a>,
    frame: PackedFrame,
    /// The unit of the packed frame in the unit of the mesh: 1 / scale. As both are powers of two,
    /// multiplying by it equals dividing by the scale, and is faster.
    unit: f64,
}

impl<'a, T> Doubles<'a, T> {
    fn of(vertices: Rows<'a, T>, faces: Faces<'a>, frame: PackedFrame) -> Self {
        Self { vertices, faces, frame, unit: 1.0 / frame.scale }
    }
}

impl<T: Copy + Default + Into<f64> + Sync> StoredCorners for Doubles<'_, T> {
    /// One vertex per vector, `[corner][lane]`. Its fourth lane has no meaning.
    type Gathered<S: Simd> = [[f64x4<S>; LANES]; 3];

    /// Extremes of the whole leaf by axis. The fourth lane has no meaning.
    type Extremes<S: Simd> = [f64x4<S>; 2];

    #[inline(always)]
    fn frame(&self) -> &PackedFrame {
        &self.frame
    }

    #[inline(always)]
    fn faces(&self) -> &Faces<'_> {
        &self.faces
    }

    #[inline(always)]
    fn prefetch_vertex(&self, vertex: u32) {
        prefetch_at(self.vertices.all(), vertex as usize);
    }

    #[inline(always)]
    fn vertex(&self, vertex: u32) -> [f64; 3] {
        self.vertices.all()[vertex as usize].map(Into::into)
    }

    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, triangles: &VertexRows) -> [[f64x4<S>; LANES]; 3] {
        let vertices: &[u32; 4 * LANES] = bytemuck::cast_ref(triangles);
        if let Some(inside) = self.vertices.inside(simd, vertices) {
            widened_rows(
                simd,
                #[inline(always)]
                |at| inside.row(at),
            )
        } else {
            widened_rows(
                simd,
                #[inline(always)]
                |at| self.vertices.row(vertices[at]),
            )
        }
    }

    #[inline(always)]
    fn extremes_of<S: Simd>(&self, gathered: &[[f64x4<S>; LANES]; 3]) -> [f64x4<S>; 2] {
        let [mut least, mut greatest] = [gathered[0]; 2];
        for lane in 0..LANES {
            let [p, q, r] = by_axis!(corner => gathered[corner][lane]);
            (least[lane], greatest[lane]) = (p.min(q).min(r), p.max(q).max(r));
        }
        // Reduced by halves: in a sequence each operation would wait for the previous one.
        for half in [4, 2, 1] {
            for lane in 0..half {
                least[lane] = least[lane].min(least[lane + half]);
                greatest[lane] = greatest[lane].max(greatest[lane + half]);
            }
        }
        [least[0], greatest[0]]
    }

    #[inline(always)]
    fn extremes<S: Simd>(&self, each: &[[f64x4<S>; 2]; LANES]) -> [Points<f64>; 2] {
        let mut extremes = [[[0.0; LANES]; 3]; 2];
        for lane in 0..LANES {
            for axis in 0..3 {
                extremes[0][axis][lane] = each[lane][0][axis];
                extremes[1][axis][lane] = each[lane][1][axis];
            }
        }
        extremes
    }

    #[inline(always)]
    fn local_origins(&self, _: &[Points<f64>; 2], bounds: &BoxLanes) -> Points<f32> {
        let mut local_origins = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                local_origins[axis][lane] = 0.5 * (bounds.min[axis][lane] + bounds.max[axis][lane]);
            }
        }
        local_origins
    }

    #[inline(always)]
    fn origin_in_mesh_frame(&self, local_origin: [f32; 3]) -> [f64; 3] {
        let local_origin = local_origin.widened();
        by_axis!(axis => local_origin[axis] * self.unit + self.frame.origin[axis])
    }

    #[inline(always)]
    fn about<S: Simd>(&self, simd: S, gathered: &[[f64x4<S>; LANES]; 3], [x, y, z]: [f64; 3]) -> [Lanes3<S>; 3] {
        let (origin, scale) = (f64x4::from_slice(simd, &[x, y, z, 0.0]), f64x4::splat(simd, self.frame.scale));
        by_axis!(corner => {
            let (mut low, mut high) = ([f32x4::splat(simd, 0.0); 4], [f32x4::splat(simd, 0.0); 4]);
            for lane in 0..4 {
                let rows = [gathered[corner][lane], gathered[corner][lane + 4]];
                let both: f32x8<S> = ((rows[0] - origin) * scale).narrow((rows[1] - origin) * scale);
                (low[lane], high[lane]) = both.split();
            }
            transposed(low, high)
        })
    }

    #[inline(always)]
    fn twice_centers<S: Simd>(&self, simd: S, faces: &[[u32; 3]; LANES]) -> [[f32x4<S>; 4]; 2] {
        let vertices: &[u32; 3 * LANES] = bytemuck::cast_ref(faces);
        if let Some(inside) = self.vertices.inside(simd, vertices) {
            twice_packed_centers_of(
                simd,
                &self.frame,
                #[inline(always)]
                |at| inside.row(at),
            )
        } else {
            twice_packed_centers_of(
                simd,
                &self.frame,
                #[inline(always)]
                |at| self.vertices.row(vertices[at]),
            )
        }
    }

    fn twice_reach(&self) -> Aabb {
        let reach = (2.0 * REACH) as f32;
        Aabb { min: [-reach; 3], max: [reach; 3] }
    }
}

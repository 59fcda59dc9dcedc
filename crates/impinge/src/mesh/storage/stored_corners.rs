//! The corners of a leaf's triangles: gathered from where the vertices are stored, and taken to about an anchor of their own in
//! the packed frame.
//!
//! Vertices in single precision are taken there in single precision, rounded once: a difference of two of them, times a power of
//! two. What is stored in double precision, or so small or large that such a product could be lost, goes by double precision.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, f64x4};

use super::eight_triangles::{corners_of, twice_centres_of, twice_packed_centres_of, widened_rows};
use super::faces::{Faces, VertexRows};
use super::frame::{PackedFrame, REACH, outward};
use super::positions::{Vertex, VertexSlice};
use crate::hierarchy::BoxLanes;
use crate::simd::{LANES, Lanes3, Rows, across, by_axis, prefetch_at, transposed};
use crate::volume::Aabb;

/// Faces over vertices, and how these get to the packed frame.
#[derive(Clone, Copy)]
pub(in crate::mesh) enum Corners<'a> {
    Single(Singles<'a>),
    SingleWidened(Doubles<'a, f32>),
    Double(Doubles<'a, f64>),
}

impl<'a> Corners<'a> {
    pub(in crate::mesh) fn of(vertices: VertexSlice<'a>, faces: &'a [[u32; 3]], frame: PackedFrame) -> Self {
        /// Beyond this and below its reciprocal, products of scale and coordinates may leave single precision.
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

/// Coordinates of eight points, or leaves, by axis.
pub(in crate::mesh) type Points<T> = [[T; LANES]; 3];

/// What gathers corners.
///
/// Corners are kept about an anchor, which is kept in single precision: of the mesh's own frame where the vertices are, of the packed
/// frame else. What stands for it is its [`place`](Self::place) in the mesh's own frame, rounded as vertices are.
pub(in crate::mesh) trait StoredCorners: Copy + Sync {
    /// Corners of up to eight triangles as they are stored.
    type Gathered<S: Simd>: Copy;

    /// The least and the greatest coordinates of them, not yet of all together.
    type Extremes<S: Simd>: Copy;

    fn frame(&self) -> &PackedFrame;

    fn faces(&self) -> &Faces<'_>;

    /// Asks for a vertex.
    fn prefetch_vertex(&self, vertex: u32);

    /// Asks for the vertices of a face.
    #[inline(always)]
    fn prefetch_vertices(&self, face: u32) {
        self.faces().all()[face as usize].iter().for_each(|&vertex| self.prefetch_vertex(vertex));
    }

    /// The corners of these triangles.
    fn gather<S: Simd>(&self, simd: S, triangles: &VertexRows) -> Self::Gathered<S>;

    /// Where a vertex is, in the mesh's own frame.
    fn vertex(&self, vertex: u32) -> [f64; 3];

    /// The least and the greatest coordinates of a leaf's corners.
    fn extremes_of<S: Simd>(&self, gathered: &Self::Gathered<S>) -> Self::Extremes<S>;

    /// Those of eight leaves side by side.
    fn extremes<S: Simd>(&self, each: &[Self::Extremes<S>; LANES]) -> [Points<f64>; 2];

    /// Anchors amid corners with these extremes and these bounds in the packed frame.
    fn anchors(&self, extremes: &[Points<f64>; 2], bounds: &BoxLanes) -> Points<f32>;

    /// Where the anchor is in the mesh's own frame, in the vertices' precision.
    fn place(&self, anchor: [f32; 3]) -> [f64; 3];

    /// The corners about a place, `[corner][axis]`, in the packed frame.
    ///
    /// A corner is at the place [as packed](PackedFrame::pack) and what is said here, up to one rounding to single precision and
    /// [`PACKING_ERROR`](super::frame::PACKING_ERROR), which is four units of 2^-53: one goes to the place, two to a difference of up
    /// to twice the frame's reach.
    fn about<S: Simd>(&self, simd: S, gathered: &Self::Gathered<S>, place: [f64; 3]) -> [Lanes3<S>; 3];

    /// Twice the centres of the boxes of eight faces and any fourth lanes, up to rounding: in the vertices' own frame or the packed one.
    fn twice_centres<S: Simd>(&self, simd: S, faces: &[[u32; 3]; LANES]) -> [[f32x4<S>; 4]; 2];

    /// Bounds of twice the centres of all faces, which may be generous.
    fn twice_reach(&self) -> Aabb;

    /// What lies between extremes in the packed frame, rounded to nearest and then outward (docs/proof.md, L1).
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

/// Vertices in single precision.
#[derive(Clone, Copy)]
pub(in crate::mesh) struct Singles<'a> {
    vertices: Rows<'a, f32>,
    faces: Faces<'a>,
    frame: PackedFrame,
}

impl StoredCorners for Singles<'_> {
    type Gathered<S: Simd> = [Lanes3<S>; 3];

    /// Of the triangles in each lane.
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
    fn anchors(&self, [least, greatest]: &[Points<f64>; 2], _: &BoxLanes) -> Points<f32> {
        let mut anchors = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                // Which zero is the least of both differs between vector units.
                anchors[axis][lane] = (0.5 * (least[axis][lane] + greatest[axis][lane])) as f32 + 0.0;
            }
        }
        anchors
    }

    #[inline(always)]
    fn place(&self, anchor: [f32; 3]) -> [f64; 3] {
        anchor.widened()
    }

    #[inline(always)]
    fn about<S: Simd>(&self, simd: S, gathered: &[Lanes3<S>; 3], place: [f64; 3]) -> [Lanes3<S>; 3] {
        let scale = f32x8::splat(simd, self.frame.scale as f32);
        let place: Lanes3<S> = by_axis!(axis => f32x8::splat(simd, place[axis] as f32));
        by_axis!(corner => by_axis!(axis => (gathered[corner][axis] - place[axis]) * scale))
    }

    #[inline(always)]
    fn twice_centres<S: Simd>(&self, simd: S, faces: &[[u32; 3]; LANES]) -> [[f32x4<S>; 4]; 2] {
        let vertices: &[u32; 3 * LANES] = bytemuck::cast_ref(faces);
        if let Some(inside) = self.vertices.inside(simd, vertices) {
            twice_centres_of(
                #[inline(always)]
                |at| f32x4::from_slice(simd, inside.row(at)),
            )
        } else {
            twice_centres_of(
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

/// Vertices that are taken to the packed frame in double precision.
#[derive(Clone, Copy)]
pub(in crate::mesh) struct Doubles<'a, T> {
    vertices: Rows<'a, T>,
    faces: Faces<'a>,
    frame: PackedFrame,
    /// The packed frame's, in the mesh's own frame: a power of two, by which to multiply is to divide by the scale, only sooner.
    unit: f64,
}

impl<'a, T> Doubles<'a, T> {
    fn of(vertices: Rows<'a, T>, faces: Faces<'a>, frame: PackedFrame) -> Self {
        Self { vertices, faces, frame, unit: 1.0 / frame.scale }
    }
}

impl<T: Copy + Default + Into<f64> + Sync> StoredCorners for Doubles<'_, T> {
    /// A vertex each, and any fourth number.
    type Gathered<S: Simd> = [[f64x4<S>; LANES]; 3];

    /// As a vertex is.
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
        // By halves, as in a row each would wait for the one before.
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
    fn anchors(&self, _: &[Points<f64>; 2], bounds: &BoxLanes) -> Points<f32> {
        let mut anchors = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                anchors[axis][lane] = 0.5 * (bounds.min[axis][lane] + bounds.max[axis][lane]);
            }
        }
        anchors
    }

    #[inline(always)]
    fn place(&self, anchor: [f32; 3]) -> [f64; 3] {
        let anchor = anchor.widened();
        by_axis!(axis => anchor[axis] * self.unit + self.frame.origin[axis])
    }

    #[inline(always)]
    fn about<S: Simd>(&self, simd: S, gathered: &[[f64x4<S>; LANES]; 3], [x, y, z]: [f64; 3]) -> [Lanes3<S>; 3] {
        let (place, scale) = (f64x4::from_slice(simd, &[x, y, z, 0.0]), f64x4::splat(simd, self.frame.scale));
        by_axis!(corner => {
            let (mut low, mut high) = ([f32x4::splat(simd, 0.0); 4], [f32x4::splat(simd, 0.0); 4]);
            for lane in 0..4 {
                let rows = [gathered[corner][lane], gathered[corner][lane + 4]];
                let both: f32x8<S> = ((rows[0] - place) * scale).narrow((rows[1] - place) * scale);
                (low[lane], high[lane]) = both.split();
            }
            transposed(low, high)
        })
    }

    #[inline(always)]
    fn twice_centres<S: Simd>(&self, simd: S, faces: &[[u32; 3]; LANES]) -> [[f32x4<S>; 4]; 2] {
        let vertices: &[u32; 3 * LANES] = bytemuck::cast_ref(faces);
        if let Some(inside) = self.vertices.inside(simd, vertices) {
            twice_packed_centres_of(
                simd,
                &self.frame,
                #[inline(always)]
                |at| inside.row(at),
            )
        } else {
            twice_packed_centres_of(
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

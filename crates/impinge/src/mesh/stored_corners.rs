//! The corners of a leaf's triangles: gathered from where the vertices are stored, and taken to about an anchor of their own in
//! the packed frame.
//!
//! Vertices in single precision are taken there in single precision, rounded once: a difference of two of them, times a power of
//! two. What is stored in double precision, or so small or large that such a product could be lost, goes by double precision.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, f64x4};

use super::frame::PackedFrame;
use super::positions::{Vertex, VertexSlice};
use crate::simd::{LANES, Lanes3, by_axis, prefetch};
use crate::volume::Aabb;

/// Faces over vertices, and how these get to the packed frame.
#[derive(Clone, Copy)]
pub(super) enum Corners<'a> {
    Single(Singles<'a>),
    SingleWidened(Doubles<'a, [f32; 3]>),
    Double(Doubles<'a, [f64; 3]>),
}

impl<'a> Corners<'a> {
    pub(super) fn of(vertices: VertexSlice<'a>, faces: &'a [[u32; 3]], frame: &'a PackedFrame) -> Self {
        /// Beyond this and below its reciprocal, products of scale and coordinates may leave single precision.
        const LARGEST_SCALE: f64 = (1_u128 << 100) as f64;
        match vertices {
            VertexSlice::F32(vertices) if (1.0 / LARGEST_SCALE..=LARGEST_SCALE).contains(&frame.scale) => {
                Self::Single(Singles { vertices, faces, frame })
            }
            VertexSlice::F32(vertices) => Self::SingleWidened(Doubles { vertices, faces, frame }),
            VertexSlice::F64(vertices) => Self::Double(Doubles { vertices, faces, frame }),
        }
    }
}

/// What gathers corners.
///
/// Corners are kept about an anchor, which is kept in single precision: of the mesh's own frame where the vertices are, of the packed
/// frame else. What stands for it is its [`place`](Self::place) in the mesh's own frame, rounded as vertices are.
pub(super) trait StoredCorners: Copy + Sync {
    /// Corners of up to eight triangles as they are stored.
    type Gathered<S: Simd>;

    fn frame(&self) -> &PackedFrame;

    fn faces(&self) -> &[[u32; 3]];

    /// Asks for a face.
    #[inline(always)]
    fn prefetch_face(&self, face: u32) {
        prefetch(&self.faces()[face as usize]);
    }

    /// Asks for the vertices of a face.
    fn prefetch_corners(&self, face: u32);

    /// The corners of these faces.
    fn gather<S: Simd>(&self, simd: S, faces: &[u32; LANES]) -> Self::Gathered<S>;

    /// Their least and greatest coordinates.
    fn extremes<S: Simd>(&self, simd: S, gathered: &Self::Gathered<S>) -> [[f64; 3]; 2];

    /// An anchor amid corners with these extremes and these bounds in the packed frame.
    fn anchor(&self, extremes: [[f64; 3]; 2], bounds: &Aabb) -> [f32; 3];

    /// Where the anchor is in the mesh's own frame, in the vertices' precision.
    fn place(&self, anchor: [f32; 3]) -> [f64; 3];

    /// The corners about a place, `[corner][axis]`, in the packed frame.
    ///
    /// A corner is at the place [as packed](PackedFrame::pack) and what is said here, up to one rounding to single precision and
    /// [`PACKING_ERROR`](super::frame::PACKING_ERROR), which is four units of 2^-53: one goes to the place, two to a difference of up
    /// to twice the frame's reach.
    fn about<S: Simd>(&self, simd: S, gathered: &Self::Gathered<S>, place: [f64; 3]) -> [Lanes3<S>; 3];

    /// What lies between extremes in the packed frame, rounded to nearest and then outward (docs/proof.md, L1).
    #[inline(always)]
    fn bounds(&self, [least, greatest]: [[f64; 3]; 2]) -> Aabb {
        let (min, max) = (self.frame().pack(least), self.frame().pack(greatest));
        Aabb { min: by_axis!(axis => -next_up(-min[axis] as f32)), max: by_axis!(axis => next_up(max[axis] as f32)) }
    }
}

/// As [`f32::next_up`], of what is finite.
#[inline(always)]
fn next_up(x: f32) -> f32 {
    // Zero is positive in a sum of zeros.
    let bits = (x + 0.0).to_bits().cast_signed();
    f32::from_bits((bits + (bits >> 31 | 1)).cast_unsigned())
}

/// Vertices in single precision.
#[derive(Clone, Copy)]
pub(super) struct Singles<'a> {
    vertices: &'a [[f32; 3]],
    faces: &'a [[u32; 3]],
    frame: &'a PackedFrame,
}

impl Singles<'_> {
    /// A vertex, and any fourth number.
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, vertex: u32) -> f32x4<S> {
        let [x, y, z] = self.vertices[vertex as usize];
        f32x4::from_slice(simd, &[x, y, z, 0.0])
    }
}

impl StoredCorners for Singles<'_> {
    type Gathered<S: Simd> = [Lanes3<S>; 3];

    #[inline(always)]
    fn frame(&self) -> &PackedFrame {
        self.frame
    }

    #[inline(always)]
    fn faces(&self) -> &[[u32; 3]] {
        self.faces
    }

    #[inline(always)]
    fn prefetch_corners(&self, face: u32) {
        for vertex in self.faces[face as usize] {
            prefetch(&self.vertices[vertex as usize]);
        }
    }

    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, &[a, b, c, d, e, f, g, h]: &[u32; LANES]) -> [Lanes3<S>; 3] {
        let face = |face: u32| &self.faces[face as usize];
        let [a, b, c, d] = [face(a), face(b), face(c), face(d)];
        let [e, f, g, h] = [face(e), face(f), face(g), face(h)];
        by_axis!(k => {
            let low = [self.row(simd, a[k]), self.row(simd, b[k]), self.row(simd, c[k]), self.row(simd, d[k])];
            let high = [self.row(simd, e[k]), self.row(simd, f[k]), self.row(simd, g[k]), self.row(simd, h[k])];
            transposed(low, high)
        })
    }

    #[inline(always)]
    fn extremes<S: Simd>(&self, _: S, [p, q, r]: &[Lanes3<S>; 3]) -> [[f64; 3]; 2] {
        let least: Lanes3<S> = by_axis!(axis => p[axis].min(q[axis]).min(r[axis]));
        let greatest: Lanes3<S> = by_axis!(axis => p[axis].max(q[axis]).max(r[axis]));
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
        [by_axis!(axis => f64::from(least[axis])), by_axis!(axis => f64::from(greatest[axis]))]
    }

    #[inline(always)]
    fn anchor(&self, [least, greatest]: [[f64; 3]; 2], _: &Aabb) -> [f32; 3] {
        // Which zero is the least of both differs between vector units.
        by_axis!(axis => (0.5 * (least[axis] + greatest[axis])) as f32 + 0.0)
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
}

/// Vertices that are taken to the packed frame in double precision.
#[derive(Clone, Copy)]
pub(super) struct Doubles<'a, V> {
    vertices: &'a [V],
    faces: &'a [[u32; 3]],
    frame: &'a PackedFrame,
}

impl<V: Vertex> StoredCorners for Doubles<'_, V> {
    /// A vertex each, and any fourth number.
    type Gathered<S: Simd> = [[f64x4<S>; LANES]; 3];

    #[inline(always)]
    fn frame(&self) -> &PackedFrame {
        self.frame
    }

    #[inline(always)]
    fn faces(&self) -> &[[u32; 3]] {
        self.faces
    }

    #[inline(always)]
    fn prefetch_corners(&self, face: u32) {
        for vertex in self.faces[face as usize] {
            prefetch(&self.vertices[vertex as usize]);
        }
    }

    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, faces: &[u32; LANES]) -> [[f64x4<S>; LANES]; 3] {
        let mut rows = [[f64x4::splat(simd, 0.0); LANES]; 3];
        for lane in 0..LANES {
            let face = &self.faces[faces[lane] as usize];
            for corner in 0..3 {
                rows[corner][lane] = V::row(simd, self.vertices, face[corner]);
            }
        }
        rows
    }

    #[inline(always)]
    fn extremes<S: Simd>(&self, _: S, gathered: &[[f64x4<S>; LANES]; 3]) -> [[f64; 3]; 2] {
        let (mut least, mut greatest) = (gathered[0][0], gathered[0][0]);
        for corner in gathered {
            for &row in corner {
                (least, greatest) = (least.min(row), greatest.max(row));
            }
        }
        [by_axis!(axis => least[axis]), by_axis!(axis => greatest[axis])]
    }

    #[inline(always)]
    fn anchor(&self, _: [[f64; 3]; 2], bounds: &Aabb) -> [f32; 3] {
        by_axis!(axis => 0.5 * (bounds.min[axis] + bounds.max[axis]))
    }

    #[inline(always)]
    fn place(&self, anchor: [f32; 3]) -> [f64; 3] {
        self.frame.unpack(anchor.widened())
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
}

/// The first three columns of eight rows.
#[inline(always)]
fn transposed<S: Simd>(low: [f32x4<S>; 4], high: [f32x4<S>; 4]) -> Lanes3<S> {
    let (low, high) = (columns(low), columns(high));
    by_axis!(axis => low[axis].combine(high[axis]))
}

/// The first three columns of four rows.
#[inline(always)]
fn columns<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 3] {
    let (xy_even, xy_odd) = (a.zip_low(c), b.zip_low(d));
    let (z_even, z_odd) = (a.zip_high(c), b.zip_high(d));
    [xy_even.zip_low(xy_odd), xy_even.zip_high(xy_odd), z_even.zip_low(z_odd)]
}

/// The lanes of each axis taken together, in an order that is the same on every vector unit; and any fourth number.
#[inline(always)]
pub(super) fn across<S: Simd>(lanes: &Lanes3<S>, both: impl Fn(f32x4<S>, f32x4<S>) -> f32x4<S>) -> f32x4<S> {
    let [x, y, z]: [f32x4<S>; 3] = by_axis!(axis => {
        let (low, high) = lanes[axis].split();
        both(low, high)
    });
    let (xz_low, xz_high) = (x.zip_low(z), x.zip_high(z));
    let (y_low, y_high) = (y.zip_low(y), y.zip_high(y));
    both(both(xz_low.zip_low(y_low), xz_low.zip_high(y_low)), both(xz_high.zip_low(y_high), xz_high.zip_high(y_high)))
}

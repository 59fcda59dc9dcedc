//! Packets: the triangles of one leaf side by side for the vector unit, in single precision about an anchor of their
//! own, for rejecting and confirming in bulk. What they leave open is decided on the stored vertices.
//!
//! They are made when they are first met, some neighbours at a time, and kept until the mesh moves: most of a large mesh is
//! never met, and what a build and a refit would write else is mostly packets.

use std::sync::OnceLock;

use fearless_simd::Simd;

use super::Mesh;
use super::leaf::Leaf;
use super::stored_corners::{Corners, StoredCorners};
use crate::simd::{LANES, Lanes3, outlined, prefetch, store3};

/// `[corner][axis][lane]`, relative to the anchor of a leaf.
pub(crate) type CornerLanes = [[[f32; LANES]; 3]; 3];

/// All of them at the anchor.
pub(super) const NO_CORNERS: CornerLanes = [[[0.0; LANES]; 3]; 3];

/// The triangles of a leaf; unused lanes repeat the first one.
///
/// A corner is `anchor + corners[..]` in the packed frame, up to `HALF_ULP · leaf.radius` for its rounding to single
/// precision and [`PACKING_ERROR`](super::frame::PACKING_ERROR) for the arithmetic before that (docs/proof.md, L4).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet<'a> {
    pub(crate) leaf: &'a Leaf,
    /// A point amid the triangles, in the packed frame.
    pub(crate) anchor: [f64; 3],
    pub(crate) corners: &'a CornerLanes,
}

/// Leaves whose packets are made together: fewer waste less of what is made, and more less memory for keeping track.
const TOGETHER: usize = 8;

/// The packets that were made so far.
#[derive(Debug)]
pub(super) struct Made(Box<[OnceLock<Box<[CornerLanes]>>]>);

impl Made {
    /// None of so many leaves.
    pub(super) fn none(leaves: usize) -> Self {
        Self((0..leaves.div_ceil(TOGETHER)).map(|_| OnceLock::new()).collect())
    }

    /// None any more.
    pub(super) fn clear(&mut self) {
        for slot in &mut self.0 {
            slot.take();
        }
    }

    /// Bytes.
    pub(super) fn memory(&self) -> usize {
        let made = self.0.iter().filter_map(OnceLock::get).map(|corners| size_of_val(&corners[..])).sum::<usize>();
        size_of_val(&self.0[..]) + made
    }
}

/// The packets of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Packets<'a> {
    leaves: &'a [Leaf],
    made: &'a [OnceLock<Box<[CornerLanes]>>],
    corners: Corners<'a>,
}

impl Mesh {
    /// The packets of its leaves.
    pub(crate) fn packets(&self) -> Packets<'_> {
        let data = &*self.0;
        let corners = Corners::of(data.vertices.slice(), &data.faces, &data.frame);
        Packets { leaves: &data.leaves, made: &data.made.0, corners }
    }

    /// What one leaf holds.
    #[inline(always)]
    pub(crate) fn leaf(&self, leaf: u32) -> &Leaf {
        &self.0.leaves[leaf as usize]
    }
}

impl<'a> Packets<'a> {
    #[inline(always)]
    pub(crate) fn leaf(&self, leaf: u32) -> &'a Leaf {
        &self.leaves[leaf as usize]
    }

    /// The place of a leaf's anchor in the packed frame.
    #[inline(always)]
    pub(crate) fn anchor(&self, leaf: &Leaf) -> [f64; 3] {
        match &self.corners {
            Corners::Single(stored) => stored.frame().pack(stored.place(leaf.anchor)),
            Corners::SingleWidened(stored) => stored.frame().pack(stored.place(leaf.anchor)),
            Corners::Double(stored) => stored.frame().pack(stored.place(leaf.anchor)),
        }
    }

    /// Asks for a leaf and its packet, where that is made.
    #[inline(always)]
    pub(crate) fn prefetch(&self, leaf: u32) {
        prefetch(&self.leaves[leaf as usize]);
        let leaf = leaf as usize;
        if let Some(made) = self.made[leaf / TOGETHER].get() {
            prefetch(&made[leaf % TOGETHER]);
        }
    }

    /// The packet of a leaf.
    #[inline(always)]
    pub(crate) fn get<S: Simd>(&self, simd: S, leaf: u32) -> Packet<'a> {
        let at = leaf as usize;
        let made = match self.made[at / TOGETHER].get() {
            Some(made) => made,
            None => self.make(simd, at / TOGETHER),
        };
        let leaf = self.leaf(leaf);
        Packet { leaf, anchor: self.anchor(leaf), corners: &made[at % TOGETHER] }
    }

    #[cold]
    #[inline(never)]
    fn make<S: Simd>(&self, simd: S, slot: usize) -> &'a [CornerLanes] {
        let end = self.leaves.len().min((slot + 1) * TOGETHER);
        let leaves = &self.leaves[slot * TOGETHER..end];
        self.made[slot].get_or_init(|| {
            outlined(
                simd,
                #[inline(always)]
                || match &self.corners {
                    Corners::Single(stored) => gathered(simd, leaves, stored),
                    Corners::SingleWidened(stored) => gathered(simd, leaves, stored),
                    Corners::Double(stored) => gathered(simd, leaves, stored),
                },
            )
        })
    }
}

#[inline(always)]
fn gathered<S: Simd>(simd: S, leaves: &[Leaf], stored: &impl StoredCorners) -> Box<[CornerLanes]> {
    let held = leaves.iter().flat_map(Leaf::held);
    held.clone().for_each(|&face| stored.prefetch_face(face));
    held.for_each(|&face| stored.prefetch_corners(face));
    let mut made = Vec::with_capacity(leaves.len());
    for leaf in leaves {
        let corners = stored.about(simd, &stored.gather(simd, &leaf.faces), stored.place(leaf.anchor));
        let mut lanes = NO_CORNERS;
        lay_side_by_side(&corners, &mut lanes);
        made.push(lanes);
    }
    made.into()
}

#[inline(always)]
pub(super) fn lay_side_by_side<S: Simd>(corners: &[Lanes3<S>; 3], lanes: &mut CornerLanes) {
    for corner in 0..3 {
        store3(&corners[corner], &mut lanes[corner]);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use fearless_simd::dispatch;
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::hierarchy::HALF_ULP;
    use crate::mesh::Positions;
    use crate::mesh::frame::{Extremes, PACKING_ERROR, PackedFrame};
    use crate::mesh::positions::VertexSlice;
    use crate::simd::{Level, levels};
    use crate::volume::Aabb;

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

    #[test]
    fn a_packet_holds_its_triangles_and_its_leaf_bounds_them() {
        let mut rng = Rng::new(151);
        let mut ways = [0; 3];
        for round in 0..500 {
            let count = rng.integer(1, 8) as usize;
            let (centre, size) = ([0; 3].map(|_| rng.uniform(-9.0, 9.0)), 2.0_f64.powi(-(round % 20)));
            let mut vertices: Vec<[f64; 3]> =
                (0..24).map(|_| std::array::from_fn(|axis| centre[axis] + rng.uniform(-size, size))).collect();
            vertices.extend([[-10.0; 3], [10.0; 3]]);
            for positions in kinds(&vertices) {
                let faces: Vec<[u32; 3]> = (0..8).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                let held: Vec<u32> = (0..count as u32).rev().collect();
                let frame = frame_over(positions.slice());
                let packed =
                    |face: u32, corner: usize| frame.pack(positions.slice().get(faces[face as usize][corner] as usize));
                let bounds = held.iter().fold(Aabb::EMPTY, |bounds, &face| {
                    bounds.union(Aabb::of_points([0, 1, 2].map(|corner| packed(face, corner).map(|x| x as f32))))
                });
                let corners = Corners::of(positions.slice(), &faces, &frame);
                ways[match corners {
                    Corners::Single(_) => 0,
                    Corners::SingleWidened(_) => 1,
                    Corners::Double(_) => 2,
                }] += 1;
                let fitted = levels().into_iter().map(|(name, level)| {
                    let mut leaf = Leaf::holding(&held);
                    let (fitted, lanes) = dispatch!(level, simd => match &corners {
                        Corners::Single(stored) => fit(simd, &mut leaf, stored),
                        Corners::SingleWidened(stored) => fit(simd, &mut leaf, stored),
                        Corners::Double(stored) => fit(simd, &mut leaf, stored),
                    });
                    assert_eq!((leaf.held(), fitted), (&held[..], bounds.next_outward()), "{name}");
                    (name, leaf, lanes)
                });
                let fitted: Vec<(&str, Leaf, CornerLanes)> = fitted.collect();
                let (_, leaf, lanes) = fitted[0];
                for (name, other, other_lanes) in &fitted {
                    assert_eq!(bytemuck::bytes_of(other), bytemuck::bytes_of(&leaf), "{name}: other bits");
                    assert_eq!(bytemuck::bytes_of(other_lanes), bytemuck::bytes_of(&lanes), "{name}: other bits");
                }
                assert_eq!(leaf.lanes_in_use(), (1 << count) - 1);
                let normal = leaf.normal();
                assert!(normal.iter().any(|x| x.abs() > 0.99) && normal.iter().all(|x| x.abs() <= 1.0), "{normal:?}");
                let made = [OnceLock::new()];
                let packets = Packets { leaves: std::slice::from_ref(&leaf), made: &made, corners };
                let packet = dispatch!(Level::fallback(), simd => packets.get(simd, 0));
                assert_eq!(packet.corners, &lanes, "made as fitted");
                let ([x, y, z], [low, high]) = leaf.slab();
                for lane in 0..LANES {
                    let face = if lane < count { held[lane] } else { held[0] };
                    assert_eq!(leaf.faces[lane], face);
                    for corner in 0..3 {
                        let exact = packed(face, corner);
                        let mut about = [0.0; 3];
                        for axis in 0..3 {
                            let relative = lanes[corner][axis][lane];
                            assert!(relative.abs() <= leaf.radius);
                            about[axis] = exact[axis] - packet.anchor[axis];
                            let off = (f64::from(relative) - about[axis]).abs();
                            assert!(off <= HALF_ULP * f64::from(leaf.radius) + PACKING_ERROR, "off by {off}");
                        }
                        let height = x * about[0] + y * about[1] + z * about[2];
                        assert!(low <= height && height <= high, "{height} is not in {low}..{high}");
                    }
                }
                assert!(high - low < 8.0 * f64::from(leaf.radius), "a slab as thick as {}", high - low);
            }
        }
        assert_eq!(ways, [500; 3], "each way of gathering");
    }

    fn fit<S: Simd>(simd: S, leaf: &mut Leaf, stored: &impl StoredCorners) -> (Aabb, CornerLanes) {
        let (bounds, corners, _) = leaf.fit(simd, stored);
        let mut lanes = NO_CORNERS;
        lay_side_by_side(&corners, &mut lanes);
        (bounds, lanes)
    }
}

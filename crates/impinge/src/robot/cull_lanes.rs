//! Culls pairs of links in four configurations at a time.
//!
//! Spheres and capsules are compared as [`Culling`](super::cull::Culling) compares them. Convex
//! hulls are compared where capsules overlap.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use super::cull::{MAX_OFFSET, SLACK};
use super::frame::Frame;
use super::lanes::{FrameLanes, ROWS};
use super::model::Robot;
use super::proxy::{Proxy, Volumes};
use super::shell::{self, ROUNDING};
use crate::simd::{Level, by_axis, dispatch};

/// A vector in each lane.
type Vectors<S> = [f64x4<S>; 3];

/// A vector in each lane, in memory.
type VectorLanes = [[f64; ROWS]; 3];

/// What is compared in each configuration.
pub(super) struct Plan<'r> {
    proxies: &'r [Proxy],
    /// Pairs of links whose shapes may be somewhere.
    pairs: Vec<PlannedPair>,
    clearance: f64,
}

/// A pair of links.
struct PlannedPair {
    /// Index of the pair.
    number: u32,
    links: [u32; 2],
    /// Sum of the radii of the spheres; infinite if a shape may be anywhere.
    radii: f64,
}

/// Two pieces of links that may be near in some of the rows.
struct NearPieces {
    /// Index of the pair of links, and the links.
    pair: u32,
    links: [u32; 2],
    /// Indices of the capsules and hulls; `None` if nothing is known about a link.
    pieces: Option<[u8; 2]>,
    /// Rows in which capsules overlap, as bits.
    rows: u32,
    /// Vectors from the first core to the second.
    between: VectorLanes,
}

/// Pairs of links that may be near in four configurations.
#[derive(Default)]
pub(super) struct CullLanes {
    level: Option<Level>,
    spheres: Vec<VectorLanes>,
    /// Ends of the capsules of each link.
    limbs: Vec<Vec<[VectorLanes; 2]>>,
    is_placed: Vec<bool>,
    slack: [f64; ROWS],
    near: Vec<NearPieces>,
}

impl<'r> Plan<'r> {
    pub(super) fn new(robot: &'r Robot, clearance: f64) -> Self {
        let proxies = robot.proxies();
        let radius = |link: usize| match &proxies[link] {
            Proxy::Within(volumes) => Some(volumes.sphere.1),
            Proxy::Nowhere => None,
            Proxy::Anywhere => Some(f64::INFINITY),
        };
        let planned = |(number, &[a, b]): (usize, &[usize; 2])| {
            let radii = radius(a)? + radius(b)?;
            Some(PlannedPair { number: number as u32, links: [a as u32, b as u32], radii })
        };
        Self { proxies, pairs: robot.pairs().iter().enumerate().filter_map(planned).collect(), clearance }
    }

    fn volumes(&self, link: u32) -> Option<&'r Volumes> {
        match &self.proxies[link as usize] {
            Proxy::Within(volumes) => Some(volumes),
            Proxy::Nowhere | Proxy::Anywhere => None,
        }
    }
}

impl CullLanes {
    /// Finds the pieces that may be near in four configurations.
    pub(super) fn start(&mut self, level: Level, plan: &Plan<'_>, frames: &[FrameLanes]) {
        self.level = Some(level);
        dispatch!(level, simd => self.find(simd, plan, frames));
    }

    #[inline(always)]
    fn find<S: Simd>(&mut self, simd: S, plan: &Plan<'_>, frames: &[FrameLanes]) {
        self.near.clear();
        self.spheres.clear();
        self.limbs.resize(frames.len(), Vec::new());
        self.is_placed.clear();
        self.is_placed.resize(frames.len(), false);
        let mut offset = f64x4::splat(simd, 0.0);
        for (proxy, frame) in plan.proxies.iter().zip(frames) {
            let center = if let Proxy::Within(volumes) = proxy { volumes.sphere.0 } else { [0.0; 3] };
            self.spheres.push(apply(simd, frame, center).map(Into::into));
            let [x, y, z]: Vectors<S> = by_axis!(axis => f64x4::from_slice(simd, &frame[axis][3]).abs());
            let size = x + y + z;
            // A sum that is not a number stays one.
            offset = size.simd_le(offset).select(offset, size);
        }
        let is_in_range = offset.simd_le(MAX_OFFSET);
        let slack = is_in_range.select(offset * SLACK, f64x4::splat(simd, f64::INFINITY));
        self.slack = slack.into();
        let margin = slack + plan.clearance;
        for pair in &plan.pairs {
            let [p, q] = pair.links.map(|link| &self.spheres[link as usize]);
            let (p, q) = (vectors(simd, p), vectors(simd, q));
            let between = sub(&q, &p);
            let reach = margin + pair.radii;
            let is_far = dot(&between, &between).simd_gt(reach * reach * ROUNDING + f64::MIN_POSITIVE);
            let rows = !(is_far.to_bitmask() as u32) & ((1 << ROWS) - 1);
            if rows != 0 {
                self.compare_pieces(simd, plan, frames, pair, rows, margin);
            }
        }
    }

    /// Compares the capsules of two links.
    #[inline(always)]
    fn compare_pieces<S: Simd>(
        &mut self,
        simd: S,
        plan: &Plan<'_>,
        frames: &[FrameLanes],
        pair: &PlannedPair,
        rows: u32,
        margin: f64x4<S>,
    ) {
        let links = pair.links;
        let [Some(a), Some(b)] = links.map(|link| plan.volumes(link)) else {
            let between = [[0.0; ROWS]; 3];
            self.near.push(NearPieces { pair: pair.number, links, pieces: None, rows, between });
            return;
        };
        for (link, volumes) in links.into_iter().zip([a, b]) {
            self.place(simd, link as usize, volumes, frames);
        }
        let [limbs_a, limbs_b] = links.map(|link| &self.limbs[link as usize]);
        for (i, (limb_a, capsule_a)) in limbs_a.iter().zip(&a.capsules).enumerate() {
            for (j, (limb_b, capsule_b)) in limbs_b.iter().zip(&b.capsules).enumerate() {
                let reach = margin + (capsule_a.radius() + capsule_b.radius());
                let [p, p_end] = [vectors(simd, &limb_a[0]), vectors(simd, &limb_a[1])];
                let [q, q_end] = [vectors(simd, &limb_b[0]), vectors(simd, &limb_b[1])];
                let between = nearest_offset(simd, [&p, &p_end], [&q, &q_end]);
                // Heights above the first end of the first core, which is at zero.
                let along = dot(&between, &sub(&p_end, &p));
                let [start, end] = [dot(&between, &sub(&q, &p)), dot(&between, &sub(&q_end, &p))];
                let gap = start.min(end) - along.max(f64x4::splat(simd, 0.0));
                let least = reach * reach * dot(&between, &between) * ROUNDING + f64::MIN_POSITIVE;
                let is_apart = gap.simd_gt(0.0) & (gap * gap).simd_gt(least);
                let rows = rows & !(is_apart.to_bitmask() as u32);
                if rows != 0 {
                    let (pieces, between) = (Some([i as u8, j as u8]), between.map(Into::into));
                    self.near.push(NearPieces { pair: pair.number, links, pieces, rows, between });
                }
            }
        }
    }

    /// Computes the capsules of a link.
    #[inline(always)]
    fn place<S: Simd>(&mut self, simd: S, link: usize, volumes: &Volumes, frames: &[FrameLanes]) {
        if std::mem::replace(&mut self.is_placed[link], true) {
            return;
        }
        let limbs = &mut self.limbs[link];
        limbs.clear();
        for capsule in &volumes.capsules {
            let [start, end] = capsule.ends();
            let (start, end) = (apply(simd, &frames[link], start), apply(simd, &frames[link], end));
            limbs.push([start.map(Into::into), end.map(Into::into)]);
        }
    }

    /// Returns the indices of the pairs that may be near in a row, in ascending order.
    pub(super) fn near<'s>(
        &'s self,
        lane: usize,
        plan: &'s Plan<'_>,
        frame: impl Fn(usize) -> Frame + 's,
    ) -> impl Iterator<Item = usize> + 's {
        let margin = plan.clearance + self.slack[lane];
        let is_same_pair = |a: &NearPieces, b: &NearPieces| a.pair == b.pair;
        self.near.chunk_by(is_same_pair).filter_map(move |all| {
            let mut frames = None;
            let may_be_near = |near: &NearPieces| {
                let [Some(a), Some(b)] = near.links.map(|link| plan.volumes(link)) else { return true };
                let Some(([i, j], level)) = near.pieces.zip(self.level) else { return true };
                let [frame_a, frame_b] = *frames.get_or_insert_with(|| near.links.map(|link| frame(link as usize)));
                let (Some(a), Some(b)) = (&a.shells[i as usize], &b.shells[j as usize]) else { return true };
                let between = near.between.map(|lanes| lanes[lane]);
                !shell::are_apart(level, (a, &frame_a), (b, &frame_b), between, margin)
            };
            let mut in_row = all.iter().filter(|near| near.rows >> lane & 1 != 0);
            in_row.any(may_be_near).then_some(all[0].pair as usize)
        })
    }
}

#[inline(always)]
fn vectors<S: Simd>(simd: S, lanes: &VectorLanes) -> Vectors<S> {
    by_axis!(axis => f64x4::from_slice(simd, &lanes[axis]))
}

/// Returns the images of a point, with the roundings of [`Frame::apply`].
#[inline(always)]
fn apply<S: Simd>(simd: S, frame: &FrameLanes, [x, y, z]: [f64; 3]) -> Vectors<S> {
    by_axis!(axis => {
        let [a, b, c, t] = &frame[axis];
        f64x4::from_slice(simd, a) * x + f64x4::from_slice(simd, b) * y + f64x4::from_slice(simd, c) * z
            + f64x4::from_slice(simd, t)
    })
}

#[inline(always)]
fn sub<S: Simd>(p: &Vectors<S>, q: &Vectors<S>) -> Vectors<S> {
    by_axis!(axis => p[axis] - q[axis])
}

/// Returns the products of vectors. They are not fused, so they are the same on every vector unit.
#[inline(always)]
fn dot<S: Simd>(p: &Vectors<S>, q: &Vectors<S>) -> f64x4<S> {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

/// Returns the vectors between nearest points of two segments, as the function of the same name for
/// one configuration does.
#[inline(always)]
fn nearest_offset<S: Simd>(simd: S, [p, p_end]: [&Vectors<S>; 2], [q, q_end]: [&Vectors<S>; 2]) -> Vectors<S> {
    let (d, e, r) = (sub(p_end, p), sub(q_end, q), sub(p, q));
    let (a, b, c, f, g) = (dot(&d, &d), dot(&d, &e), dot(&d, &r), dot(&e, &r), dot(&e, &e));
    let s = ratio(simd, b * f - c * g, a * g - b * b);
    let t = ratio(simd, b * s + f, g);
    // With t clamped, this s is the best for it.
    let s = ratio(simd, b * t - c, a);
    by_axis!(axis => (q[axis] + t * e[axis]) - (p[axis] + s * d[axis]))
}

/// Returns `x / y` from 0 to 1, or 0 if `y` is zero.
#[inline(always)]
fn ratio<S: Simd>(simd: S, x: f64x4<S>, y: f64x4<S>) -> f64x4<S> {
    let zero = f64x4::splat(simd, 0.0);
    let ratio = (x / y).max(zero).min(f64x4::splat(simd, 1.0));
    y.simd_gt(zero).select(ratio, zero)
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::query::{self, Proximity};
    use crate::robot::JointKind;
    use crate::robot::cull::Culling;
    use crate::robot::cull::tests::chain;
    use crate::robot::lanes;
    use crate::simd::levels;

    #[test]
    fn four_rows_are_culled_as_single_rows_are_and_pairs_left_out_are_apart() {
        let mut rng = Rng::new(3);
        let (mut culled, mut apart, mut by_hulls, mut touching) = (0, 0, 0, 0);
        let (mut culling, mut of_four) = (Culling::default(), CullLanes::default());
        let (mut lanes_of_frames, mut frames) = (Vec::new(), Vec::new());
        for _ in 0..60 {
            let robot = chain(&mut rng, 6);
            let step = |kind| if kind == JointKind::Prismatic { 0.25 } else { std::f64::consts::FRAC_PI_4 };
            let rows: [Vec<f64>; ROWS] = std::array::from_fn(|_| {
                robot.joints().iter().map(|joint| step(joint.kind) * rng.integer(-4, 4) as f64).collect()
            });
            let clearance = [0.0, 0.25][rng.integer(0, 1) as usize];
            let plan = Plan::new(&robot, clearance);
            for (name, level) in levels() {
                lanes::place(level, &robot, rows.each_ref().map(Vec::as_slice), &mut lanes_of_frames);
                of_four.start(level, &plan, &lanes_of_frames);
                for (lane, row) in rows.iter().enumerate() {
                    robot.place(row, &mut frames);
                    culling.start(robot.proxies(), &frames);
                    let near: Vec<usize> = of_four.near(lane, &plan, |link| frames[link]).collect();
                    assert!(near.is_sorted());
                    for (at, &pair) in robot.pairs().iter().enumerate() {
                        let by_capsules = culling.are_apart(pair, clearance, robot.proxies(), &frames);
                        let is_near = near.contains(&at);
                        assert!(!(by_capsules && is_near), "{name} {pair:?} {row:?}");
                        let has_near_pieces =
                            |near: &NearPieces| near.pair as usize == at && near.rows >> lane & 1 != 0;
                        assert_eq!(by_capsules, !of_four.near.iter().any(has_near_pieces), "{name} {pair:?} {row:?}");
                        let placed = pair.map(|link| {
                            let pose = frames[link].pose().expect("a pose");
                            robot.links()[link].shape.as_ref().expect("a shape").at(pose).expect("a place")
                        });
                        let found = query::nearness(&placed[0], &placed[1], clearance);
                        assert!(is_near || found == Proximity::Apart, "{name} {pair:?} {row:?}");
                        by_hulls += usize::from(!is_near && !by_capsules);
                        culled += usize::from(!is_near);
                        apart += usize::from(found == Proximity::Apart);
                        let distance = query::distance(&placed[0], &placed[1]);
                        touching += usize::from((distance.upper - clearance).abs() < 1e-9);
                    }
                }
            }
        }
        assert!(culled * 10 > apart * 9, "{culled} of {apart}");
        assert!(by_hulls > 50, "{by_hulls} of {apart}");
        assert!(touching > 50, "{touching}");
    }
}

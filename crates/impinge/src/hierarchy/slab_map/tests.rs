//! Transformed slabs against exact rational heights.

use crate::simd::dispatch_every;
use bytemuck::Zeroable;
use dashu_ratio::Relaxed;
use impinge_testkit::generate::Rng;

use super::super::tests::maps::{any_linear, coarse, exact};
use super::*;
use crate::simd::{LANES, kernel_levels};

/// A map, boxes in its source, and a slab in its target that ends at the image of one box, or near
/// it.
struct Trial {
    linear: [[f64; 3]; 3],
    translation: [f64; 3],
    error: [f64; 3],
    node: Node,
    slab: Slab,
}

impl Trial {
    fn new(rng: &mut Rng, gap: f64) -> Self {
        let mut linear = any_linear(rng);
        if rng.one_in(4) {
            linear = linear.map(|row| row.map(|x| x * 2.0_f64.powi(rng.integer(-20, 20) as i32)));
        }
        let size = linear.as_flattened().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let translation = [0; 3].map(|_| coarse(rng) * size);
        let error = if rng.one_in(2) { [0.0; 3] } else { [0; 3].map(|_| rng.uniform(0.0, 1e-5) * size) };
        let mut node = Node::zeroed();
        for axis in 0..3 {
            for lane in 0..LANES {
                let (p, q) = (coarse(rng) as f32, coarse(rng) as f32);
                (node.min[axis][lane], node.max[axis][lane]) = (p.min(q), p.max(q));
            }
        }
        let normal = [0; 3].map(|_| coarse(rng) as f32);
        let mut trial = Self { linear, translation, error, node, slab: Slab { normal, min: 0.0, max: 0.0 } };
        let [low, high] = trial.heights(0).map(|height| height.to_f64_fast());
        // Above the box, or below it.
        let (low, high) = if rng.one_in(2) { (high + gap * size, high + size) } else { (low - size, low - gap * size) };
        trial.slab.min = low as f32;
        trial.slab.max = high as f32;
        trial
    }

    /// Returns the minimum and the maximum height of one box's images under all maps within the
    /// error.
    fn heights(&self, lane: usize) -> [Relaxed; 2] {
        let normal = self.slab.normal.map(|x| exact(f64::from(x)));
        let (mut low, mut high) = (Relaxed::ZERO, Relaxed::ZERO);
        for axis in 0..3 {
            let moved = &normal[axis] * exact(self.translation[axis]);
            let off = exact(f64::from(self.slab.normal[axis].abs()) * self.error[axis]);
            low += moved.clone() - &off;
            high += moved + &off;
        }
        for from in 0..3 {
            let slope = (0..3).fold(Relaxed::ZERO, |sum, axis| sum + &normal[axis] * exact(self.linear[axis][from]));
            let ends = [self.node.min[from][lane], self.node.max[from][lane]].map(|x| exact(f64::from(x)) * &slope);
            let [p, q] = ends;
            let (least, greatest) = if p < q { (p, q) } else { (q, p) };
            low += least;
            high += greatest;
        }
        [low, high]
    }

    /// Returns the number of boxes reported outside the slab, over all vector levels. Asserts that
    /// they are.
    fn missed(&self) -> usize {
        let map = SlabMap::new(&self.linear, &self.translation, &self.error, 1.0);
        let mut missed = 0;
        for (name, level) in kernel_levels() {
            let outside = dispatch_every!(level, simd => map.carry(simd, &self.slab).outside(simd, &self.node));
            for lane in (0..LANES).filter(|&lane| outside >> lane & 1 == 1) {
                let [low, high] = self.heights(lane);
                let (min, max) = (exact(f64::from(self.slab.min)), exact(f64::from(self.slab.max)));
                assert!(low > max || high < min, "{name}: box {lane} intersects the slab");
                missed += 1;
            }
        }
        missed
    }
}

#[test]
fn boxes_reported_outside_are_outside() {
    let mut rng = Rng::new(131);
    let (mut touching, mut clear) = (0, 0);
    for round in 0..3_000 {
        // In these cases the slab touches box 0, or passes it by less than single precision can
        // resolve.
        let gap = [0.0, 1e-9, 1e-7, 1e-6, 1e-2][round % 5];
        let trial = Trial::new(&mut rng, gap);
        let missed = trial.missed();
        *(if round % 5 == 4 { &mut clear } else { &mut touching }) += missed;
    }
    assert!(touching > 3_000 && clear > 3_000, "{touching} and {clear} boxes were missed");
}

#[test]
fn the_slack_is_small() {
    // Boxes of size 1e-3 are proved outside a slab that is 1e-5 away.
    let map = SlabMap::new(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &[0.0; 3], &[0.0; 3], 1.0);
    let mut node = Node::zeroed();
    for axis in 0..3 {
        node.max[axis] = [1e-3; LANES];
    }
    let slab = Slab { normal: [0.0, 0.0, 1.0], min: 1e-3 + 1e-5, max: 1.0 };
    for (name, level) in kernel_levels() {
        let outside = dispatch_every!(level, simd => map.carry(simd, &slab).outside(simd, &node));
        assert_eq!(outside, 0xff, "{name}");
        let all = dispatch_every!(level, simd => map.carry(simd, &Slab::ALL).outside(simd, &node));
        assert_eq!(all, 0, "{name}: nothing is outside all of space");
    }
}

#[test]
fn overflow_proves_nothing() {
    let map = SlabMap::new(&[[1e30; 3]; 3], &[1e38; 3], &[f64::INFINITY; 3], 1.0);
    let slab = Slab { normal: [1.0; 3], min: -1.0, max: 1.0 };
    for (name, level) in kernel_levels() {
        assert_eq!(dispatch_every!(level, simd => map.carry(simd, &slab).outside(simd, &Node::zeroed())), 0, "{name}");
    }
}

#[test]
fn maps_beyond_single_precision_prove_nothing() {
    // Nearly along the planes, so the origin is lifted by 10. The factors exceed single precision.
    let map = SlabMap::new(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &[1e39, 0.0, 0.0], &[0.0; 3], 1.0);
    let slab = Slab { normal: [1e-38, 1.0, 0.0], min: 9.0, max: 11.0 };
    for (name, level) in kernel_levels() {
        let outside = dispatch_every!(level, simd => map.carry(simd, &slab).outside(simd, &Node::zeroed()));
        assert_eq!(outside, 0, "{name}");
    }
}

/// Returns the identity map, for boxes in the unit cube.
fn identity() -> SlabMap {
    SlabMap::new(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &[0.0; 3], &[0.0; 3], 1.0)
}

/// Returns a slab with this normal that contains a point near one of its planes, and extends from
/// it by `thickness`.
fn slab_at(point: [f32; 3], normal: [f32; 3], thickness: f32) -> Slab {
    let height: f64 = (0..3).map(|axis| f64::from(normal[axis]) * f64::from(point[axis])).sum();
    let nearest = height as f32;
    let low = if f64::from(nearest) > height { nearest.next_down() } else { nearest };
    let high = if f64::from(nearest) < height { nearest.next_up() } else { nearest };
    if thickness > 0.0 {
        Slab { normal, min: low, max: high + thickness }
    } else {
        Slab { normal, min: low + thickness, max: high }
    }
}

#[test]
fn points_in_both_slabs_are_in_the_difference_slab() {
    let mut rng = Rng::new(132);
    let (mut facing, mut missed) = (0, 0);
    for _ in 0..4_000 {
        let mut node = Node::zeroed();
        let size = 2.0_f32.powi(-(rng.integer(0, 8) as i32));
        for axis in 0..3 {
            for lane in 0..LANES {
                let (p, q) = (coarse(&mut rng) as f32 * size, coarse(&mut rng) as f32 * size);
                (node.min[axis][lane], node.max[axis][lane]) = (p.min(q), p.max(q));
            }
        }
        // A corner of a box: no other point of the box lies farther out.
        let lane = rng.integer(0, LANES as i64 - 1) as usize;
        let point: [f32; 3] =
            std::array::from_fn(|axis| if rng.one_in(2) { node.min[axis][lane] } else { node.max[axis][lane] });
        let normal: [f32; 3] = if rng.one_in(3) {
            std::array::from_fn(|_| coarse(&mut rng) as f32)
        } else {
            std::array::from_fn(|_| rng.uniform(-1.0, 1.0) as f32)
        };
        let turned = 2.0_f64.powi(-(rng.integer(2, 20) as i32));
        let length = rng.choose(&[1.0, -1.0, 0.5]);
        let other = normal.map(|x| (f64::from(x) * length + turned * coarse(&mut rng)).clamp(-1.0, 1.0) as f32);
        let thickness = |rng: &mut Rng| (rng.choose(&[1.0, -1.0]) * 2.0_f64.powi(-(rng.integer(0, 20) as i32))) as f32;
        let carried = slab_at(point, normal, thickness(&mut rng));
        let own = slab_at(point, other, thickness(&mut rng));
        let Some(difference) = identity().difference(&carried, &own) else { continue };
        facing += 1;
        for (name, level) in kernel_levels() {
            let outside = dispatch_every!(level, simd => difference.outside(simd, &node));
            assert_eq!(outside >> lane & 1, 0, "{name}: {point:?} in {carried:?} and {own:?}");
            missed += outside.count_ones();
        }
    }
    assert!(facing > 2_000 && missed > 5_000, "{facing} pairs of slabs, {missed} boxes missed");
}

#[test]
fn difference_slabs_cull_boxes_that_lie_in_both_slabs() {
    let normal = [0.6, 0.5, 0.6];
    let mut node = Node::zeroed();
    for axis in 0..3 {
        node.max[axis] = [1e-2; LANES];
    }
    let own = Slab { normal, min: 8e-3, max: 8.1e-3 };
    let carried = Slab { normal: [0.6, 0.503, 0.599], min: 8.2e-3, max: 8.3e-3 };
    let difference = identity().difference(&carried, &own).expect("they face the same way");
    for (name, level) in kernel_levels() {
        let outside = dispatch_every!(level, simd => [own, carried, difference].map(|slab| slab.outside(simd, &node)));
        assert_eq!(outside, [0, 0, 0xff], "{name}");
    }
    assert_eq!(identity().difference(&carried, &Slab::ALL), None);
    assert_eq!(identity().difference(&Slab { normal: [0.6, -0.5, 0.6], ..carried }, &own), None);
}

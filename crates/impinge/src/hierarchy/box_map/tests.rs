//! Transformed boxes against exact rational images.

use crate::simd::dispatch_every;
use bytemuck::Zeroable;
use dashu_ratio::Relaxed;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::rotation;

use super::super::tests::maps::exact;
use super::*;
use crate::hierarchy::lanes::{overlapping_each, overlapping_pairs};
use crate::simd::{LANES, Level, kernel_levels, load3};

const REACH: f64 = 1.0;

/// A map, and eight boxes within reach.
#[derive(Clone, Debug)]
struct Trial {
    linear: [[f64; 3]; 3],
    translation: [f64; 3],
    error: [f64; 3],
    node: Node,
}

impl Trial {
    /// Asserts at one vector level that each box encloses its image under every map within the
    /// error. Returns the part of the slack that rounding took, in units of u S.
    fn taken(&self, level: Level) -> f64 {
        let map = BoxMap::new(&self.linear, &self.translation, &self.error, REACH);
        let node = &self.node;
        let boxes = dispatch_every!(level, simd => map.apply(simd, node));
        let mut most = 0.0_f64;
        for axis in 0..3 {
            let size = self.linear[axis].iter().map(|x| x.abs()).sum::<f64>() * REACH + self.translation[axis].abs();
            let row = self.linear[axis].map(exact);
            let error = exact(self.error[axis]);
            for lane in 0..LANES {
                let mut low = exact(self.translation[axis]) - &error;
                let mut high = exact(self.translation[axis]) + &error;
                for from in 0..3 {
                    let [p, q] = [node.min[from][lane], node.max[from][lane]].map(|x| exact(f64::from(x)) * &row[from]);
                    let (least, greatest) = if p < q { (p, q) } else { (q, p) };
                    low += least;
                    high += greatest;
                }
                let [min, max] = [boxes.min[axis][lane], boxes.max[axis][lane]].map(|x| exact(f64::from(x)));
                for margin in [low - min, max - high] {
                    assert!(margin >= Relaxed::ZERO, "axis {axis}, lane {lane}: {self:?}");
                    let taken = exact(f64::from(map.slack[axis])) - &error - margin;
                    most = most.max(taken.to_f64_fast() / (HALF_ULP * size));
                }
            }
        }
        most
    }

    fn taken_at_any_level(&self) -> f64 {
        kernel_levels().into_iter().map(|(_, level)| self.taken(level)).fold(0.0, f64::max)
    }
}

/// Returns a number whose rounding error in single precision is nearly the largest possible.
fn near_tie(rng: &mut Rng) -> f64 {
    let units = rng.integer(0, 8) as f64 + 0.5 + rng.choose(&[-1.0, 0.0, 1.0]) / 1024.0;
    rng.choose(&[-1.0, 1.0]) * (1.0 + units * 2.0 * HALF_ULP)
}

/// Returns a coordinate of a box, at most [`REACH`] in magnitude.
fn coordinate(rng: &mut Rng) -> f32 {
    let x = match rng.integer(0, 5) {
        0 => rng.choose(&[0.0, 1.0]),
        1 => 1.0 - rng.integer(0, 9) as f64 * HALF_ULP,
        2 => 0.5 + rng.integer(-9, 9) as f64 * HALF_ULP,
        3 => rng.integer(1, 9) as f64 * HALF_ULP,
        4 => rng.unit() * 2.0_f64.powi(-rng.integer(0, 30) as i32),
        _ => rng.unit(),
    };
    x.copysign(rng.choose(&[-1.0, 1.0])) as f32
}

fn set_interval(node: &mut Node, axis: usize, lane: usize, rng: &mut Rng) {
    let p = coordinate(rng);
    let q = if rng.one_in(4) { p } else { coordinate(rng) };
    node.min[axis][lane] = p.min(q);
    node.max[axis][lane] = p.max(q);
}

fn entry(rng: &mut Rng) -> f64 {
    match rng.integer(0, 3) {
        0 => 0.0,
        1 => rng.uniform(-1.0, 1.0),
        _ => near_tie(rng) * 2.0_f64.powi(-rng.integer(0, 12) as i32),
    }
}

fn trial(rng: &mut Rng) -> Trial {
    let mut node = Node::zeroed();
    for axis in 0..3 {
        for lane in 0..LANES {
            set_interval(&mut node, axis, lane, rng);
        }
    }
    let linear: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| entry(rng)));
    Trial { linear, translation: [0; 3].map(|_| entry(rng)), error: [0.0; 3], node }
}

#[test]
fn moved_boxes_contain_the_exact_images() {
    let mut rng = Rng::new(72);
    for round in 0..600 {
        let mut trial = trial(&mut rng);
        match round % 4 {
            // A rotation, far from the origin or near it.
            0 => {
                trial.linear = rotation(&mut rng).linear;
                let far = 2.0_f64.powi(rng.integer(-30, 40) as i32);
                trial.translation = trial.translation.map(|x| x * far);
            }
            // A shear.
            1 => {
                trial.linear = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                trial.linear[0][1] = near_tie(&mut rng) * 2.0_f64.powi(rng.integer(-60, 60) as i32);
            }
            // Each axis scaled by its own power of two, also below the range of single precision.
            2 => {
                let scales = [0; 3].map(|_| 2.0_f64.powi(rng.integer(-60, 60) as i32));
                trial.linear = trial.linear.map(|row| std::array::from_fn(|k| row[k] * scales[k]));
            }
            _ => {
                let scale = 2.0_f64.powi(rng.integer(-200, 99) as i32);
                trial.linear = trial.linear.map(|row| row.map(|x| x * scale));
                trial.translation = trial.translation.map(|x| x * scale);
            }
        }
        // From zero to far more than the image.
        for axis in 0..3 {
            let size = trial.linear[axis].iter().map(|x| x.abs()).sum::<f64>() + trial.translation[axis].abs();
            trial.error[axis] = match rng.integer(0, 3) {
                0 => 0.0,
                _ => (size * rng.unit() * 2.0_f64.powi(rng.integer(-30, 12) as i32)).min(2.0_f64.powi(100)),
            };
        }
        trial.taken_at_any_level();
    }
}

/// The rounding bound is neither broken nor far too large: an input bred for bad rounding takes a
/// third of it.
#[test]
fn rounding_error_stays_within_its_bound() {
    // The best of 60 seeds.
    let mut rng = Rng::new(38);
    let mut best = trial(&mut rng);
    // Bred at the one vector level that every processor has.
    let mut most = best.taken(Level::fallback());
    for _ in 0..3_000 {
        let mut bred = best.clone();
        for _ in 0..rng.integer(1, 3) {
            let (row, column) = (rng.integer(0, 2) as usize, rng.integer(0, 2) as usize);
            let nudge = 1.0 + rng.integer(-64, 64) as f64 * HALF_ULP / 8.0;
            match rng.integer(0, 4) {
                0 => bred.linear[row][column] = entry(&mut rng),
                1 => bred.translation[row] = entry(&mut rng),
                2 => bred.linear[row][column] *= nudge,
                3 => bred.translation[row] *= nudge,
                _ => (0..LANES).for_each(|lane| set_interval(&mut bred.node, column, lane, &mut rng)),
            }
        }
        let taken = bred.taken(Level::fallback());
        if taken >= most {
            (best, most) = (bred, taken);
        }
    }
    let worst = best.taken_at_any_level();
    assert!((5.5..=16.0).contains(&worst), "{worst} u S");
}

/// For any choice of pairs, and for boxes with common faces.
#[test]
fn chosen_pairs_overlap_as_all_pairs_do() {
    let mut rng = Rng::new(91);
    let boxes = |rng: &mut Rng| {
        let mut node = Node::zeroed();
        for axis in 0..3 {
            for lane in 0..LANES {
                let [p, q] = [0; 2].map(|_| rng.integer(0, 4) as f32);
                (node.min[axis][lane], node.max[axis][lane]) = (p.min(q), p.max(q));
            }
        }
        BoxLanes { min: node.min, max: node.max }
    };
    let mut overlapping = 0;
    for _ in 0..300 {
        let (one, many) = (boxes(&mut rng), boxes(&mut rng));
        let rows = (0..rng.integer(0, 8)).fold(0, |rows, _| rows | 0xff << (8 * rng.integer(0, 7)));
        let pairs = rng.next_u64() & rows;
        for (name, level) in kernel_levels() {
            let [each, some] = dispatch_every!(level, simd => {
                let one = (&load3(simd, &one.min), &load3(simd, &one.max));
                [overlapping_each(simd, one, &many), overlapping_pairs(simd, one, &many, pairs)]
            });
            assert_eq!(some, each & pairs, "{name}");
            overlapping += some.count_ones();
        }
    }
    assert!(overlapping > 1000, "{overlapping}");
}

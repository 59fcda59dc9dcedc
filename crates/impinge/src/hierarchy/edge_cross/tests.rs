//! Crossing segments, exactly transformed. They are the boxes for which an edge-cross axis has the
//! least room.

use crate::simd::dispatch_every;
use dashu_ratio::Relaxed;
use impinge_testkit::generate::Rng;

use super::super::lanes::BoxLanes;
use super::super::tests::maps::{any_linear, coarse, exact};
use super::*;
use crate::simd::{LANES, kernel_levels};

/// A map, and eight boxes of the host and eight of the guest, each thin and along an axis. Box `i`
/// of the guest passes box `i` of the host at a distance of `gap`.
struct Trial {
    linear: [[f64; 3]; 3],
    translation: [f64; 3],
    error: f64,
    host: Node,
    guest: Node,
}

impl Trial {
    fn new(rng: &mut Rng, gap: f64, largest_error: f64) -> Self {
        let mut linear = any_linear(rng);
        if rng.one_in(4) {
            linear = linear.map(|row| row.map(|x| x * 2.0_f64.powi(rng.integer(-20, 0) as i32)));
        }
        let size = linear.as_flattened().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let translation = [0; 3].map(|_| coarse(rng) * size);
        let error = if rng.one_in(2) { 0.0 } else { rng.uniform(0.0, largest_error) * size };
        let (mut host, mut guest) = (BoxLanes::default(), BoxLanes::default());
        for lane in 0..LANES {
            let along = [0; 2].map(|_| rng.integer(0, 2) as usize);
            let place = [0; 3].map(|_| coarse(rng) as f32);
            // Within the map's error, and a gap away along the edge-cross axis.
            let across = cross(along[0], &linear.map(|row| row[along[1]]));
            let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
            for axis in 0..3 {
                let long = if axis == along[1] { rng.unit() as f32 } else { 0.0 };
                (guest.min[axis][lane], guest.max[axis][lane]) = (place[axis] - long, place[axis] + long);
                let terms = (0..3).map(|from| exact(linear[axis][from]) * exact(f64::from(place[from])));
                let image = terms.fold(exact(translation[axis]), |sum, term| sum + term)
                    + exact(rng.choose(&[-error, 0.0, error]))
                    + exact(if length > 0.0 { gap * size * across[axis] / length } else { 0.0 });
                let long = if axis == along[0] { rng.unit() as f32 } else { 0.0 };
                let [low, high] = around(&image);
                (host.min[axis][lane], host.max[axis][lane]) = (low - long, high + long);
            }
        }
        Self { linear, translation, error, host: Node::of_leaves(&host), guest: Node::of_leaves(&guest) }
    }

    /// Returns the number of lanes whose boxes are proved apart, summed over all vector levels.
    fn apart(&self) -> usize {
        // The translation may move boxes beyond a reach of 1.
        let edge_cross = EdgeCrossAxes::new(&self.linear, &self.translation, self.error, 8.0);
        let apart = |(_, level)| {
            let near = dispatch_every!(level, simd => edge_cross.near(simd, &self.host, &self.guest, u64::MAX));
            (0..LANES).filter(|lane| near >> (LANES * lane + lane) & 1 == 0).count()
        };
        kernel_levels().into_iter().map(apart).sum()
    }
}

/// Returns the unit vector of an axis crossed with a vector.
fn cross(axis: usize, v: &[f64; 3]) -> [f64; 3] {
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut product = [0.0; 3];
    product[next] = -v[last];
    product[last] = v[next];
    product
}

/// Returns the single-precision numbers just below and above `x`, or `x` twice.
fn around(x: &Relaxed) -> [f32; 2] {
    let near = x.to_f64_fast() as f32;
    let (mut low, mut high) = (near, near);
    while exact(f64::from(low)) > *x {
        low = low.next_down();
    }
    while exact(f64::from(high)) < *x {
        high = high.next_up();
    }
    [low, high]
}

#[test]
fn intersecting_boxes_are_never_culled() {
    let mut rng = Rng::new(311);
    for _ in 0..2_000 {
        assert_eq!(Trial::new(&mut rng, 0.0, 0.1).apart(), 0);
    }
}

/// A gap of 1e-3 exceeds errors of 1e-5 and rounding.
#[test]
fn crossing_boxes_with_a_gap_are_culled() {
    let mut rng = Rng::new(312);
    let found: usize = (0..500).map(|_| Trial::new(&mut rng, 1e-3, 1e-5).apart()).sum();
    let all = 500 * LANES * kernel_levels().len();
    // The other pairs are parallel, or nearly so.
    assert!(found * 10 > all * 8, "{found} of {all}");
}

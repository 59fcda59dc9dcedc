//! Errors of determinants in single precision.

use impinge_testkit::generate::Rng;

use super::super::classify::{Triangle, bound};
use super::super::*;
use super::{Point, exact, power_of_two, unit_point};
use crate::simd::{Level, cross, dispatch, levels};

/// Eight triangles with exactly known corners.
type Lanes8 = [[[f32; 3]; 3]; LANES];

fn in_lanes<S: Simd>(simd: S, triangles: &Lanes8) -> Triangle<S> {
    let mut lanes = [[[0.0; LANES]; 3]; 3];
    for (lane, triangle) in triangles.iter().enumerate() {
        for corner in 0..3 {
            for axis in 0..3 {
                lanes[corner][axis][lane] = triangle[corner][axis];
            }
        }
    }
    let corners: [Lanes3<S>; 3] = by_axis!(corner => load3(simd, &lanes[corner]));
    let (min, max) = bounds(&corners);
    Triangle { corners, width: width(&min, &max) }
}

/// The determinants that decide, each by its points `[p, q, r, s, t]`: (e from p to q) × (f from r
/// to s) · (d from p to t). Points 0 to 2 are the corners of the host, 3 to 5 those of the guest.
const DETERMINANTS: [[usize; 5]; 4] = [[0, 1, 0, 2, 3], [0, 1, 0, 2, 5], [3, 4, 3, 5, 2], [0, 1, 3, 4, 3]];

fn determinant<T>(points: &[[T; 3]; 6], which: [usize; 5]) -> T
where
    T: Clone + std::ops::Sub<Output = T> + std::ops::Mul<Output = T> + std::ops::Add<Output = T>,
{
    let [p, q, r, s, t] = which;
    let sub = |a: usize, b: usize| -> [T; 3] {
        std::array::from_fn(|axis| points[a][axis].clone() - points[b][axis].clone())
    };
    let (e, f, d) = (sub(q, p), sub(s, r), sub(t, p));
    let minor = |j: usize, k: usize| e[j].clone() * f[k].clone() - e[k].clone() * f[j].clone();
    minor(1, 2) * d[0].clone() + minor(2, 0) * d[1].clone() + minor(0, 1) * d[2].clone()
}

/// Returns the determinants of each lane in single precision, with their bounds and the unit of
/// rounding, u X Z Y.
fn determinants(level: Level, host: &Lanes8, guest: &Lanes8, error: f32) -> [[[f32; LANES]; 3]; 4] {
    let mut found = [[[0.0; LANES]; 3]; 4];
    dispatch!(level, simd => {
        let (h, g) = (in_lanes(simd, host), in_lanes(simd, guest));
        let points = [h.corners[0], h.corners[1], h.corners[2], g.corners[0], g.corners[1], g.corners[2]];
        let error = f32x8::splat(simd, error);
        let margin = error * 4.0;
        let (x, z, y) = (h.width + margin, g.width + margin, h.width + g.width + margin + margin);
        for (which, [values, limits, units]) in DETERMINANTS.into_iter().zip(&mut found) {
            let [p, q, r, s, t] = which;
            let d = sub(&points[t], &points[p]);
            let value = dot(&cross(&sub(&points[q], &points[p]), &sub(&points[s], &points[r])), &d);
            let size = |from: usize| if from < 3 { x } else { z };
            value.store_slice(values);
            bound(error, size(p), size(r), y).store_slice(limits);
            (size(p) * size(r) * y * HALF_ULP as f32).store_slice(units);
        }
    });
    found
}

/// Returns a coordinate of at most 1 that is likely to cause large rounding errors.
fn coordinate(rng: &mut Rng) -> f32 {
    let x = match rng.integer(0, 3) {
        0 => rng.choose(&[0.0, 0.5, 1.0]),
        1 => 1.0 - rng.integer(0, 9) as f64 * HALF_ULP,
        2 => rng.integer(1, 9) as f64 * HALF_ULP,
        _ => rng.unit(),
    };
    x.copysign(rng.choose(&[-1.0, 1.0])) as f32
}

fn points(host: &[[f32; 3]; 3], guest: &[[f32; 3]; 3]) -> [Point; 6] {
    let [a, b, c] = host.map(|corner| corner.map(f64::from));
    let [d, e, f] = guest.map(|corner| corner.map(f64::from));
    [a, b, c, d, e, f]
}

/// Reports whether the boxes of the two triangles overlap if one is enlarged by `error`. The filter
/// classifies no other pairs.
fn overlap(points: &[Point; 6], error: f64) -> bool {
    (0..3).all(|axis| {
        let least = |of: &[Point]| of.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
        let greatest = |of: &[Point]| of.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
        let (host, guest) = points.split_at(3);
        least(host) <= greatest(guest) + error && least(guest) - error <= greatest(host)
    })
}

/// Returns the maximum error of a determinant of these lanes, in units of u X Z Y and relative to
/// its bound.
fn off(
    level: Level,
    host: &Lanes8,
    guest: &Lanes8,
    error: f32,
    moved: impl Fn(&[Point; 6], [usize; 5]) -> [Point; 6],
) -> [f64; 2] {
    let found = determinants(level, host, guest, error);
    let mut most = [0.0_f64; 2];
    for lane in 0..LANES {
        let stored = points(&host[lane], &guest[lane]);
        if !overlap(&stored, f64::from(error)) {
            continue;
        }
        for (which, [values, limits, units]) in DETERMINANTS.into_iter().zip(&found) {
            let truth = determinant(&moved(&stored, which).map(|point| point.map(exact)), which);
            let off = (truth - exact(f64::from(values[lane]))).to_f64_fast().abs();
            most[0] = most[0].max(off / f64::from(units[lane]));
            most[1] = most[1].max(off / f64::from(limits[lane]));
        }
    }
    most
}

#[test]
fn rounding_of_determinants_is_bounded() {
    let mut rng = Rng::new(82);
    let mut most = 0.0;
    let fresh = |rng: &mut Rng| -> Lanes8 { [0; LANES].map(|_| [0; 3].map(|_| [0; 3].map(|_| coordinate(rng)))) };
    let (mut host, mut guest) = (fresh(&mut rng), fresh(&mut rng));
    for _ in 0..2_000 {
        let (mut h, mut g) = (host, guest);
        for lane in 0..LANES {
            let bred = if rng.one_in(2) { &mut h[lane] } else { &mut g[lane] };
            let x = &mut bred[rng.integer(0, 2) as usize][rng.integer(0, 2) as usize];
            *x = if rng.one_in(2) {
                coordinate(&mut rng)
            } else {
                f32::from_bits(x.to_bits().wrapping_add_signed(rng.integer(-9, 9) as i32))
            };
            *x = if x.abs() <= 1.0 { *x } else { 1.0 };
        }
        let [units, of_bound] = off(Level::fallback(), &h, &g, 0.0, |&points, _| points);
        assert!(of_bound < 1.0, "{of_bound} of the bound: {h:?} {g:?}");
        if units >= most {
            (host, guest, most) = (h, g, units);
        }
    }
    for (name, level) in levels() {
        let [_, of_bound] = off(level, &host, &guest, 0.0, |&points, _| points);
        assert!(of_bound < 1.0, "{name}: {of_bound} of the bound: {host:?} {guest:?}");
    }
    assert!((5.0..68.0).contains(&most), "{most} u X Z Y");
}

#[test]
fn errors_of_corners_are_bounded() {
    let mut rng = Rng::new(83);
    let mut most = 0.0_f64;
    for _ in 0..600 {
        let error = power_of_two(&mut rng, -18, 3);
        let guest_size = power_of_two(&mut rng, -6, 6);
        let share = rng.choose(&[0.0, 0.5, 1.0]);
        let corner = |rng: &mut Rng, size: f64| -> [f32; 3] {
            if rng.one_in(2) {
                unit_point(rng).map(|x| (x * size) as f32)
            } else {
                [0; 3].map(|_| rng.choose(&[-size, size]) as f32)
            }
        };
        let host: Lanes8 = [0; LANES].map(|_| [0; 3].map(|_| corner(&mut rng, 1.0)));
        let guest: Lanes8 = [0; LANES].map(|_| [0; 3].map(|_| corner(&mut rng, guest_size)));
        let [_, of_bound] = off(Level::fallback(), &host, &guest, error as f32, |points, which| {
            // The determinant is linear in each coordinate. Each is moved in the direction that
            // increases it.
            let value = determinant(points, which);
            let mut moved = *points;
            for (at, point) in moved.iter_mut().enumerate() {
                let reach = if at < 3 { error * share } else { error * (1.0 - share) };
                for axis in 0..3 {
                    let mut one = *points;
                    one[at][axis] += reach;
                    point[axis] += if determinant(&one, which) >= value { reach } else { -reach };
                }
            }
            moved
        });
        assert!(of_bound < 1.0, "{of_bound} of the bound for an error of {error}: {host:?} {guest:?}");
        most = most.max(of_bound);
    }
    assert!(most > 0.15, "{most}");
}

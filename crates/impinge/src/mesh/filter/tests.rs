//! The filter against exact arithmetic: how far its corners and determinants are off, and whether its verdicts are true.

use dashu_ratio::{RBig, Relaxed};
use fearless_simd::dispatch;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::{large_integer_map, rotation};
use impinge_testkit::{Affine, oracle};

use super::*;
use crate::exact::{Placement, triangles_intersect};
use crate::math::{Pose, RelativeMap};
use crate::mesh::{Mesh, Positions};
use crate::simd::{Level, levels};

type Point = [f64; 3];

fn exact(x: f64) -> Relaxed {
    Relaxed::try_from(x).expect("finite")
}

fn power_of_two(rng: &mut Rng, low: i64, high: i64) -> f64 {
    2.0_f64.powi(rng.integer(low, high) as i32)
}

fn unit_point(rng: &mut Rng) -> Point {
    [0; 3].map(|_| rng.uniform(-1.0, 1.0))
}

fn along(p: &Point, q: &Point, weight: f64) -> Point {
    std::array::from_fn(|axis| p[axis] + (q[axis] - p[axis]) * weight)
}

/// Up to eight triangles in their own frame, and their pose.
#[derive(Debug)]
struct Side8 {
    mesh: Mesh,
    pose: Affine,
}

impl Side8 {
    /// Triangles that the pose takes to `corners`; `stray` is a vertex of no face that widens the packed frame.
    fn new(corners: &[[Point; 3]], stray: Option<Point>, pose: Affine) -> Self {
        let vertices: Vec<Point> = corners.iter().flatten().copied().chain(stray).collect();
        let faces = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Self { mesh: Mesh::new(Positions::F64(vertices), faces).expect("a legal mesh"), pose }
    }

    fn world_from_mesh(&self) -> Pose {
        Pose::new(self.pose.linear, self.pose.translation).expect("a legal pose")
    }

    fn packet(&self) -> &Packet {
        &self.mesh.0.packets[0]
    }

    fn corners(&self, lane: usize) -> [Point; 3] {
        self.mesh.corners(self.packet().faces[lane])
    }
}

fn relate(host: &Side8, guest: &Side8) -> Relation {
    let map = RelativeMap::a_from_b(&host.world_from_mesh(), &guest.world_from_mesh());
    Relation::new(&map, &host.mesh.0.frame, &guest.mesh.0.frame)
}

/// A point's exact place in the host's packed frame.
fn packed_exactly(host: &Side8, pose: &Affine, point: &Point) -> [RBig; 3] {
    let rational = |x: f64| RBig::try_from(x).expect("finite");
    let world: [RBig; 3] = std::array::from_fn(|i| {
        (0..3).fold(rational(pose.translation[i]), |sum, k| sum + rational(pose.linear[i][k]) * rational(point[k]))
    });
    let m = host.pose.linear.map(|row| row.map(rational));
    let offset: [RBig; 3] = std::array::from_fn(|i| world[i].clone() - rational(host.pose.translation[i]));
    let determinant_with = |column: Option<usize>| {
        let entry = |i: usize, j: usize| if column == Some(j) { offset[i].clone() } else { m[i][j].clone() };
        (0..3).fold(RBig::ZERO, |sum, j| {
            let (k, l) = ((j + 1) % 3, (j + 2) % 3);
            sum + entry(0, j) * (entry(1, k) * entry(2, l) - entry(1, l) * entry(2, k))
        })
    };
    let determinant = determinant_with(None);
    let frame = &host.mesh.0.frame;
    std::array::from_fn(|axis| {
        (determinant_with(Some(axis)) / &determinant - rational(frame.origin[axis])) * rational(frame.scale)
    })
}

#[test]
fn corners_and_bounds_are_within_their_error() {
    let mut rng = Rng::new(81);
    let (mut worst, mut met) = (0.0_f64, 0);
    for _ in 0..400 {
        // The host is a small packet of a larger mesh, or not; the guest has any scale.
        let (host_size, guest_size) = (power_of_two(&mut rng, -20, 0), power_of_two(&mut rng, -20, 0));
        let (host_scale, guest_scale) = (power_of_two(&mut rng, -30, 30), power_of_two(&mut rng, -30, 30));
        let world = if rng.one_in(3) { large_integer_map(&mut rng) } else { rotation(&mut rng) };
        let turn = if rng.one_in(2) { rotation(&mut rng).linear } else { Affine::IDENTITY.linear };
        let centre = unit_point(&mut rng);
        let count = rng.integer(1, 8) as usize;
        let triangles = |rng: &mut Rng, size: f64, scale: f64| -> Vec<[Point; 3]> {
            let near = |rng: &mut Rng| unit_point(rng).map(|x| x * size);
            let corner = |rng: &mut Rng| {
                let step = near(rng);
                std::array::from_fn(|axis| (centre[axis] + step[axis]) / scale)
            };
            (0..count).map(|_| [0; 3].map(|_| corner(rng))).collect()
        };
        let pose = |scale: f64, turn: &[[f64; 3]; 3]| {
            let linear = std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..3).map(|k| world.linear[i][k] * turn[k][j]).sum::<f64>() * scale)
            });
            Affine { linear, translation: world.translation }
        };
        let host = Side8::new(
            &triangles(&mut rng, host_size, host_scale),
            Some([1.0 / host_scale; 3]),
            pose(host_scale, &Affine::IDENTITY.linear),
        );
        let guest = Side8::new(
            &triangles(&mut rng, guest_size, guest_scale),
            Some([1.0 / guest_scale; 3]),
            pose(guest_scale, &turn),
        );
        let (relation, back) = (relate(&host, &guest), relate(&guest, &host));
        let exact_guest: Vec<[[RBig; 3]; 3]> =
            (0..count).map(|lane| guest.corners(lane).map(|c| packed_exactly(&host, &guest.pose, &c))).collect();
        for (name, level) in levels() {
            let mut taken = Guest::EMPTY;
            let anchor = host.packet().anchor;
            let mut moved = [[[0.0_f32; LANES]; 3]; 3];
            dispatch!(level, simd => {
                taken.take_up(simd, guest.packet(), &relation, &back);
                let offset: Lanes3<_> = by_axis!(axis => {
                    f32x8::splat(simd, (taken.anchor[axis] - f64::from(anchor[axis])) as f32)
                });
                for corner in 0..3 {
                    for axis in 0..3 {
                        let sum = load(simd, &taken.corners[corner][axis]) + offset[axis];
                        sum.store_slice(&mut moved[corner][axis]);
                    }
                }
            });
            let radii = host.packet().radius + guest.packet().radius * relation.stretch as f32;
            let near = (0..3).all(|axis| (taken.anchor[axis] - f64::from(anchor[axis])).abs() < f64::from(radii));
            met += usize::from(near);
            for (lane, corners) in exact_guest.iter().enumerate() {
                for (corner, point) in corners.iter().enumerate() {
                    for axis in 0..3 {
                        let truth = &point[axis];
                        let rational = |x: f32| RBig::try_from(x).expect("finite");
                        assert!(*truth >= rational(taken.bounds.min[axis]), "{name}: {host:?} {guest:?}");
                        assert!(*truth <= rational(taken.bounds.max[axis]), "{name}: {host:?} {guest:?}");
                        if !near {
                            continue;
                        }
                        let off = truth - rational(anchor[axis]) - rational(moved[corner][axis][lane]);
                        let off = f64::from(off.to_f32_fast()).abs();
                        // One rounding of the host's corners takes a quarter of its part.
                        let bound = f64::from(taken.error) + 3.0 * HALF_ULP * f64::from(host.packet().radius);
                        assert!(off <= bound * (1.0 + 1e-6), "{name}: {off} > {bound}: {host:?} {guest:?}");
                        let by_radius = HALF_ULP * relation.stretch * f64::from(guest.packet().radius);
                        let rest = 3.0 * HALF_ULP * f64::from(host.packet().radius)
                            + f64::from(relation.corner_error.constant);
                        worst = worst.max((off - rest) / by_radius);
                    }
                }
            }
        }
    }
    assert!(met > 500, "{met}");
    // One unit for each rounding would not do.
    assert!((1.2..9.0).contains(&worst), "{worst}");
}

/// Eight triangles in lanes, known exactly.
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
    let normal = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]));
    Triangle { corners, normal, width: width(&min, &max) }
}

/// The determinants that decide, each by the four points that it is of: (e from p to q) × (f from r to s) · (p to t).
/// Points 0 to 2 are the host's corners, 3 to 5 the guest's.
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

/// Each lane's determinants in single precision, with their bounds and u X Z Y, the unit of rounding.
fn determinants(level: Level, host: &Lanes8, guest: &Lanes8, error: f32) -> [[[f32; LANES]; 3]; 4] {
    let mut found = [[[0.0; LANES]; 3]; 4];
    dispatch!(level, simd => {
        let (h, g) = (in_lanes(simd, host), in_lanes(simd, guest));
        let points = [h.corners[0], h.corners[1], h.corners[2], g.corners[0], g.corners[1], g.corners[2]];
        let side = Side::new(simd, h.corners, h.width, error);
        let margin = side.error * 4.0;
        let (x, z, y) = (h.width + margin, g.width + margin, h.width + g.width + margin + margin);
        for (which, [values, limits, units]) in DETERMINANTS.into_iter().zip(&mut found) {
            let [p, q, r, s, t] = which;
            let d = sub(&points[t], &points[p]);
            let value = dot(&cross(&sub(&points[q], &points[p]), &sub(&points[s], &points[r])), &d);
            let size = |from: usize| if from < 3 { x } else { z };
            value.store_slice(values);
            side.bound(size(p), size(r), y).store_slice(limits);
            (size(p) * size(r) * y * HALF_ULP as f32).store_slice(units);
        }
    });
    found
}

/// A coordinate as nasty as unit ones get.
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

/// Whether the boxes of the two triangles overlap when one is grown by `error`: others are not judged.
fn overlap(points: &[Point; 6], error: f64) -> bool {
    (0..3).all(|axis| {
        let least = |of: &[Point]| of.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
        let greatest = |of: &[Point]| of.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
        let (host, guest) = points.split_at(3);
        least(host) <= greatest(guest) + error && least(guest) - error <= greatest(host)
    })
}

/// The most that a determinant of these lanes is off by: in u X Z Y, and in its bound.
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
            // The determinant is linear in each coordinate; each is moved the way that hurts, all the same way.
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

/// A triangle made to meet or just miss `host`, by `gap`.
fn close_to(rng: &mut Rng, host: &[Point; 3], gap: f64) -> [Point; 3] {
    let [p, q, r] = host;
    let edge = along(p, q, rng.unit());
    let inside = along(&edge, r, rng.unit());
    let shift = |rng: &mut Rng, point: &Point| {
        let step = unit_point(rng);
        std::array::from_fn(|axis| point[axis] + gap * step[axis])
    };
    let far = |rng: &mut Rng, from: &Point| {
        let step = unit_point(rng);
        std::array::from_fn::<f64, 3, _>(|axis| from[axis] + step[axis])
    };
    match rng.integer(0, 3) {
        // A corner near the face.
        0 => [shift(rng, &inside), far(rng, &inside), far(rng, &inside)],
        // All corners near the plane.
        1 => {
            let (s, t) = (rng.uniform(-1.0, 2.0), rng.uniform(-1.0, 2.0));
            [shift(rng, &inside), shift(rng, &along(&inside, q, s)), shift(rng, &along(&inside, r, t))]
        }
        // Edges that cross.
        2 => {
            let (on, end) = (shift(rng, &edge), far(rng, &edge));
            [end, along(&end, &on, rng.uniform(1.0, 3.0)), far(rng, &edge)]
        }
        // A sliver.
        _ => {
            let (on, end) = (shift(rng, &inside), far(rng, &inside));
            let other = along(&end, &on, rng.uniform(1.0, 3.0));
            let between = along(&end, &other, rng.unit());
            [end, other, shift(rng, &between)]
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Generic,
    Close,
    /// Of other sizes by up to 2^50, and close.
    Sized,
}

/// Counts of pairs that were proved to meet, proved apart, and left open.
#[derive(Clone, Copy, Debug, Default)]
struct Outcomes {
    meet: usize,
    apart: usize,
    open: usize,
}

fn judge_packets(kind: Kind, seed: u64, packets: usize) -> Outcomes {
    let mut rng = Rng::new(seed);
    let mut outcomes = Outcomes::default();
    let mut asked = 0;
    for _ in 0..packets {
        let (hosts, guests) = (rng.integer(1, 8) as usize, rng.integer(1, 8) as usize);
        let mut host: Vec<[Point; 3]> = (0..hosts).map(|_| [0; 3].map(|_| unit_point(&mut rng))).collect();
        let size = if kind == Kind::Sized { power_of_two(&mut rng, -50, 50) } else { 1.0 };
        let mut guest: Vec<[Point; 3]> = (0..guests)
            .map(|i| match kind {
                Kind::Generic => [0; 3].map(|_| unit_point(&mut rng)),
                Kind::Close | Kind::Sized => {
                    let gap = if rng.one_in(8) { 0.0 } else { power_of_two(&mut rng, -54, -4) };
                    let host = &host[i % hosts];
                    let near = close_to(&mut rng, host, gap);
                    // About its first corner, which is close in half of the cases.
                    let size = if rng.one_in(4) { size.sqrt() } else { size };
                    near.map(|corner| along(&near[0], &corner, size))
                }
            })
            .collect();
        if rng.one_in(3) {
            // On the grid of single precision.
            for x in host.iter_mut().chain(&mut guest).flatten().flatten() {
                *x = f64::from(*x as f32);
            }
        }
        // A map of both changes no answer, nor does a power of two that the pose takes back.
        let common = match rng.integer(0, 3) {
            0 => large_integer_map(&mut rng),
            1 => rotation(&mut rng),
            _ => Affine::IDENTITY,
        };
        let range = if common.linear[0][1].abs() > 2.0 { 40 } else { 60 };
        let range = if rng.one_in(2) { 0 } else { range };
        let side = |rng: &mut Rng, corners: &[[Point; 3]]| {
            let scale = power_of_two(rng, -range, range);
            let stray = rng.one_in(3).then(|| [power_of_two(rng, 0, 12) / scale; 3]);
            let own: Vec<[Point; 3]> = corners.iter().map(|c| c.map(|point| point.map(|x| x / scale))).collect();
            let linear = common.linear.map(|row| row.map(|x| x * scale));
            Side8::new(&own, stray, Affine { linear, translation: common.translation })
        };
        let (host, guest) = (side(&mut rng, &host), side(&mut rng, &guest));
        let (relation, back) = (relate(&host, &guest), relate(&guest, &host));
        let placement = Placement::new(&host.world_from_mesh(), &guest.world_from_mesh());
        let truths: Vec<Vec<bool>> = (0..guests)
            .map(|g| (0..hosts).map(|h| triangles_intersect(&placement, &host.corners(h), &guest.corners(g))).collect())
            .collect();
        for (name, level) in levels() {
            let mut verdicts = [Verdict::default(); LANES];
            let met = dispatch!(level, simd => {
                let mut taken = Guest::EMPTY;
                taken.take_up(simd, guest.packet(), &relation, &back);
                taken.meet(simd, host.packet(), 0xff, &mut verdicts)
            });
            for (lane, verdict) in verdicts.into_iter().enumerate() {
                let verdict = if met >> lane & 1 == 1 { verdict } else { Verdict::default() };
                assert_eq!(verdict.meets & verdict.open, 0, "{name}");
                let hosts = if lane < guests { hosts } else { 0 };
                assert_eq!((verdict.meets | verdict.open) >> hosts, 0, "{name}: a lane without a triangle");
                for h in 0..hosts {
                    if verdict.open >> h & 1 == 1 {
                        outcomes.open += 1;
                        continue;
                    }
                    let meets = verdict.meets >> h & 1 == 1;
                    let truth = truths[lane][h];
                    assert_eq!(meets, truth, "{name}, {kind:?}, lanes {h} and {lane}: {host:?} {guest:?}");
                    *(if meets { &mut outcomes.meet } else { &mut outcomes.apart }) += 1;
                    asked += 1;
                    if asked % 101 == 0 {
                        // An oracle that shares nothing with the engine.
                        let (a, b) = (host.corners(h), guest.corners(lane));
                        assert_eq!(truth, oracle::triangles_meet(&a, &host.pose, &b, &guest.pose));
                    }
                }
            }
        }
    }
    outcomes
}

#[test]
fn generic_pairs_are_decided_and_truly() {
    let Outcomes { meet, apart, open } = judge_packets(Kind::Generic, 84, 800);
    let total = meet + apart + open;
    assert!(open * 50 < total, "{open} of {total} are open");
    assert!(meet * 10 > total && apart * 3 > total, "{meet} meet and {apart} are apart of {total}");
}

#[test]
fn close_pairs_are_never_wrong() {
    for (kind, seed, rare) in [(Kind::Close, 85, 20), (Kind::Sized, 86, 200)] {
        let Outcomes { meet, apart, open } = judge_packets(kind, seed, 1_500);
        let total = meet + apart + open;
        assert!(meet * rare > total && apart * 10 > total && open * 20 > total, "{kind:?}: {meet} {apart} {open}");
    }
}

//! The filter compared with exact arithmetic. The errors of corners are tested here, determinants
//! and verdicts in files of their own.

mod determinants;
mod verdicts;

use dashu_ratio::{RBig, Relaxed};
use impinge_testkit::Affine;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::{large_integer_map, rotation};

use super::*;
use crate::math::{Pose, RelativeMap};
use crate::mesh::{Mesh, Positions};
use crate::simd::{best_level, dispatch, levels};

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

/// Up to eight triangles in the mesh frame, and their pose.
#[derive(Debug)]
struct Side8 {
    mesh: Mesh,
    pose: Affine,
}

impl Side8 {
    /// Makes triangles that the pose maps to `corners`. `stray` is a vertex without a face that
    /// enlarges the packed frame.
    fn new(corners: &[[Point; 3]], stray: Option<Point>, pose: Affine) -> Self {
        let vertices: Vec<Point> = corners.iter().flatten().copied().chain(stray).collect();
        let faces: Vec<_> = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Self { mesh: Mesh::new(Positions::F64(vertices), faces).expect("a valid mesh"), pose }
    }

    fn world_from_mesh(&self) -> Pose {
        Pose::new(self.pose.linear, self.pose.translation).expect("a valid pose")
    }

    fn packet(&self) -> Packet<'_> {
        dispatch!(best_level(), simd => self.mesh.packets().get(simd, 0))
    }

    fn corners(&self, lane: usize) -> [Point; 3] {
        self.mesh.corners(self.packet().leaf.faces[lane])
    }
}

fn relate(host: &Side8, guest: &Side8) -> Relation {
    let map = RelativeMap::a_from_b(&host.world_from_mesh(), &guest.world_from_mesh());
    Relation::new(&map, &host.mesh.0.frame, &guest.mesh.0.frame)
}

/// Returns the exact image of a point in the packed frame of the host.
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
    let (mut worst, mut near_corners) = (0.0_f64, 0);
    for _ in 0..400 {
        // The host is a small packet of a larger mesh in some cases; the guest has any scale.
        let (host_size, guest_size) = (power_of_two(&mut rng, -20, 0), power_of_two(&mut rng, -20, 0));
        let (host_scale, guest_scale) = (power_of_two(&mut rng, -30, 30), power_of_two(&mut rng, -30, 30));
        let world = if rng.one_in(3) { large_integer_map(&mut rng) } else { rotation(&mut rng) };
        let turn = if rng.one_in(2) { rotation(&mut rng).linear } else { Affine::IDENTITY.linear };
        let center = unit_point(&mut rng);
        let count = rng.integer(1, 8) as usize;
        let triangles = |rng: &mut Rng, size: f64, scale: f64| -> Vec<[Point; 3]> {
            let near = |rng: &mut Rng| unit_point(rng).map(|x| x * size);
            let corner = |rng: &mut Rng| {
                let step = near(rng);
                std::array::from_fn(|axis| (center[axis] + step[axis]) / scale)
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
            let local_origin = host.packet().local_origin;
            let mut moved = [[[0.0_f32; LANES]; 3]; 3];
            dispatch!(level, simd => {
                taken.set_packet(simd, &guest.packet(), &relation, &back);
                let offset: Lanes3<_> = by_axis!(axis => {
                    f32x8::splat(simd, (taken.local_origin[axis] - local_origin[axis]) as f32)
                });
                for corner in 0..3 {
                    for axis in 0..3 {
                        let sum = load(simd, &taken.corners[corner][axis]) + offset[axis];
                        sum.store_slice(&mut moved[corner][axis]);
                    }
                }
            });
            let radii = host.packet().radius + guest.packet().radius * relation.stretch as f32;
            let near = (0..3).all(|axis| (taken.local_origin[axis] - local_origin[axis]).abs() < f64::from(radii));
            near_corners += usize::from(near);
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
                        let off = truth
                            - RBig::try_from(local_origin[axis]).expect("finite")
                            - rational(moved[corner][axis][lane]);
                        let off = f64::from(off.to_f32_fast()).abs();
                        // The host's corners have one rounding here, a quarter of what the bound
                        // allows for them.
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
    assert!(near_corners > 150 * levels().len(), "{near_corners}");
    // A bound of one unit per radius would be too small.
    assert!((1.2..9.0).contains(&worst), "{worst}");
}

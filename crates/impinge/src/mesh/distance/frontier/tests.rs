//! Searches that resume at a frontier, compared with searches that start anew.

use std::collections::BTreeSet;

use impinge_testkit::generate::knots::{Knot, TREFOIL, torus_knot};
use impinge_testkit::generate::poses::cube_symmetry;
use impinge_testkit::generate::{Rng, solids};
use impinge_testkit::{Affine, Mesh as Plain};

use super::*;
use crate::hierarchy::Child;
use crate::math::Pose;
use crate::mesh::distance::bounds::Bounds;
use crate::mesh::distance::metric::Metric;
use crate::mesh::distance::{WarmStart, nearest, within};
use crate::mesh::{Mesh, PlacedMesh, Positions};
use crate::primitive::triangle_triangle;
use crate::simd::levels;

fn mesh(plain: &Plain) -> Mesh {
    Mesh::new(Positions::F64(plain.vertices.clone()), plain.faces.clone()).expect("a valid mesh")
}

fn relative(a: PlacedMesh<'_>, b: PlacedMesh<'_>, options: &Options<'_>) -> Option<RelativeFrame> {
    Bounds::new(a, b, &Metric::new(a, b), options.host).relative
}

/// Lets the next search keep a frontier, even if this search was not costly.
fn keep_frontier(warm_start: &mut WarmStart, a: PlacedMesh<'_>, b: PlacedMesh<'_>, options: &Options<'_>) {
    if warm_start.frontier.is_none() {
        warm_start.costly = relative(a, b, options);
    }
}

/// Pairs of meshes, with the first position of the second mesh. Many of their triangles are equally
/// near.
fn scenes() -> Vec<(Plain, Plain, [f64; 3])> {
    let sphere = solids::icosphere(2);
    let knot = torus_knot(32, 10, TREFOIL);
    let thin = torus_knot(32, 10, Knot { radius: 0.125, ..TREFOIL });
    let plate = solids::plane_grid(6, 6);
    vec![
        (sphere.clone().scaled(2.0), sphere.clone(), [0.0; 3]),
        (knot.clone(), thin, [0.0; 3]),
        (plate.clone(), plate.clone(), [0.0, 0.0, 0.5]),
        (plate, sphere.clone(), [3.0, 3.0, 1.25]),
        (sphere.clone(), knot, [0.0, 0.0, 0.0]),
        (solids::cuboid([-1.0; 3], [1.0; 3]), sphere, [2.5, 0.0, 0.0]),
    ]
}

/// Returns a pose near another pose, after one of several kinds of motion.
fn next(rng: &mut Rng, pose: &Affine) -> Affine {
    let shift = |rng: &mut Rng, step: f64| [0; 3].map(|_| step * rng.integer(-2, 2) as f64);
    let plus = |by: [f64; 3]| [0, 1, 2].map(|k| pose.translation[k] + by[k]);
    match rng.integer(0, 6) {
        0 => *pose,
        1 | 2 => Affine::new(pose.linear, plus(shift(rng, 1.0 / 1024.0))),
        3 => Affine::new(pose.linear, plus([0; 3].map(|_| rng.uniform(-0.004, 0.004)))),
        4 => {
            let (sin, cos) = rng.uniform(-0.004, 0.004).sin_cos();
            let turn = Affine::new([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]);
            let linear = [0, 1, 2]
                .map(|i| [0, 1, 2].map(|j| (0..3).map(|k| turn.linear[i][k] * pose.linear[k][j]).sum::<f64>()));
            Affine::new(linear, pose.translation)
        }
        5 => Affine::new(pose.linear, plus(shift(rng, 1.0 / 64.0))),
        _ => Affine::new(if rng.one_in(2) { cube_symmetry(rng) } else { pose.linear }, plus(shift(rng, 0.125))),
    }
}

#[test]
fn resuming_at_a_frontier_changes_no_answer() {
    let (mut followed, mut intersecting, mut apart) = (0, 0, 0);
    for (scene, (a, b, at)) in scenes().into_iter().enumerate() {
        for (name, level) in levels() {
            let mut rng = Rng::new(scene as u64 + 40);
            let (mut mesh_a, mesh_b) = (mesh(&a), mesh(&b));
            let mut pose = Affine::translation(at);
            let mut warm_start = WarmStart::default();
            for step in 0..150 {
                if rng.one_in(24) {
                    // The mesh deforms.
                    let swell = 1.0 + rng.uniform(0.0, 0.01);
                    let positions = a.vertices.iter().map(|v| v.map(|x| x * swell)).collect();
                    mesh_a.refit(Positions::F64(positions)).expect("as many vertices");
                }
                pose = next(&mut rng, &pose);
                let host = rng.choose(&[HostChoice::First, HostChoice::Second, HostChoice::SmallerError]);
                let options = Options { level, host, ..Options::default() };
                let pose = Pose::new(pose.linear, pose.translation).expect("a pose");
                let both = if rng.one_in(4) {
                    Pose::from_translation([5.0, -3.0, 1.0]).expect("a pose")
                } else {
                    Pose::IDENTITY
                };
                let (place_a, place_b) = (mesh_a.at(both), mesh_b.at(both.compose(&pose).expect("a pose")));
                keep_frontier(&mut warm_start, place_a, place_b, &options);
                let had_frontier = warm_start.frontier.is_some();
                let alone = nearest(place_a, place_b, &mut WarmStart::default(), &options).expect("faces");
                if rng.one_in(3) {
                    for clearance in [alone.lower.next_down(), alone.lower, alone.upper, alone.upper * 1.01] {
                        let expected =
                            within(place_a, place_b, clearance, &mut WarmStart::default(), &options).is_some();
                        let found = within(place_a, place_b, clearance, &mut warm_start, &options).is_some();
                        assert_eq!(found, expected, "scene {scene}, {name}, step {step}, {clearance}");
                    }
                    keep_frontier(&mut warm_start, place_a, place_b, &options);
                }
                let found = nearest(place_a, place_b, &mut warm_start, &options).expect("faces");
                assert_eq!(found, alone, "scene {scene}, {name}, step {step}");
                followed += usize::from(had_frontier && warm_start.frontier.is_some());
                *(if found.upper > 0.0 { &mut apart } else { &mut intersecting }) += 1;
            }
        }
    }
    assert!(
        followed > 200 && intersecting > 50 && apart > 500,
        "{followed} followed, {intersecting} intersecting, {apart} apart"
    );
}

#[test]
fn triangles_that_come_to_cross_intersect() {
    // The tip of a spike goes through a plate far from the plate's edges, so no edge of one mesh is
    // near an edge of the other.
    let plate: [[f64; 3]; 3] = [[-8.0, -8.0, 0.0], [8.0, -8.0, 0.0], [0.0, 9.0, 0.0]];
    let far_apart = plate.map(|[x, y, z]| [x, y, z + 100.0]);
    let corners = [plate, far_apart].concat();
    let plates = Mesh::new(Positions::F64(corners), vec![[0, 1, 2], [3, 4, 5]]).expect("a mesh");
    let tip = vec![[0.0, 0.0, 0.0], [-0.1, 0.0, 4.0], [0.1, 0.0, 4.0]];
    let spike = Mesh::new(Positions::F64(tip), vec![[0, 1, 2]]).expect("a mesh");
    let (options, mut warm_start) = (Options::default(), WarmStart::default());
    let above = spike.at(Pose::from_translation([0.0, 0.0, 0.25]).expect("a pose"));
    keep_frontier(&mut warm_start, (&plates).into(), above, &options);
    assert_eq!(nearest((&plates).into(), above, &mut warm_start, &options).expect("faces").faces, [0, 0]);
    assert!(warm_start.frontier.is_some());
    // If the far plate is tried first, the step is small compared with the distance.
    warm_start.faces = Some([1, 0]);
    let through = spike.at(Pose::from_translation([0.0, 0.0, -0.5]).expect("a pose"));
    let found = nearest((&plates).into(), through, &mut warm_start, &options).expect("faces");
    assert_eq!((found.upper, found.faces), (0.0, [0, 0]));
}

#[test]
fn boxes_too_far_for_squares_are_kept() {
    // In the unit of a cube of size 2^-70, two plates are so far away that squares in single
    // precision overflow.
    let speck = mesh(&solids::cuboid([-1.0; 3], [1.0; 3]));
    let scale = 1.0 / (1_u128 << 70) as f64;
    let small = Pose::new([[scale, 0.0, 0.0], [0.0, scale, 0.0], [0.0, 0.0, scale]], [0.0; 3]).expect("a pose");
    let plate = |x: f64| {
        let mut grid = solids::plane_grid(6, 6);
        grid.vertices.iter_mut().for_each(|v| *v = [x, v[0] / 3.0 - 1.0, v[1] / 3.0 - 1.0]);
        grid
    };
    let (near, far) = (plate(1.0), plate(-1.001));
    let count = near.vertices.len() as u32;
    let faces = [near.faces, far.faces.iter().map(|face| face.map(|v| v + count)).collect()].concat();
    let plates = Mesh::new(Positions::F64([near.vertices, far.vertices].concat()), faces).expect("a mesh");
    let options = Options { host: HostChoice::First, ..Options::default() };
    let (mut warm_start, mut kept) = (WarmStart::default(), 0);
    for shift in [0.0, 0.0, 0.00001, 0.002] {
        let there = plates.at(Pose::from_translation([shift, 0.0, 0.0]).expect("a pose"));
        keep_frontier(&mut warm_start, speck.at(small), there, &options);
        let alone = nearest(speck.at(small), there, &mut WarmStart::default(), &options);
        assert_eq!(nearest(speck.at(small), there, &mut warm_start, &options), alone, "{shift}");
        kept += usize::from(warm_start.frontier.is_some());
    }
    assert!(kept > 1, "{kept} of 4 kept a frontier");
}

/// Collects the faces below a child.
fn faces(mesh: &Mesh, child: Child, found: &mut Vec<u32>) {
    match child {
        // Unused lanes repeat a face.
        Child::Leaf(leaf) => found.extend(BTreeSet::from(mesh.leaf(leaf).faces)),
        Child::Inner(node) => {
            let node = &mesh.0.tree.nodes()[node as usize];
            (0..node.count()).for_each(|lane| faces(mesh, node.child(lane), found));
        }
    }
}

#[test]
fn every_pair_of_faces_is_below_one_bound_and_no_nearer() {
    let options = Options { host: HostChoice::First, ..Options::default() };
    let (mut tightest, mut bounds) = (f64::INFINITY, 0);
    for (scene, (a, b, at)) in scenes().into_iter().enumerate() {
        let (mesh_a, mesh_b) = (mesh(&a), mesh(&b));
        let mut warm_start = WarmStart::default();
        let mut rng = Rng::new(scene as u64);
        let mut pose = Affine::translation(at);
        for step in 0..6 {
            pose.translation = pose.translation.map(|x| x + rng.uniform(-0.002, 0.002));
            let (place_a, place_b) =
                (mesh_a.at(Pose::IDENTITY), mesh_b.at(Pose::from_translation(pose.translation).expect("a pose")));
            keep_frontier(&mut warm_start, place_a, place_b, &options);
            let found = nearest(place_a, place_b, &mut warm_start, &options).expect("faces");
            let Some(frontier) = &warm_start.frontier else { continue };
            let metric = Metric::new(place_a, place_b);
            let mut covered = vec![0_u8; mesh_a.faces().len() * mesh_b.faces().len()];
            for Entry { nodes: [host, guest], bounds: rows } in &frontier.entries {
                let (host, guest) = (&mesh_a.0.tree.nodes()[*host as usize], &mesh_b.0.tree.nodes()[*guest as usize]);
                for (guest_lane, row) in rows.iter().enumerate() {
                    for (host_lane, &bound) in row.iter().enumerate().filter(|(_, bound)| **bound < f32::INFINITY) {
                        bounds += 1;
                        let (mut on_a, mut on_b) = (Vec::new(), Vec::new());
                        faces(&mesh_a, host.child(host_lane), &mut on_a);
                        faces(&mesh_b, guest.child(guest_lane), &mut on_b);
                        let bound = f64::from(bound) * frontier.relative.stretch[0];
                        for &of_a in &on_a {
                            for &of_b in &on_b {
                                covered[of_a as usize * mesh_b.faces().len() + of_b as usize] += 1;
                                let corners = [0, 1].map(|m| {
                                    let corners = [mesh_a.corners(of_a), mesh_b.corners(of_b)][m];
                                    corners.map(|corner| metric.maps[m].apply(corner))
                                });
                                let value = triangle_triangle(&corners[0], &corners[1]).squared.sqrt();
                                assert!(
                                    bound <= value + metric.error,
                                    "scene {scene}, step {step}: {bound} above {value}"
                                );
                                tightest = tightest.min(value - bound);
                            }
                        }
                    }
                }
            }
            assert!(covered.iter().all(|&times| times == 1), "scene {scene}, step {step}: {found:?}");
        }
    }
    assert!(bounds > 10_000 && tightest < 1e-6, "{bounds} bounds, the tightest off by {tightest}");
}

#[test]
fn a_full_frontier_changes_no_answer() {
    let thick = mesh(&torus_knot(560, 140, TREFOIL));
    let thin = mesh(&torus_knot(560, 140, Knot { radius: 0.2, ..TREFOIL }));
    let (options, mut warm_start) = (Options::default(), WarmStart::default());
    for step in 0..4 {
        let pose = Pose::from_translation([0.001 * f64::from(step), 0.0, 0.0]).expect("a pose");
        let alone = nearest(thick.at(Pose::IDENTITY), thin.at(pose), &mut WarmStart::default(), &options);
        assert_eq!(nearest(thick.at(Pose::IDENTITY), thin.at(pose), &mut warm_start, &options), alone, "step {step}");
        assert_eq!(warm_start.frontier.as_ref().map(Frontier::len), (step > 0).then_some(MAX_ENTRIES), "step {step}");
    }
}

//! Candidate pairs of generic trees, decided exactly, against brute force, on meshes full of ties.

use impinge::exact::{Placement, triangles_intersect};
use impinge::hierarchy::{Builder, Counters, Enclosure, GenericTree, NodeVolume};
use impinge::volume::{Aabb, BoundingSphere, Capsule, Kdop14, Kdop18, Kdop26, Lozenge, Obb};
use impinge::{Pose, math::RelativeMap};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::rotation;
use impinge_testkit::generate::solids::{grid_soup, icosphere};
use impinge_testkit::{Affine, Mesh, oracle};

/// Two small meshes, the map from the frame of the second to that of the first, and their
/// intersecting pairs.
struct Scene {
    a: Mesh,
    b: Mesh,
    a_from_b: Affine,
    expected: Vec<(u32, u32)>,
}

/// Returns scenes of meshes with integer corners, shared vertices, zero areas and duplicates, moved
/// by integers or turned. Most intersect.
fn scenes() -> Vec<Scene> {
    let mut rng = Rng::new(2026);
    let mut scenes: Vec<Scene> = (0..6)
        .map(|i| {
            let (side, reach) = (rng.integer(3, 8), rng.integer(1, 3));
            let count = rng.integer(60, 150) as usize;
            let a = grid_soup(&mut rng, count, side, reach);
            let b = if i % 2 == 0 { a.clone() } else { grid_soup(&mut rng, 40, side, reach) };
            let shift = [0; 3].map(|_| rng.integer(-1, 1) as f64);
            let a_from_b = match i % 3 {
                0 => Affine::translation(shift),
                1 => Affine::new([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], shift),
                _ => rotation(&mut rng),
            };
            scene(a, b, a_from_b)
        })
        .collect();
    let sphere = icosphere(2);
    scenes.push(scene(sphere.clone(), sphere.clone(), Affine::translation([2.0, 0.0, 0.0])));
    scenes.push(scene(sphere.clone(), sphere, Affine::translation([0.0, 0.5, 3.0])));
    scenes.push(scene(Mesh::default(), icosphere(0), Affine::IDENTITY));
    scenes
}

fn scene(a: Mesh, b: Mesh, a_from_b: Affine) -> Scene {
    let expected = oracle::brute_force(a.at(Affine::IDENTITY), b.at(a_from_b));
    Scene { a, b, a_from_b, expected }
}

fn pose(map: &Affine) -> Pose {
    Pose::new(map.linear, map.translation).expect("a legal pose")
}

fn corners(mesh: &Mesh, face: u32) -> [[f64; 3]; 3] {
    mesh.faces[face as usize].map(|vertex| mesh.vertices[vertex as usize])
}

fn tree<V: NodeVolume, const DEGREE: usize>(
    mesh: &Mesh,
    builder: Builder,
    capacity: usize,
    enclosure: Enclosure,
) -> GenericTree<V, DEGREE> {
    let boxes: Vec<Aabb> = (0..mesh.faces.len() as u32)
        .map(|face| Aabb::of_points(corners(mesh, face).map(|p| p.map(|x| x as f32))).next_outward())
        .collect();
    let binary = builder.build_with_leaves_of(capacity, &boxes);
    GenericTree::new(&binary, |face, points| points.extend(corners(mesh, face)), enclosure).expect("finite points")
}

/// Returns the intersecting pairs among the candidates of the trees, sorted, and the work. Panics
/// if a candidate occurs twice.
fn pairs<V: NodeVolume, const DEGREE: usize>(
    scene: &Scene,
    builder: Builder,
    capacity: usize,
    enclosure: Enclosure,
) -> (Vec<(u32, u32)>, Counters) {
    let [a, b] = [&scene.a, &scene.b].map(|mesh| tree::<V, DEGREE>(mesh, builder, capacity, enclosure));
    let mut shown = Vec::new();
    let work = a.pairs(&b, &pose(&scene.a_from_b), |a, b| shown.push((a, b)));
    assert_eq!(work.primitive_tests, shown.len() as u64);
    shown.sort_unstable();
    assert!(shown.is_sorted_by(|x, y| x < y), "a pair is reported twice");
    let placement = Placement::new(&Pose::IDENTITY, &pose(&scene.a_from_b));
    shown.retain(|&(i, j)| triangles_intersect(&placement, &corners(&scene.a, i), &corners(&scene.b, j)));
    (shown, work)
}

/// Checks one volume and degree with each builder, enclosure and leaf capacity.
fn every_tree_finds_the_pairs<V: NodeVolume, const DEGREE: usize>(
    kind: &str,
    builders: &[Builder],
    capacities: &[usize],
) {
    let (mut met, mut tests, mut all) = (0, 0, 0);
    for (at, scene) in scenes().iter().enumerate() {
        for &builder in builders {
            for enclosure in [Enclosure::Wrapped, Enclosure::Layered] {
                for &capacity in capacities {
                    let (found, work) = pairs::<V, DEGREE>(scene, builder, capacity, enclosure);
                    assert_eq!(
                        found,
                        scene.expected,
                        "{kind} of degree {DEGREE}, {}, {enclosure:?}, leaves of {capacity}, scene {at}",
                        builder.name()
                    );
                    tests += work.primitive_tests;
                    all += (scene.a.faces.len() * scene.b.faces.len()) as u64;
                }
            }
        }
        met += usize::from(!scene.expected.is_empty());
    }
    assert!((5..=8).contains(&met), "{met} of 9 scenes intersect");
    assert!(2 * tests < all, "{kind} of degree {DEGREE}: {tests} of {all} pairs are tested, so too few are pruned");
}

#[test]
fn trees_of_boxes_find_the_pairs_at_every_degree() {
    every_tree_finds_the_pairs::<Aabb, 2>("boxes", &Builder::ALL, &[1, 4]);
    every_tree_finds_the_pairs::<Aabb, 4>("boxes", &Builder::ALL, &[1, 4]);
    every_tree_finds_the_pairs::<Aabb, 8>("boxes", &Builder::ALL, &[1, 4]);
    every_tree_finds_the_pairs::<Aabb, 16>("boxes", &Builder::ALL, &[1, 4]);
}

/// One builder of each strategy, for volumes that take longer to fit than boxes. Builders use only
/// boxes, not volumes.
const THREE_BUILDERS: [Builder; 3] = [Builder::Morton, Builder::SweepSah, Builder::Insertion];

#[test]
fn trees_of_round_volumes_find_the_pairs() {
    every_tree_finds_the_pairs::<BoundingSphere, 2>("spheres", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<BoundingSphere, 8>("spheres", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<Capsule, 2>("capsules", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<Lozenge, 2>("lozenges", &THREE_BUILDERS, &[1]);
}

#[test]
fn trees_of_polytopes_find_the_pairs() {
    every_tree_finds_the_pairs::<Obb, 2>("oriented boxes", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<Obb, 4>("oriented boxes", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<Kdop14, 2>("14-DOPs", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<Kdop18, 2>("18-DOPs", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<Kdop26, 2>("26-DOPs", &THREE_BUILDERS, &[1]);
    every_tree_finds_the_pairs::<Kdop26, 16>("26-DOPs", &THREE_BUILDERS, &[1]);
}

#[test]
fn self_pairs_report_each_pair_once() {
    fn check<V: NodeVolume, const DEGREE: usize>(mesh: &Mesh, capacity: usize) -> usize {
        let placement = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        let intersect = |i, j| triangles_intersect(&placement, &corners(mesh, i), &corners(mesh, j));
        let count = mesh.faces.len() as u32;
        let expected: Vec<(u32, u32)> =
            (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j))).filter(|&(i, j)| intersect(i, j)).collect();
        for builder in Builder::ALL {
            let tree = tree::<V, DEGREE>(mesh, builder, capacity, Enclosure::Wrapped);
            let mut found = Vec::new();
            let work = tree.self_pairs(|i, j| found.push((i.min(j), i.max(j))));
            assert_eq!(work.primitive_tests, found.len() as u64);
            found.sort_unstable();
            assert!(found.is_sorted_by(|x, y| x < y) && found.iter().all(|(i, j)| i != j), "a pair is reported twice");
            found.retain(|&(i, j)| intersect(i, j));
            assert_eq!(found, expected, "{} of degree {DEGREE}", builder.name());
        }
        expected.len()
    }
    let soup = grid_soup(&mut Rng::new(7), 120, 6, 2);
    let mut total = 0;
    for mesh in [&soup, &icosphere(2), &Mesh::default()] {
        total += check::<Aabb, 2>(mesh, 1)
            + check::<Aabb, 8>(mesh, 4)
            + check::<Aabb, 16>(mesh, 8)
            + check::<Obb, 2>(mesh, 1);
    }
    assert!(total > 3_000, "{total}");
}

#[test]
fn moved_boxes_contain_the_exact_images() {
    let mut rng = Rng::new(11);
    for round in 0..2_000 {
        let scale: f64 = [1.0, 1e6, 1e-20][round % 3];
        let points: [[f64; 3]; 4] = [[0; 3]; 4].map(|p| p.map(|_| scale * rng.uniform(-1.0, 1.0)));
        let linear = [[0; 3]; 3].map(|row| row.map(|_: i32| rng.uniform(-2.0, 2.0)));
        let translation = [0; 3].map(|_| scale * rng.uniform(-1.0, 1.0));
        let pose = Pose::new(linear, translation).expect("hardly ever singular");
        let moved =
            <Aabb as NodeVolume>::of_points(&points).and_then(|b| NodeVolume::moved(&b, &pose)).expect("finite");
        // The map's error bound of a rounded image replaces exact arithmetic.
        let map = RelativeMap::a_from_b(&Pose::IDENTITY, &pose);
        for point in points {
            let (image, error) = (map.apply(point), map.image_error(point.map(f64::abs)));
            for axis in 0..3 {
                assert!(f64::from(moved.min[axis]) <= image[axis] + error[axis], "round {round}");
                assert!(f64::from(moved.max[axis]) >= image[axis] - error[axis], "round {round}");
            }
        }
    }
}

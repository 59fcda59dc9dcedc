//! Laws of depths and of kinds of pairs: what one answer says about others. The solids are heaps of
//! bricks on a lattice, full of common walls, edges and corners, and turned blocks.

use impinge::clash::{Kind, Options, find};
use impinge::query::batch::Execution;
use impinge::query::{self, Deeper, Penetrates};
use impinge::scene::Scene;
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::bricks::{self, Cut};
use impinge_testkit::generate::solids::cuboid;

use super::models::side;

/// Number of pairs of each kind of solid.
const PAIRS: usize = 150;

/// Two solids, and the pose of the second.
struct Pair {
    a: Mesh,
    b: Mesh,
    pose_b: Pose,
    /// Whether the interiors intersect, where it is known.
    penetrates: Option<bool>,
}

fn mesh(solid: impinge_testkit::Mesh) -> Option<Mesh> {
    (!solid.faces.is_empty()).then(|| Mesh::new(Positions::F64(solid.vertices), solid.faces).unwrap())
}

/// Returns two heaps of bricks, moved by half steps of the lattice.
fn bricks_of(rng: &mut Rng) -> Option<Pair> {
    let scene = bricks::Scene::random(rng);
    let cut = rng.choose(&[Cut::AsLattice, Cut::ByChance, Cut::Whole]);
    let [a, b] = scene.bricks.each_ref().map(|heap| mesh(bricks::mesh(rng, heap, cut)));
    let pose_b = Pose::from_translation(scene.half_steps.map(|step| 0.5 * step as f64)).unwrap();
    Some(Pair { a: a?, b: b?, pose_b, penetrates: Some(scene.penetrates()) })
}

/// Returns two blocks, the second one turned about an axis.
fn turned_blocks(rng: &mut Rng) -> Option<Pair> {
    let mut block = || {
        let high = [0; 3].map(|_| 0.25 * rng.integer(1, 6) as f64);
        mesh(cuboid([0.0; 3], high))
    };
    let (a, b) = (block()?, block()?);
    let axis = rng.choose(&[[0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, 2.0, 3.0]]);
    let angle = rng.choose(&[0.125, std::f64::consts::FRAC_PI_4, 2.0]);
    let offset = [0; 3].map(|_| 0.125 * rng.integer(-6, 6) as f64);
    Some(Pair { a, b, pose_b: Pose::from_axis_angle(axis, angle, offset).unwrap(), penetrates: None })
}

fn pairs(make: fn(&mut Rng) -> Option<Pair>, seed: u64) -> Vec<Pair> {
    let mut rng = Rng::new(seed);
    std::iter::from_fn(|| Some(make(&mut rng))).flatten().take(PAIRS).collect()
}

fn all_pairs() -> impl Iterator<Item = Pair> {
    pairs(bricks_of, 11).into_iter().chain(pairs(turned_blocks, 12))
}

/// Thresholds, ascending. Many depths on the lattice equal one of them.
const THRESHOLDS: [f64; 7] = [1e-6, 0.0625, 0.125, 0.25, 0.5, 0.75, 1.0];

#[test]
fn a_pair_that_is_not_deeper_is_not_deeper_than_a_larger_threshold() {
    let mut verdicts = [0; 3];
    for Pair { a, b, pose_b, .. } in all_pairs() {
        let deeper = THRESHOLDS.map(|threshold| query::deeper(&a, b.at(pose_b), threshold));
        let swapped = THRESHOLDS.map(|threshold| query::deeper(b.at(pose_b), &a, threshold));
        assert_eq!(deeper, swapped);
        let first_no = deeper.iter().position(|&verdict| verdict == Deeper::No).unwrap_or(THRESHOLDS.len());
        assert!(deeper[first_no..].iter().all(|&verdict| verdict != Deeper::Yes), "{deeper:?}");
        let depth = query::depth(&a, b.at(pose_b));
        for (verdict, threshold) in deeper.into_iter().zip(THRESHOLDS) {
            verdicts[verdict as usize] += 1;
            match verdict {
                Deeper::Yes => assert!(depth.upper > threshold, "{depth:?} {threshold}"),
                Deeper::No => assert!(depth.lower <= threshold, "{depth:?} {threshold}"),
                Deeper::Undecided => {}
            }
        }
    }
    let [no, undecided, yes] = verdicts;
    assert!(no > 500 && yes > 300, "{verdicts:?}");
    // The depth of a third of the pairs is a threshold.
    assert!(undecided < 300, "{verdicts:?}");
}

#[test]
fn depths_agree_with_intersections_distances_and_ways_out() {
    let (mut deep, mut touching, mut apart) = (0, 0, 0);
    for Pair { a, b, pose_b, penetrates } in all_pairs() {
        let [solid_a, solid_b] = [&a, &b].map(Mesh::solid);
        let depth = query::depth(&a, b.at(pose_b));
        let verdict = query::penetrates(&a, b.at(pose_b));
        let at_zero = query::deeper(&a, b.at(pose_b), 0.0);
        let expected = [Deeper::No, Deeper::Undecided, Deeper::Yes][match verdict {
            Penetrates::No => 0,
            Penetrates::Undecided => 1,
            Penetrates::Yes => 2,
        }];
        assert_eq!(at_zero, expected, "{depth:?}");
        if let Some(penetrates) = penetrates {
            assert_eq!(at_zero == Deeper::Yes, penetrates, "{depth:?}");
        }
        let gap = query::distance(solid_a, solid_b.at(pose_b));
        if depth.lower > 0.0 {
            assert!(depth.is_proved && query::intersects(solid_a, solid_b.at(pose_b)));
            assert!(gap.lower == 0.0 && query::within(solid_a, solid_b.at(pose_b), 0.0));
            let way_out = query::penetration(solid_a, solid_b.at(pose_b)).unwrap();
            assert!(depth.lower <= way_out.upper, "{depth:?} {way_out:?}");
            // The witness is inside both solids.
            let point = depth.point.unwrap();
            let in_b = pose_b.inverse().unwrap().apply(point);
            for (mesh, point) in [(&a, point), (&b, in_b)] {
                assert!(mesh.contains(&[point]).unwrap()[0].is_contained());
                assert!(mesh.closest_point(point).unwrap().unwrap().lower >= 0.0);
            }
            deep += 1;
        } else if gap.lower > 0.0 {
            assert_eq!(depth.upper, 0.0);
            apart += 1;
        } else {
            touching += 1;
        }
    }
    assert!(deep > 80 && touching > 10 && apart > 20, "{deep} {touching} {apart}");
}

/// Returns how much a kind says about the depth.
fn rank(kind: Kind) -> usize {
    match kind {
        Kind::Clear | Kind::Clearance => 0,
        Kind::Contact => 1,
        Kind::Undecided => 2,
        Kind::Clash => 3,
        Kind::Contained(_) => 4,
        Kind::Duplicate => 5,
    }
}

#[test]
fn a_larger_tolerance_never_turns_a_contact_into_a_clash() {
    let (mut contacts, mut clashes) = (0, 0);
    for Pair { a, b, pose_b, .. } in all_pairs() {
        let mut scene = Scene::new();
        scene.add("a", &a, Pose::IDENTITY).unwrap();
        scene.add("b", &b, pose_b).unwrap();
        let sides = [side("pair", &scene)];
        let kinds = [1e-6, 0.0625, 0.3, 0.8].map(|tolerance| {
            let options = Options { contacts: true, clearance: Some(0.5), ..Options::new(tolerance) };
            let report = find(&sides, options, Execution::default().sequentially()).unwrap();
            if report.duplicates.is_empty() {
                report.clashes.first().map(|clash| clash.kind)
            } else {
                Some(Kind::Duplicate)
            }
        });
        let is_contact = |kind: Option<Kind>| kind.is_none_or(|kind| rank(kind) <= 1);
        let first = kinds.iter().position(|&kind| is_contact(kind)).unwrap_or(kinds.len());
        let later = kinds[first..].iter().flatten();
        assert!(later.clone().all(|&kind| rank(kind) <= 2), "{kinds:?}");
        contacts += later.count();
        clashes += kinds[..first].iter().flatten().count();
    }
    assert!(contacts > 200 && clashes > 200, "{contacts} {clashes}");
}

#[test]
fn a_contact_is_as_deep_as_a_block_is_sunk_into_a_turned_face() {
    const TOLERANCE: f64 = 1.0 / 256.0;
    let block = |high| mesh(cuboid([0.0; 3], high)).unwrap();
    let (floor, post) = (block([4.0, 3.0, 0.5]), block([0.25, 0.5, 2.0]));
    for (axis, angle) in [([1.0, 2.0, 3.0], 0.75), ([1.0, 1.0, 0.0], 2.0), ([3.0, -1.0, 0.5], -0.5)] {
        let turn = Pose::from_axis_angle(axis, angle, [1.0, 2.0, -3.0]).unwrap();
        for sunk in [1.0 / 4096.0, 1.0 / 512.0, 1.0 / 300.0] {
            // No way along an axis of the world is as short as the one out of the floor.
            let sink = Pose::from_translation([1.5, 1.0, 0.5 - sunk]).unwrap();
            let mut scene = Scene::new();
            scene.add("floor", &floor, turn).unwrap();
            scene.add("post", &post, turn.compose(&sink).unwrap()).unwrap();
            let options = Options { contacts: true, ..Options::new(TOLERANCE) };
            let report = find(&[side("scene", &scene)], options, Execution::default()).unwrap();
            let contact = &report.clashes[0];
            let [lower, upper] = contact.depth.unwrap();
            assert_eq!((report.clashes.len(), contact.kind, contact.proved), (1, Kind::Contact, true));
            assert!(lower <= sunk && sunk <= upper + 1e-12 && upper <= sunk + 1e-9, "{sunk}: {lower} to {upper}");
        }
    }
}

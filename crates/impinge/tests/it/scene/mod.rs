//! Scenes against all pairs of parts, queried one by one.

mod repair;

use std::sync::atomic::{AtomicUsize, Ordering};

use impinge::Budget;
use impinge::query::batch::{Execution, Poses, Status};
use impinge::query::{self, Penetrates};
use impinge::scene::{Details, PartId, Question, Scene, SceneError, Stop};
use impinge::{Mesh, Pose, Positions, Shape};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::{cuboid, icosphere};
use impinge_testkit::rounds;

fn mesh(plain: &impinge_testkit::Mesh) -> Mesh {
    Mesh::new(Positions::F64(plain.vertices.clone()), plain.faces.clone()).unwrap()
}

fn grid_pose(rng: &mut Rng, reach: i64) -> Pose {
    Pose::from_translation([0; 3].map(|_| 0.5 * rng.integer(-reach, reach) as f64)).unwrap()
}

/// Returns a scene of boxes, spheres, meshes, solids, compounds, empty meshes and half-spaces,
/// placed so that many touch.
fn scene(rng: &mut Rng, count: i64) -> Scene {
    let (block, ball) = (mesh(&cuboid([-0.5; 3], [0.5; 3])), mesh(&icosphere(1)));
    let bar = Shape::cuboid([1.0, 0.25, 0.25]).unwrap();
    let compound =
        Shape::compound(&[(bar.clone(), Pose::IDENTITY), (Shape::sphere([0.0; 3], 0.5).unwrap(), Pose::IDENTITY)]);
    let shapes = [
        Shape::from(&block),
        Shape::from(block.solid()),
        Shape::from(ball.solid()),
        bar,
        compound.unwrap(),
        Shape::from(&Mesh::new(Positions::F64(Vec::new()), Vec::new()).unwrap()),
        Shape::half_space([0.0, 0.0, 1.0], -4.5).unwrap(),
    ];
    let mut scene = Scene::new();
    for number in 0..count {
        // One in twelve is empty or unbounded.
        let kind = if rng.one_in(12) { rng.integer(5, 6) } else { rng.integer(0, 4) };
        scene.add(format!("part {number}"), &shapes[kind as usize], grid_pose(rng, 9)).unwrap();
    }
    let parts: Vec<PartId> = scene.parts().collect();
    for _ in 0..count / 2 {
        let (a, b) = (rng.choose(&parts), rng.choose(&parts));
        scene.ignore(a, b);
        scene.set_group(a, Some(rng.integer(0, 3) as u32));
    }
    scene
}

fn holds(scene: &Scene, question: Question, [a, b]: [PartId; 2], poses: [&Pose; 2]) -> bool {
    let (placed_a, placed_b) = (scene.shape(a).at(*poses[0]).unwrap(), scene.shape(b).at(*poses[1]).unwrap());
    match question {
        Question::Within(clearance) => query::within(&placed_a, &placed_b, clearance),
        Question::Penetrates => query::penetrates(&placed_a, &placed_b) != Penetrates::No,
        _ => query::intersects(&placed_a, &placed_b),
    }
}

#[test]
fn scenes_report_the_pairs_of_brute_force() {
    let mut rng = Rng::new(482);
    let (mut hits, mut asked) = (0, 0);
    for round in 0..rounds(60) {
        // The scene compares few parts one by one, and sweeps many.
        let count = if round.is_multiple_of(3) { 60 } else { rng.integer(0, 12) };
        let scene = scene(&mut rng, count);
        let parts: Vec<PartId> = scene.parts().collect();
        let rows = rng.integer(1, 4) as usize;
        let mut moves = scene.configurations();
        let mut places: Vec<Vec<Pose>> = Vec::new();
        for &part in &parts {
            let is_fixed = rng.one_in(2);
            let poses: Vec<Pose> = (0..if is_fixed { 1 } else { rows }).map(|_| grid_pose(&mut rng, 9)).collect();
            moves.set(part, poses.clone()).unwrap();
            places.push(poses);
        }
        for question in [Question::Intersects, Question::Within(0.5), Question::Within(0.0), Question::Penetrates] {
            let all = scene.check(question, Stop::All, &moves, Execution::default()).unwrap();
            let first = scene.check(question, Stop::First, &moves, Execution::default().sequentially()).unwrap();
            for row in 0..all.values.len() {
                let place = |part: PartId| &places[part.index()][row.min(places[part.index()].len() - 1)];
                let mut expected = Vec::new();
                for (i, &a) in parts.iter().enumerate() {
                    for &b in &parts[i + 1..] {
                        if scene.admits(a, b) && holds(&scene, question, [a, b], [place(a), place(b)]) {
                            expected.push([a, b]);
                        }
                        asked += 1;
                    }
                }
                let found: Vec<[PartId; 2]> = all.values[row].iter().map(|pair| pair.parts).collect();
                assert_eq!(found, expected, "round {round}, {question:?}");
                assert_eq!(first.values[row].first(), all.values[row].first());
                assert!(first.values[row].len() <= 1);
                hits += found.len();
            }
        }
    }
    assert!(50 * hits > asked, "{hits} of {asked} pairs hold");
}

#[test]
fn shares_of_the_candidates_find_the_pairs_of_a_whole_check() {
    let mut rng = Rng::new(484);
    let (mut hits, mut undecided, mut asked) = (0, 0, 0);
    for round in 0..rounds(40) {
        let count = if round.is_multiple_of(3) { 60 } else { rng.integer(1, 20) };
        let scene = scene(&mut rng, count);
        let mut moves = scene.configurations();
        let parts: Vec<PartId> = scene.parts().collect();
        for &part in &parts {
            let mut matrices = [0; 2].map(|_| {
                let [x, y, z] = [0; 3].map(|_| 0.5 * rng.integer(-9, 9) as f64);
                [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]
            });
            if rng.one_in(40) {
                matrices[1][0][0] = f64::NAN;
            } else if rng.one_in(2) {
                continue;
            }
            moves.set(part, Poses::from_matrices(&[2], &matrices).unwrap()).unwrap();
        }
        for question in [Question::Intersects, Question::Within(0.5), Question::Penetrates] {
            let whole = scene.check(question, Stop::All, &moves, Execution::default()).unwrap();
            for row in 0..whole.values.len() {
                let found = scene.candidates(question, &moves, row, &Budget::new()).unwrap();
                assert!(found.pairs.is_sorted());
                assert_eq!(found.boxes.len(), scene.parts().len());
                let mut shares = Vec::new();
                for share in found.pairs.chunks(rng.integer(1, 9) as usize) {
                    shares.extend(scene.check_pairs(question, share, &moves, row, Execution::default()).unwrap());
                }
                assert_eq!(shares, whole.values[row], "round {round}, {question:?}");
                let is_undecided = shares.iter().any(|pair| pair.is_undecided);
                let status = if is_undecided && found.status == Status::Ok { Status::Undecided } else { found.status };
                assert_eq!(status, whole.status[row]);
                // A pair that is no candidate is not found either.
                let (a, b) = (rng.choose(&parts), rng.choose(&parts));
                let pair = [a.min(b), a.max(b)];
                if scene.admits(a, b) && found.pairs.binary_search(&pair).is_err() {
                    assert_eq!(scene.check_pairs(question, &[pair], &moves, row, Execution::default()).unwrap(), []);
                }
                (hits, undecided) = (hits + shares.len(), undecided + usize::from(found.status != Status::Ok));
                asked += found.pairs.len();
            }
        }
    }
    assert!(4 * hits > asked && hits < asked && undecided > 5, "{hits} of {asked}, {undecided} faulty");
}

#[test]
fn a_scene_without_moves_is_one_configuration() {
    let mut rng = Rng::new(483);
    let scene = scene(&mut rng, 40);
    let found = scene.check(Question::Intersects, Stop::All, &scene.configurations(), Execution::default()).unwrap();
    let pairs: Vec<[PartId; 2]> = found.values[0].iter().map(|pair| pair.parts).collect();
    assert_eq!((found.shape.len(), found.values.len()), (0, 1));
    assert_eq!(scene.pairs(Question::Intersects).unwrap(), pairs);
    assert!(!pairs.is_empty());
}

#[test]
fn invalid_poses_count_as_hits_with_every_part() {
    let ball = Shape::sphere([0.0; 3], 0.5).unwrap();
    let at = |x: f64| Pose::from_translation([x, 0.0, 0.0]).unwrap();
    let mut scene = Scene::new();
    let parts = [0, 1, 2].map(|i| scene.add(format!("{i}"), &ball, at(9.0 * f64::from(i))).unwrap());
    scene.ignore(parts[1], parts[2]);
    let sheared = [[1.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let there = [[1.0, 0.0, 0.0, 5.0], sheared[1], sheared[2], sheared[3]];
    let mut moves = scene.configurations();
    moves.set(parts[1], Poses::from_matrices(&[2], &[there, sheared]).unwrap()).unwrap();
    assert_eq!(moves.first_fault().map(|(part, row, _)| (part, row)), Some((parts[1], 1)));
    let found = scene.check(Question::Intersects, Stop::All, &moves, Execution::default()).unwrap();
    assert_eq!(found.status, [Status::Ok, Status::NotRigid]);
    assert_eq!(found.values[0], []);
    let pairs: Vec<_> = found.values[1].iter().map(|pair| (pair.parts, pair.is_undecided)).collect();
    assert_eq!(pairs, [([parts[0], parts[1]], true)]);
    assert!(moves.set(parts[0], vec![at(0.0); 3]).is_err());
    assert_eq!(scene.add("0", &ball, at(0.0)), Err(SceneError::NameTaken { name: "0".into() }));
    let sheared = Pose::from_matrix(sheared).unwrap();
    assert!(matches!(scene.add("sheared", &ball, sheared), Err(SceneError::Pose { .. })));
    assert_eq!((scene.find("2"), scene.name(parts[2])), (Some(parts[2]), "2"));
}

/// Returns a scene of nested surfaces, all pairs of whose boxes overlap.
fn nested(count: usize, size: impl Fn(usize) -> f64) -> Scene {
    let mut scene = Scene::new();
    for number in 0..count {
        let shell = mesh(&cuboid([-size(number); 3], [size(number); 3]));
        scene.add(format!("shell {number}"), Shape::from(&shell), Pose::IDENTITY).unwrap();
    }
    scene
}

#[test]
fn the_first_pair_may_come_after_any_number_of_pairs_that_are_apart() {
    // 1,326 pairs, of which only the last one intersects.
    let scene = nested(52, |number| 1.0 + number.min(50) as f64);
    let parts: Vec<PartId> = scene.parts().collect();
    let check = |stop| scene.check(Question::Intersects, stop, &scene.configurations(), Execution::default()).unwrap();
    let [first, all] = [Stop::First, Stop::All].map(|stop| check(stop).values);
    assert_eq!(first, all);
    assert_eq!(first[0].iter().map(|pair| pair.parts).collect::<Vec<_>>(), [[parts[50], parts[51]]]);
}

#[test]
fn pairs_after_the_first_are_not_checked() {
    // 19,900 pairs, all of which intersect. The budget is checked before each of them.
    let scene = nested(200, |_| 1.0);
    let asked = |stop| {
        let asked = AtomicUsize::new(0);
        let count = || {
            asked.fetch_add(1, Ordering::Relaxed);
            false
        };
        let budget = Budget::new().with_cancel(&count);
        let execution = Execution::default().with_budget(&budget);
        let found = scene.check(Question::Intersects, stop, &scene.configurations(), execution).unwrap();
        (found.values[0].len(), asked.into_inner())
    };
    let ((first, few), (all, many)) = (asked(Stop::First), asked(Stop::All));
    assert_eq!((first, all), (1, 19_900));
    assert!(many > 19_900 && few < many / 4, "{few} of {many}");
}

#[test]
fn details_of_a_part_are_empty_until_they_are_set_and_change_no_answer() {
    let mut scene = nested(3, |_| 1.0);
    let parts: Vec<PartId> = scene.parts().collect();
    assert_eq!(scene.details(parts[1]), &Details::default());
    let before = scene.pairs(Question::Intersects).unwrap();
    let details = Details {
        key: "2O2Fr$t4X7Zf8NOew3FNr2".into(),
        kind: "IfcWall".into(),
        path: vec!["building".into(), "storey".into()],
        extras: vec![("fire rating".into(), "F90".into())],
    };
    scene.set_details(parts[1], details.clone());
    assert_eq!(parts.iter().map(|&part| scene.details(part) == &details).collect::<Vec<_>>(), [false, true, false]);
    assert_eq!(scene.pairs(Question::Intersects).unwrap(), before);
    let at = Pose::from_translation([1.0, 2.0, 3.0]).unwrap();
    let moved = scene.add("moved", Shape::sphere([0.0; 3], 1.0).unwrap(), at).unwrap();
    assert_eq!(scene.pose(moved), &at);
}

//! Piles of faces in one place: the pairs of faces that tie are quadratic in number, although the
//! answer is small. The budget counts the work, as a query checks it after each slice.

use std::sync::atomic::{AtomicUsize, Ordering};

use impinge::Budget;
use impinge::query::{self, Query};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::grid_soup;

type Triangle = [[f64; 3]; 3];

const GROUND: Triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const BEAM: Triangle = [[0.9, 0.9, -1.0], [0.9, 0.9, 1.0], [0.8, 0.95, 1.0]];

fn soup(faces: &[Triangle]) -> Mesh {
    let numbers: Vec<[u32; 3]> = (0..faces.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    Mesh::new(Positions::F64(faces.concat()), numbers).expect("a mesh")
}

/// Returns how often a query checks its budget, and what it returns.
fn counted<T>(ask: impl FnOnce(Query<'_>) -> T) -> (usize, T) {
    let asked = AtomicUsize::new(0);
    let never = || {
        asked.fetch_add(1, Ordering::Relaxed);
        false
    };
    let answer = ask(Query::new().with_budget(&Budget::new().with_cancel(&never)));
    (asked.into_inner(), answer)
}

#[test]
fn the_distance_of_piles_is_that_of_two_faces_and_takes_linear_work() {
    let expected = query::distance(&soup(&[GROUND]), &soup(&[BEAM]));
    let mut work = Vec::new();
    for count in [1000, 4000] {
        let (asked, found) = counted(|query| query.distance(&soup(&vec![GROUND; count]), &soup(&vec![BEAM; count])));
        assert_eq!(found, expected);
        work.push(asked);
    }
    assert!(work[1] <= 64, "{work:?}");
}

/// Faces of a coarse grid, each with many copies that are mixed with those of other faces.
#[test]
fn copies_of_faces_change_no_distance() {
    let mut rng = Rng::new(905);
    let mut positive = 0;
    for round in 0..8 {
        let mut side = |shift: f64| {
            let plain = grid_soup(&mut rng, 5, 4, 2);
            let distinct: Vec<Triangle> = plain
                .faces
                .iter()
                .map(|face| face.map(|vertex| plain.vertices[vertex as usize].map(|x| x + shift)))
                .collect();
            // The first face is alone at the front, so that the first faces are those of
            // `distinct`.
            let more = (0..600).map(|_| distinct[rng.integer(0, distinct.len() as i64 - 1) as usize]);
            (soup(&distinct), soup(&distinct.iter().copied().chain(more.collect::<Vec<_>>()).collect::<Vec<_>>()))
        };
        let ((a, many_a), (b, many_b)) = (side(0.0), side(f64::from(round) * 2.0));
        let (alone, piled) = (query::distance(&a, &b), query::distance(&many_a, &many_b));
        assert!(piled.lower <= alone.upper && alone.lower <= piled.upper, "{alone:?} {piled:?}");
        assert_eq!(alone.upper == 0.0, piled.upper == 0.0);
        for clearance in [alone.lower.next_down(), alone.upper, 0.5 * alone.lower, alone.upper + 1.0] {
            assert_eq!(query::within(&a, &b, clearance), query::within(&many_a, &many_b, clearance), "{clearance}");
        }
        if alone.upper > 0.0 {
            let faces = |found: query::Distance| found.witness.and_then(|witness| witness.faces);
            assert_eq!(faces(alone), faces(piled), "round {round}");
            positive += 1;
        }
    }
    assert!(positive >= 4, "{positive} of 8 are apart");
}

#[test]
fn the_first_pairs_of_piles_take_linear_work() {
    let mut work = Vec::new();
    for count in [4000, 16_000] {
        let pile = soup(&vec![GROUND; count]);
        let (asked, found) = counted(|query| query.intersecting_pairs_up_to(&pile, &pile, 10));
        assert_eq!(found.pairs, (0..10).map(|face| [0, face]).collect::<Vec<_>>());
        assert!(found.truncated);
        work.push(asked);
    }
    assert!(work[1] < 8 * work[0].max(100), "{work:?}");
}

/// Thousands of pairs of a soup on a coarse grid: the first ones are those of the sorted list.
#[test]
fn the_first_pairs_are_the_smallest_of_all() {
    let mut rng = Rng::new(906);
    for side in [2, 5] {
        let soup = grid_soup(&mut rng, 900, side, 2);
        let mesh = Mesh::new(Positions::F64(soup.vertices), soup.faces).expect("a mesh");
        let turned = mesh.at(Pose::from_translation([1.0, 0.0, 0.0]).expect("a pose"));
        let all = query::intersecting_pairs(&mesh, turned);
        assert!(all.len() > 40_000, "{}", all.len());
        for limit in [0, 1, 10, 500, 5000, all.len() - 1, all.len()] {
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                let some = pool.install(|| query::intersecting_pairs_up_to(&mesh, turned, limit));
                assert_eq!(some.pairs, all[..limit], "{limit} pairs on {threads} threads");
                assert_eq!(some.truncated, limit < all.len());
            }
        }
    }
}

/// Flat faces of sizes from 2^-500 to 2^100. Each pair is decided exactly.
#[test]
fn a_search_checks_its_budget_after_few_exact_decisions() {
    let mut rng = Rng::new(907);
    let faces: Vec<Triangle> = (0..150)
        .map(|_| {
            [0; 3].map(|_: i32| {
                let [x, y] = [0; 2].map(|_: i32| rng.uniform(-1.0, 1.0) * 2.0_f64.powi(rng.integer(-500, 100) as i32));
                [x, y, 0.0]
            })
        })
        .collect();
    let mesh = soup(&faces);
    let (asked, pairs) = counted(|query| query.intersecting_pairs(&mesh, &mesh));
    assert!(pairs.len() > 5000, "{}", pairs.len());
    assert!(asked > 22_500 * 64 / 2048 / 2, "{asked}");
    let patience = AtomicUsize::new(0);
    let must_stop = || patience.fetch_add(1, Ordering::Relaxed) >= 3;
    let some = Query::new().with_budget(&Budget::new().with_cancel(&must_stop)).intersecting_pairs(&mesh, &mesh);
    assert!(some.len() < pairs.len() / 4, "{} of {}", some.len(), pairs.len());
}

/// A cone of thousands of faces with one tip, which have a hierarchy of their own.
#[test]
fn a_search_at_a_hub_checks_its_budget() {
    let mut fan = impinge_testkit::generate::solids::fan(4000);
    fan.vertices.iter_mut().skip(1).for_each(|vertex| vertex[2] = 0.7);
    let mesh = Mesh::new(Positions::F64(fan.vertices), fan.faces).expect("a mesh");
    let (asked, pairs) = counted(|query| query.self_intersecting_pairs(&mesh));
    assert!(pairs.is_empty());
    assert!(asked > 4000 / 8, "{asked}");
}

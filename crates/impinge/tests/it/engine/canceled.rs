//! Canceled queries: they return soon, with the safe answer, and their caches change no later
//! answer.

use std::sync::atomic::{AtomicUsize, Ordering};

use impinge::Budget;
use impinge::mesh::Options;
use impinge::query::{self, Cache, Penetrates, Query};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::knots::{Knot, TREFOIL, torus_knot};

fn knot(radius: f64) -> Mesh {
    let knot = torus_knot(2000, 100, Knot { radius, ..TREFOIL });
    Mesh::new(Positions::F64(knot.vertices), knot.faces).expect("a mesh")
}

#[test]
fn canceled_queries_return_the_safe_answer_at_once() {
    // The thin knot lies inside the other, close to it everywhere.
    let (mesh, thin) = (knot(TREFOIL.radius), knot(0.9 * TREFOIL.radius));
    let other = thin.at(Pose::IDENTITY);
    assert!(!query::intersects(&mesh, other), "the surfaces are apart");
    let distance = query::distance(&mesh, other);
    let touching = mesh.at(Pose::from_translation([0.003, 0.001, 0.002]).expect("a pose"));
    let pairs = query::intersecting_pairs(&mesh, touching);
    for patience in [0, 1, 3] {
        let asked = AtomicUsize::new(0);
        let must_stop = || asked.fetch_add(1, Ordering::Relaxed) >= patience;
        let budget = || Budget::new().with_cancel(&must_stop);
        let ended_soon = || (1..patience + 300).contains(&asked.swap(0, Ordering::Relaxed));
        let (mut hits, mut witnesses) = (Cache::default(), Cache::default());

        assert!(
            Query::new().with_budget(&budget()).with_cache(&mut hits).intersects(&mesh, other) && ended_soon(),
            "{patience}"
        );
        assert!(!Query::new().with_cache(&mut hits).intersects(&mesh, other));

        let found = Query::new().with_budget(&budget()).with_cache(&mut witnesses).distance(&mesh, other);
        assert!(found.lower == 0.0 && found.upper.is_finite() && ended_soon(), "{patience}: {found:?}");
        assert_eq!(Query::new().with_cache(&mut witnesses).distance(&mesh, other), distance);

        let near = 0.999 * distance.lower;
        assert!(Query::new().with_budget(&budget()).within(&mesh, other, near) && ended_soon());
        assert!(!Query::new().with_cache(&mut witnesses).within(&mesh, other, near));

        let some = Query::new().with_budget(&budget()).intersecting_pairs(&mesh, touching);
        assert!(some.len() < pairs.len() && ended_soon(), "{patience}: {} of {}", some.len(), pairs.len());
        assert!(some.iter().all(|pair| pairs.binary_search(pair).is_ok()));
    }
}

/// The knot touches its moved copy all along, so that many contacts have to be decided.
#[test]
fn canceled_questions_about_solids_are_undecided() {
    let mesh = knot(TREFOIL.radius);
    let inside = mesh.at(Pose::from_translation([9.0 * TREFOIL.radius, 0.0, 0.0]).expect("a pose"));
    let touching = mesh.at(Pose::from_translation([0.003, 0.001, 0.002]).expect("a pose"));
    assert_eq!(query::penetrates(&mesh, touching), Penetrates::Yes);
    let apart = query::penetrates(&mesh, inside);
    for patience in [0, 1, 100] {
        let asked = AtomicUsize::new(0);
        let must_stop = || asked.fetch_add(1, Ordering::Relaxed) >= patience;
        let budget = || Budget::new().with_cancel(&must_stop);
        assert_ne!(Query::new().with_budget(&budget()).penetrates(&mesh, touching), Penetrates::No, "{patience}");
        asked.store(0, Ordering::Relaxed);
        assert_ne!(
            Query::new().with_budget(&budget()).penetrates(&mesh, inside),
            Penetrates::No,
            "{patience}: {apart:?}"
        );
        asked.store(0, Ordering::Relaxed);
        assert!(Query::new().with_budget(&budget()).self_intersecting_pairs(&mesh).is_empty());
    }
    assert_eq!(query::penetrates(&mesh, inside), apart);
}

/// A pile of faces in one place, of which each intersects each other one.
#[test]
fn a_canceled_search_for_self_intersections_ends_soon() {
    let [ground, wall] =
        [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.25, 0.25, -1.0], [0.25, 0.25, 1.0], [2.0, 0.5, 0.0]]];
    let faces: Vec<[u32; 3]> = (0..3000).map(|i| if i % 2 == 0 { [0, 1, 2] } else { [3, 4, 5] }).collect();
    let pile = Mesh::new([ground, wall].concat(), faces).expect("a mesh");
    let all = query::self_intersecting_pairs(&pile).len();
    let asked = AtomicUsize::new(0);
    let must_stop = || asked.fetch_add(1, Ordering::Relaxed) >= 2;
    let some = Query::new().with_budget(&Budget::new().with_cancel(&must_stop)).self_intersecting_pairs(&pile).len();
    assert!(some < all / 2, "{some} of {all}");
    // Each of the tasks that threads share asks once more, and does nothing.
    assert!(asked.into_inner() < 1 << 14);
}

/// Checks that a budget that is never spent changes no answer.
#[test]
fn a_budget_that_is_not_spent_changes_no_answer() {
    let (mesh, thin) = (knot(TREFOIL.radius), knot(0.9 * TREFOIL.radius));
    let asked = AtomicUsize::new(0);
    let never = || {
        asked.fetch_add(1, Ordering::Relaxed);
        false
    };
    let budget = Budget::new().with_cancel(&never);
    let options = Options { budget: &budget, ..Options::default() };
    let touching = mesh.at(Pose::from_translation([0.003, 0.001, 0.002]).expect("a pose"));
    let pairs = Query::new().with_options(options).intersecting_pairs(&mesh, touching);
    assert_eq!(pairs, query::intersecting_pairs(&mesh, touching));
    let found = Query::new().with_options(options).distance(&mesh, &thin);
    assert_eq!(found, query::distance(&mesh, &thin));
    assert!(asked.into_inner() > 3);
}

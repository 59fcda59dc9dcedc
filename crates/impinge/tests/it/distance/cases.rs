//! Distances in the corpus of cases (`cases/distances.toml`).

use impinge_testkit::cases::distances;

use crate::distance::ways::{distance_in_every_way, engine_mesh, within_in_every_way};

#[test]
fn every_distance_of_the_corpus_is_within_its_interval() {
    let cases = distances().expect("the corpus");
    assert!(cases.len() >= 12, "only {} distances", cases.len());
    for case in cases {
        let (a, b) = (engine_mesh(&case.a.mesh), engine_mesh(&case.b.mesh));
        let (a, b) = ((&a, &case.world_from_a), (&b, &case.world_from_b));
        let found = distance_in_every_way(a, b);
        let (lower, upper) = (case.distance - case.tolerance, case.distance + case.tolerance);
        assert!(found.lower <= upper && lower <= found.upper, "{} ({}): {found:?}", case.id, case.source);
        assert_eq!(found.upper == 0.0, case.distance == 0.0, "{}: {found:?}", case.id);
        assert!(within_in_every_way(a, b, upper), "{}", case.id);
        assert!(case.distance == 0.0 || !within_in_every_way(a, b, lower - found.upper * 1e-12), "{}", case.id);
    }
}

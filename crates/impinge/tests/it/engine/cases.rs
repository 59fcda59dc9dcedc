//! The corpus of cases with known answers (`cases/*.toml`).

use impinge_testkit::cases::{Expected, corpus};

use crate::engine::ways::{engine_mesh, pairs_in_every_way};

#[test]
fn every_case_of_the_corpus_has_its_answer() {
    let cases = corpus().expect("the corpus");
    assert!(cases.len() >= 60, "only {} cases", cases.len());
    for case in cases {
        let a = engine_mesh(&case.a.mesh, case.a.precision);
        let b = engine_mesh(&case.b.mesh, case.b.precision);
        let found = pairs_in_every_way((&a, &case.world_from_a), (&b, &case.world_from_b));
        let answer = match &case.expected {
            Expected::Intersects(_) => Expected::Intersects(!found.is_empty()),
            Expected::Pairs(_) => Expected::Pairs(found),
            Expected::PairCount(_) => Expected::PairCount(found.len()),
        };
        assert_eq!(answer, case.expected, "{} ({})", case.id, case.source);
    }
}

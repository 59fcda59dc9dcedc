//! Recorded queries against their authors' answers and exact times. Skipped if the data folder is
//! missing.

use std::cmp::Ordering;

use impinge::sweep::{Impact, edge_edge, vertex_face};
use impinge_testkit::ccd::{Query, QueryKind, read_all};
use impinge_testkit::env_rob::data_folder;
use impinge_testkit::oracle::first_contact;

fn answer(query: &Query) -> Impact {
    match query.kind {
        QueryKind::VertexFace => vertex_face(&query.t0, &query.t1).expect("in range"),
        QueryKind::EdgeEdge => edge_edge(&query.t0, &query.t1).expect("in range"),
    }
}

/// Checks that no collision is missed and none is invented. Tight-Inclusion invents one in 7 % of
/// the misses.
#[test]
fn recorded_queries_are_decided_as_their_authors_did() {
    let Some(data) = data_folder() else { return };
    let (mut touching, mut apart, mut alarms, mut undecided) = (0, 0, 0, 0);
    for kind in [QueryKind::VertexFace, QueryKind::EdgeEdge] {
        for (name, queries) in read_all(&data, kind).expect("the recorded queries") {
            for (number, query) in queries.iter().enumerate() {
                let impact = answer(query);
                assert!(impact.hit() || !query.touches, "missed: {name} {number} {query:?}");
                if query.touches {
                    touching += 1;
                } else {
                    apart += 1;
                    alarms += usize::from(impact.hit());
                }
                undecided += usize::from(!impact.is_decided());
            }
        }
    }
    assert!(touching > 200 && apart > 1500 && undecided < 5, "{touching} {apart} {undecided}");
    assert_eq!(alarms, 0);
}

/// Checks one query in six, because an exact time takes about 20 ms.
#[test]
fn recorded_queries_have_their_exact_times() {
    let Some(data) = data_folder() else { return };
    let (mut touching, mut widest) = (0, 0.0_f64);
    for kind in [QueryKind::VertexFace, QueryKind::EdgeEdge] {
        for (name, queries) in read_all(&data, kind).expect("the recorded queries") {
            for (number, query) in queries.iter().enumerate().step_by(6) {
                let impact = answer(query);
                let truth = first_contact(kind, &query.t0, &query.t1);
                assert_eq!(truth.is_some(), query.touches, "{name} {number}");
                let Some(root) = truth else { continue };
                touching += 1;
                assert_ne!(root.compare(impact.t_lower), Ordering::Less, "{name} {number} {impact:?}");
                if impact.is_decided() {
                    assert_ne!(root.compare(impact.t_upper), Ordering::Greater, "{name} {number} {impact:?}");
                    widest = widest.max(impact.t_upper - impact.t_lower);
                }
            }
        }
    }
    assert!(touching > 20 && widest <= 1e-9, "{touching} {widest}");
}

//! First contact of four moving corners against exact times.
//!
//! Cases: on grids, in planes, on lines, without motion, touching at the start or at the end, and
//! missing each other by a unit in the last place. Guards `sweep::vertex_face` and
//! `sweep::edge_edge`.

use std::cmp::Ordering;

use impinge::InputErrorKind;
use impinge::sweep::{Impact, edge_edge, vertex_face};
use impinge_testkit::ccd::QueryKind;
use impinge_testkit::generate::Rng;
use impinge_testkit::oracle::first_contact;
use impinge_testkit::rounds;

type Corners = [[f64; 3]; 4];

const KINDS: [QueryKind; 2] = [QueryKind::VertexFace, QueryKind::EdgeEdge];

fn answer(kind: QueryKind, t0: &Corners, t1: &Corners) -> Impact {
    match kind {
        QueryKind::VertexFace => vertex_face(t0, t1).expect("in range"),
        QueryKind::EdgeEdge => edge_edge(t0, t1).expect("in range"),
    }
}

/// Counts of outcomes of a run of queries.
#[derive(Debug, Default)]
struct Counts {
    touching: usize,
    at_start: usize,
    at_end: usize,
    undecided: usize,
    alarms: usize,
    widest: f64,
}

impl Counts {
    /// Checks that the interval of the answer contains the exact time.
    fn check(&mut self, kind: QueryKind, t0: &Corners, t1: &Corners) {
        let impact = answer(kind, t0, t1);
        self.undecided += usize::from(!impact.is_decided());
        let Some(root) = first_contact(kind, t0, t1) else {
            assert_eq!(impact.t_upper, f64::INFINITY, "false contact: {kind:?} {t0:?} {t1:?}");
            self.alarms += usize::from(impact.hit());
            return;
        };
        self.touching += 1;
        self.at_start += usize::from(root.compare(0.0) == Ordering::Equal);
        self.at_end += usize::from(root.compare(1.0) == Ordering::Equal);
        assert!(impact.hit(), "missed: {kind:?} {t0:?} {t1:?}");
        assert_ne!(root.compare(impact.t_lower), Ordering::Less, "late: {impact:?} {kind:?} {t0:?} {t1:?}");
        if impact.is_decided() {
            assert_ne!(root.compare(impact.t_upper), Ordering::Greater, "early: {impact:?} {kind:?} {t0:?} {t1:?}");
            self.widest = self.widest.max(impact.t_upper - impact.t_lower);
        } else {
            // As near as floats allow.
            assert_ne!(root.compare(impact.t_lower + 1e-9), Ordering::Greater, "{impact:?} {kind:?} {t0:?} {t1:?}");
        }
    }
}

fn corners(rng: &mut Rng, reach: i64) -> Corners {
    std::array::from_fn(|_| std::array::from_fn(|_| rng.integer(-reach, reach) as f64))
}

#[test]
fn corners_on_small_grids_have_their_exact_times() {
    let mut rng = Rng::new(1);
    let mut counts = Counts::default();
    for case in 0..2400 {
        let reach = [1, 2, 4, 30][case % 4];
        let (mut t0, mut t1) = (corners(&mut rng, reach), corners(&mut rng, reach));
        // Very different scales, and places far from the origin.
        let scale = [1.0, 2.0_f64.powi(-40), 2.0_f64.powi(60)][case / 4 % 3];
        let offset = [0.0, 2.0_f64.powi(20)][case / 12 % 2];
        for corners in [&mut t0, &mut t1] {
            *corners = corners.map(|corner| corner.map(|x| (x + offset) * scale));
        }
        counts.check(KINDS[case / 24 % 2], &t0, &t1);
    }
    assert!((400..1200).contains(&counts.touching) && counts.at_start > 80 && counts.at_end > 50, "{counts:?}");
    assert!(counts.alarms == 0 && counts.undecided < 60 && counts.widest <= 1e-9, "{counts:?}");
}

#[test]
fn flat_queries_have_their_exact_times() {
    let mut rng = Rng::new(2);
    let mut counts = Counts::default();
    let rounds = rounds(120);
    for case in 0..rounds {
        let (mut t0, mut t1) = (corners(&mut rng, 3), corners(&mut rng, 3));
        match case % 4 {
            // All corners stay in one plane, or on one line.
            0 => (t0, t1) = (t0.map(|[x, y, _]| [x, y, x]), t1.map(|[x, y, _]| [x, y, x])),
            1 => (t0, t1) = (t0.map(|[x, ..]| [x, x, -x]), t1.map(|[x, ..]| [x, x, -x])),
            // No motion.
            2 => t1 = t0,
            // Faces without area, and edges without length.
            _ => ([t0[2], t0[3]], [t1[2], t1[3]]) = ([t0[3]; 2], [t1[3]; 2]),
        }
        counts.check(KINDS[case / 4 % 2], &t0, &t1);
    }
    let touching = counts.touching * 100 / rounds;
    assert!((30..75).contains(&touching) && counts.at_start * 10 > rounds && counts.at_end > 0, "{counts:?}");
    assert!(counts.alarms == 0 && counts.undecided * 3 < rounds, "{counts:?}");
}

/// Checks a vertex on a corner, an edge or the inside of a face, or an edge on another one, at the
/// start, at the end or between. Then it moves by one unit in the last place.
#[test]
fn touching_and_missing_by_one_unit_are_distinguished() {
    let mut rng = Rng::new(3);
    let mut counts = Counts::default();
    let rounds = rounds(1_000);
    for case in 0..rounds {
        let kind = KINDS[case % 2];
        let mut random = || -> [f64; 3] { std::array::from_fn(|_| rng.uniform(-1.0, 1.0)) };
        let (mut t0, mut t1): (Corners, Corners) =
            (std::array::from_fn(|_| random()), std::array::from_fn(|_| random()));
        let other = [1, 2][case % 2];
        match case / 2 % 4 {
            0 => t0[0] = t0[other],
            1 => t1[0] = t1[other + 1],
            // Through a corner of the other at the middle, exactly unless rounded.
            2 => t1[0] = std::array::from_fn(|k| t0[other][k] + t1[other][k] - t0[0][k]),
            // Onto a line between two corners at the end.
            _ => t1[0] = std::array::from_fn(|k| 0.5 * (t1[other][k] + t1[3][k])),
        }
        let k = case / 8 % 3;
        match case / 24 % 3 {
            0 => t1[0][k] = t1[0][k].next_up(),
            1 => t1[0][k] = t1[0][k].next_down(),
            _ => {}
        }
        counts.check(kind, &t0, &t1);
    }
    let touching = counts.touching * 100 / rounds;
    assert!((40..90).contains(&touching) && counts.at_start * 7 > rounds, "{counts:?}");
    assert!(counts.at_end * 40 > rounds && counts.alarms == 0 && counts.undecided * 20 < rounds, "{counts:?}");
}

#[test]
fn double_roots_are_contacts() {
    // The vertex passes an edge that turns: in the frame of the edge it reaches the line and leaves
    // it again.
    let t0 = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let t1 = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -4.0, 8.0]];
    let impact = answer(QueryKind::VertexFace, &t0, &t1);
    let root = first_contact(QueryKind::VertexFace, &t0, &t1);
    assert_eq!(impact.hit(), root.is_some());
    // The face flattens to a needle and opens again on the other side. The vertex is on its line
    // only at that time.
    let t0 = [[0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 1.0]];
    let t1 = [[0.5, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, -1.0]];
    let impact = answer(QueryKind::VertexFace, &t0, &t1);
    assert!(impact.t_lower <= 0.5 && impact.t_lower > 0.5 - 1e-9 && impact.hit(), "{impact:?}");
}

#[test]
fn tiny_and_vast_motions_have_their_times() {
    for size in [1e-300, 1e-40, 1e-12, 1.0, 1e6, 1e37] {
        for gap in [1e-300, 1e-12, 1.0, 3.0] {
            let t0 = [[0.25, 0.25, gap], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|p| p.map(|x| x * size));
            if t0[0][2] == 0.0 {
                continue; // the gap underflows to zero
            }
            let mut t1 = t0;
            t1[0][2] = -t0[0][2];
            let impact = answer(QueryKind::VertexFace, &t0, &t1);
            assert!(impact.t_lower <= 0.5 && impact.t_lower > 0.5 - 1e-9, "{size:e} {gap:e} {impact:?}");
            t1[0][2] = 0.5 * t0[0][2];
            assert_eq!(answer(QueryKind::VertexFace, &t0, &t1).hit(), t1[0][2] == 0.0, "{size:e} {gap:e}");
        }
    }
}

#[test]
fn swapped_and_reversed_queries_agree() {
    let mut rng = Rng::new(4);
    let mut hits = 0;
    for case in 0..4000 {
        let (t0, t1) = (corners(&mut rng, 3), corners(&mut rng, 3));
        let swap = |[a, b, c, d]: Corners| [c, d, b, a];
        let (edges, swapped) =
            (answer(QueryKind::EdgeEdge, &t0, &t1), answer(QueryKind::EdgeEdge, &swap(t0), &swap(t1)));
        assert_eq!(edges.hit(), swapped.hit(), "{t0:?} {t1:?}");
        let kind = KINDS[case % 2];
        let (forward, backward) = (answer(kind, &t0, &t1), answer(kind, &t1, &t0));
        assert_eq!(forward.hit(), backward.hit(), "{t0:?} {t1:?}");
        if forward.is_decided() && backward.is_decided() && forward.hit() {
            assert!(forward.t_lower <= 1.0 - backward.t_lower + 1e-9, "{t0:?} {t1:?}");
        }
        hits += usize::from(edges.hit());
    }
    assert!((600..2000).contains(&hits), "{hits}");
}

#[test]
fn invalid_corners_are_rejected_by_index() {
    let good = [[0.0; 3]; 4];
    let mut bad = good;
    bad[2][1] = f64::NAN;
    let error = vertex_face(&good, &bad).expect_err("NaN");
    assert_eq!(*error.kind(), InputErrorKind::NonFinite { what: "corner", index: 6 });
    bad[2][1] = 2.0_f64.powi(128);
    let error = edge_edge(&bad, &good).expect_err("2^128");
    assert!(matches!(error.kind(), InputErrorKind::OutOfRange { what: "corner", index: 2, .. }));
    bad[2][1] = bad[2][1].next_down();
    assert!(edge_edge(&bad, &good).expect("in range").hit());
}

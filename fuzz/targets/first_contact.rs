//! Moving corners and edges with many ties: no contact may be missed or reported too late.

#![no_main]

use std::cmp::Ordering;

use arbitrary::{Arbitrary, Unstructured};
use impinge::sweep::{edge_edge, vertex_face};
use impinge_testkit::ccd::QueryKind;
use impinge_testkit::oracle::first_contact;
use libfuzzer_sys::fuzz_target;

#[derive(Debug)]
struct Corners([[f64; 3]; 4]);

impl<'a> Arbitrary<'a> for Corners {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let mut corners = [[0.0; 3]; 4];
        for x in corners.as_flattened_mut() {
            let on_grid = 0.5 * f64::from(bytes.int_in_range(-3..=3_i8)?);
            *x = match bytes.int_in_range(0..=15_u8)? {
                0 => on_grid.next_up(),
                1 => on_grid * (1.0 / 3.0),
                _ => on_grid,
            };
        }
        Ok(Self(corners))
    }
}

fuzz_target!(|motion: [Corners; 2]| {
    let [Corners(from), Corners(to)] = motion;
    let asked = [(QueryKind::VertexFace, vertex_face(&from, &to)), (QueryKind::EdgeEdge, edge_edge(&from, &to))];
    for (kind, impact) in asked {
        let impact = impact.expect("finite corners");
        match first_contact(kind, &from, &to) {
            // The true time must lie in the reported interval.
            Some(root) => {
                assert!(impact.hit() && root.compare(impact.t_lower) != Ordering::Less, "{impact:?} is late");
                let is_by_then = |t: f64| t == f64::INFINITY || root.compare(t) != Ordering::Greater;
                assert!(is_by_then(impact.t_upper), "{impact:?} is early");
            }
            None => assert!(impact.t_upper == f64::INFINITY, "{impact:?} but nothing touches"),
        }
    }
});

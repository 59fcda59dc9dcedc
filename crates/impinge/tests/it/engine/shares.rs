//! Shares of the search for pairs, each with other options, as on machines that differ.

use impinge::query::{self, Query, Share};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::icosphere;

use super::ways::options_in_turns;

#[test]
fn shares_of_large_meshes_have_each_pair_once_and_about_the_same_work() {
    let plain = icosphere(5);
    let ball = Mesh::new(Positions::F64(plain.vertices), plain.faces).unwrap();
    let small = Mesh::new(Positions::F64(icosphere(1).vertices), icosphere(1).faces).unwrap();
    let at = |x: f64| Pose::from_translation([x, 0.25, 0.0]).unwrap();
    for (a, b) in [(ball.at(at(0.0)), ball.at(at(0.5))), (small.at(at(0.0)), ball.at(at(0.5)))] {
        let expected = query::intersecting_pairs(a, b);
        assert!(expected.len() > 200);
        for of in [1, 2, 7, 64, 5000] {
            let mut all = Vec::new();
            let mut most = 0;
            for (index, options) in (0..of).zip(options_in_turns()) {
                let share = Share::new(index, of).unwrap();
                let pairs = Query::new().with_options(options).intersecting_pairs_in(a, b, share);
                assert!(pairs.is_sorted());
                most = most.max(pairs.len());
                all.extend(pairs);
            }
            all.sort_unstable();
            assert!(all == expected, "{of} shares have {} pairs, not {}", all.len(), expected.len());
            assert!(of > 7 || most < 2 * expected.len() / of as usize + 50, "{most} pairs in one of {of} shares");
        }
        assert_eq!(Share::new(3, 3), None);
    }
}

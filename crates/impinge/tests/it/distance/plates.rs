//! Flat sides that face each other: thousands of pairs of faces tie, and bounds from planes end the
//! search at once.
//!
//! Guards the direction bounds of `mesh::distance`.

use impinge::hierarchy::Builder;
use impinge::query::{Cache, Query};
use impinge::{Mesh, query};
use impinge_testkit::Affine;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::rotation;
use impinge_testkit::generate::solids::plane_grid;

use crate::distance::ways::{all_options, engine_mesh, engine_pose};

/// Returns the map followed by a step along its own axes.
fn beside(map: &Affine, step: [f64; 3]) -> Affine {
    let moved = |i: usize| (0..3).map(|k| map.linear[i][k] * step[k]).sum::<f64>() + map.translation[i];
    Affine { linear: map.linear, translation: [0, 1, 2].map(moved) }
}

/// Checks the interval of a distance against [`query::within`], which is exact, and returns it.
///
/// The interval must be the same for every option, with and without a cache.
fn check_interval(mesh: &Mesh, map: &Affine, other: &Affine) -> [f64; 2] {
    let (a, b) = (mesh.at(engine_pose(map)), mesh.at(engine_pose(other)));
    let mut warm = Cache::default();
    let found = Query::new().with_cache(&mut warm).distance(a, b);
    for options in all_options() {
        for mut cache in [Cache::default(), warm.clone()] {
            let again = Query::new().with_options(options).with_cache(&mut cache).distance(a, b);
            // The witness among tied faces may depend on the host.
            assert_eq!([again.lower, again.upper], [found.lower, found.upper], "{:?}", options.host);
        }
    }
    assert!(query::within(a, b, found.upper) && !query::within(a, b, found.lower.next_down()), "{found:?}");
    let swapped = query::distance(b, a);
    assert_eq!([swapped.lower, swapped.upper], [found.lower, found.upper]);
    [found.lower, found.upper]
}

#[test]
fn plates_have_their_distance_to_the_last_digits() {
    let mesh = engine_mesh(&plane_grid(48, 48));
    let mut rng = Rng::new(488);
    let mut narrow = 0;
    for round in 0..12 {
        let map = if round % 2 == 0 { Affine::IDENTITY } else { rotation(&mut rng) };
        let gap = [0.1 + 0.2, 7.0, 1.0 / 3.0][round / 2 % 3];
        let shift = if round < 6 { [0.25, 0.5, gap] } else { [3.0, -5.0, gap] };
        let [lower, upper] = check_interval(&mesh, &map, &beside(&map, shift));
        // Because the matrix is rounded, the exact gap differs slightly from `gap`.
        assert!((upper - gap).abs() < 1e-13, "round {round}: {lower} to {upper}");
        assert!(round % 2 == 1 || (lower <= gap && gap <= upper), "round {round}: {lower} to {upper}, not {gap}");
        narrow += usize::from(upper - lower <= 8.0 * f64::EPSILON * gap);
    }
    assert!(narrow >= 10, "{narrow} of 12 are proved by planes");
}

/// Checks that the builder changes no bit of the interval, and that an unused vertex between the
/// plates only widens it.
#[test]
fn builders_change_no_bit_of_the_distance_of_plates() {
    let plate = plane_grid(40, 40);
    let mut rng = Rng::new(489);
    let map = rotation(&mut rng);
    let other = beside(&map, [0.5, 0.25, 0.75]);
    let mut mesh = engine_mesh(&plate);
    let mut intervals = Vec::new();
    for builder in Builder::ALL {
        mesh.rebuild(builder);
        intervals.push(check_interval(&mesh, &map, &other));
    }
    assert!(intervals.iter().all(|interval| *interval == intervals[0]), "{intervals:?}");

    let mut spoiled = plate;
    spoiled.vertices.push([0.0, 0.0, 0.375]);
    let [lower, upper] = check_interval(&engine_mesh(&spoiled), &map, &other);
    assert!(lower <= intervals[0][0] && intervals[0][1] <= upper && upper - lower < 1e-11, "{lower} to {upper}");
}

/// Checks plates that are tilted slightly, or have one vertex out of their plane: the nearest
/// corner decides.
#[test]
fn nearly_parallel_plates_have_the_distance_of_their_nearest_corner() {
    for (tilt, bump) in [(1e-9, 0.0), (0.0, 1e-9), (1e-14, 0.0), (0.0, 1e-14), (0.0, -1e-9)] {
        let mut plate = plane_grid(40, 40);
        let [low, high] = [0, 1].map(|end| {
            let along = plate.vertices.iter().map(|vertex| vertex[0]);
            if end == 0 { along.fold(f64::INFINITY, f64::min) } else { along.fold(f64::NEG_INFINITY, f64::max) }
        });
        plate.vertices.iter_mut().for_each(|vertex| vertex[2] = tilt * (vertex[0] - low) / (high - low));
        let middle = plate.vertices.len() / 2 + 7;
        plate.vertices[middle][2] += bump;
        let below = engine_mesh(&plate);
        let above = engine_mesh(&plane_grid(40, 40));
        let other = Affine::translation([0.1, 0.2, 0.5]);
        let found = query::distance(&below, above.at(engine_pose(&other)));
        // The plates overlap in projection nearly everywhere, at the higher end of the tilt too.
        let expected = 0.5 - tilt - bump.max(0.0);
        let is_held = found.lower <= expected + 1e-15 && expected - 1e-15 <= found.upper;
        assert!(is_held && found.upper - found.lower < 4e-12, "{tilt} {bump}: {found:?}, not {expected}");
        let placed = above.at(engine_pose(&other));
        assert!(query::within(&below, placed, found.upper) && !query::within(&below, placed, found.lower.next_down()));
    }
}

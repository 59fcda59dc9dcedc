//! Meshes whose faces all intersect each other: a limit keeps memory small, and the result reports
//! that it was reached.

use impinge::mesh::{HostChoice, Options};
use impinge::query::{self, Query};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::grid_soup;
use impinge_testkit::rounds;

use crate::{COUNTED, alone};

fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(run)
}

/// Returns a mesh of `count` equal triangles.
fn pile(count: usize) -> Mesh {
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    Mesh::new(Positions::F32(corners), vec![[0, 1, 2]; count]).expect("a mesh")
}

fn first_of_soups_are_first_of_all() {
    let (mut reached, mut not_reached) = (0, 0);
    let rounds = rounds(15);
    for seed in 0..rounds as u64 {
        let mut rng = Rng::new(seed);
        let [a, b] = [0; 2].map(|_| {
            let count = rng.integer(1, 300) as usize;
            let soup = grid_soup(&mut rng, count, 5, 3);
            Mesh::new(Positions::F64(soup.vertices), soup.faces).expect("a mesh")
        });
        let all = query::intersecting_pairs(&a, &b);
        for limit in [0, 1, 7, all.len() / 2, all.len().saturating_sub(1), all.len(), all.len() + 1, usize::MAX] {
            for threads in [1, 2] {
                let some = on_threads(threads, || query::intersecting_pairs_up_to(&a, &b, limit));
                assert_eq!(some.pairs, all[..limit.min(all.len())], "seed {seed}, limit {limit}, {threads} threads");
                assert_eq!(some.truncated, limit < all.len(), "seed {seed}, limit {limit}");
                let room = some.pairs.capacity();
                assert!(!some.truncated || room == limit, "room for {room} pairs, limit {limit}");
                *(if some.truncated { &mut reached } else { &mut not_reached }) += 1;
            }
        }
    }
    assert!(reached > 5 * rounds && not_reached > 5 * rounds, "{reached} limits reached, {not_reached} not");
}

/// Checks the memory of a limited query. All four million pairs would take 32 MB, and as much again
/// to sort.
fn a_limit_bounds_memory() {
    const FACES: usize = 2_000;
    const LIMIT: usize = 10_000;
    let (below, above) = (pile(FACES), pile(FACES));
    let pose = Pose::from_translation([0.25, 0.0, 0.0]).expect("a pose");
    for (threads, host) in [(1, HostChoice::First), (1, HostChoice::Second), (2, HostChoice::First)] {
        let options = Options { host, ..Options::default() };
        let some = on_threads(threads, || {
            COUNTED.reset_peak_usage();
            let before = COUNTED.current_usage();
            let some = Query::new().with_options(options).intersecting_pairs_up_to(&below, above.at(pose), LIMIT);
            let most = COUNTED.peak_usage().saturating_sub(before);
            assert!(most < 4 << 20, "{most} bytes for {LIMIT} pairs on {threads} threads");
            some
        });
        let first: Vec<[u32; 2]> = (0..LIMIT).map(|i| [i / FACES, i % FACES].map(|face| face as u32)).collect();
        assert!(some.truncated && some.pairs == first, "{threads} threads, {host:?}");
    }
}

/// Checks piles side by side with shuffled face numbers: the first pairs are found late, in any
/// pile.
fn first_of_mixed_piles_are_first_of_all() {
    const PILES: u32 = 64;
    const FACES: u32 = 3_200;
    let place = |pile: u32| 2.0 * f64::from(pile);
    let vertices =
        (0..PILES).flat_map(|pile| [[place(pile), 0.0, 0.0], [place(pile) + 1.0, 0.0, 0.0], [place(pile), 1.0, 0.0]]);
    // 37 is coprime to the number of faces.
    let pile_of = |face: u32| face * 37 % FACES % PILES;
    let faces = (0..FACES).map(|face| [0, 1, 2].map(|corner| 3 * pile_of(face) + corner));
    let mesh = Mesh::new(Positions::F64(vertices.collect()), faces.rev().collect::<Vec<_>>()).expect("a mesh");
    let all = query::intersecting_pairs(&mesh, &mesh);
    assert_eq!(all.len() as u32, FACES * FACES / PILES);
    for (threads, host) in [(1, HostChoice::First), (1, HostChoice::Second), (2, HostChoice::First)] {
        for limit in [10, 1_000, 20_000] {
            let options = Options { host, ..Options::default() };
            let some = on_threads(threads, || {
                Query::new().with_options(options).intersecting_pairs_up_to(&mesh, &mesh, limit)
            });
            assert!(some.truncated && some.pairs == all[..limit], "{limit} on {threads} threads, {host:?}");
        }
    }
}

#[test]
fn a_limit_gives_the_first_pairs_and_bounds_memory() {
    let _alone = alone();
    first_of_soups_are_first_of_all();
    first_of_mixed_piles_are_first_of_all();
    a_limit_bounds_memory();
}

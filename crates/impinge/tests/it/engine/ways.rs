//! Pair queries with every option of the engine, none of which may change an answer.

use impinge::mesh::{HostChoice, Options};
use impinge::query::{Query, Share};
use impinge::{Mesh, Pose, Positions, simd};
use impinge_testkit::{Affine, Posed, cases::Precision};

/// Returns the engine's mesh for a mesh of the testkit.
pub(crate) fn engine_mesh(mesh: &impinge_testkit::Mesh, precision: Precision) -> Mesh {
    let positions = match precision {
        Precision::F32 => Positions::F32(mesh.vertices.iter().map(|v| v.map(|x| x as f32)).collect()),
        Precision::F64 => Positions::F64(mesh.vertices.clone()),
    };
    Mesh::new(positions, mesh.faces.clone()).expect("a legal mesh")
}

pub(crate) fn engine_pose(pose: &Affine) -> Pose {
    Pose::new(pose.linear, pose.translation).expect("a legal pose")
}

/// Returns the pairs that the engine finds with the given options.
pub(crate) fn pairs(a: (&Mesh, &Affine), b: (&Mesh, &Affine), options: &Options<'_>) -> Vec<(u32, u32)> {
    let (placed_a, placed_b) = (a.0.at(engine_pose(a.1)), b.0.at(engine_pose(b.1)));
    let pairs = Query::new().with_options(*options).intersecting_pairs(placed_a, placed_b);
    let met = Query::new().with_options(*options).intersects(placed_a, placed_b);
    assert_eq!(met, !pairs.is_empty(), "the first hit and all pairs disagree");
    pairs.into_iter().map(|[a, b]| (a, b)).collect()
}

/// Returns the options for all vector levels and hosts, each with its name.
pub(crate) fn all_options() -> impl Iterator<Item = (String, Options<'static>)> {
    simd::levels().into_iter().flat_map(|(name, level)| {
        [HostChoice::SmallerError, HostChoice::First, HostChoice::Second]
            .map(|host| (format!("{name}, {host:?}"), Options { level, host, ..Options::default() }))
    })
}

/// Returns the options for all vector levels and hosts, again and again.
pub(crate) fn options_in_turns() -> impl Iterator<Item = Options<'static>> {
    let all: Vec<Options<'_>> = all_options().map(|(_, options)| options).collect();
    (0..).map(move |turn: usize| all[turn % all.len()])
}

/// Runs a function on a pool of `threads` threads.
pub(crate) fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(run)
}

/// Returns the pairs of all shares of the search, each of which has other options.
fn pairs_of_shares(a: (&Mesh, &Affine), b: (&Mesh, &Affine), shares: u32) -> Vec<(u32, u32)> {
    let (a, b) = (a.0.at(engine_pose(a.1)), b.0.at(engine_pose(b.1)));
    let shares = (0..shares).filter_map(|index| Share::new(index, shares)).zip(options_in_turns());
    let mut pairs: Vec<[u32; 2]> = shares
        .flat_map(|(share, options)| Query::new().with_options(options).intersecting_pairs_in(a, b, share))
        .collect();
    pairs.sort_unstable();
    pairs.into_iter().map(|[a, b]| (a, b)).collect()
}

/// Returns the intersecting pairs, after checking that all options, on one thread and on two, give
/// the same pairs, and so do shares.
pub(crate) fn pairs_in_every_way(a: (&Mesh, &Affine), b: (&Mesh, &Affine)) -> Vec<(u32, u32)> {
    let expected = on_threads(1, || pairs(a, b, &Options::default()));
    for threads in [1, 2] {
        on_threads(threads, || {
            for (name, options) in all_options() {
                let found = pairs(a, b, &options);
                assert!(found == expected, "{name}, {threads} threads: {} pairs, not {}", found.len(), expected.len());
            }
        });
    }
    assert!(pairs_of_shares(a, b, 3) == expected, "the shares have other pairs than the whole");
    expected
}

/// Does the same as [`pairs_in_every_way`], from meshes of the testkit.
pub(crate) fn posed_pairs_in_every_way(a: Posed<'_>, b: Posed<'_>, precision: Precision) -> Vec<(u32, u32)> {
    let owned =
        |posed: &Posed<'_>| impinge_testkit::Mesh { vertices: posed.vertices.to_vec(), faces: posed.faces.to_vec() };
    let (mesh_a, mesh_b) = (engine_mesh(&owned(&a), precision), engine_mesh(&owned(&b), precision));
    pairs_in_every_way((&mesh_a, &a.world_from_local), (&mesh_b, &b.world_from_local))
}

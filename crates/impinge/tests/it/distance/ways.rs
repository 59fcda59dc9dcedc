//! Distance queries with every option of the engine, none of which may change an answer.

use impinge::mesh::{HostChoice, Options};
use impinge::query::{Cache, Distance, Query};
use impinge::{Mesh, Pose, Positions, simd};
use impinge_testkit::{Affine, Mesh as Plain};

pub(crate) fn engine_mesh(mesh: &Plain) -> Mesh {
    Mesh::new(Positions::F64(mesh.vertices.clone()), mesh.faces.clone()).expect("a legal mesh")
}

pub(crate) fn engine_pose(pose: &Affine) -> Pose {
    Pose::new(pose.linear, pose.translation).expect("a legal pose")
}

pub(crate) fn all_options() -> impl Iterator<Item = Options<'static>> {
    let hosts = [HostChoice::SmallerError, HostChoice::First, HostChoice::Second];
    simd::levels()
        .into_iter()
        .flat_map(move |(_, level)| hosts.map(|host| Options { level, host, ..Options::default() }))
}

/// Returns the distance, after checking that it is the same at every vector level, with either
/// host, and with no cache, a good cache and a stale cache.
pub(crate) fn distance_in_every_way(a: (&Mesh, &Affine), b: (&Mesh, &Affine)) -> Distance {
    let (placed_a, placed_b) = (a.0.at(engine_pose(a.1)), b.0.at(engine_pose(b.1)));
    let mut stale = Cache::default();
    let elsewhere = Pose::from_translation([-3.0, 5.0, 1.0]).expect("a pose");
    let _ = Query::new().with_cache(&mut stale).distance(a.0.at(elsewhere), b.0);
    let mut cache = Cache::default();
    let expected = Query::new().with_cache(&mut cache).distance(placed_a, placed_b);
    assert_eq!(Query::new().with_cache(&mut stale).distance(placed_a, placed_b), expected, "with a stale cache");
    for options in all_options() {
        for mut cache in [Cache::default(), cache.clone()] {
            let found = Query::new().with_options(options).with_cache(&mut cache).distance(placed_a, placed_b);
            assert_eq!(found, expected, "{:?}", options.host);
        }
    }
    expected
}

/// Reports whether the meshes are within the clearance, after checking that every option gives the
/// same answer.
pub(crate) fn within_in_every_way(a: (&Mesh, &Affine), b: (&Mesh, &Affine), clearance: f64) -> bool {
    let (placed_a, placed_b) = (a.0.at(engine_pose(a.1)), b.0.at(engine_pose(b.1)));
    let mut cache = Cache::default();
    let expected = Query::new().with_cache(&mut cache).within(placed_a, placed_b, clearance);
    for options in all_options() {
        for mut cache in [Cache::default(), cache.clone()] {
            assert_eq!(
                Query::new().with_options(options).with_cache(&mut cache).within(placed_a, placed_b, clearance),
                expected
            );
        }
    }
    expected
}

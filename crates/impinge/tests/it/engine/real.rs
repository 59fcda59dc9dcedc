//! Real meshes with recorded exact answers. Runs only if the data folder is present.

use impinge_testkit::Affine;
use impinge_testkit::cases::Precision;
use impinge_testkit::env_rob::{EnvRob, data_folder, pairs_digest};

use crate::engine::ways::{engine_mesh, pairs_in_every_way};

#[test]
fn the_250_recorded_poses_of_env_and_rob_have_their_pairs() {
    let Some(folder) = data_folder() else { return };
    let scene = EnvRob::read(&folder).expect("the recorded poses");
    assert_eq!(scene.rows.len(), 250);
    let rob = engine_mesh(&scene.rob, Precision::F64);
    let mut met = 0;
    for (index, row) in scene.rows.iter().enumerate() {
        let env = engine_mesh(&scene.baked_env(row), Precision::F64);
        let pairs = pairs_in_every_way((&env, &Affine::IDENTITY), (&rob, &Affine::IDENTITY));
        assert_eq!(pairs.len(), row.pair_count, "pose {index}");
        assert_eq!(pairs_digest(&pairs), row.pairs_digest, "pose {index}");
        met += usize::from(!pairs.is_empty());
    }
    assert!((50..=250).contains(&met), "{met} of 250 poses intersect");
}

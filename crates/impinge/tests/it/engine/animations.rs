//! Recorded animations: a mesh refitted to each frame answers as a mesh built for that frame. Runs
//! only if `IMPINGE_DATA` is set.

use impinge::{Mesh, Pose, Positions, query};
use impinge_testkit::animation::{ANIMATIONS, Animation};
use impinge_testkit::env_rob::data_folder;

#[test]
fn every_frame_is_answered_like_a_new_mesh() {
    let Some(folder) = data_folder() else { return };
    for name in ANIMATIONS {
        let Animation { frames, faces } = Animation::read(&folder, name).expect("a recording");
        let mut mesh = Mesh::new(Positions::F32(frames[0].clone()), faces.clone()).expect("a legal mesh");
        let still = mesh.clone();
        // Moved aside by a quarter of its width, so that it intersects the first frame.
        let xs = || frames[0].iter().map(|v| f64::from(v[0]));
        let width = xs().fold(f64::MIN, f64::max) - xs().fold(f64::MAX, f64::min);
        let aside = Pose::from_translation([0.25 * width, 0.0, 0.0]).expect("a legal pose");
        let mut pairs = 0;
        for (number, frame) in frames.iter().enumerate() {
            let aging = mesh.refit(Positions::F32(frame.clone())).expect("as many vertices");
            assert!(aging.ratio().is_finite() && aging.ratio() > 0.5, "{name}, frame {number}: {aging:?}");
            if number % 10 == 9 {
                let fresh = Mesh::new(Positions::F32(frame.clone()), faces.clone()).expect("a legal mesh");
                let expected = query::intersecting_pairs(&fresh, still.at(aside));
                assert_eq!(query::intersecting_pairs(&mesh, still.at(aside)), expected, "{name}, frame {number}");
                assert_eq!(mesh.validate(), Ok(()), "{name}, frame {number}");
                pairs += expected.len();
            }
        }
        assert!(pairs > 100, "{name}: {pairs} pairs");
    }
}

//! Rigs with very many keys and vertices: the work of following their animations is limited.

use impinge::character::{
    Animation, Bone, Channel, Character, Influence, Interpolation, Joint, Mode, Plan, Rig, RigError, RigErrorKind,
    Skeleton, Skin, Target, Transform,
};

use super::Random;
use super::holding::assert_all_are_contained;

/// Builds a rig of two bones, the upper one of which turns over at every key.
fn turning(keys: usize, vertices: usize) -> Rig {
    let mut random = Random(7);
    let bone = |parent, height| Bone {
        name: String::new(),
        parent,
        rest: Transform { translation: [0.0, 0.0, height], ..Transform::IDENTITY },
    };
    let skeleton = Skeleton::new(vec![bone(None, 0.0), bone(Some(0), 0.5)]).unwrap();
    let inverse_bind = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let joints = [0, 1].map(|bone| Joint { bone, inverse_bind }).to_vec();
    let influences: Vec<_> = (0..vertices).map(|at| vec![Influence { joint: at as u32 % 2, weight: 1.0 }]).collect();
    let positions = (0..vertices).map(|_| random.vector(1.0)).collect();
    let faces = (0..vertices as u32).map(|at| [at, (at + 2) % vertices as u32, (at + 4) % vertices as u32]).collect();
    let skin = Skin::new(positions, faces, joints, &influences, vec![]).unwrap();
    let turn = |key: usize| if key.is_multiple_of(2) { [1.0, 0.0, 0.0, 0.0] } else { [0.0, 0.6, 0.8, 0.0] };
    let channel = Channel {
        target: Target::Rotation(1),
        interpolation: Interpolation::Linear,
        times: (0..keys).map(|key| key as f64).collect(),
        values: (0..keys).flat_map(turn).collect(),
    };
    Rig::new(skeleton, skin, vec![Animation::new(String::new(), vec![channel], 0).unwrap()]).unwrap()
}

fn fit(rig: &Rig) -> Result<Character, RigError> {
    Character::fit(rig, &Plan::automatic(rig, 1)?, Mode::Conservative)
}

#[test]
fn volumes_hold_every_vertex_if_the_work_allows_few_samples_between_keys() {
    let rig = turning(1000, 1000);
    let (checked, _) = assert_all_are_contained(&rig, &fit(&rig).unwrap(), &mut Random(3));
    assert!(checked > 1_000_000, "{checked}");
}

#[test]
fn too_many_keys_for_the_vertices_are_an_error_before_any_work() {
    let mut excess = Vec::new();
    for many in [10_000, 20_000] {
        let error = fit(&turning(many, many)).unwrap_err();
        let &RigErrorKind::TooMany { what: "vertices and bones over all keys", count, limit } = error.kind() else {
            panic!("{error}")
        };
        excess.push((count, limit));
    }
    let [(count, limit), (larger, larger_limit)] = excess[..] else { panic!() };
    // The work grows with the product, and the limit with the sum.
    assert!(larger > 3 * count && larger_limit < 2 * limit, "{excess:?}");
}

#[test]
fn chains_of_bones_and_many_parts_take_nearly_linear_time() {
    for bones in [5_000_u32, 20_000] {
        let bone = |at: u32| Bone { name: String::new(), parent: at.checked_sub(1), rest: Transform::IDENTITY };
        let skeleton = Skeleton::new((0..bones).map(bone).collect()).unwrap();
        let inverse_bind = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let joints = (0..bones).map(|bone| Joint { bone, inverse_bind }).collect();
        let corner = |joint| vec![Influence { joint, weight: 1.0 }];
        let triangle = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let influences = [corner(bones - 1), corner(bones - 1), corner(bones - 1)];
        let skin = Skin::new(triangle, vec![[0, 1, 2]], joints, &influences, vec![]).unwrap();
        let rig = Rig::new(skeleton, skin, Vec::new()).unwrap();
        let character = fit(&rig).unwrap();
        assert_eq!(character.parts().len(), 1);
        assert_eq!(character.bones(&rig), rig.skeleton().bone_set(0..bones));
    }
}

use super::super::skeleton::{Bone, Skeleton};
use super::super::skin::{Influence, Joint, Morph};
use super::super::transform::Transform;
use super::*;

const JOINTS: u32 = 5;

/// Returns a number from -1 to 1.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Builds a sheet over five bones. Each vertex follows one to three of them, with weights on a
/// grid.
fn sheet(state: &mut u64) -> Rig {
    let bones = (0..JOINTS).map(|at| Bone { name: at.to_string(), parent: None, rest: Transform::IDENTITY });
    let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let joints = (0..JOINTS).map(|bone| Joint { bone, inverse_bind: identity }).collect();
    let (mut positions, mut influences) = (Vec::new(), Vec::new());
    for vertex in 0..400_u32 {
        positions.push([f64::from(vertex / 20), f64::from(vertex % 20), random(state)]);
        let shares = [4.0, 3.0, 1.0].map(|most| (most * random(state).abs()).round());
        let sum = shares.iter().sum::<f64>().max(1.0);
        let own = shares.iter().zip(vertex / 80..).map(|(share, joint)| Influence {
            joint: joint % JOINTS,
            weight: if shares == [0.0; 3] { 1.0 / 3.0 } else { share / sum },
        });
        influences.push(own.collect::<Vec<_>>());
    }
    let corners = (0..19).flat_map(|i| (0..19).map(move |j| 20 * i + j));
    let faces = corners.flat_map(|at| [[at, at + 1, at + 20], [at + 1, at + 21, at + 20]]).collect();
    let morphs = [0.5, -0.5].map(|weight| Morph {
        weight,
        offsets: (0..400).step_by(3).map(|vertex| (vertex, [0; 3].map(|_| random(state)))).collect(),
    });
    let skin = Skin::new(positions, faces, joints, &influences, morphs.into()).unwrap();
    Rig::new(Skeleton::new(bones.collect()).unwrap(), skin, vec![]).unwrap()
}

/// Returns the faces below a node.
fn faces_of(tree: &SkinTree, node: u32) -> Vec<u32> {
    match tree.children(node) {
        Children::Nodes(nodes) => nodes.iter().flat_map(|&node| faces_of(tree, node)).collect(),
        Children::Faces { faces, .. } => tree.faces(*faces).iter().map(|own| own.face).collect(),
    }
}

/// Checks that the spheres of all nodes enclose their vertices. Returns the largest distance of a
/// vertex from its center, in radii.
fn largest_share(rig: &Rig, tree: &SkinTree, pose: &SkinPose) -> f64 {
    let mut vertices = Vec::new();
    rig.skin().morphed(&pose.morph_weights, &mut vertices);
    for (vertex, point) in vertices.iter_mut().enumerate() {
        *point = add(&blended(&pose.palette, rig.skin().influences(vertex as u32), *point), &pose.origin);
    }
    let mut most = 0.0_f64;
    for node in 0..tree.nodes.len() as u32 {
        let (center, radius) = tree.sphere(node, pose);
        for corner in faces_of(tree, node).into_iter().flat_map(|face| rig.skin().faces()[face as usize]) {
            let share = length(&sub(&vertices[corner as usize], &center)) / radius;
            assert!(share <= 1.0, "vertex {corner} of node {node} is {share} radii from its center");
            most = most.max(share);
        }
    }
    most
}

#[test]
fn spheres_enclose_their_faces_in_any_pose() {
    let mut state = 3;
    let rig = sheet(&mut state);
    let tree = SkinTree::new(&rig);
    let all: Vec<u32> = tree.roots().iter().flat_map(|&root| faces_of(&tree, root)).collect();
    let mut sorted = all.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, (0..rig.skin().faces().len() as u32).collect::<Vec<_>>());
    let mut nearest = 0.0_f64;
    for case in 0..60 {
        // Arbitrary affine maps of very different sizes. Some are nearly flat, and some agree at a
        // point.
        let size = [1.0, 1e-3, 1e3][case % 3];
        let mut map = |joint: u32| {
            let size = size * if joint as usize == case % 4 { 20.0 } else { 1.0 };
            let linear = [[0.0; 3]; 3].map(|row| row.map(|_| size * random(&mut state)));
            let linear = if case % 5 == 0 { [linear[0], linear[0], linear[2]] } else { linear };
            let agreed = scale(&apply(&linear, [4.5 * (1 + case % 4) as f64, 9.0, 0.0]), -1.0);
            (linear, if case % 2 == 0 { agreed } else { [0; 3].map(|_| 10.0 * random(&mut state)) })
        };
        let palette: Vec<(Matrix, Vector)> = (0..JOINTS).map(&mut map).collect();
        let stretches = palette.iter().map(|(linear, _)| stretch(linear)).collect();
        let morph_weights = vec![random(&mut state), 3.0 * random(&mut state)];
        let origin = [0; 3].map(|_| [0.0, 1e9][case % 2] * random(&mut state));
        nearest = nearest.max(largest_share(&rig, &tree, &SkinPose { palette, stretches, morph_weights, origin }));
    }
    assert!(nearest > 0.9, "{nearest}: a bound that is never nearly reached is none");
}

#[test]
fn spheres_of_a_rigid_motion_are_as_tight_as_at_rest() {
    let mut state = 5;
    let rig = sheet(&mut state);
    let tree = SkinTree::new(&rig);
    let turn = ([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], [3.0, -2.0, 5.0]);
    let pose = SkinPose {
        palette: vec![turn; JOINTS as usize],
        stretches: vec![stretch(&turn.0); JOINTS as usize],
        morph_weights: vec![0.0; 2],
        origin: [0.0; 3],
    };
    assert!(largest_share(&rig, &tree, &pose) > 1.0 - 1e-9);
    for (at, node) in (0..).zip(&tree.nodes) {
        assert!(tree.sphere(at, &pose).1 <= node.radius * (1.0 + 1e-9));
    }
}

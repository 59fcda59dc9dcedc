//! Tests that conservative volumes contain all vertices at all times, and how many vertices snug
//! volumes leave out.

use std::path::Path;

use impinge::character::{
    Animation, Bone, Channel, Character, HitVolume, Influence, Interpolation, Joint, Mode, Morph, Plan, Posed, Rig,
    RigPose, Skeleton, Skin, Surface, Target, Transform, VolumeKind,
};
use impinge_files::load_rig;

use super::{Random, aimed, dot, fitted, robot, sub};

/// Returns how far a point is outside of a volume, by textbook formulas; negative inside.
fn outside(volume: &HitVolume, point: [f64; 3]) -> f64 {
    let distance = |a, b| dot(sub(a, b), sub(a, b)).sqrt();
    match volume {
        HitVolume::Sphere(sphere) => distance(point, sphere.center()) - sphere.radius(),
        HitVolume::Capsule(capsule) => {
            let [a, b] = capsule.ends();
            let t = (dot(sub(point, a), sub(b, a)) / dot(sub(b, a), sub(b, a)).max(1e-300)).clamp(0.0, 1.0);
            distance(point, [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]))) - capsule.radius()
        }
        HitVolume::Box(obb) => {
            let along = obb.axes().map(|axis| dot(axis, sub(point, obb.center())));
            (0..3).map(|k| along[k].abs() - obb.half_extents()[k]).fold(f64::NEG_INFINITY, f64::max)
        }
        HitVolume::Lozenge(_) | HitVolume::Hull(_) => volume.signed_distance(point),
    }
}

/// Asserts that every vertex of every part is inside its volume: at rest, at every other key of all
/// animations, just before the next key, and at a random time between them. Returns the number of
/// checks, and the least distance of a vertex from the border.
pub(super) fn assert_all_are_contained(rig: &Rig, character: &Character, random: &mut Random) -> (u64, f64) {
    let mut belongs = vec![vec![false; rig.skin().positions().len()]; character.parts().len()];
    for (face, &part) in rig.skin().faces().iter().zip(character.part_of_face()) {
        face.iter().for_each(|&corner| belongs[part as usize][corner as usize] = true);
    }
    let (mut vertices, mut checked, mut nearest) = (Vec::new(), 0_u64, f64::INFINITY);
    let mut check = |pose: &RigPose| {
        rig.skin().skinned(pose, &mut vertices);
        for ((part, frame), belongs) in character.parts().iter().zip(character.frames(pose)).zip(&belongs) {
            for (vertex, point) in vertices.iter().enumerate().filter(|(vertex, _)| belongs[*vertex]) {
                let out = outside(part.volume(), frame.local(*point));
                assert!(out <= 0.0, "vertex {vertex} is {out} out of {}", part.name);
                nearest = nearest.min(-out);
                checked += 1;
            }
        }
    };
    check(&rig.rest_pose().unwrap());
    for (at, animation) in rig.animations().iter().enumerate() {
        let times = animation.key_times();
        for pair in times.windows(2).step_by(2) {
            check(&rig.pose_at(at, pair[0]).unwrap());
            check(&rig.pose_at(at, pair[0] + random.next() * (pair[1] - pair[0])).unwrap());
            check(&rig.pose_at(at, pair[1].next_down()).unwrap());
        }
        check(&rig.pose_at(at, times[times.len() - 1]).unwrap());
    }
    assert!(character.leaks(rig).unwrap().iter().all(|leak| leak.share == 0.0));
    (checked, nearest)
}

#[test]
fn no_vertex_is_outside_at_any_key_or_between() {
    let rig = robot();
    let mut random = Random(1);
    for (volumes, kinds) in [(6, None), (12, Some(VolumeKind::Hull)), (6, Some(VolumeKind::Lozenge))] {
        let mut plan = Plan::automatic(&rig, volumes).unwrap();
        plan.parts.iter_mut().for_each(|part| part.kind = kinds);
        let character = Character::fit(&rig, &plan, Mode::Conservative).unwrap();
        let (checked, nearest) = assert_all_are_contained(&rig, &character, &mut random);
        // Some vertex is almost on the border, because volumes are no larger than necessary.
        assert!(checked > 2_000_000 && nearest < 0.02, "{checked} {nearest}");
    }
}

#[test]
fn no_vertex_is_outside_if_vertices_are_shared_among_bones() {
    let Some(folder) = std::env::var_os("IMPINGE_DATA") else {
        eprintln!("skipped: IMPINGE_DATA names no folder of real files");
        return;
    };
    let rig = load_rig(Path::new(&folder).join("characters/greenman.glb")).unwrap();
    let mut random = Random(17);
    for volumes in [6, 12] {
        let mut character = fitted(&rig, volumes, Mode::Conservative);
        let (checked, _) = assert_all_are_contained(&rig, &character, &mut random);
        assert!(checked > 40_000, "{checked}");
        // No ray that hits the surface misses the refined volumes.
        character.refine(&rig, 32).unwrap();
        let mut surface = Surface::new(&rig, &rig.rest_pose().unwrap()).unwrap();
        let (mut vertices, mut hits) = (Vec::new(), 0);
        for _ in 0..50 {
            let pose = random.pose(&rig);
            surface.set(&rig, &pose).unwrap();
            rig.skin().skinned(&pose, &mut vertices);
            let posed = Posed::new(&character, &pose);
            for _ in 0..40 {
                let ray = aimed(&rig, &vertices, &mut random);
                let Some(truth) = surface.ray_cast(&character, &ray) else { continue };
                let own = posed.ray_cast_all(&ray).into_iter().find(|hit| hit.part == truth.part);
                assert!(own.is_some_and(|own| own.t <= truth.t * (1.0 + 1e-9)));
                hits += 1;
            }
        }
        assert!(hits > 1_900, "{hits}");
    }
}

/// Returns a rig of three bones in a chain whose skin bulges, with every target and every
/// interpolation, including steps.
pub(super) fn bulging(random: &mut Random) -> Rig {
    let bone = |parent: Option<u32>| Bone {
        name: format!("bone {}", parent.map_or(0, |parent| parent + 1)),
        parent,
        rest: Transform { translation: [0.0, if parent.is_some() { 1.0 } else { 0.0 }, 0.0], ..Transform::IDENTITY },
    };
    let skeleton = Skeleton::new(vec![bone(None), bone(Some(0)), bone(Some(1))]).unwrap();
    let joints = (0..3).map(|bone: u32| Joint {
        bone,
        inverse_bind: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, -f64::from(bone)], [0.0, 0.0, 1.0, 0.0]],
    });
    let (mut positions, mut influences) = (Vec::new(), Vec::new());
    for vertex in 0..90_u32 {
        let [x, y, z] = random.vector(0.4);
        positions.push([x, f64::from(vertex / 30) + 0.5 + y, z]);
        let weight = if vertex % 3 == 0 { 1.0 } else { 0.75 };
        let own = Influence { joint: vertex / 30, weight };
        let other = Influence { joint: (vertex / 30 + 1) % 3, weight: 1.0 - weight };
        influences.push(if weight < 1.0 { vec![own, other] } else { vec![own] });
    }
    let faces = (0..30).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    let morphs = [0.0, 0.5].map(|weight| Morph {
        weight,
        offsets: (0..90).step_by(2).map(|vertex| (vertex, random.vector(0.3))).collect(),
    });
    let skin = Skin::new(positions, faces, joints.collect(), &influences, morphs.into()).unwrap();
    let times = [0.0, 0.3, 0.7, 1.0];
    let mut channel = |target: Target, width: usize, interpolation: Interpolation, about: f64, spread: f64| {
        let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let values = (0..times.len() * width * parts).map(|at| {
            let is_value = parts == 1 || at / width % 3 == 1;
            spread * (2.0 * random.next() - 1.0) + if is_value { about } else { 0.0 }
        });
        Channel { target, interpolation, times: times.into(), values: values.collect() }
    };
    let (step, linear, spline) = (Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline);
    let channels = vec![
        channel(Target::Rotation(1), 4, step, 0.5, 0.4),
        channel(Target::Rotation(2), 4, spline, 0.5, 0.4),
        channel(Target::Translation(0), 3, step, 0.0, 2.0),
        channel(Target::Translation(2), 3, linear, 0.5, 0.5),
        channel(Target::Scale(1), 3, spline, 1.0, 0.2),
        channel(Target::Scale(2), 3, step, 1.0, 0.3),
        channel(Target::MorphWeight(0), 1, step, 0.0, 1.0),
        channel(Target::MorphWeight(1), 1, spline, 0.0, 1.0),
    ];
    Rig::new(skeleton, skin, vec![Animation::new("all".into(), channels, 0).unwrap()]).unwrap()
}

#[test]
fn volumes_contain_vertices_with_step_channels_and_morph_targets() {
    let mut random = Random(23);
    let mut bulged = 0;
    for _ in 0..12 {
        let rig = bulging(&mut random);
        for kind in [None, Some(VolumeKind::Capsule), Some(VolumeKind::Hull)] {
            let mut plan = Plan::automatic(&rig, 3).unwrap();
            plan.parts.iter_mut().for_each(|part| part.kind = kind);
            let character = Character::fit(&rig, &plan, Mode::Conservative).unwrap();
            let (checked, nearest) = assert_all_are_contained(&rig, &character, &mut random);
            assert!(checked >= 90 * 8 && nearest < 0.2, "{checked} {nearest}");
        }
        // The morph targets matter: their weights change during the animation.
        let rest = rig.rest_pose().unwrap();
        let moved = rig.pose_at(0, 0.5).unwrap();
        bulged += u32::from((moved.morph_weights()[0] - rest.morph_weights()[0]).abs() > 0.1);
    }
    assert!(bulged >= 6, "{bulged}");
}

#[test]
fn snug_volumes_leak_little_and_are_smaller() {
    let rig = robot();
    let (snug, all) = (fitted(&rig, 6, Mode::Snug), fitted(&rig, 6, Mode::Conservative));
    let leaks = snug.leaks(&rig).unwrap();
    assert!(leaks.iter().all(|leak| leak.share < 0.06 && leak.farthest < 0.6));
    assert!(leaks.iter().filter(|leak| leak.share > 0.0 && leak.farthest > 0.0).count() >= 4);
    let area = |character: &Character| character.parts().iter().map(|part| part.volume().surface_area()).sum::<f64>();
    assert!(area(&snug) < 0.9 * area(&all), "{} {}", area(&snug), area(&all));
}

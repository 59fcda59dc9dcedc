//! Tests of rays against characters.

use impinge::Pose;
use impinge::character::{Character, HitHull, HitPart, HitVolume, Mode, Posed, Rig, Surface};
use impinge::mesh::Ray;
use impinge::query;
use impinge::shape::Shape;
use impinge::volume::{BoundingSphere, Capsule, Lozenge, Obb, Proximity};

use super::{Random, aimed, dot, fitted, robot, sub};

#[test]
fn rays_hit_every_part_that_the_mesh_hits_and_mostly_first() {
    let rig = robot();
    let mut character = fitted(&rig, 6, Mode::Conservative);
    let mut rights = Vec::new();
    for refined in [false, true] {
        if refined {
            character.refine(&rig, 64).unwrap();
        }
        let mut random = Random(7);
        let mut surface = Surface::new(&rig, &rig.rest_pose().unwrap()).unwrap();
        let (mut vertices, mut hits, mut right) = (Vec::new(), 0_u32, 0_u32);
        for _ in 0..250 {
            let pose = random.pose(&rig);
            surface.set(&rig, &pose).unwrap();
            rig.skin().skinned(&pose, &mut vertices);
            let posed = Posed::new(&character, &pose);
            for _ in 0..40 {
                let ray = aimed(&rig, &vertices, &mut random);
                let Some(truth) = surface.ray_cast(&character, &ray) else { continue };
                hits += 1;
                let all = posed.ray_cast_all(&ray);
                let own = all.iter().find(|hit| hit.part == truth.part).expect("no hit on the mesh is missed");
                assert!(own.t <= truth.t * (1.0 + 1e-9), "a volume is entered before its surface");
                let first = posed.ray_cast(&ray).unwrap();
                assert!(first == all[0] && all.is_sorted_by(|a, b| a.t <= b.t) && first.t <= own.t);
                assert!(
                    (dot(first.normal, first.normal) - 1.0).abs() < 1e-9 && dot(first.normal, ray.direction()) < 1e-6
                );
                right += u32::from(first.part == truth.part);
            }
        }
        assert!(hits > 9_900);
        rights.push(f64::from(right) / f64::from(hits));
    }
    assert!(rights[0] > 0.7 && rights[1] >= 0.95, "{rights:?}");
}

/// Returns a rig of one bone that does not move, and one face.
fn still() -> Rig {
    use impinge::character::{Bone, Influence, Joint, Skeleton, Skin, Transform};
    let bone = Bone { name: "bone".into(), parent: None, rest: Transform::IDENTITY };
    let inverse_bind = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let whole = vec![Influence { joint: 0, weight: 1.0 }];
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let skin = Skin::new(positions, vec![[0, 1, 2]], vec![Joint { bone: 0, inverse_bind }], &vec![whole; 3], vec![]);
    Rig::new(Skeleton::new(vec![bone]).unwrap(), skin.unwrap(), vec![]).unwrap()
}

fn volumes() -> Vec<HitVolume> {
    let turned = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
    let corners: Vec<[f64; 3]> = (0..40).scan(Random(3), |random, _| Some(random.unit())).collect();
    vec![
        HitVolume::Sphere(BoundingSphere::new([0.1, 0.2, -0.3], 0.8).unwrap()),
        HitVolume::Capsule(Capsule::new([-0.5, 0.0, 0.2], [0.6, 0.7, 0.0], 0.3).unwrap()),
        HitVolume::Capsule(Capsule::new([0.5; 3], [0.5; 3], 0.3).unwrap()),
        HitVolume::Box(Obb::new([0.1, 0.0, 0.0], turned, [1.0, 0.3, 0.6]).unwrap()),
        HitVolume::Lozenge(Lozenge::new([-0.5; 3], [[1.2, 0.0, 0.0], [0.0, 0.0, 0.9]], 0.25).unwrap()),
        HitVolume::Hull(HitHull::new(&corners).unwrap()),
    ]
}

fn alone(rig: &Rig, volume: HitVolume) -> Character {
    Character::of_parts(rig, vec![HitPart::new("it".into(), vec![0], 0, volume, 1.0)]).unwrap()
}

/// Compares rays with the distance of a segment, which shares no code with the closed forms.
#[test]
fn rays_agree_with_distances_of_segments() {
    let rig = still();
    let pose = rig.rest_pose().unwrap();
    let mut random = Random(11);
    for volume in volumes() {
        let placed = volume.placed(Pose::IDENTITY).unwrap();
        let character = alone(&rig, volume);
        let posed = Posed::new(&character, &pose);
        let mut hits = 0;
        for case in 0..3_000 {
            let mut origin = random.vector(2.5);
            let mut direction = if case % 2 == 0 { random.vector(1.0) } else { sub(random.vector(0.6), origin) };
            if case % 5 == 0 {
                // A ray along an axis, on a grid.
                origin = origin.map(|x| (4.0 * x).round() / 4.0);
                direction = [0, 1, 2].map(|k| if k == case % 3 { -2.0 } else { 0.0 });
            }
            let ray = Ray::new(origin, direction).unwrap();
            let segment = Shape::segment([origin, ray.at(100.0)]).unwrap().at(Pose::IDENTITY).unwrap();
            let distance = query::distance(&segment, &placed);
            let hit = posed.ray_cast(&ray);
            match distance.proximity {
                Proximity::Apart if distance.lower > 1e-9 => assert!(hit.is_none(), "{case} {distance:?} {hit:?}"),
                Proximity::Apart => {}
                _ => assert!(hit.is_some(), "{case} {distance:?}"),
            }
            let Some(hit) = hit else { continue };
            hits += 1;
            // The hit point is on the border unless the ray starts inside, and there is no hit
            // before it.
            let here = |t: f64| Shape::point(ray.at(t)).unwrap().at(Pose::IDENTITY).unwrap();
            assert!(query::distance(here(hit.t), &placed).upper < 1e-6, "{case} {hit:?}");
            if hit.t > 0.0 {
                let before = Shape::segment([origin, ray.at(hit.t - 1e-6)]).unwrap().at(Pose::IDENTITY).unwrap();
                assert!(query::distance(&before, &placed).upper > 0.0, "{case} {hit:?}");
            }
            let leave = hit.t + hit.depth / dot(direction, direction).sqrt();
            assert!(query::distance(here(leave), &placed).upper < 1e-6, "{case} {hit:?}");
        }
        assert!((100..2_700).contains(&hits), "{hits}");
    }
}

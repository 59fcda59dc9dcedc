//! Hit volumes of a real character: what they hold, what rays and punches strike, what they are saved as.

use std::path::Path;

use impinge::character::{
    Character, HitHull, HitPart, HitVolume, Mode, Plan, Posed, Rig, RigPose, Surface, VolumeKind,
};
use impinge::mesh::Ray;
use impinge::query::shapes;
use impinge::shape::Shape;
use impinge::volume::{BoundingSphere, Capsule, Lozenge, Obb, Proximity};
use impinge::{Mesh, Pose, Positions};
use impinge_files::{character_text, load_rig, parse_character, parse_plan};

fn robot() -> Rig {
    load_rig(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robot.glb")).unwrap()
}

fn fitted(rig: &Rig, volumes: usize, mode: Mode) -> Character {
    Character::fit(rig, &Plan::automatic(rig, volumes).unwrap(), mode).unwrap()
}

/// Numbers from 0 to 1, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn vector(&mut self, reach: f64) -> [f64; 3] {
        [0; 3].map(|_| reach * (2.0 * self.next() - 1.0))
    }

    fn unit(&mut self) -> [f64; 3] {
        loop {
            let v = self.vector(1.0);
            let length = dot(v, v).sqrt();
            if (0.1..1.0).contains(&length) {
                return v.map(|x| x / length);
            }
        }
    }

    fn pose(&mut self, rig: &Rig) -> RigPose {
        let animation = (self.next() * rig.animations().len() as f64) as usize;
        let [start, end] = rig.animations()[animation].span();
        rig.pose_at(animation, start + self.next() * (end - start)).unwrap()
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

/// How far a point is outside of a volume, by textbook formulas.
fn outside(volume: &HitVolume, point: [f64; 3]) -> f64 {
    let distance = |a, b| dot(sub(a, b), sub(a, b)).sqrt();
    match volume {
        HitVolume::Sphere(sphere) => distance(point, sphere.centre()) - sphere.radius(),
        HitVolume::Capsule(capsule) => {
            let [a, b] = capsule.ends();
            let t = (dot(sub(point, a), sub(b, a)) / dot(sub(b, a), sub(b, a)).max(1e-300)).clamp(0.0, 1.0);
            distance(point, [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]))) - capsule.radius()
        }
        HitVolume::Box(obb) => {
            let along = obb.axes().map(|axis| dot(axis, sub(point, obb.centre())));
            (0..3).map(|k| along[k].abs() - obb.half_extents()[k]).fold(f64::NEG_INFINITY, f64::max)
        }
        HitVolume::Lozenge(_) | HitVolume::Hull(_) => volume.signed_distance(point),
    }
}

#[test]
fn parts_are_what_a_person_would_say() {
    let rig = robot();
    let character = fitted(&rig, 6, Mode::Conservative);
    let mut parts: Vec<(&str, VolumeKind)> =
        character.parts().iter().map(|part| (part.name.as_str(), part.volume().kind())).collect();
    parts.sort_unstable();
    let names: Vec<&str> = parts.iter().map(|part| part.0).collect();
    assert_eq!(names, ["head", "left arm", "left leg", "right arm", "right leg", "torso"]);
    assert_eq!((parts[0].1, parts[1].1, parts[2].1), (VolumeKind::Sphere, VolumeKind::Capsule, VolumeKind::Capsule));
    // A budget is a budget, and what is merged is never lost.
    for volumes in [1, 2, 7, 12, 1000] {
        let plan = Plan::automatic(&rig, volumes).unwrap();
        assert!(plan.parts.len() <= volumes && plan.parts.len() >= volumes.min(12), "{volumes}");
        let mut bones: Vec<u32> = plan.parts.iter().flat_map(|part| part.bones.clone()).collect();
        bones.sort_unstable();
        let before = bones.len();
        bones.dedup();
        assert_eq!((before, bones.len()), (36, 36));
    }
}

#[test]
fn no_vertex_is_outside_at_any_key_or_between() {
    let rig = robot();
    let mut random = Random(1);
    for (volumes, kinds) in [(6, None), (12, Some(VolumeKind::Hull)), (6, Some(VolumeKind::Lozenge))] {
        let mut plan = Plan::automatic(&rig, volumes).unwrap();
        plan.parts.iter_mut().for_each(|part| part.kind = kinds);
        let character = Character::fit(&rig, &plan, Mode::Conservative).unwrap();
        let mut held = vec![vec![false; rig.skin().positions().len()]; character.parts().len()];
        for (face, &part) in rig.skin().faces().iter().zip(character.part_of_face()) {
            face.iter().for_each(|&corner| held[part as usize][corner as usize] = true);
        }
        let (mut vertices, mut checked, mut nearest) = (Vec::new(), 0_u64, f64::INFINITY);
        let mut check = |pose: &RigPose| {
            rig.skin().skinned(pose, &mut vertices);
            for ((part, frame), held) in character.parts().iter().zip(character.frames(pose)).zip(&held) {
                for (vertex, point) in vertices.iter().enumerate().filter(|(vertex, _)| held[*vertex]) {
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
            }
            check(&rig.pose_at(at, times[times.len() - 1]).unwrap());
        }
        // Some vertex is nearly at the border, as volumes are no larger than they must be.
        assert!(checked > 2_000_000 && nearest < 0.02, "{checked} {nearest}");
        assert!(character.leaks(&rig).unwrap().iter().all(|leak| leak.share == 0.0));
    }
}

#[test]
fn snug_volumes_leak_as_little_as_they_say() {
    let rig = robot();
    let (snug, all) = (fitted(&rig, 6, Mode::Snug), fitted(&rig, 6, Mode::Conservative));
    let leaks = snug.leaks(&rig).unwrap();
    assert!(leaks.iter().all(|leak| leak.share < 0.06 && leak.farthest < 0.6));
    assert!(leaks.iter().filter(|leak| leak.share > 0.0 && leak.farthest > 0.0).count() >= 4);
    let area = |character: &Character| character.parts().iter().map(|part| part.volume().surface_area()).sum::<f64>();
    assert!(area(&snug) < 0.9 * area(&all), "{} {}", area(&snug), area(&all));
}

/// A ray at a random point of the surface, from outside.
fn aimed(rig: &Rig, vertices: &[[f64; 3]], random: &mut Random) -> Ray {
    let face = rig.skin().faces()[(random.next() * rig.skin().faces().len() as f64) as usize];
    let (u, v) = (random.next(), random.next());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let [a, b, c] = face.map(|corner| vertices[corner as usize]);
    let target = [0, 1, 2].map(|k| (1.0 - u - v) * a[k] + u * b[k] + v * c[k]);
    let direction = random.unit();
    Ray::new([0, 1, 2].map(|k| target[k] - 20.0 * direction[k]), direction).unwrap()
}

#[test]
fn rays_strike_the_part_that_the_mesh_says() {
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

#[test]
fn some_bones_are_posed_as_all_are() {
    let rig = robot();
    let character = fitted(&rig, 6, Mode::Snug);
    let bones = character.bones(&rig);
    let mut pose = rig.rest_pose().unwrap();
    for animation in 0..rig.animations().len() {
        rig.pose_bones_into(animation, 0.37, &bones, &mut pose).unwrap();
        assert_eq!(character.frames(&pose), character.frames(&rig.pose_at(animation, 0.37).unwrap()));
    }
}

/// A rig of one bone that stands still, and a face.
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

/// Against the distance of a segment, which shares no code with the closed forms.
#[test]
fn rays_agree_with_distances() {
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
                // Along an axis, on a grid.
                origin = origin.map(|x| (4.0 * x).round() / 4.0);
                direction = [0, 1, 2].map(|k| if k == case % 3 { -2.0 } else { 0.0 });
            }
            let ray = Ray::new(origin, direction).unwrap();
            let segment = Shape::segment([origin, ray.at(100.0)]).unwrap().at(Pose::IDENTITY).unwrap();
            let distance = shapes::distance(&segment, &placed);
            let hit = posed.ray_cast(&ray);
            match distance.proximity {
                Proximity::Apart if distance.lower > 1e-9 => assert!(hit.is_none(), "{case} {distance:?} {hit:?}"),
                Proximity::Apart => {}
                _ => assert!(hit.is_some(), "{case} {distance:?}"),
            }
            let Some(hit) = hit else { continue };
            hits += 1;
            // The point is of the border, unless the ray starts inside, and nothing was met before.
            let here = |t: f64| Shape::point(ray.at(t)).unwrap().at(Pose::IDENTITY).unwrap();
            assert!(shapes::distance(&here(hit.t), &placed).upper < 1e-6, "{case} {hit:?}");
            if hit.t > 0.0 {
                let before = Shape::segment([origin, ray.at(hit.t - 1e-6)]).unwrap().at(Pose::IDENTITY).unwrap();
                assert!(shapes::distance(&before, &placed).upper > 0.0, "{case} {hit:?}");
            }
            let leave = hit.t + hit.depth / dot(direction, direction).sqrt();
            assert!(shapes::distance(&here(leave), &placed).upper < 1e-6, "{case} {hit:?}");
        }
        assert!((100..2_700).contains(&hits), "{hits}");
    }
}

#[test]
fn a_punch_through_the_body_in_one_step_is_caught() {
    let rig = robot();
    let character = fitted(&rig, 6, Mode::Conservative);
    let mut random = Random(5);
    let fist = HitVolume::Sphere(BoundingSphere::new([0.0; 3], 0.12).unwrap());
    let mut surface = Surface::new(&rig, &rig.rest_pose().unwrap()).unwrap();
    let (mut vertices, mut caught) = (Vec::new(), 0);
    for _ in 0..24 {
        let pose = random.pose(&rig);
        surface.set(&rig, &pose).unwrap();
        rig.skin().skinned(&pose, &mut vertices);
        let posed = Posed::new(&character, &pose);
        let ray = aimed(&rig, &vertices, &mut random);
        // Forty units in a step: in front of the body at its start, behind it at its end.
        let [from, to] = [0.0, 40.0].map(|t| Pose::from_translation(ray.at(t)).unwrap());
        let strikes = posed.strikes(&posed, &fist, &from, &to).unwrap();
        assert!(strikes.is_sorted_by(|a, b| a.t <= b.t));
        let touches = |step: u32| {
            let centre = ray.at(40.0 * f64::from(step) / 4000.0);
            surface.mesh().closest_point(centre).unwrap().is_some_and(|p| p.upper <= 0.12)
        };
        let Some(truth) = (0..=4000).find(|&step| touches(step)) else { continue };
        let first = strikes.first().expect("the volumes hold the surface");
        assert!(first.t <= f64::from(truth) / 4000.0, "{first:?} {truth}");
        assert!(first.t > 0.2 && first.depth == 0.0 && (dot(first.normal, first.normal) - 1.0).abs() < 1e-9);
        caught += 1;
    }
    assert!(caught >= 20, "{caught}");
}

#[test]
fn strikes_on_moving_parts_are_never_late() {
    let rig = robot();
    let character = fitted(&rig, 6, Mode::Conservative);
    let mut random = Random(9);
    let fist = HitVolume::Capsule(Capsule::new([0.0; 3], [0.5, 0.0, 0.0], 0.1).unwrap());
    let (mut hit, mut missed) = (0, 0);
    for _ in 0..12 {
        let (before, after) = (random.pose(&rig), random.pose(&rig));
        let (before, after) = (Posed::new(&character, &before), Posed::new(&character, &after));
        let pose = |random: &mut Random| {
            let [x, y, z] = random.vector(3.5);
            Pose::from_axis_angle(random.unit(), 3.0 * random.next(), [x, y + 2.0, z]).unwrap()
        };
        let (from, to) = (pose(&mut random), pose(&mut random));
        let strikes = before.strikes(&after, &fist, &from, &to).unwrap();
        let motion = impinge::sweep::Motion::between(from, to).unwrap();
        for (at, part) in character.parts().iter().enumerate() {
            let [start, end] = [&before, &after].map(|posed| posed.frames()[at].pose().unwrap());
            let of_part = impinge::sweep::Motion::between(start, end).unwrap();
            let meets = |step: u32| {
                let t = f64::from(step) / 400.0;
                let (a, b) = (fist.placed(motion.at(t)).unwrap(), part.volume().placed(of_part.at(t)).unwrap());
                shapes::intersects(&a, &b)
            };
            let truth = (0..=400).find(|&step| meets(step)).map(|step| f64::from(step) / 400.0);
            let found = strikes.iter().find(|strike| strike.part as usize == at);
            match (truth, found) {
                (Some(truth), Some(found)) => {
                    assert!(found.t <= truth + 1e-9 && found.t > truth - 1.0 / 200.0, "{found:?} {truth}");
                    hit += 1;
                }
                (Some(truth), None) => panic!("{} is struck at {truth}", part.name),
                _ => missed += 1,
            }
        }
    }
    assert!(hit >= 10 && missed >= 10, "{hit} {missed}");
}

#[test]
fn shapes_meshes_and_characters_strike_alike() {
    let rig = robot();
    let character = fitted(&rig, 12, Mode::Conservative);
    let mut random = Random(13);
    let (mut struck, mut pairs) = (0, 0);
    for _ in 0..30 {
        let poses = [random.pose(&rig), random.pose(&rig)];
        let [a, b] = [&poses[0], &poses[1]].map(|pose| Posed::new(&character, pose));
        // A tetrahedron as a hull and as a mesh.
        let centre = random.vector(1.0);
        let corners: Vec<[f64; 3]> =
            (0..4).map(|_| random.unit()).map(|u| [0, 1, 2].map(|k| centre[k] + u[k] + [0.0, 2.0, 0.0][k])).collect();
        let hull = impinge::hull::Hull::new(&corners).unwrap();
        let mesh = Mesh::new(Positions::F64(hull.positions().to_vec()), hull.faces().to_vec()).unwrap();
        let shape = Shape::hull(hull.into()).at(Pose::IDENTITY).unwrap();
        let by_shape = a.struck_by(&shape).unwrap();
        let by_mesh = a.struck_by_mesh((&mesh).into()).unwrap();
        for (part, frame) in (0..).zip(a.frames()) {
            let placed = character.parts()[part as usize].volume().placed(frame.pose().unwrap()).unwrap();
            let truth = shapes::intersects(&placed, &shape);
            assert_eq!(by_shape.iter().any(|hit| hit.part == part), truth);
            // The surface of the mesh is not its inside, so a part may be in it whole.
            let of_mesh = by_mesh.iter().any(|hit| hit.part == part);
            assert!(truth || !of_mesh, "part {part}");
            struck += u32::from(of_mesh);
        }
        for hit in by_shape.iter().chain(&by_mesh) {
            assert!(hit.depth >= 0.0 && (dot(hit.normal, hit.normal) - 1.0).abs() < 1e-9);
        }

        let found = a.struck_by_character(&b).unwrap();
        let mut swapped: Vec<_> = b.struck_by_character(&a).unwrap().iter().map(|p| (p.part_b, p.part_a)).collect();
        swapped.sort_unstable();
        assert_eq!(found.iter().map(|p| (p.part_a, p.part_b)).collect::<Vec<_>>(), swapped);
        for (i, frame_a) in (0..).zip(a.frames()) {
            for (j, frame_b) in (0..).zip(b.frames()) {
                let place = |at: u32, pose| character.parts()[at as usize].volume().placed(pose).unwrap();
                let distance = shapes::distance(&place(i, frame_a.pose().unwrap()), &place(j, frame_b.pose().unwrap()));
                let is_found = found.iter().any(|p| (p.part_a, p.part_b) == (i, j));
                let expected = distance.proximity != Proximity::Apart;
                assert!(is_found == expected || distance.upper < 1e-9, "{i} {j} {distance:?}");
            }
        }
        pairs += found.len();
    }
    assert!(struck > 20 && pairs > 300, "{struck} {pairs}");
}

#[test]
fn a_saved_character_is_the_same_and_a_plan_overrides() {
    let rig = robot();
    let character = fitted(&rig, 8, Mode::Conservative);
    let text = character_text(&rig, &character);
    let loaded = parse_character(&text, &rig).unwrap();
    assert_eq!(character_text(&rig, &loaded), text);
    assert_eq!(loaded.part_of_face(), character.part_of_face());
    let pose = rig.pose_at(0, 0.4).unwrap();
    let (a, b) = (Posed::new(&character, &pose), Posed::new(&loaded, &pose));
    let mut random = Random(2);
    for _ in 0..500 {
        let ray = Ray::new(random.vector(6.0), random.unit()).unwrap();
        assert_eq!(a.ray_cast_all(&ray), b.ray_cast_all(&ray));
    }

    let plan = "[[part]]\nname = \"upper half\"\nbones = [\"Hips\", \"Head\", \"Shoulder.L\", \"Shoulder.R\"]\nkind = \"box\"\n\
        [[part]]\nbones = [\"UpperLeg.L\", \"UpperLeg.R\", \"Foot.L\", \"Foot.R\"]\n";
    let plan = parse_plan(plan, &rig).unwrap();
    let character = Character::fit(&rig, &plan, Mode::Conservative).unwrap();
    assert_eq!(character.parts()[0].name, "upper half");
    assert_eq!(character.parts()[0].volume().kind(), VolumeKind::Box);
    assert_eq!((character.parts().len(), character.parts()[1].name.as_str()), (2, "UpperLeg.L"));

    for (text, kind, place) in [
        ("[[part]]\nbones = [\"Tail\"]", "syntax", "part 0"),
        ("[[part]]\nbones = [\"Head\"]\nkind = \"cone\"", "syntax", "part 0"),
        ("[[part]]\nbones = []", "syntax", "part 0"),
        ("[[part]]\nbones = [999]", "syntax", "part 0"),
        ("part = 1", "syntax", "line 1"),
        ("[[part]]\nbones = [\"Head\"]\ncolour = 1", "syntax", "line 3"),
    ] {
        let error = parse_plan(text, &rig).unwrap_err();
        assert_eq!(error.kind().name(), kind, "{error}");
        assert!(error.place().is_some_and(|found| found.to_string() == place), "{text}: {error}");
    }
    assert!(
        parse_character("[[part]]\nbones = [\"Head\"]\nkind = \"sphere\"\nradius = -1.0\npoints = [[0, 0, 0]]", &rig)
            .is_err()
    );
}

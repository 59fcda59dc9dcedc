//! Tests of moving volumes, shapes, meshes and other characters against characters.

use impinge::character::{HitVolume, Mode, Posed, Surface};
use impinge::query;
use impinge::shape::Shape;
use impinge::volume::{BoundingSphere, Capsule, Proximity};
use impinge::{Mesh, Pose, Positions};

use super::{Random, aimed, dot, fitted, robot};

#[test]
fn a_punch_through_the_body_in_one_step_is_detected() {
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
        // The fist moves forty units in a step: from in front of the body to behind it.
        let [from, to] = [0.0, 40.0].map(|t| Pose::from_translation(ray.at(t)).unwrap());
        let strikes = posed.strikes(&posed, &fist, &from, &to).unwrap();
        assert!(strikes.is_sorted_by(|a, b| a.t <= b.t));
        let touches = |step: u32| {
            let center = ray.at(40.0 * f64::from(step) / 4000.0);
            surface.mesh().closest_point(center).unwrap().is_some_and(|p| p.upper <= 0.12)
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
                query::intersects(&a, &b)
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
fn shapes_meshes_and_characters_strike_the_same_parts() {
    let rig = robot();
    let character = fitted(&rig, 12, Mode::Conservative);
    let mut random = Random(13);
    let (mut struck, mut pairs) = (0, 0);
    for _ in 0..30 {
        let poses = [random.pose(&rig), random.pose(&rig)];
        let [a, b] = [&poses[0], &poses[1]].map(|pose| Posed::new(&character, pose));
        // A tetrahedron as a hull and as a mesh.
        let center = random.vector(1.0);
        let corners: Vec<[f64; 3]> =
            (0..4).map(|_| random.unit()).map(|u| [0, 1, 2].map(|k| center[k] + u[k] + [0.0, 2.0, 0.0][k])).collect();
        let hull = impinge::hull::Hull::new(&corners).unwrap();
        let mesh = Mesh::new(Positions::F64(hull.positions().to_vec()), hull.faces().to_vec()).unwrap();
        let shape = Shape::hull(hull.into()).at(Pose::IDENTITY).unwrap();
        let by_shape = a.struck_by(&shape).unwrap();
        let by_mesh = a.struck_by_mesh((&mesh).into()).unwrap();
        for (part, frame) in (0..).zip(a.frames()) {
            let placed = character.parts()[part as usize].volume().placed(frame.pose().unwrap()).unwrap();
            let truth = query::intersects(&placed, &shape);
            assert_eq!(by_shape.iter().any(|hit| hit.part == part), truth);
            // The mesh is only a surface, so a part may be entirely inside it.
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
                let distance = query::distance(place(i, frame_a.pose().unwrap()), place(j, frame_b.pose().unwrap()));
                let is_found = found.iter().any(|p| (p.part_a, p.part_b) == (i, j));
                let expected = distance.proximity != Proximity::Apart;
                assert!(is_found == expected || distance.upper < 1e-9, "{i} {j} {distance:?}");
            }
        }
        pairs += found.len();
    }
    assert!(struck > 20 && pairs > 300, "{struck} {pairs}");
}

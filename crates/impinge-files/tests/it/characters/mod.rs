//! Tests of hit volumes of a real character: containment, rays, strikes, and saving.

mod holding;
mod many_keys;
mod rays;
mod saving;
mod strikes;
mod surface;
mod world;

use std::path::Path;

use impinge::character::{Character, Mode, Plan, Rig, RigPose, VolumeKind};
use impinge::mesh::Ray;
use impinge_files::load_rig;

fn robot() -> Rig {
    load_rig(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robot.glb")).unwrap()
}

fn fitted(rig: &Rig, volumes: usize, mode: Mode) -> Character {
    Character::fit(rig, &Plan::automatic(rig, volumes).unwrap(), mode).unwrap()
}

/// Pseudorandom numbers from 0 to 1, the same in every run.
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

/// Returns a ray from outside at a random point of the surface.
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
fn automatic_parts_are_head_torso_and_limbs() {
    let rig = robot();
    let character = fitted(&rig, 6, Mode::Conservative);
    let mut parts: Vec<(&str, VolumeKind)> =
        character.parts().iter().map(|part| (part.name.as_str(), part.volume().kind())).collect();
    parts.sort_unstable();
    let names: Vec<&str> = parts.iter().map(|part| part.0).collect();
    assert_eq!(names, ["head", "left arm", "left leg", "right arm", "right leg", "torso"]);
    assert_eq!((parts[0].1, parts[1].1, parts[2].1), (VolumeKind::Sphere, VolumeKind::Capsule, VolumeKind::Capsule));
    // The maximum number of volumes is kept, and merging loses no bones.
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
fn posing_some_bones_gives_the_same_frames_as_posing_all() {
    let rig = robot();
    let character = fitted(&rig, 6, Mode::Snug);
    let bones = character.bones(&rig);
    let mut pose = rig.rest_pose().unwrap();
    for animation in 0..rig.animations().len() {
        rig.pose_bones_into(animation, 0.37, &bones, &mut pose).unwrap();
        assert_eq!(character.frames(&pose), character.frames(&rig.pose_at(animation, 0.37).unwrap()));
    }
}

//! A rigged character: which part a shot hits, and which part a punch hits between two frames.
//!
//! The volumes contain the whole skin at every time of every animation, so a shot that misses them
//! misses the character.

use std::error::Error;

use impinge::Pose;
use impinge::character::{Character, HitVolume, Mode, Plan, Posed, SurfaceRays};
use impinge::mesh::Ray;
use impinge::volume::BoundingSphere;

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/robot.glb");

fn main() -> Result<(), Box<dyn Error>> {
    let rig = impinge_files::load_rig(ROBOT)?;
    let robot = Character::fit(&rig, &Plan::automatic(&rig, 6)?, Mode::Conservative)?;
    for part in robot.parts() {
        println!("{}: {}", part.name, part.volume().kind().name());
    }

    let walking = rig.animations().iter().position(|animation| animation.name() == "Robot_Walking");
    let walking = walking.ok_or("there is no such animation")?;
    let pose = rig.pose_at(walking, 0.5)?;
    let posed = Posed::new(&robot, &pose);
    let skin = SurfaceRays::new(&robot, &rig, &pose);
    for (row, origin) in [[0.0, 4.0, 9.0], [0.0, 2.0, 9.0], [1.0, 0.5, 9.0], [3.0, 4.0, 9.0]].into_iter().enumerate() {
        let ray = Ray::new(origin, [0.0, 0.0, -1.0])?;
        let name = |part: u32| &robot.parts()[part as usize].name;
        match (posed.ray_cast(&ray), skin.ray_cast(&ray)) {
            (None, _) => println!("shot {row}: misses"),
            (Some(hit), None) => println!("shot {row}: enters {}, misses the skin", name(hit.part)),
            (_, Some(hit)) => println!("shot {row}: strikes {} at {:.6}, face {}", name(hit.part), hit.t, hit.face),
        }
    }

    // A fist passes through the robot within one frame, while the robot moves on.
    let fist = HitVolume::Sphere(BoundingSphere::new([0.0; 3], 0.125)?);
    let after = Posed::new(&robot, &rig.pose_at(walking, 0.55)?);
    let (from, to) = (Pose::from_translation([0.0, 3.5, 9.0])?, Pose::from_translation([0.0, 3.5, -9.0])?);
    for strike in posed.strikes(&after, &fist, &from, &to)? {
        println!("the fist strikes {} at {:.6}", robot.parts()[strike.part as usize].name, strike.t);
    }
    Ok(())
}

//! A scene of named parts: which pairs of them intersect or come near, in many configurations.
//!
//! Neighboring links of the robot are ignored. Only pairs of parts whose boxes are near each other
//! are tested.

use std::error::Error;

use impinge::query::batch::Execution;
use impinge::scene::{Question, Scene, Stop};
use impinge::{InputError, Mesh, Pose, Shape};

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");
const CONFIGURATIONS: u32 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let mut scene = Scene::new();
    let base = Shape::cuboid([0.25, 0.125, 0.25])?;
    let base = scene.add("base", base, Pose::from_translation([-1.0, -0.5, 0.25])?)?;
    let arm = Shape::capsule([0.0; 3], [0.5, 0.0, 0.0], 0.0625)?;
    let arm = scene.add("arm", arm, Pose::IDENTITY)?;
    let hand = scene.add("hand", Shape::sphere([0.0; 3], 0.125)?, Pose::IDENTITY)?;
    scene.add("human", &Mesh::new(model.positions, model.faces)?, Pose::IDENTITY)?;
    scene.ignore(base, arm);
    scene.ignore(arm, hand);

    // The base is fixed. The arm sinks from one configuration to the next, together with the hand
    // at its end.
    let mut configurations = scene.configurations();
    configurations.set(arm, sinking(-1.0)?)?;
    configurations.set(hand, sinking(-0.5)?)?;

    let found = scene.check(Question::Intersects, Stop::All, &configurations, Execution::default())?.values;
    let count = found.iter().filter(|pairs| !pairs.is_empty()).count();
    println!("{count} of {CONFIGURATIONS} configurations have parts that intersect");
    for (row, pairs) in found.iter().enumerate() {
        for pair in pairs {
            let [a, b] = pair.parts.map(|part| scene.name(part));
            println!("configuration {row}: {a} and {b}");
        }
    }

    let near = scene.check(Question::Within(0.125), Stop::All, &configurations, Execution::default())?.values;
    let count = near.iter().filter(|pairs| !pairs.is_empty()).count();
    println!("{count} of {CONFIGURATIONS} configurations have parts within 0.125 of each other");
    Ok(())
}

/// Returns the poses of a part that sinks.
fn sinking(x: f64) -> Result<Vec<Pose>, InputError> {
    (0..CONFIGURATIONS).map(|row| Pose::from_translation([x, 0.5 - f64::from(row) / 8.0, 0.25])).collect()
}

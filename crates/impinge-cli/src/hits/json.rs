//! The JSON answer: one object of schema `impinge.hits/1`. Values that are not known are absent.

use impinge::character::HitVolume;
use impinge_report::picture::DISTINCT_NAMES;
use serde::Serialize;

use super::{Fitting, Outcome, Seconds};
use crate::console;

#[derive(Serialize)]
struct Object {
    schema: &'static str,
    version: &'static str,
    character: Summary,
    mode: &'static str,
    parts: Vec<Part>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<Drawn>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Summary {
    path: String,
    bones: usize,
    animations: Vec<String>,
    vertices: usize,
    triangles: usize,
}

#[derive(Serialize)]
struct Part {
    name: String,
    bones: Vec<String>,
    /// Name of the bone in whose frame the volume is given.
    anchor: String,
    kind: &'static str,
    volume: Numbers,
    looseness: f64,
    leak_share: f64,
    leak_farthest: f64,
    bytes: usize,
}

/// Numbers of a volume, in the frame of the bone that it is fixed to.
#[derive(Serialize)]
#[serde(untagged)]
enum Numbers {
    Sphere { centre: [f64; 3], radius: f64 },
    Capsule { ends: [[f64; 3]; 2], radius: f64 },
    Box { centre: [f64; 3], axes: [[f64; 3]; 3], half_extents: [f64; 3] },
    Lozenge { corner: [f64; 3], edges: [[f64; 3]; 2], radius: f64 },
    Hull { corners: Vec<[f64; 3]> },
}

#[derive(Serialize)]
struct Drawn {
    path: String,
    frames: usize,
    colours: Vec<&'static str>,
}

/// Returns the JSON object as one line.
pub(super) fn object(outcome: &Outcome<'_>) -> String {
    let Outcome { arguments, rig, character, leaks, frames, seconds } = outcome;
    let bone = |bone: u32| rig.skeleton().bones()[bone as usize].name.clone();
    let parts = character.parts().iter().zip(leaks).map(|(part, leak)| Part {
        name: part.name.clone(),
        bones: part.bones.iter().map(|&own| bone(own)).collect(),
        anchor: bone(part.anchor),
        kind: part.volume().kind().name(),
        volume: numbers(part.volume()),
        looseness: part.looseness,
        leak_share: leak.share,
        leak_farthest: leak.farthest,
        bytes: part.volume().bytes(),
    });
    let picture = arguments.picture.as_ref().zip(*frames).map(|(path, frames)| Drawn {
        path: path.display().to_string(),
        frames,
        colours: (0..character.parts().len()).map(|at| DISTINCT_NAMES[at % DISTINCT_NAMES.len()]).collect(),
    });
    console::to_line(&Object {
        schema: "impinge.hits/1",
        version: env!("CARGO_PKG_VERSION"),
        character: Summary {
            path: arguments.character.display().to_string(),
            bones: rig.skeleton().bones().len(),
            animations: rig.animations().iter().map(|animation| animation.name().to_owned()).collect(),
            vertices: rig.skin().positions().len(),
            triangles: rig.skin().faces().len(),
        },
        mode: match arguments.mode {
            Fitting::Conservative => "conservative",
            Fitting::Snug => "snug",
        },
        parts: parts.collect(),
        picture,
        seconds: *seconds,
    })
}

fn numbers(volume: &HitVolume) -> Numbers {
    match volume {
        HitVolume::Sphere(sphere) => Numbers::Sphere { centre: sphere.center(), radius: sphere.radius() },
        HitVolume::Capsule(capsule) => Numbers::Capsule { ends: capsule.ends(), radius: capsule.radius() },
        HitVolume::Box(obb) => {
            Numbers::Box { centre: obb.center(), axes: obb.axes(), half_extents: obb.half_extents() }
        }
        HitVolume::Lozenge(plate) => {
            Numbers::Lozenge { corner: plate.corner(), edges: plate.edges(), radius: plate.radius() }
        }
        HitVolume::Hull(hull) => Numbers::Hull { corners: hull.hull().positions().to_vec() },
    }
}

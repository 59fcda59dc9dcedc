//! The parts of a character as editable TOML text, with one table per part.
//!
//! ```toml
//! [[part]]
//! name = "left arm"
//! bones = ["LowerArm.L", "UpperArm.L"]
//! anchor = "UpperArm.L"
//! kind = "capsule"
//! ```
//! Only `bones` is required. `kind` states which volume to fit; without it the best kind is chosen.
//! Saved files also contain the numbers of the fitted volumes. [`load_character`] uses these
//! numbers, and [`load_plan`] ignores them.

use std::{collections::HashMap, path::Path};

use impinge::character::{Character, HitHull, HitPart, HitVolume, PartPlan, Plan, Rig, VolumeKind};
use impinge::volume::{BoundingSphere, Capsule, Lozenge, Obb};
use serde::{Deserialize, Serialize};

use crate::{
    error::{LoadError, Place},
    limits::Limits,
    regular_file::read_regular_file,
};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    part: Vec<Part>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    name: Option<String>,
    /// Names of the bones, or indices for names that are empty or not unique.
    bones: Vec<BoneName>,
    anchor: Option<BoneName>,
    kind: Option<String>,
    looseness: Option<f64>,
    radius: Option<f64>,
    half_extents: Option<[f64; 3]>,
    /// Center, ends, corner or corners of the volume.
    points: Option<Vec<[f64; 3]>>,
    /// Axes or edges of the volume.
    vectors: Option<Vec<[f64; 3]>>,
}

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum BoneName {
    Name(String),
    Number(u32),
}

/// Returns the parts of a fitted character as TOML text. The numbers of the volumes read back to
/// the last bit.
#[must_use]
pub fn character_text(rig: &Rig, character: &Character) -> String {
    let by_name = BonesByName::new(rig);
    let name = |bone: u32| {
        let name = &rig.skeleton().bones()[bone as usize].name;
        match by_name.find(name) {
            Some(found) if found == bone => BoneName::Name(name.clone()),
            _ => BoneName::Number(bone),
        }
    };
    let part = |part: &HitPart| {
        let (radius, half_extents, points, vectors) = match part.volume() {
            HitVolume::Sphere(sphere) => (Some(sphere.radius()), None, vec![sphere.center()], None),
            HitVolume::Capsule(capsule) => (Some(capsule.radius()), None, capsule.ends().to_vec(), None),
            HitVolume::Box(obb) => (None, Some(obb.half_extents()), vec![obb.center()], Some(obb.axes().to_vec())),
            HitVolume::Lozenge(plate) => {
                (Some(plate.radius()), None, vec![plate.corner()], Some(plate.edges().to_vec()))
            }
            HitVolume::Hull(hull) => (None, None, hull.hull().positions().to_vec(), None),
        };
        Part {
            name: Some(part.name.clone()),
            bones: part.bones.iter().map(|&bone| name(bone)).collect(),
            anchor: Some(name(part.anchor)),
            kind: Some(part.volume().kind().name().to_owned()),
            looseness: Some(part.looseness),
            radius,
            half_extents,
            points: Some(points),
            vectors,
        }
    };
    let file = File { part: character.parts().iter().map(part).collect() };
    // Structs of text and finite numbers always serialize.
    toml::to_string(&file).unwrap_or_default()
}

/// The bones of a rig by their names.
struct BonesByName<'a> {
    /// The bones of joints. They come first, because nodes of meshes often have their names.
    joints: HashMap<&'a str, Option<u32>>,
    all: HashMap<&'a str, Option<u32>>,
}

impl<'a> BonesByName<'a> {
    fn new(rig: &'a Rig) -> Self {
        let joints = rig.skin().joints().iter().map(|joint| joint.bone);
        Self { joints: by_name(rig, joints), all: by_name(rig, 0..rig.skeleton().bones().len() as u32) }
    }

    /// Returns the only bone of a name among the joints, or else among all bones. Returns `None` if
    /// there is none or more than one.
    fn find(&self, name: &str) -> Option<u32> {
        [&self.joints, &self.all].into_iter().find_map(|bones| bones.get(name).copied().flatten())
    }
}

/// Returns the bone of each name; `None` for a name that several bones have. Bones without a name
/// are left out.
fn by_name(rig: &Rig, bones: impl Iterator<Item = u32>) -> HashMap<&str, Option<u32>> {
    let mut found = HashMap::new();
    for bone in bones {
        let name = rig.skeleton().bones()[bone as usize].name.as_str();
        if !name.is_empty() {
            let known = found.entry(name).or_insert(Some(bone));
            *known = known.filter(|&known| known == bone);
        }
    }
    found
}

/// Loads a plan of the parts of a character. For each part it has the bones, and optionally the
/// part's name, the kind of its volume, and the bone that the volume is fixed to.
///
/// # Errors
/// Returns an error if the file cannot be read, is not valid TOML of this form, or names a bone or
/// a kind of volume that does not exist.
pub fn load_plan(path: impl AsRef<Path>, rig: &Rig) -> Result<Plan, LoadError> {
    load_plan_with(path, rig, &Limits::default())
}

/// Loads a plan, as [`load_plan`] does, from a file of at most
/// [`max_bytes`](Limits::max_bytes).
///
/// # Errors
/// Returns an error as [`load_plan`] does, with this limit.
pub fn load_plan_with(path: impl AsRef<Path>, rig: &Rig, limits: &Limits) -> Result<Plan, LoadError> {
    let path = path.as_ref();
    let text = read_text(path, limits)?;
    parse_plan(&text, rig).map_err(|e| e.in_file(path))
}

/// Parses a plan from TOML text, as [`load_plan`] does from a file.
///
/// # Errors
/// Returns an error as [`load_plan`] does; the path of the error is empty.
pub fn parse_plan(text: &str, rig: &Rig) -> Result<Plan, LoadError> {
    let parts = read(text)?;
    let by_name = BonesByName::new(rig);
    let of_part = |(at, part): (usize, &Part)| plan(rig, &by_name, part, at);
    Ok(Plan { parts: parts.iter().enumerate().map(of_part).collect::<Result<_, _>>()? })
}

/// Loads a saved character with its volumes, without fitting. `rig` is the rig of the character.
///
/// # Errors
/// Returns an error as [`load_plan`] does, and if a part has no volume or the numbers of its volume
/// are invalid.
pub fn load_character(path: impl AsRef<Path>, rig: &Rig) -> Result<Character, LoadError> {
    load_character_with(path, rig, &Limits::default())
}

/// Loads a saved character, as [`load_character`] does, from a file of at most
/// [`max_bytes`](Limits::max_bytes).
///
/// # Errors
/// Returns an error as [`load_character`] does, with this limit.
pub fn load_character_with(path: impl AsRef<Path>, rig: &Rig, limits: &Limits) -> Result<Character, LoadError> {
    let path = path.as_ref();
    let text = read_text(path, limits)?;
    parse_character(&text, rig).map_err(|e| e.in_file(path))
}

/// Parses a saved character from TOML text, as [`load_character`] does from a file.
///
/// # Errors
/// Returns an error as [`load_character`] does; the path of the error is empty.
pub fn parse_character(text: &str, rig: &Rig) -> Result<Character, LoadError> {
    let by_name = BonesByName::new(rig);
    let mut parts = Vec::new();
    for (at, part) in read(text)?.iter().enumerate() {
        let PartPlan { name, bones, anchor, kind } = plan(rig, &by_name, part, at)?;
        let volume = kind.and_then(|kind| volume(part, kind));
        let volume = volume.ok_or_else(|| in_part(LoadError::syntax("valid numbers of a volume", b""), at))?;
        parts.push(HitPart::new(name, bones, anchor, volume, part.looseness.unwrap_or(1.0)));
    }
    Character::of_parts(rig, parts).map_err(|e| LoadError::syntax("parts of this rig", e.to_string().as_bytes()))
}

fn read_text(path: &Path, limits: &Limits) -> Result<String, LoadError> {
    let bytes = read_regular_file(path, limits)?;
    String::from_utf8(bytes).map_err(|e| LoadError::syntax("UTF-8 text", e.to_string().as_bytes()).in_file(path))
}

fn read(text: &str) -> Result<Vec<Part>, LoadError> {
    let line = |offset: usize| 1 + text.as_bytes()[..offset.min(text.len())].iter().filter(|b| **b == b'\n').count();
    toml::from_str::<File>(text).map(|file| file.part).map_err(|e| {
        let error = LoadError::refused("a table [[part]] for each part", &e.message());
        match e.span() {
            Some(span) => error.at(Place::Line(line(span.start) as u64)),
            None => error,
        }
    })
}

fn in_part(error: LoadError, part: usize) -> LoadError {
    error.at(Place::Entry(format!("part {part}")))
}

fn plan(rig: &Rig, by_name: &BonesByName<'_>, part: &Part, at: usize) -> Result<PartPlan, LoadError> {
    let bone = |name: &BoneName| {
        let (found, text) = match name {
            BoneName::Name(name) => (by_name.find(name), name.clone()),
            BoneName::Number(number) => {
                (Some(*number).filter(|&n| (n as usize) < rig.skeleton().bones().len()), number.to_string())
            }
        };
        found.ok_or_else(|| in_part(LoadError::syntax("a bone of the rig", text.as_bytes()), at))
    };
    let bones = part.bones.iter().map(bone).collect::<Result<Vec<u32>, _>>()?;
    let anchor = match (&part.anchor, bones.first()) {
        (Some(anchor), _) => bone(anchor)?,
        (None, Some(&first)) => first,
        (None, None) => return Err(in_part(LoadError::syntax("a bone", b""), at)),
    };
    let kind = match part.kind.as_deref() {
        None => None,
        Some(name) => {
            let known = || in_part(LoadError::syntax("sphere, capsule, box, lozenge or hull", name.as_bytes()), at);
            Some(VolumeKind::from_name(name).ok_or_else(known)?)
        }
    };
    let name = part.name.clone().unwrap_or_else(|| rig.skeleton().bones()[anchor as usize].name.clone());
    Ok(PartPlan { name, bones, anchor, kind })
}

fn volume(part: &Part, kind: VolumeKind) -> Option<HitVolume> {
    let points = part.points.as_deref()?;
    let vectors = part.vectors.as_deref().unwrap_or_default();
    Some(match (kind, points, vectors) {
        (VolumeKind::Sphere, &[center], []) => HitVolume::Sphere(BoundingSphere::new(center, part.radius?).ok()?),
        (VolumeKind::Capsule, &[from, to], []) => HitVolume::Capsule(Capsule::new(from, to, part.radius?).ok()?),
        (VolumeKind::Lozenge, &[corner], &[u, v]) => {
            HitVolume::Lozenge(Lozenge::new(corner, [u, v], part.radius?).ok()?)
        }
        (VolumeKind::Box, &[center], &[x, y, z]) => {
            HitVolume::Box(Obb::new(center, [x, y, z], part.half_extents?).ok()?)
        }
        (VolumeKind::Hull, corners, []) => HitVolume::Hull(HitHull::new(corners).ok()?),
        _ => return None,
    })
}

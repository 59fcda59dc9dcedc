//! Names parts by the names of their bones, or by their positions if those names say nothing.

use super::error::RigError;
use super::plan::Plan;
use super::rig::Rig;
use super::skin::blended;
use crate::math::vec3::{self, Vector};

/// The body region that the words in a bone's name indicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Region {
    Head,
    Torso,
    Arm,
    Hand,
    Leg,
    Foot,
}

/// Words and their regions. The first match counts, so fingers come before arms.
const WORDS: [(Region, &[&str]); 6] = [
    (Region::Hand, &["hand", "finger", "thumb", "index", "middle", "ring", "pinky", "palm", "wrist"]),
    (Region::Foot, &["foot", "feet", "toe", "toes", "ankle", "heel"]),
    (Region::Arm, &["arm", "forearm", "elbow", "shoulder", "clavicle"]),
    (Region::Leg, &["leg", "thigh", "knee", "shin", "calf"]),
    (Region::Head, &["head", "neck", "face", "jaw", "hair", "eye", "hat"]),
    (Region::Torso, &["torso", "chest", "spine", "hips", "pelvis", "abdomen", "body", "waist", "root", "hip"]),
];

/// Names the parts of a plan. Names that would repeat are replaced by the name of the bone or get a
/// number.
pub(super) fn name(rig: &Rig, plan: &mut Plan) -> Result<(), RigError> {
    let shapes = Shapes::of(rig, plan)?;
    let mut names: Vec<String> = Vec::new();
    for (at, part) in plan.parts.iter().enumerate() {
        let bones = rig.skeleton().bones();
        // Sorted by area, largest first.
        let mut known: Vec<(f64, &str)> =
            part.bones.iter().map(|&bone| (shapes.area_of_bone[bone as usize], &*bones[bone as usize].name)).collect();
        known.sort_by(|a, b| b.0.total_cmp(&a.0));
        let name = by_regions(&known).unwrap_or_else(|| shapes.name(at));
        names.push(name);
    }
    for (at, part) in plan.parts.iter_mut().enumerate() {
        let earlier = names[..at].iter().filter(|name| **name == names[at]).count();
        let again = names.iter().filter(|name| **name == names[at]).count() > 1;
        let only = &*rig.skeleton().bones()[part.anchor as usize].name;
        part.name = match again {
            false => names[at].clone(),
            _ if region(only).is_some() => only.to_owned(),
            _ => format!("{} {}", names[at], earlier + 1),
        };
    }
    Ok(())
}

/// Returns the words of a name in lower case, split at everything but letters and before capitals
/// that follow a lower-case letter.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last_is_lower = false;
    for letter in name.chars() {
        let starts = letter.is_uppercase() && last_is_lower;
        if (starts || !letter.is_alphabetic()) && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphabetic()) {
            word.extend(letter.to_lowercase());
        }
        last_is_lower = letter.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

fn region(name: &str) -> Option<Region> {
    let words = words(name);
    // A hip with a side is the start of that leg.
    if words.iter().any(|word| word == "hip") && side(name).is_some() {
        return Some(Region::Leg);
    }
    let has = |known: &[&str]| words.iter().any(|word| known.contains(&word.as_str()));
    WORDS.iter().find(|(_, known)| has(known)).map(|(region, _)| *region)
}

/// Returns a number for the limb, head or torso that a bone belongs to by its name, or `None` if
/// the name does not say.
pub(super) fn limb(name: &str) -> Option<usize> {
    let side = match side(name) {
        Some("left ") => 1,
        Some(_) => 2,
        None => 0,
    };
    Some(match region(name)? {
        Region::Head => 0,
        Region::Torso => 1,
        Region::Arm | Region::Hand => 2 + side,
        Region::Leg | Region::Foot => 5 + side,
    })
}

fn side(name: &str) -> Option<&'static str> {
    let words = words(name);
    let has = |known: [&str; 2]| words.iter().any(|word| known.contains(&word.as_str()));
    if has(["l", "left"]) {
        Some("left ")
    } else if has(["r", "right"]) {
        Some("right ")
    } else {
        None
    }
}

/// Returns one name for several bones, or `None` if their names say nothing. Bones with more
/// surface must come first.
fn by_regions(bones: &[(f64, &str)]) -> Option<String> {
    let regions: Vec<Region> = bones.iter().filter_map(|bone| region(bone.1)).collect();
    let first = *regions.first()?;
    let has = |region: Region| regions.contains(&region);
    let word = match first {
        Region::Torso => "torso",
        Region::Head if has(Region::Torso) => "torso and head",
        Region::Head => "head",
        Region::Hand if !has(Region::Arm) => "hand",
        Region::Foot if !has(Region::Leg) => "foot",
        Region::Arm | Region::Hand => "arm",
        Region::Leg | Region::Foot => "leg",
    };
    let sides: Vec<_> = bones.iter().filter(|bone| region(bone.1) == Some(first)).map(|bone| side(bone.1)).collect();
    let paired = !matches!(first, Region::Torso | Region::Head);
    let one_side = sides.first().copied().flatten().filter(|own| sides.iter().all(|side| *side == Some(*own)));
    match one_side {
        Some(side) if paired => Some(format!("{side}{word}")),
        None if paired && sides.len() > 1 => Some(format!("{word}s")),
        _ => Some(word.to_owned()),
    }
}

/// Positions of the parts at rest. As in glTF, y is up and z points forward.
struct Shapes {
    area_of_bone: Vec<f64>,
    boxes: Vec<[Vector; 2]>,
    /// Index of the part with the largest box.
    torso: usize,
}

impl Shapes {
    fn of(rig: &Rig, plan: &Plan) -> Result<Self, RigError> {
        let pose = rig.rest_pose()?;
        let palette = rig.skin().palette(pose.bones());
        let part_of_bone = plan.part_of_bones(rig)?;
        let mut area_of_bone = vec![0.0; part_of_bone.len()];
        let mut boxes = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; plan.parts.len()];
        let place =
            |corner: u32| blended(&palette, rig.skin().influences(corner), rig.skin().positions()[corner as usize]);
        for (face, bone) in rig.skin().faces().iter().zip(super::plan::bones_of_faces(rig)) {
            let [a, b, c] = face.map(place);
            let across = vec3::cross(&vec3::sub(&b, &a), &vec3::sub(&c, &a));
            area_of_bone[bone as usize] += vec3::length(&across);
            let bounds = &mut boxes[part_of_bone[bone as usize] as usize];
            for point in [a, b, c] {
                *bounds =
                    [[0, 1, 2].map(|k| bounds[0][k].min(point[k])), [0, 1, 2].map(|k| bounds[1][k].max(point[k]))];
            }
        }
        let size = |b: &[Vector; 2]| (0..3).map(|k| (b[1][k] - b[0][k]).max(0.0)).product::<f64>();
        let torso = (0..boxes.len()).max_by(|&a, &b| size(&boxes[a]).total_cmp(&size(&boxes[b]))).unwrap_or(0);
        Ok(Self { area_of_bone, boxes, torso })
    }

    fn name(&self, part: usize) -> String {
        let middle = |part: usize, k: usize| 0.5 * (self.boxes[part][0][k] + self.boxes[part][1][k]);
        let torso = &self.boxes[self.torso];
        if part == self.torso || !middle(part, 0).is_finite() {
            return "torso".to_owned();
        }
        let width = torso[1][0] - torso[0][0];
        let aside = middle(part, 0) - middle(self.torso, 0);
        let side = match aside {
            x if x > 0.1 * width => "left ",
            x if x < -0.1 * width => "right ",
            _ => "",
        };
        let height = middle(part, 1);
        if side.is_empty() && height > middle(self.torso, 1) {
            "head".to_owned()
        } else if height < 0.75 * torso[0][1] + 0.25 * torso[1][1] && aside.abs() < width {
            format!("{side}leg")
        } else {
            format!("{side}arm")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_split_into_words_region_and_side() {
        assert_eq!(words("mixamorig:LeftForeArm_01"), ["mixamorig", "left", "fore", "arm"]);
        assert_eq!(words("UpperLeg.L"), ["upper", "leg", "l"]);
        let cases = [
            ("UpperLeg.L", Some(Region::Leg), Some("left ")),
            ("hip_R", Some(Region::Leg), Some("right ")),
            ("Hips", Some(Region::Torso), None),
            ("mixamorig:RightHandIndex1", Some(Region::Hand), Some("right ")),
            ("Head", Some(Region::Head), None),
            ("Bone.001", None, None),
        ];
        for (name, of, on) in cases {
            assert_eq!((region(name), side(name)), (of, on), "{name}");
        }
    }

    #[test]
    fn several_bones_get_the_name_of_their_region() {
        let name = |bones: &[&str]| by_regions(&bones.iter().map(|bone| (1.0, *bone)).collect::<Vec<_>>());
        assert_eq!(name(&["LowerArm.L", "Palm1.L", "UpperArm.L"]).as_deref(), Some("left arm"));
        assert_eq!(name(&["Palm1.R", "Thumb.R"]).as_deref(), Some("right hand"));
        assert_eq!(name(&["LowerLeg.R", "Foot.R"]).as_deref(), Some("right leg"));
        assert_eq!(name(&["LowerLeg.R", "LowerLeg.L"]).as_deref(), Some("legs"));
        assert_eq!(name(&["Chest", "Neck"]).as_deref(), Some("torso"));
        assert_eq!(name(&["Head", "Neck"]).as_deref(), Some("head"));
        assert_eq!(name(&["a", "b"]), None);
    }
}

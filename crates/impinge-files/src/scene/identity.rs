//! Names and keys of parts. Both are unique, and keys do not depend on the order of the file.

use std::{
    cmp::Ordering,
    collections::{HashMap, HashSet},
};

use impinge::scene::Details;

use super::names::Names;
use crate::{
    properties::Properties,
    scene_draft::PartDraft,
    scene_model::{SceneMesh, ScenePart},
    text::name,
};

/// Names of the properties that hold the key of a part, the preferred one first.
const KEYS: [&str; 4] = ["GlobalId", "globalId", "guid", "id"];

/// Names of the properties that hold the type of a part, the preferred one first.
const KINDS: [&str; 4] = ["type", "Type", "ifcType", "class"];

/// Number of characters of an IFC GlobalId.
const GLOBAL_ID: usize = 22;

/// Returns the parts with unique names and keys.
///
/// # Complexity
/// O(n log n) in the number of parts. Vertices are read only of meshes whose parts have equal keys.
pub(super) fn named(meshes: &[SceneMesh], drafts: Vec<PartDraft>, names: &Names) -> Vec<ScenePart> {
    let mut taken = UniqueNames::default();
    let part = |(number, draft): (usize, PartDraft)| {
        let element = names.get(&draft.title);
        let mut extras = Properties(draft.extras);
        let (own_key, own_kind) = (extras.take(&KEYS), extras.take(&KINDS));
        let (titled_kind, titled_key) = type_and_guid(&draft.title).unzip();
        let own = |text: &str| name(text.as_bytes());
        let key = element.and_then(|element| element.key.clone()).or(own_key).or(titled_key.map(str::to_owned));
        let kind = element.and_then(|element| element.kind.clone()).or(own_kind).or(titled_kind.map(str::to_owned));
        let key = key.map_or_else(|| path_key(&draft.path, &draft.title), |key| own(&key));
        extras.0.extend(element.into_iter().flat_map(|element| element.extras.iter().cloned()));
        let given = element.and_then(|element| element.name.as_deref()).unwrap_or(&draft.title);
        let kind = own(&kind.unwrap_or_default());
        let details = Details { key, kind, path: draft.path, extras: extras.0 };
        let name = taken.name(&own(given), number);
        ScenePart { name, details, mesh: draft.mesh, world_from_part: draft.world_from_part }
    };
    let mut parts: Vec<ScenePart> = drafts.into_iter().enumerate().map(part).collect();
    tell_keys_apart(meshes, &mut parts);
    parts
}

/// Names that are taken, and for each name that was given several times the next number.
#[derive(Default)]
struct UniqueNames {
    taken: HashSet<String>,
    next: HashMap<String, u64>,
}

impl UniqueNames {
    /// Returns a name that is not taken: the given one, or that of the part's number, or one of
    /// these with a further number.
    fn name(&mut self, given: &str, number: usize) -> String {
        let base = if given.is_empty() { format!("part {number}") } else { given.to_owned() };
        let mut name = base.clone();
        while self.taken.contains(&name) {
            let next = self.next.entry(base.clone()).or_insert(2);
            name = format!("{base} ({next})");
            *next += 1;
        }
        self.taken.insert(name.clone());
        name
    }
}

/// Returns the halves of a name like `IfcWall|2O2Fr$t4X7Zf8NOew3FNr2`: the type and the GlobalId.
fn type_and_guid(title: &str) -> Option<(&str, &str)> {
    let (kind, guid) = title.split_once('|')?;
    let is_kind = kind.starts_with("Ifc") && kind.bytes().all(|c| c.is_ascii_alphanumeric());
    let is_guid = guid.len() == GLOBAL_ID && guid.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_' || c == b'$');
    (is_kind && is_guid).then_some((kind, guid))
}

/// Returns the names around a part and its own name, joined by slashes.
fn path_key(path: &[String], title: &str) -> String {
    let own = if title.is_empty() { "part" } else { title };
    path.iter().map(String::as_str).chain([own]).collect::<Vec<_>>().join("/")
}

/// Adds numbers to keys that several parts have, in the order of the places of the parts.
fn tell_keys_apart(meshes: &[SceneMesh], parts: &mut [ScenePart]) {
    let mut of_key: HashMap<String, Vec<usize>> = HashMap::new();
    for (at, part) in parts.iter().enumerate() {
        of_key.entry(part.details.key.clone()).or_default().push(at);
    }
    let mut centers = HashMap::new();
    for (key, equal) in of_key.iter().filter(|(_, equal)| equal.len() > 1) {
        let mut placed: Vec<(usize, [f64; 15])> =
            equal.iter().map(|&at| (at, place(meshes, &parts[at], &mut centers))).collect();
        placed.sort_by(|(a, place_a), (b, place_b)| {
            let entries = place_a.iter().zip(place_b).map(|(x, y)| x.total_cmp(y));
            entries.fold(Ordering::Equal, Ordering::then).then(a.cmp(b))
        });
        let numbered = (2_u64..).map(|number| format!("{key}#{number}")).filter(|other| !of_key.contains_key(other));
        for ((at, _), key) in placed.into_iter().skip(1).zip(numbered) {
            parts[at].details.key = key;
        }
    }
}

/// Returns numbers that tell parts with equal meshes apart: the center of the part's box in the
/// scene, and its pose.
fn place(meshes: &[SceneMesh], part: &ScenePart, centers: &mut HashMap<usize, [f64; 3]>) -> [f64; 15] {
    let center = *centers.entry(part.mesh).or_insert_with(|| center(&meshes[part.mesh]));
    let pose = &part.world_from_part;
    let numbers = pose.apply(center).into_iter().chain(pose.linear().iter().flatten().copied());
    let mut place = [0.0; 15];
    for (entry, number) in place.iter_mut().zip(numbers.chain(*pose.translation())) {
        *entry = number;
    }
    place
}

/// Returns the center of the box around the vertices of a mesh, in its own frame.
fn center(mesh: &SceneMesh) -> [f64; 3] {
    let points = (0..mesh.positions.len()).map(|at| mesh.positions.get(at));
    let all = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [low, high] =
        points.fold(all, |[low, high], p| [[0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k]))]);
    [0, 1, 2].map(|k| 0.5 * low[k] + 0.5 * high[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_taken_get_numbers() {
        let mut names = UniqueNames::default();
        let given = ["nut", "nut (2)", "nut", "", "nut", "part 3"];
        let made: Vec<String> = given.iter().enumerate().map(|(number, given)| names.name(given, number)).collect();
        assert_eq!(made, ["nut", "nut (2)", "nut (3)", "part 3", "nut (4)", "part 3 (2)"]);
    }

    #[test]
    fn only_ifc_names_with_a_global_id_are_split() {
        let guid = "2O2Fr$t4X7Zf8NOew3FNr2";
        assert_eq!(type_and_guid(&format!("IfcWall|{guid}")), Some(("IfcWall", guid)));
        for other in [format!("Wall|{guid}"), format!("IfcWall|{guid}x"), guid.to_owned(), "IfcWall|".to_owned()] {
            assert_eq!(type_and_guid(&other), None, "{other}");
        }
    }
}

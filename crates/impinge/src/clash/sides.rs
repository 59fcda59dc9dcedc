//! The scenes of a search with their labels, and their parts in one order.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::error::ClashError;
use crate::mesh::Positions;
use crate::scene::{PartId, Scene};
use crate::shape::PlacedShape;

/// A scene with a label, which names it in reports.
#[derive(Clone, Debug)]
pub struct Side<'s> {
    /// Name of the scene, such as `mep`. It is not empty, has no slash, and differs from the labels
    /// of the other scenes.
    pub label: String,
    /// The scene.
    pub scene: &'s Scene,
}

/// A part as reports name it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Member {
    /// Label of the scene.
    pub scene: String,
    /// Handle of the part in its scene.
    pub part: PartId,
    /// Identity of the part in its scene. It is the key of the [`Details`](crate::scene::Details);
    /// or the name, if the key is empty; or both, if another part of the scene has the same key.
    pub key: String,
    /// Type of the part, for example `IfcWall`; it may be empty.
    pub kind: String,
    /// Name of the part.
    pub name: String,
    /// Names of the groups that contain the part, the outermost first.
    pub path: Vec<String>,
}

impl Member {
    /// Returns the text that identifies the part among all scenes: `label/key`.
    #[must_use]
    pub fn identity(&self) -> String {
        format!("{}/{}", self.scene, self.key)
    }
}

/// All parts of all scenes, sorted by label and key. The order depends neither on the order of the
/// scenes nor on that of the parts.
pub(super) struct Roster {
    pub(super) members: Vec<Arc<Member>>,
    /// Index of the scene of each member.
    pub(super) sides: Vec<usize>,
}

impl Roster {
    pub(super) fn new(sides: &[Side<'_>]) -> Result<Self, ClashError> {
        let mut labels = HashSet::new();
        let mut all = Vec::new();
        for (side, Side { label, scene }) in sides.iter().enumerate() {
            if label.is_empty() || label.contains('/') || !labels.insert(label) {
                return Err(ClashError::Label { label: label.clone() });
            }
            let mut uses: HashMap<&str, usize> = HashMap::new();
            for part in scene.parts() {
                *uses.entry(key_of(scene, part)).or_default() += 1;
            }
            for part in scene.parts() {
                let (details, name) = (scene.details(part), scene.name(part));
                let key = match key_of(scene, part) {
                    key if uses[key] > 1 => format!("{key}/{name}"),
                    key => key.to_owned(),
                };
                let (kind, path) = (details.kind.clone(), details.path.clone());
                all.push((side, Member { scene: label.clone(), part, key, kind, name: name.to_owned(), path }));
            }
        }
        all.sort_by(|(_, a), (_, b)| (&a.scene, &a.key, &a.name).cmp(&(&b.scene, &b.key, &b.name)));
        let (sides, members) = all.into_iter().map(|(side, member)| (side, Arc::new(member))).unzip();
        Ok(Self { members, sides })
    }
}

/// Returns the key of a part, or its name if it has no key.
fn key_of(scene: &Scene, part: PartId) -> &str {
    match scene.details(part).key.as_str() {
        "" => scene.name(part),
        key => key,
    }
}

/// Returns the part at its pose, as a solid if it is a mesh.
pub(super) fn placed(scene: &Scene, part: PartId) -> Result<PlacedShape, ClashError> {
    let shape = scene.shape(part);
    let solid = shape.as_mesh().map(|(mesh, _)| mesh.solid().into());
    let placed = solid.as_ref().unwrap_or(shape).at(*scene.pose(part));
    placed.map_err(|error| ClashError::Part { name: scene.name(part).to_owned(), error })
}

/// Returns the default tolerance in world units: 0.1 mm, or a millionth of the diagonal of the
/// scenes if the unit is not known. It is at least 16 units in the last place of the largest f32
/// coordinate, because the rounding of coordinates makes parts overlap.
///
/// `meters` is the length of the world unit in meters, or `None` if it is not known.
#[must_use]
pub fn default_tolerance(sides: &[Side<'_>], meters: Option<f64>) -> f64 {
    let usual = match meters {
        Some(meters) => 1e-4 / meters,
        None => 1e-6 * diagonal(sides),
    };
    usual.max(16.0 * rounding(sides))
}

/// Returns the diagonal of the box around all bounded parts, or 0 without any.
fn diagonal(sides: &[Side<'_>]) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for Side { scene, .. } in sides {
        let bounds = scene.parts().filter_map(|part| placed(scene, part).ok()?.bounds());
        for [min, max] in bounds {
            low = std::array::from_fn(|k| low[k].min(min[k]));
            high = std::array::from_fn(|k| high[k].max(max[k]));
        }
    }
    (0..3).map(|k| (high[k] - low[k]).max(0.0).powi(2)).sum::<f64>().sqrt()
}

/// Returns the unit in the last place of the largest f32 coordinate, in world units.
pub(super) fn rounding(sides: &[Side<'_>]) -> f64 {
    let of_side =
        |side: &Side<'_>| side.scene.parts().fold(0.0_f64, |most, part| most.max(rounding_of(side.scene, part)));
    sides.iter().map(of_side).fold(0.0, f64::max)
}

/// Returns the unit in the last place of the largest f32 coordinate of a part, in world units; 0
/// if its coordinates are f64.
fn rounding_of(scene: &Scene, part: PartId) -> f64 {
    let Some((mesh, _)) = scene.shape(part).as_mesh() else { return 0.0 };
    let (Positions::F32(_), Ok(own)) = (mesh.positions(), scene.shape(part).at(crate::math::Pose::IDENTITY)) else {
        return 0.0;
    };
    let largest = own.bounds().into_iter().flatten().flatten().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let stretch = scene.pose(part).linear().iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
    // A rotation has a norm of the square root of 3.
    ulp_f32(largest) * stretch / 3.0_f64.sqrt()
}

/// Returns the distance of an f32 of this size from the next.
fn ulp_f32(x: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "the size of the number matters, not its digits")]
    let x = x as f32;
    if x.is_finite() { f64::from(x.next_up()) - f64::from(x) } else { f64::from(f32::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_place_of_a_number_is_that_of_f32() {
        assert_eq!(ulp_f32(1.0), 2.0_f64.powi(-23));
        assert_eq!(ulp_f32(50.0), 2.0_f64.powi(-18));
        assert_eq!(ulp_f32(5e6), 0.5);
    }
}

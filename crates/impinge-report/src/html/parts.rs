//! The parts of a page: which are drawn in full, and which as boxes.

use std::collections::HashMap;
use std::ops::ControlFlow;

use impinge::clash::{Member, Report, Side};
use impinge::partition::{KdTree, Partition};
use impinge::scene::{PartId, Scene};
use impinge::volume::MinMax;
use impinge::{Mesh, Pose, Shape};

use super::quantized::QuantizedMesh;
use super::surface::surface;

/// How a part is drawn.
pub(super) enum Look {
    /// Nothing: the part is empty or unbounded.
    Nothing,
    /// Box in the world frame: its lower and its upper corner.
    Box([[f64; 3]; 2]),
    /// Mesh with an index in [`Drawn::meshes`], at a pose.
    Mesh(usize, Pose),
}

/// The parts of all scenes, in the order of the scenes and of their parts.
pub(super) struct Drawn {
    /// Meshes, each once.
    pub(super) meshes: Vec<QuantizedMesh>,
    pub(super) looks: Vec<Look>,
}

/// The place of each part in the list of all parts.
pub(super) struct Places<'s> {
    first: HashMap<&'s str, usize>,
}

impl<'s> Places<'s> {
    pub(super) fn new(sides: &'s [Side<'_>]) -> Self {
        let mut next = 0;
        let mut first = HashMap::new();
        for Side { label, scene } in sides {
            first.insert(label.as_str(), next);
            next += scene.parts().len();
        }
        Self { first }
    }

    /// Returns the place of a part, or `None` if it belongs to none of the scenes.
    pub(super) fn of(&self, member: &Member) -> Option<usize> {
        self.first.get(member.scene.as_str()).map(|first| first + member.part.index())
    }
}

impl Drawn {
    /// Chooses the parts that are drawn in full. Meshes have at most `max_triangles` triangles
    /// together. The parts of the worst clashes come first, then duplicates, then parts whose box
    /// reaches into the surroundings of a clash, then all others.
    pub(super) fn choose(sides: &[Side<'_>], report: &Report, max_triangles: usize) -> Self {
        let parts: Vec<(&Scene, PartId)> =
            sides.iter().flat_map(|side| side.scene.parts().map(move |part| (side.scene, part))).collect();
        let boxes: Vec<Option<[[f64; 3]; 2]>> =
            parts.iter().map(|&(scene, part)| scene.shape(part).at(*scene.pose(part)).ok()?.bounds()).collect();
        let mut looks: Vec<Look> = boxes.iter().map(|&bounds| bounds.map_or(Look::Nothing, Look::Box)).collect();
        let mut meshes = Vec::new();
        let mut numbers: HashMap<*const [u32; 3], Option<usize>> = HashMap::new();
        let mut left = max_triangles;
        for place in by_importance(sides, report, &boxes) {
            let (scene, part) = parts[place];
            let shape = scene.shape(part);
            let number = match shape.as_mesh() {
                // Clones of a mesh share its faces.
                Some((mesh, _)) => {
                    *numbers.entry(mesh.faces().as_ptr()).or_insert_with(|| add(&mut meshes, mesh, &mut left))
                }
                None => surface(shape).and_then(|mesh| add(&mut meshes, &mesh, &mut left)),
            };
            if let Some(number) = number {
                looks[place] = Look::Mesh(number, *scene.pose(part));
            }
        }
        Self { meshes, looks }
    }

    /// Draws meshes in their places, in full as long as they have at most `max_triangles` triangles
    /// together, and as boxes otherwise.
    pub(super) fn of(things: &[(Mesh, Pose)], max_triangles: usize) -> Self {
        let (mut meshes, mut looks, mut left) = (Vec::new(), Vec::new(), max_triangles);
        for (mesh, pose) in things {
            let bounds = || Shape::mesh(mesh).at(*pose).ok().and_then(|placed| placed.bounds());
            let bounds = || bounds().map_or(Look::Nothing, Look::Box);
            looks.push(add(&mut meshes, mesh, &mut left).map_or_else(bounds, |number| Look::Mesh(number, *pose)));
        }
        Self { meshes, looks }
    }

    /// Adds some faces of a mesh, which lie on the mesh if it is drawn.
    pub(super) fn push_faces(&mut self, mesh: &Mesh, pose: Pose, faces: impl Iterator<Item = [u32; 3]>) {
        let look = match QuantizedMesh::of_faces(mesh, faces) {
            Some(quantized) => {
                self.meshes.push(quantized);
                Look::Mesh(self.meshes.len() - 1, pose)
            }
            None => Look::Nothing,
        };
        self.looks.push(look);
    }

    /// Returns the number of parts that are drawn as boxes.
    pub(super) fn boxes(&self) -> usize {
        self.looks.iter().filter(|look| matches!(look, Look::Box(_))).count()
    }

    /// Returns the largest distance between a corner and its rounded position, in world units.
    pub(super) fn error(&self) -> f64 {
        let of = |look: &Look| match look {
            Look::Mesh(number, pose) => {
                let stretch = pose.linear().iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
                // A rotation has a norm of the square root of 3.
                self.meshes[*number].frame.error() * stretch / 3.0_f64.sqrt()
            }
            _ => 0.0,
        };
        self.looks.iter().map(of).fold(0.0, f64::max)
    }
}

fn add(meshes: &mut Vec<QuantizedMesh>, mesh: &Mesh, left: &mut usize) -> Option<usize> {
    *left = left.checked_sub(mesh.faces().len())?;
    meshes.push(QuantizedMesh::new(mesh)?);
    Some(meshes.len() - 1)
}

/// Returns the places of all parts, the most important first, each once.
fn by_importance(sides: &[Side<'_>], report: &Report, boxes: &[Option<[[f64; 3]; 2]>]) -> Vec<usize> {
    let places = Places::new(sides);
    let mut order = Vec::with_capacity(boxes.len());
    let mut is_taken = vec![false; boxes.len()];
    let mut take = |place: usize| {
        if !std::mem::replace(&mut is_taken[place], true) {
            order.push(place);
        }
    };
    let of_clashes = report.clashes.iter().flat_map(|clash| [&clash.a, &clash.b]);
    let of_sets = report.duplicates.iter().flat_map(|set| &set.parts);
    of_clashes.chain(of_sets).filter_map(|member| places.of(member)).for_each(&mut take);

    let (mut owners, mut known) = (Vec::new(), Vec::new());
    for (place, bounds) in boxes.iter().enumerate() {
        if let Some([low, high]) = *bounds
            && let Ok(bounds) = MinMax::new(low, high)
        {
            owners.push(place);
            known.push(bounds);
        }
    }
    let tree = KdTree::build(&known);
    for bounds in report.clashes.iter().filter_map(|clash| clash.bounds) {
        let Ok(around) = surroundings(bounds) else { continue };
        let mut found = Vec::new();
        let _ = tree.overlapping(&around, &mut |key| {
            found.push(owners[key as usize]);
            ControlFlow::Continue(())
        });
        found.sort_unstable();
        found.into_iter().for_each(&mut take);
    }
    (0..boxes.len()).for_each(take);
    order
}

/// Returns the box around a clash that a person sees beside it: it reaches as far to each side as
/// the clash is long.
fn surroundings([low, high]: [[f64; 3]; 2]) -> Result<MinMax, impinge::InputError> {
    let reach = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    MinMax::new(low.map(|x| x - reach), high.map(|x| x + reach))
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge::Positions;
    use impinge::clash::{Options, find};
    use impinge::query::batch::Execution;

    /// Returns tetrahedra with a row of places along x, of which the last two clash.
    fn row(places: &[f64]) -> Scene {
        let mut scene = Scene::new();
        for (at, &x) in places.iter().enumerate() {
            // Each has a mesh of its own.
            let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0 + at as f64 * 1e-3]];
            let mesh = Mesh::new(Positions::F64(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
            scene.add(at.to_string(), &mesh, Pose::from_translation([x, 0.0, 0.0]).unwrap()).unwrap();
        }
        scene
    }

    #[test]
    fn parts_of_clashes_come_first_then_their_neighbors() {
        // Part 1 is far from the clash, and part 0 is near it.
        let scene = row(&[-1.25, 50.0, 0.0, 0.25]);
        let sides = [Side { label: "row".to_owned(), scene: &scene }];
        let report = find(&sides, Options::new(1e-3), Execution::default()).unwrap();
        assert_eq!(report.clashes.len(), 1);
        let full = |triangles: usize| -> Vec<bool> {
            let drawn = Drawn::choose(&sides, &report, triangles);
            drawn.looks.iter().map(|look| matches!(look, Look::Mesh(..))).collect()
        };
        assert_eq!(full(0), [false, false, false, false]);
        assert_eq!(full(8), [false, false, true, true]);
        assert_eq!(full(15), [true, false, true, true]);
        assert_eq!(full(16), [true, true, true, true]);
        assert_eq!(Drawn::choose(&sides, &report, 8).boxes(), 2);
    }
}

//! Pairs of faces at hubs. A hub is a corner that very many faces share, such as the middle of a
//! fan.
//!
//! The boxes of all faces at one corner overlap there, so a hierarchy over boxes cannot separate
//! them. Their *directions* can. Two faces at a corner intersect beyond it only along a common
//! direction from it, and the directions of a face are an arc between those of its other two
//! corners. So the faces at a hub get a hierarchy of their own, over the boxes of their arcs on the
//! unit sphere. The descent of the mesh skips parts whose faces all share a hub.
//!
//! Directions are unit vectors in the mesh frame. Their boxes are enlarged by more than the
//! rounding error, so no pair is lost (docs/notes/proof.md, L18).
//!
//! Guarded by the tests below and by the benchmark `solids`, "fan with itself".

use rayon::prelude::*;

use crate::budget::Budget;
use crate::hierarchy::{BinaryTree, Builder, Child};
use crate::math::vec3::{Vector, length, sub};
use crate::mesh::Mesh;
use crate::simd::LANES;
use crate::volume::Aabb;

/// Minimum number of faces at a hub. All pairs of fewer faces take less than a millisecond.
const MIN_HUB_FACES: usize = 128;

/// Bound for the rounding errors of a direction and of the height of an arc, in units of the
/// sphere's radius.
const ROUNDING: f64 = 1e-12;

/// Number of nodes of a star that are compared with a leaf between two checks of the budget. It
/// compares few faces, so these take about 100 microseconds.
const LEAVES_PER_BUDGET_CHECK: usize = 1 << 6;

/// Up to three hubs, by number; unused entries are [`NONE`](Self::NONE).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HubSet([u32; 3]);

impl HubSet {
    const NONE: u32 = u32::MAX;
    const EMPTY: Self = Self([Self::NONE; 3]);

    fn contains(self, hub: u32) -> bool {
        hub != Self::NONE && self.0.contains(&hub)
    }

    fn intersection(self, other: Self) -> Self {
        Self(self.0.map(|hub| if other.contains(hub) { hub } else { Self::NONE }))
    }

    /// Returns the hub with the smallest number that both sets have, or `None`.
    pub(super) fn first_common(self, other: Self) -> Option<u32> {
        self.intersection(other).0.into_iter().filter(|&hub| hub != Self::NONE).min()
    }
}

/// The hubs of a mesh, and the hubs that all faces of a part share.
#[derive(Debug)]
pub(super) struct Hubs {
    /// The first vertex at the position of each hub.
    vertices: Vec<u32>,
    /// Hubs of each face.
    of_face: Vec<HubSet>,
    /// Hubs that all faces below a child share, for each node and lane.
    of_children: Vec<[HubSet; LANES]>,
}

impl Hubs {
    /// Finds the hubs of a mesh.
    ///
    /// # Complexity
    /// O(n log n) if the topology of the mesh is not known yet, then O(n).
    pub(in crate::mesh) fn of(mesh: &Mesh) -> Self {
        let first_at = &mesh.topology().first_at;
        let mut number_of = vec![HubSet::NONE; first_at.len()];
        let mut vertices = Vec::new();
        for vertex in 0..first_at.len() as u32 {
            if mesh.faces_at(vertex).len() >= MIN_HUB_FACES {
                number_of[vertex as usize] = vertices.len() as u32;
                vertices.push(vertex);
            }
        }
        let of_face: Vec<HubSet> = mesh
            .faces()
            .iter()
            .map(|face| HubSet(face.map(|vertex| number_of[first_at[vertex as usize] as usize])))
            .collect();
        let nodes = mesh.0.tree.nodes();
        let mut of_children = vec![[HubSet::EMPTY; LANES]; nodes.len()];
        // Children come after their parents.
        for (index, node) in nodes.iter().enumerate().rev() {
            for lane in 0..node.count() {
                let common = |sets: &mut dyn Iterator<Item = HubSet>| sets.reduce(HubSet::intersection);
                of_children[index][lane] = match node.child(lane) {
                    Child::Leaf(leaf) => common(&mut mesh.leaf_faces(leaf).map(|face| of_face[face as usize])),
                    Child::Inner(child) => {
                        let count = nodes[child as usize].count();
                        common(&mut of_children[child as usize][..count].iter().copied())
                    }
                }
                .unwrap_or(HubSet::EMPTY);
            }
        }
        Self { vertices, of_face, of_children }
    }

    /// Returns the hubs of a face.
    pub(in crate::mesh) fn of_face(&self, face: u32) -> HubSet {
        self.of_face[face as usize]
    }

    /// Returns the hubs that all faces below a child of a node share.
    pub(super) fn of_child(&self, node: u32, lane: u8) -> HubSet {
        self.of_children[node as usize][usize::from(lane)]
    }

    /// Returns the pairs of faces that share a hub and for which `intersect` returns `true`, the
    /// smaller index first. `intersect` is called once for all copies of two faces.
    /// If the budget ends the search, these are the pairs found so far.
    pub(in crate::mesh) fn collect(
        &self,
        mesh: &Mesh,
        budget: &Budget<'_>,
        intersect: impl Fn([u32; 2]) -> bool + Sync,
    ) -> Vec<[u32; 2]> {
        let hubs = (0_u32..).zip(&self.vertices);
        hubs.flat_map(|(hub, &vertex)| {
            // If faces share several hubs, the first one reports the pair.
            let is_first = |[one, other]: [u32; 2]| self.of_face(one).first_common(self.of_face(other)) == Some(hub);
            Star::at(mesh, vertex).collect(budget, |pair| is_first(pair) && intersect(pair))
        })
        .collect()
    }
}

/// The faces at a corner, in a hierarchy over their arcs.
struct Star {
    /// Faces grouped by their corners, ascending. Copies of a face share all corners, so they do
    /// not intersect beyond them.
    copies: Vec<Vec<u32>>,
    /// Box of the arc of each group.
    arcs: Vec<Aabb>,
    tree: BinaryTree,
}

impl Star {
    /// Builds the hierarchy of the faces at a vertex, which must be the first one at its position.
    fn at(mesh: &Mesh, vertex: u32) -> Self {
        let hub = mesh.positions().get(vertex as usize);
        let first_at = &mesh.topology().first_at;
        let mut faces: Vec<([u32; 3], u32)> = mesh
            .faces_at(vertex)
            .iter()
            .map(|&face| {
                let mut places = mesh.faces()[face as usize].map(|corner| first_at[corner as usize]);
                places.sort_unstable();
                (places, face)
            })
            .collect();
        faces.sort_unstable();
        faces.dedup();
        let (copies, arcs): (Vec<Vec<u32>>, Vec<Aabb>) = faces
            .chunk_by(|one, other| one.0 == other.0)
            .filter_map(|copies| {
                let arc = arc(&hub, &mesh.corners(copies[0].1))?;
                Some((copies.iter().map(|&(_, face)| face).collect::<Vec<u32>>(), arc))
            })
            .unzip();
        let tree = Builder::Auto.build(&arcs);
        Self { copies, arcs, tree }
    }

    /// Returns the pairs of faces whose arcs overlap and that intersect. Each leaf is compared with
    /// itself and the leaves after it.
    fn collect(&self, budget: &Budget<'_>, intersect: impl Fn([u32; 2]) -> bool + Sync) -> Vec<[u32; 2]> {
        let nodes = &self.tree.nodes;
        let leaves = (0..nodes.len() as u32).into_par_iter().filter(|&node| nodes[node as usize].right.is_none());
        leaves
            .flat_map_iter(|leaf| {
                let own = nodes[leaf as usize];
                let mut found = Vec::new();
                let mut stack = vec![0];
                let mut compared = 0_usize;
                while let Some(node) = stack.pop() {
                    if compared.is_multiple_of(LEAVES_PER_BUDGET_CHECK) && budget.is_spent() {
                        break;
                    }
                    compared += 1;
                    let at = nodes[node as usize];
                    if at.first + at.count <= own.first || !at.bounds.overlaps(&own.bounds) {
                        continue;
                    }
                    match at.right {
                        Some(right) => stack.extend([node + right.get(), node + 1]),
                        None => self.compare_leaves([leaf, node], &intersect, &mut found),
                    }
                }
                found
            })
            .collect()
    }

    /// Appends the intersecting pairs of two leaves, or of one leaf with itself.
    fn compare_leaves(&self, [leaf, other]: [u32; 2], intersect: impl Fn([u32; 2]) -> bool, found: &mut Vec<[u32; 2]>) {
        let (own, others) = (self.tree.held(leaf), self.tree.held(other));
        for (number, &one) in own.iter().enumerate() {
            let others = if leaf == other { &others[number + 1..] } else { others };
            for &other in others {
                let [one, other] = [one, other].map(|at| at as usize);
                let (copies, other_copies) = (&self.copies[one], &self.copies[other]);
                if self.arcs[one].overlaps(&self.arcs[other]) && intersect([copies[0], other_copies[0]]) {
                    let pairs = copies.iter().flat_map(|&a| other_copies.iter().map(move |&b| [a.min(b), a.max(b)]));
                    found.extend(pairs);
                }
            }
        }
    }
}

/// Returns bounds of the directions from a hub into a face, or `None` if the face is the hub
/// itself.
fn arc(hub: &Vector, corners: &[Vector; 3]) -> Option<Aabb> {
    let direction = |corner: &Vector| {
        let difference = sub(corner, hub);
        let greatest = difference.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let scaled = difference.map(|x| x / greatest);
        let size = length(&scaled);
        (greatest > 0.0).then(|| scaled.map(|x| x / size))
    };
    let mut ends = corners.iter().filter_map(direction);
    let first = ends.next()?;
    let last = ends.next().unwrap_or(first);
    // The arc rises above its chord by no more than in the middle.
    let middle = [0, 1, 2].map(|k| 0.5 * (first[k] + last[k]));
    let margin = 1.0 - length(&middle) + ROUNDING;
    Some(Aabb {
        min: [0, 1, 2].map(|k| ((f64::min(first[k], last[k]) - margin) as f32).next_down()),
        max: [0, 1, 2].map(|k| ((f64::max(first[k], last[k]) + margin) as f32).next_up()),
    })
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::{Rng, solids};

    use super::*;
    use crate::budget::Budget;
    use crate::exact::{Placement, intersect_beyond_shared};
    use crate::math::Pose;
    use crate::mesh::pairs::self_descent::{WantedFaces, collect_self_intersecting};
    use crate::mesh::storage::positions::Positions;

    fn engine(mesh: &impinge_testkit::Mesh, is_soup: bool) -> Mesh {
        let corners = mesh.faces.iter().flatten().map(|&vertex| mesh.vertices[vertex as usize]);
        let soup = (0..mesh.faces.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]);
        let (vertices, faces) =
            if is_soup { (corners.collect(), soup.collect()) } else { (mesh.vertices.clone(), mesh.faces.clone()) };
        Mesh::new(Positions::F64(vertices), faces).expect("a mesh")
    }

    /// Returns faces with corners on a lattice around a corner that most of them share, and around
    /// another one.
    fn star(rng: &mut Rng, faces: u32, scale: f64) -> impinge_testkit::Mesh {
        let mut mesh = impinge_testkit::Mesh { vertices: vec![[0.0; 3], [2.0 * scale, scale, 0.0]], faces: Vec::new() };
        for face in 0..faces {
            let first = mesh.vertices.len() as u32;
            let mut corner = || [0; 3].map(|_: i32| scale * rng.integer(-3, 4) as f64);
            mesh.vertices.extend([corner(), corner(), corner()]);
            let hub = [0, 0, 0, 1, first + 2][face as usize % 5];
            // Some faces have both hubs, and some have one twice.
            let second = if face % 11 == 0 {
                1
            } else if face % 37 == 0 {
                hub
            } else {
                first + 1
            };
            mesh.faces.push(if face % 2 == 0 { [hub, first, second] } else { [first, second, hub] });
            // Copies, turned and not turned.
            if face % 13 == 0 {
                mesh.faces.push([second, hub, first]);
            }
        }
        mesh
    }

    fn all_pairs(mesh: &Mesh, wanted: impl Fn(u32) -> bool) -> Vec<[u32; 2]> {
        let one_place = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        let count = mesh.faces().len() as u32;
        let pairs = (0..count).flat_map(|one| (one + 1..count).map(move |other| [one, other]));
        let is_wanted = |[one, other]: [u32; 2]| wanted(one) || wanted(other);
        pairs
            .filter(|&[one, other]| {
                is_wanted([one, other]) && intersect_beyond_shared(&one_place, &mesh.corners(one), &mesh.corners(other))
            })
            .collect()
    }

    /// Half of the pairs of these stars intersect; all others only touch at their hubs.
    #[test]
    fn stars_have_the_pairs_of_brute_force() {
        let mut rng = Rng::new(32);
        let mut reported = 0;
        for (round, scale) in [1.0, 1e-30, 1e30, 1.0].into_iter().enumerate() {
            let mesh = engine(&star(&mut rng, 720, scale), round % 2 == 1);
            let marks: Vec<bool> = (0..mesh.faces().len()).map(|face| face % 9 == 4).collect();
            assert_eq!(Hubs::of(&mesh).vertices.len(), 2, "round {round}");
            for (wanted, expected) in [
                (WantedFaces::All, all_pairs(&mesh, |_| true)),
                (WantedFaces::WithMarked(&marks), all_pairs(&mesh, |face| marks[face as usize])),
            ] {
                let mut found = collect_self_intersecting(&mesh, wanted, Budget::unlimited());
                found.sort_unstable();
                assert_eq!(found, expected, "round {round}");
                reported += found.len();
            }
        }
        assert!(reported > 100_000, "{reported}");
    }

    /// Narrow faces around a corner, flat and as a cone, that intersect only in shared edges.
    #[test]
    fn fans_have_no_pairs() {
        for height in [0.0, 0.7] {
            let mut fan = solids::fan(4000);
            fan.vertices.iter_mut().skip(1).for_each(|vertex| vertex[2] = height);
            for is_soup in [false, true] {
                let mesh = engine(&fan, is_soup);
                assert_eq!(Hubs::of(&mesh).vertices.len(), 1);
                assert_eq!(
                    collect_self_intersecting(&mesh, WantedFaces::All, Budget::unlimited()),
                    Vec::<[u32; 2]>::new()
                );
            }
        }
    }

    /// Copies of a face share all corners.
    #[test]
    fn piles_of_copies_have_no_pairs() {
        let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(Positions::F32(vertices), vec![[0, 1, 2]; 3000]).expect("a mesh");
        assert_eq!(Hubs::of(&mesh).vertices.len(), 3);
        assert_eq!(collect_self_intersecting(&mesh, WantedFaces::All, Budget::unlimited()), Vec::<[u32; 2]>::new());
    }

    /// Every direction into a face is in the bounds, and the bounds of a narrow face are narrow.
    #[test]
    fn arcs_hold_every_direction() {
        let mut rng = Rng::new(5);
        let mut held = 0;
        for _ in 0..2000 {
            let mut corner = || [0; 3].map(|_: i32| rng.integer(-4, 5) as f64);
            let (hub, p, q) = (corner(), corner(), corner());
            let Some(bounds) = arc(&hub, &[p, hub, q]) else {
                assert!(p == hub && q == hub);
                continue;
            };
            for share in [0.0, 0.1, 0.5, 0.75, 1.0] {
                let towards = [0, 1, 2].map(|k| (1.0 - share) * (p[k] - hub[k]) + share * (q[k] - hub[k]));
                let size = length(&towards);
                if size > 0.0 {
                    let direction = towards.map(|x| x / size);
                    let is_held =
                        |k: usize| f64::from(bounds.min[k]) <= direction[k] && direction[k] <= f64::from(bounds.max[k]);
                    assert!((0..3).all(is_held), "{hub:?} {p:?} {q:?}: {direction:?} not in {bounds:?}");
                    held += 1;
                }
            }
        }
        assert!(held > 9_000, "{held} of 10,000 are directions");
        let narrow = arc(&[0.0; 3], &[[1.0, 0.0, 0.0], [1.0, 1e-3, 0.0], [0.0; 3]]).expect("an arc");
        assert!((0..3).all(|k| narrow.max[k] - narrow.min[k] < 1.1e-3), "{narrow:?}");
    }
}

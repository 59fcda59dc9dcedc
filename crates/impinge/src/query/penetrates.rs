//! Whether the interiors of two solids meet, which touching is not.
//!
//! Let U be the points off the surface that a mesh winds round more than half, its interior. Where the interiors of both
//! meshes meet, one of these is so, as follows a generic point on the border of what they have in common:
//! 1. a connected component of one surface, apart from the other but for single points, lies inside the other;
//! 2. about a segment in which a face of one meets a face of the other at length, some direction across it is inside both:
//!    where the faces cross off their edges, or in the fan of the faces that meet there, seen along the edge;
//! 3. faces of both overlap in an area, and are inside both on one side of it.
//!
//! And each of them is enough. Whether a face has its interior on a side is not told by its corners' order alone, as shells
//! lie in shells and meshes are turned inside out, but by the winding numbers on both sides, which are integers for a closed
//! mesh. A face that other faces of its own mesh go through has no such sides; what it meets is left undecided, unless
//! something else is sure.

use std::collections::HashMap;

use rayon::prelude::*;

use super::intersecting_pairs;
use crate::exact::{Contact, EdgeLine, Fan, Placement, PosedPoint, Spot, contact};
use crate::mesh::{Containment, Judge, Mesh, Placed, Wall, Walls};

/// Whether the interiors of two solids meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Penetrates {
    /// They do not, though the solids may touch.
    No,
    /// Not known: a mesh is open, or meets itself where it meets the other.
    Undecided,
    /// They do.
    Yes,
}

/// Whether the interiors of two meshes, taken as solids, meet.
///
/// # Accuracy
/// `Yes` and `No` are exact. `Undecided` is possible only where a mesh is open, or where faces of one that meet the other
/// also meet faces of their own mesh elsewhere than in common corners and edges.
///
/// # Complexity
/// That of [`intersecting_pairs`], linear in the pairs, and for each face that is in one and each connected component
/// that is in none that of [`Mesh::contains`] for one point.
///
/// ```
/// use impinge::query::{self, Penetrates};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
/// let part = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // The same part on its other side, turned by half about the x axis: two edges in common.
/// let turned = part.at(Pose::new([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]], [0.0; 3])?);
/// assert!(query::intersects(&part, turned));
/// assert_eq!(query::penetrates(&part, turned), Penetrates::No);
/// assert_eq!(query::penetrates(&part, part.at(Pose::from_translation([1.0, 0.0, 0.0])?)), Penetrates::Yes);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn penetrates<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Penetrates {
    let (a, b) = (a.into(), b.into());
    penetrates_of_pairs(a, b, &intersecting_pairs(a, b))
}

/// [`penetrates`], for pairs that are at hand already: all that [`intersecting_pairs`] returned.
///
/// # Panics
/// Where a pair names a face that a mesh does not have.
#[must_use]
pub fn penetrates_of_pairs<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    pairs: &[[u32; 2]],
) -> Penetrates {
    /// Contacts looked at before all of them are: bodies deep in each other show it in any.
    const FIRST_CONTACTS: usize = 64;
    let solids = Solids::new(a.into(), b.into());
    let contacts = solids.contacts(pairs);
    let first = solids.judge_contacts(&contacts[..contacts.len().min(FIRST_CONTACTS)]);
    if first == Penetrates::Yes {
        return first;
    }
    let apart = solids.judge_components(0, &contacts).max(solids.judge_components(1, &contacts));
    if apart == Penetrates::Yes {
        return apart;
    }
    let rest = if contacts.len() > FIRST_CONTACTS { solids.judge_contacts(&contacts) } else { first };
    match rest.max(apart) {
        Penetrates::No if !solids.stay_within_reach() => Penetrates::Undecided,
        answer => answer,
    }
}

/// A pair of faces that meets at length or in an area.
type Touching = ([u32; 2], Contact);

/// Two placed meshes, A and B.
struct Solids<'m> {
    placed: [Placed<'m>; 2],
    placement: Placement,
}

impl<'m> Solids<'m> {
    fn new(a: Placed<'m>, b: Placed<'m>) -> Self {
        Self { placed: [a, b], placement: Placement::new(&a.world_from_mesh, &b.world_from_mesh) }
    }

    fn mesh(&self, side: usize) -> &'m Mesh {
        self.placed[side].mesh
    }

    fn contacts(&self, pairs: &[[u32; 2]]) -> Vec<Touching> {
        let kind = |&pair: &[u32; 2]| {
            let [a, b] = [0, 1].map(|side| self.mesh(side).corners(pair[side]));
            (pair, contact(&self.placement, &a, &b))
        };
        pairs.par_iter().map(kind).filter(|(_, contact)| *contact != Contact::Slight).collect()
    }

    /// What these contacts show.
    fn judge_contacts(&self, contacts: &[Touching]) -> Penetrates {
        let sides =
            [0, 1].map(|side| Side::new(self.mesh(side), contacts.iter().map(|(pair, _)| pair[side]).collect()));
        // Stops at the first that is sure.
        let answers = contacts.par_iter().map(|(pair, contact)| match self.judge(&sides, *pair, *contact) {
            Penetrates::Yes => Err(()),
            answer => Ok(answer),
        });
        answers.try_reduce(|| Penetrates::No, |x, y| Ok(x.max(y))).unwrap_or(Penetrates::Yes)
    }

    fn judge(&self, sides: &[Side<'_>; 2], [a, b]: [u32; 2], contact: Contact) -> Penetrates {
        let faces = |side: usize, face: u32, edge: [usize; 2]| sides[side].about(face, edge);
        let line = |side: usize, face: u32, edge: [usize; 2]| {
            let corners = self.mesh(side).corners(face);
            EdgeLine { of_b: side == 1, ends: edge.map(|corner| corners[corner]) }
        };
        match contact {
            Contact::Slight => Penetrates::No,
            Contact::Across => match (sides[0].walls.get(a), sides[1].walls.get(b)) {
                (Wall::Sides { front, back }, Wall::Sides { front: other_front, back: other_back }) => {
                    Penetrates::surely((front || back) && (other_front || other_back))
                }
                _ => Penetrates::Undecided,
            },
            Contact::Area { same_turn } => match (sides[0].walls.get(a), sides[1].walls.get(b)) {
                (Wall::Sides { front, back }, Wall::Sides { front: other_front, back: other_back }) => {
                    // The corners of each turn in the world as in its frame, unless its pose mirrors.
                    let mirrors = self.placed.map(|placed| placed.world_from_mesh.mirrors());
                    let [facing, opposite] = if same_turn == (mirrors[0] == mirrors[1]) {
                        [other_front, other_back]
                    } else {
                        [other_back, other_front]
                    };
                    Penetrates::surely((front && facing) || (back && opposite))
                }
                _ => Penetrates::Undecided,
            },
            Contact::EdgeOfA(edge) => self.judge_fan(sides, line(0, a, edge), [faces(0, a, edge), Some(vec![b])]),
            Contact::EdgeOfB(edge) => self.judge_fan(sides, line(1, b, edge), [Some(vec![a]), faces(1, b, edge)]),
            Contact::Edges(edge_a, edge_b) => {
                self.judge_fan(sides, line(0, a, edge_a), [faces(0, a, edge_a), faces(1, b, edge_b)])
            }
        }
    }

    /// What the faces of both that meet in a line show; undecided where those of one are not known.
    fn judge_fan(&self, sides: &[Side<'_>; 2], line: EdgeLine, faces: [Option<Vec<u32>>; 2]) -> Penetrates {
        let mut fan = Fan::about(&self.placement, line);
        for (side, faces) in faces.into_iter().enumerate() {
            let Some(faces) = faces else { return Penetrates::Undecided };
            for face in faces {
                let Wall::Sides { front, back } = sides[side].walls.get(face) else { return Penetrates::Undecided };
                fan.add(side == 1, &self.mesh(side).corners(face), front, back);
            }
        }
        Penetrates::surely(fan.interiors_meet())
    }

    /// Whether a component of one mesh that the other meets in single points at most lies inside that.
    fn judge_components(&self, inner: usize, contacts: &[Touching]) -> Penetrates {
        let (mesh, outer) = (self.mesh(inner), self.mesh(1 - inner));
        outer.topology();
        let topology = mesh.topology();
        let mut is_open_question = vec![true; topology.first_faces.len()];
        for (pair, _) in contacts {
            is_open_question[topology.component_of[pair[inner] as usize] as usize] = false;
        }
        let [of_outer, of_inner] = [1 - inner, inner].map(|side| self.placed[side].world_from_mesh);
        let placement = Placement::new(&of_outer, &of_inner);
        let at = |judge: &mut Judge<'_>, face: u32| {
            let spot = Spot::Within(mesh.corners(face));
            match judge.containment(&PosedPoint::new(&placement, spot)) {
                Containment::Outside => Some(Penetrates::No),
                Containment::Undecided => Some(Penetrates::Undecided),
                Containment::Inside => mesh.is_solid_beside(face, &mut Vec::new()).then_some(Penetrates::Yes),
                Containment::Surface => None,
            }
        };
        let firsts = topology.first_faces.par_iter().zip(&is_open_question).filter(|&(_, open)| *open);
        let mut answer = Penetrates::No;
        let mut left = vec![false; topology.first_faces.len()];
        let answers: Vec<(u32, Option<Penetrates>)> =
            firsts.map_init(|| Judge::new(outer), |judge, (&face, _)| (face, at(judge, face))).collect();
        for (face, of_component) in answers {
            match of_component {
                Some(of_component) => answer = answer.max(of_component),
                None => left[topology.component_of[face as usize] as usize] = true,
            }
        }
        // Its first face is touched there or has nothing inside beside it; a later one will tell, or none has an interior.
        if left.contains(&true) {
            let mut judge = Judge::new(outer);
            for face in 0..mesh.faces().len() as u32 {
                let component = topology.component_of[face as usize] as usize;
                if left[component]
                    && let Some(of_component) = at(&mut judge, face)
                {
                    left[component] = false;
                    answer = answer.max(of_component);
                }
            }
        }
        answer
    }

    /// Whether nothing can be inside both but what the surfaces tell of: closed meshes have their interior within their
    /// surface. An open mesh of area S winds round a point at distance d by at most S / 4πd², so its interior is within
    /// √(S / 2π) of its box; where both boxes, so enlarged, are apart, there is nothing.
    fn stay_within_reach(&self) -> bool {
        if self.placed.iter().all(|placed| placed.mesh.is_closed()) {
            return true;
        }
        let [a, b] = self.placed.map(reach);
        (0..3).any(|axis| a[axis][1] < b[axis][0] || b[axis][1] < a[axis][0])
    }
}

/// The box in the world, along each axis, that the interior of a placed mesh is in.
fn reach(placed: Placed<'_>) -> [[f64; 2]; 3] {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    let mut extent = 0.0_f64;
    let faces = || {
        let corners = |face| placed.mesh.corners(face).map(|corner| placed.world_from_mesh.apply(corner));
        (0..placed.mesh.faces().len() as u32).map(corners)
    };
    for corners in faces() {
        for (axis, [low, high]) in bounds.iter_mut().enumerate() {
            for corner in &corners {
                (*low, *high) = (low.min(corner[axis]), high.max(corner[axis]));
                extent = extent.max(corner[axis].abs());
            }
        }
    }
    // In units of the mesh's size, so that no square vanishes; a reciprocal of less is none.
    let size = bounds.iter().fold(1e-300, |most: f64, [low, high]| most.max(high - low));
    let mut area = 0.0;
    for corners in faces() {
        let edge = |to: usize| -> [f64; 3] { std::array::from_fn(|k| (corners[to][k] - corners[0][k]) / size) };
        let (u, v) = (edge(1), edge(2));
        let normal = |k: usize| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        area += 0.5 * (normal(0).powi(2) + normal(1).powi(2) + normal(2).powi(2)).sqrt();
    }
    // Far more than all roundings, of the corners and of the area, may add up to.
    let wound = if placed.mesh.is_closed() { 0.0 } else { (area / std::f64::consts::TAU).sqrt() * 1.01 * size };
    let margin = wound + extent * 1e-6 + f64::MIN_POSITIVE;
    bounds.map(|[low, high]| [low - margin, high + margin])
}

/// The faces of one mesh that are in contacts.
struct Side<'m> {
    mesh: &'m Mesh,
    walls: Walls,
    /// The faces at each edge, which are named by their positions.
    at_edge: HashMap<[u32; 2], Vec<u32>>,
}

impl<'m> Side<'m> {
    fn new(mesh: &'m Mesh, mut faces: Vec<u32>) -> Self {
        faces.par_sort_unstable();
        faces.dedup();
        let walls = Walls::of(mesh, faces);
        let mut at_edge: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
        for &face in walls.faces() {
            for corner in 0..3 {
                at_edge.entry(mesh.edge_name(face, [corner, (corner + 1) % 3])).or_default().push(face);
            }
        }
        Self { mesh, walls, at_edge }
    }

    /// The faces at an edge of one of them; none where some are missing: not all of them met the other mesh, so that
    /// these do not hold together.
    fn about(&self, face: u32, edge: [usize; 2]) -> Option<Vec<u32>> {
        let name = self.mesh.edge_name(face, edge);
        let faces = self.at_edge.get(&name)?;
        self.mesh.is_balanced_at(name, faces).then(|| faces.clone())
    }
}

impl Penetrates {
    /// Whether they do, or it is not known that they do not: the safe answer.
    #[must_use]
    pub fn possibly(self) -> bool {
        self != Self::No
    }

    fn surely(meet: bool) -> Self {
        if meet { Self::Yes } else { Self::No }
    }
}

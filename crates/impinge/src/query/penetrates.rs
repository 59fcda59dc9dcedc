//! Whether the interiors of two solids intersect. Touching does not count.
//!
//! Let U be the interior of a mesh: the points off its surface whose winding number is above one
//! half. A face that does not count (`mesh/solid/sheets.rs`) changes no winding number, so the
//! search skips it. If the interiors of both meshes intersect, one of three conditions holds. This
//! follows from a generic point on the border of the intersection of the interiors:
//! 1. A sheet of one surface lies inside the other mesh, and the other surface touches it at most
//!    in single points.
//! 2. A face of one mesh and a face of the other intersect in a segment, and some direction across
//!    the segment is inside both. Either the faces cross away from their edges, or the direction
//!    lies in the fan of all faces that share an edge, seen along the edge.
//! 3. Faces of both meshes overlap in an area, and both interiors are on the same side of it.
//!
//! Each condition is also sufficient. Every contact is classified by itself, from all faces of the
//! mesh at its edge and from the winding numbers on both sides of each face. So the order of the
//! faces changes no answer, and the search can stop at the first contact that proves an
//! intersection. If other faces of its own mesh go through a face, its sides are not the same all
//! over it. The contacts of such a face are undecided, unless another contact proves an
//! intersection.
//!
//! An open mesh is like a closed one except near its border (`mesh/derived/cap.rs`), so the same
//! holds away from the border.
//!
//! Proof: docs/notes/proof.md, L19. Tests: `tests/it/solids/penetration.rs`. Benchmark: `solids`.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::budget::Budget;
use crate::exact::{Contact, Corners, EdgeLine, Fan, Placement, PosedPoint, Spot, contact};
use crate::mesh::{Components, Containment, Mesh, PlacedMesh, PointClassifier, Wall, Walls};

/// Verdict whether the interiors of two solids intersect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Penetrates {
    /// The interiors do not intersect. The solids may touch.
    No,
    /// Undecided: a mesh is open near the other one, or intersects itself at a place that matters;
    /// or, for shapes, zero lies in the proved interval of the depth.
    Undecided,
    /// The interiors intersect.
    Yes,
}

/// Returns whether the interiors of two meshes intersect, as [`penetrates`](super::penetrates())
/// does, given the pairs of faces that intersect. Both meshes count as solids. `pairs` must be all
/// pairs that [`intersecting_pairs`](super::intersecting_pairs()) returned for the same meshes and
/// poses.
///
/// # Panics
/// If a face index of a pair is out of range.
#[must_use]
pub fn penetrates_of_pairs<'a, 'b>(
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    pairs: &[[u32; 2]],
) -> Penetrates {
    decide(a.into(), b.into(), pairs, Budget::unlimited())
}

/// Computes [`penetrates_of_pairs`]. Once the budget is spent, everything that is left is
/// undecided.
pub(super) fn decide(a: PlacedMesh<'_>, b: PlacedMesh<'_>, pairs: &[[u32; 2]], budget: &Budget<'_>) -> Penetrates {
    /// Number of contacts that are classified before the parts and all other contacts. If bodies
    /// are deep in each other, any contact shows it. More contacts take longer if they prove
    /// nothing; fewer contacts often are not enough.
    const FIRST_CONTACTS: usize = 64;
    let solids = Solids { placed: [a, b], placement: Placement::new(&a.world_from_mesh, &b.world_from_mesh), budget };
    let contacts = solids.contacts(pairs);
    let first = solids.classify_contacts(&contacts[..contacts.len().min(FIRST_CONTACTS)]);
    if first == Penetrates::Yes {
        return first;
    }
    let apart = [0, 1].map(|side| solids.classify_parts(side, pairs, &contacts));
    let apart = apart[0].max(apart[1]);
    if apart == Penetrates::Yes {
        return apart;
    }
    let rest = if contacts.len() > FIRST_CONTACTS { solids.classify_contacts(&contacts) } else { first };
    match rest.max(apart) {
        Penetrates::No if budget.is_spent() || !solids.have_clear_borders() => Penetrates::Undecided,
        answer => answer,
    }
}

/// Pair of faces that intersect in a segment or in an area. Both faces count.
type Touching = ([u32; 2], Contact);

/// Faces of one mesh in a fan: a single face, or all faces at an edge, given by its name.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Member {
    Face(u32),
    Edge([u32; 2]),
}

/// Two placed meshes, A and B.
struct Solids<'m> {
    placed: [PlacedMesh<'m>; 2],
    placement: Placement,
    budget: &'m Budget<'m>,
}

impl<'m> Solids<'m> {
    fn mesh(&self, side: usize) -> &'m Mesh {
        self.placed[side].mesh
    }

    fn contacts(&self, pairs: &[[u32; 2]]) -> Vec<Touching> {
        let kind = |&pair: &[u32; 2]| {
            let [a, b] = [0, 1].map(|side| self.mesh(side).corners(pair[side]));
            let contact = contact(&self.placement, &a, &b);
            let counts = contact != Contact::Slight && (0..2).all(|side| self.mesh(side).counts(pair[side]));
            counts.then_some((pair, contact))
        };
        pairs.par_iter().filter_map(|pair| if self.budget.is_spent() { None } else { kind(pair) }).collect()
    }

    /// Returns the verdict of some contacts: `Yes` if one of them proves an intersection.
    fn classify_contacts(&self, contacts: &[Touching]) -> Penetrates {
        let contacts = self.with_distinct_fans(contacts);
        let sides = [0, 1].map(|side| Side::of(self.mesh(side), side, &contacts, self.budget));
        // Stops at the first contact that proves an intersection.
        let answers = contacts.par_iter().map(|(pair, contact)| {
            if self.budget.is_spent() {
                return Ok(Penetrates::Undecided);
            }
            match self.classify(&sides, *pair, *contact) {
                Penetrates::Yes => Err(()),
                answer => Ok(answer),
            }
        });
        answers.try_reduce(|| Penetrates::No, |x, y| Ok(x.max(y))).unwrap_or(Penetrates::Yes)
    }

    /// Returns the contacts, with one contact only for each fan. Many faces at an edge have many
    /// contacts with the faces at another edge, and all of these contacts have one fan.
    fn with_distinct_fans(&self, contacts: &[Touching]) -> Vec<Touching> {
        let name = |side: usize, face: u32, edge: [usize; 2]| Member::Edge(self.mesh(side).edge_name(face, edge));
        let mut fans = HashSet::new();
        let mut is_first = |&(pair, contact): &Touching| {
            let [a, b] = pair;
            match contact {
                Contact::EdgeOfA(edge) => fans.insert([name(0, a, edge), Member::Face(b)]),
                Contact::EdgeOfB(edge) => fans.insert([Member::Face(a), name(1, b, edge)]),
                Contact::Edges(edge_a, edge_b) => fans.insert([name(0, a, edge_a), name(1, b, edge_b)]),
                _ => true,
            }
        };
        contacts.iter().copied().filter(|contact| is_first(contact)).collect()
    }

    /// Returns the verdict of one contact.
    fn classify(&self, sides: &[Side; 2], [a, b]: [u32; 2], contact: Contact) -> Penetrates {
        let faces =
            |side: usize, face: u32, edge: [usize; 2]| sides[side].at_edge(self.mesh(side).edge_name(face, edge));
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
                    // The corners of each face have the same orientation in the world as in its
                    // mesh frame, unless its pose mirrors.
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
            Contact::EdgeOfA(edge) => self.classify_fan(sides, line(0, a, edge), [faces(0, a, edge), &[b]]),
            Contact::EdgeOfB(edge) => self.classify_fan(sides, line(1, b, edge), [&[a], faces(1, b, edge)]),
            Contact::Edges(edge_a, edge_b) => {
                self.classify_fan(sides, line(0, a, edge_a), [faces(0, a, edge_a), faces(1, b, edge_b)])
            }
        }
    }

    /// Returns the verdict of all faces of both meshes that intersect in a line. The given faces
    /// are all faces there that count. Any other face of the mesh would intersect one of them
    /// outside of common corners and edges, and that face then has an unknown wall.
    fn classify_fan(&self, sides: &[Side; 2], line: EdgeLine, faces: [&[u32]; 2]) -> Penetrates {
        let mut fan = Fan::about(&self.placement, line);
        for (side, faces) in faces.into_iter().enumerate() {
            if faces.is_empty() {
                return Penetrates::Undecided;
            }
            for &face in faces {
                let Wall::Sides { front, back } = sides[side].walls.get(face) else { return Penetrates::Undecided };
                fan.add(side == 1, &self.mesh(side).corners(face), front, back);
            }
        }
        Penetrates::surely(fan.interiors_intersect())
    }

    /// Returns whether a connected part of one mesh lies inside the other mesh. Only parts are
    /// checked that the other surface touches at most in single points.
    fn classify_parts(&self, inner: usize, pairs: &[[u32; 2]], contacts: &[Touching]) -> Penetrates {
        let (mesh, outer) = (self.mesh(inner), self.mesh(1 - inner));
        // Built here, so that the threads below do not wait for it. Each step takes long for a
        // large mesh.
        outer.topology();
        if self.budget.is_spent() {
            return Penetrates::Undecided;
        }
        let topology = mesh.topology();
        if self.budget.is_spent() {
            return Penetrates::Undecided;
        }
        // A part that is connected along edges stays connected if touched in single points.
        let parts = if pairs.is_empty() { Some(&topology.components) } else { mesh.sheets(self.budget) };
        let Some(parts) = parts else { return Penetrates::Undecided };
        let mut is_free = vec![true; parts.first_faces.len()];
        for (pair, _) in contacts {
            // The parts are sheets here, and both faces count.
            is_free[parts.of_face[pair[inner] as usize] as usize] = false;
        }
        let placement = Placement::new(&self.placed[1 - inner].world_from_mesh, &self.placed[inner].world_from_mesh);
        let inside = |classifier: &mut PointClassifier<'_>, face: u32| {
            if self.budget.is_spent() {
                return Some(Penetrates::Undecided);
            }
            is_inside(classifier, mesh, &placement, face)
        };
        let faces = representatives(mesh, parts, outer.is_closed());
        let mut answers: Vec<Option<Penetrates>> = is_free
            .par_iter()
            .zip(faces)
            .map_init(
                || PointClassifier::new(outer),
                |classifier, (&is_free, face)| match face {
                    Some(face) if is_free => inside(classifier, face),
                    // A contact decides instead, or no face of the part counts.
                    _ => Some(Penetrates::No),
                },
            )
            .collect();
        // If the outer mesh is closed, any point of a part decides for all of it. If it is open,
        // only one face of each part is checked, which is the same for any order of the faces.
        if outer.is_closed() && answers.contains(&None) {
            let mut classifier = PointClassifier::new(outer);
            for face in 0..mesh.faces().len() as u32 {
                let part = parts.of_face[face as usize];
                if part != Components::NONE && answers[part as usize].is_none() && mesh.counts(face) {
                    answers[part as usize] = inside(&mut classifier, face);
                }
            }
        }
        // A part stays undecided if all checked points lie on the other surface, or if it overlaps
        // itself there.
        answers.into_iter().map(|answer| answer.unwrap_or(Penetrates::Undecided)).max().unwrap_or(Penetrates::No)
    }

    /// Reports whether no surface comes near the border of the other mesh. Then everything near one
    /// loop of a border is on one side of the other surface. If that side is inside, the faces at
    /// the loop are inside too, and they or a contact of their sheet show it.
    fn have_clear_borders(&self) -> bool {
        let [a, b] = &self.placed;
        a.has_border_clear_of(b) && b.has_border_clear_of(a)
    }
}

/// Returns a face that counts for each part, or `None` if the part has no such face. It is the
/// first such face or, if the outer mesh is open, the face whose corners have the smallest
/// coordinates.
fn representatives(mesh: &Mesh, parts: &Components, outer_is_closed: bool) -> Vec<Option<u32>> {
    let mut found: Vec<Option<u32>> = parts.first_faces.iter().map(|&face| mesh.counts(face).then_some(face)).collect();
    if !outer_is_closed || found.contains(&None) {
        for face in 0..mesh.faces().len() as u32 {
            let part = parts.of_face[face as usize];
            if part == Components::NONE || !mesh.counts(face) {
                continue;
            }
            let found = &mut found[part as usize];
            let precedes = |known: u32| !outer_is_closed && sorted_corners(mesh, face) < sorted_corners(mesh, known);
            if found.is_none_or(precedes) {
                *found = Some(face);
            }
        }
    }
    found
}

fn sorted_corners(mesh: &Mesh, face: u32) -> Corners {
    let mut corners = mesh.corners(face);
    corners.sort_by(|x, y| x.partial_cmp(y).unwrap_or(std::cmp::Ordering::Equal));
    corners
}

/// Returns whether a face of one mesh has its own solid beside it and lies inside the other mesh.
/// Returns `None` if the checked points do not decide, because they lie on the other surface or the
/// solid is not beside them.
fn is_inside(
    classifier: &mut PointClassifier<'_>,
    mesh: &Mesh,
    placement: &Placement,
    face: u32,
) -> Option<Penetrates> {
    let [p, q, r] = sorted_corners(mesh, face);
    [[p, q, r], [q, r, p], [r, p, q]].into_iter().find_map(|corners| {
        match classifier.containment(&PosedPoint::new(placement, Spot::Within(corners))) {
            Containment::Outside => Some(Penetrates::No),
            Containment::Undecided => Some(Penetrates::Undecided),
            Containment::Inside => mesh.is_solid_beside(&corners, &mut Vec::new()).then_some(Penetrates::Yes),
            Containment::Surface => None,
        }
    })
}

/// Faces of one mesh that some contacts depend on.
struct Side {
    walls: Walls,
    /// All faces that count at each edge that a contact lies on.
    at_edge: HashMap<[u32; 2], Vec<u32>>,
}

impl Side {
    fn of(mesh: &Mesh, side: usize, contacts: &[Touching], budget: &Budget<'_>) -> Self {
        let mut faces: Vec<u32> = contacts.iter().map(|(pair, _)| pair[side]).collect();
        let mut at_edge = HashMap::new();
        for (pair, contact) in contacts {
            let edge = match (side, *contact) {
                (0, Contact::EdgeOfA(edge) | Contact::Edges(edge, _)) => edge,
                (1, Contact::EdgeOfB(edge) | Contact::Edges(_, edge)) => edge,
                _ => continue,
            };
            let name = mesh.edge_name(pair[side], edge);
            if let Entry::Vacant(entry) = at_edge.entry(name) {
                let fan: Vec<u32> = mesh.faces_at_edge(name).collect();
                faces.extend(&fan);
                entry.insert(fan);
            }
        }
        faces.par_sort_unstable();
        faces.dedup();
        Self { walls: Walls::of(mesh, faces, budget), at_edge }
    }

    fn at_edge(&self, edge: [u32; 2]) -> &[u32] {
        self.at_edge.get(&edge).map_or(&[], Vec::as_slice)
    }
}

impl Penetrates {
    /// Reports whether the interiors intersect or may intersect. `true` is the safe answer if the
    /// verdict is undecided.
    #[must_use]
    pub fn possibly(self) -> bool {
        self != Self::No
    }

    fn surely(is_hit: bool) -> Self {
        if is_hit { Self::Yes } else { Self::No }
    }
}

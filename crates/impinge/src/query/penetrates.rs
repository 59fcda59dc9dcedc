//! Whether the interiors of two solids intersect, which touching is not.
//!
//! Let U be the points off the surface that a mesh winds round more than half, its interior. A face
//! that does not count (`mesh/solid/sheets.rs`) changes no winding number, so only faces that count are
//! looked at. If the interiors of both meshes intersect, one of these holds, as follows from a
//! generic point on the border of what they have in common:
//! 1. A sheet of one surface, which the other surface touches in single points or not at all, lies
//!    inside the other.
//! 2. A face of one and a face of the other intersect in a segment, and some direction across the
//!    segment is inside both:
//!    where the faces cross off their edges, or in the fan of all faces that meet in an edge, seen along the edge.
//! 3. Faces of both overlap in an area and are inside both on one side of it.
//!
//! Each of them is also enough. Every contact is judged by itself, from all faces of the mesh at
//! its edge and from the winding numbers on both sides of each face. So the order of the faces
//! changes no answer, and contacts may be judged until one proves an intersection. A face that
//! other faces of its own mesh go through has no sides that are the same all over it; its contacts
//! are undecided, unless something else proves an intersection.
//!
//! An open mesh is a closed one but near its border (`mesh/derived/cap.rs`). The same holds for it away
//! from there.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use rayon::prelude::*;

use crate::exact::{Contact, Corners, EdgeLine, Fan, Placement, PosedPoint, Spot, contact};
use crate::mesh::{Components, Containment, Judge, Mesh, PlacedMesh, Wall, Walls};

/// Whether the interiors of two solids meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Penetrates {
    /// They do not, though the solids may touch.
    No,
    /// Not known: a mesh is open near the other one, or intersects itself where it intersects the
    /// other.
    Undecided,
    /// They do.
    Yes,
}

/// [`penetrates`](super::penetrates()) of two meshes, for pairs that were computed before: all that
/// [`intersecting_pairs`](super::intersecting_pairs) returned.
///
/// # Panics
/// Where a pair names a face that a mesh does not have.
#[must_use]
pub fn penetrates_of_pairs<'a, 'b>(
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    pairs: &[[u32; 2]],
) -> Penetrates {
    /// Number of contacts that are judged before all of them are. Bodies that are deep in each
    /// other show it in any contact. More take longer if they show nothing, and fewer are more
    /// often not enough.
    const FIRST_CONTACTS: usize = 64;
    let solids = Solids::new(a.into(), b.into());
    let contacts = solids.contacts(pairs);
    let first = solids.judge_contacts(&contacts[..contacts.len().min(FIRST_CONTACTS)]);
    if first == Penetrates::Yes {
        return first;
    }
    let apart = [0, 1].map(|side| solids.judge_parts(side, pairs, &contacts));
    let apart = apart[0].max(apart[1]);
    if apart == Penetrates::Yes {
        return apart;
    }
    let rest = if contacts.len() > FIRST_CONTACTS { solids.judge_contacts(&contacts) } else { first };
    match rest.max(apart) {
        Penetrates::No if !solids.have_clear_borders() => Penetrates::Undecided,
        answer => answer,
    }
}

/// A pair of faces, both of which count, that intersect in a segment or in an area.
type Touching = ([u32; 2], Contact);

/// Two placed meshes, A and B.
struct Solids<'m> {
    placed: [PlacedMesh<'m>; 2],
    placement: Placement,
}

impl<'m> Solids<'m> {
    fn new(a: PlacedMesh<'m>, b: PlacedMesh<'m>) -> Self {
        Self { placed: [a, b], placement: Placement::new(&a.world_from_mesh, &b.world_from_mesh) }
    }

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
        pairs.par_iter().filter_map(kind).collect()
    }

    /// Returns what these contacts prove.
    fn judge_contacts(&self, contacts: &[Touching]) -> Penetrates {
        let sides = [0, 1].map(|side| Side::of(self.mesh(side), side, contacts));
        // Stops at the first that is sure.
        let answers = contacts.par_iter().map(|(pair, contact)| match self.judge(&sides, *pair, *contact) {
            Penetrates::Yes => Err(()),
            answer => Ok(answer),
        });
        answers.try_reduce(|| Penetrates::No, |x, y| Ok(x.max(y))).unwrap_or(Penetrates::Yes)
    }

    fn judge(&self, sides: &[Side; 2], [a, b]: [u32; 2], contact: Contact) -> Penetrates {
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
            Contact::EdgeOfA(edge) => self.judge_fan(sides, line(0, a, edge), [faces(0, a, edge), &[b]]),
            Contact::EdgeOfB(edge) => self.judge_fan(sides, line(1, b, edge), [&[a], faces(1, b, edge)]),
            Contact::Edges(edge_a, edge_b) => {
                self.judge_fan(sides, line(0, a, edge_a), [faces(0, a, edge_a), faces(1, b, edge_b)])
            }
        }
    }

    /// Returns what the faces of both prove that intersect in a line. These are all faces there
    /// that count: any other face of the mesh would intersect one of them elsewhere than in common
    /// corners and edges, which then has an unknown wall.
    fn judge_fan(&self, sides: &[Side; 2], line: EdgeLine, faces: [&[u32]; 2]) -> Penetrates {
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
        Penetrates::surely(fan.interiors_meet())
    }

    /// Returns whether a connected part of one mesh that the other one touches in single points at
    /// most lies inside that.
    fn judge_parts(&self, inner: usize, pairs: &[[u32; 2]], contacts: &[Touching]) -> Penetrates {
        let (mesh, outer) = (self.mesh(inner), self.mesh(1 - inner));
        // Built now, not by the threads that share the work.
        outer.topology();
        // No touch in single points separates what is connected along edges.
        let parts = if pairs.is_empty() { &mesh.topology().components } else { mesh.sheets() };
        let mut is_free = vec![true; parts.first_faces.len()];
        for (pair, _) in contacts {
            // The parts are sheets, and both faces count.
            is_free[parts.of_face[pair[inner] as usize] as usize] = false;
        }
        let placement = Placement::new(&self.placed[1 - inner].world_from_mesh, &self.placed[inner].world_from_mesh);
        let inside = |judge: &mut Judge<'_>, face: u32| is_inside(judge, mesh, &placement, face);
        let asked = representatives(mesh, parts, outer.is_closed());
        let mut answers: Vec<Option<Penetrates>> = is_free
            .par_iter()
            .zip(asked)
            .map_init(
                || Judge::new(outer),
                |judge, (&is_free, face)| match face {
                    Some(face) if is_free => inside(judge, face),
                    // A contact decides, or no face counts.
                    _ => Some(Penetrates::No),
                },
            )
            .collect();
        // Any point tells for all of a part if the outer mesh is closed. Those of an open one are
        // asked at one face only, which is the same for any order of the faces.
        if outer.is_closed() && answers.contains(&None) {
            let mut judge = Judge::new(outer);
            for face in 0..mesh.faces().len() as u32 {
                let part = parts.of_face[face as usize];
                if part != Components::NONE && answers[part as usize].is_none() && mesh.counts(face) {
                    answers[part as usize] = inside(&mut judge, face);
                }
            }
        }
        // What no face tells about is touched in all points asked for, or overlaps itself there.
        answers.into_iter().map(|answer| answer.unwrap_or(Penetrates::Undecided)).max().unwrap_or(Penetrates::No)
    }

    /// Reports whether the surface of neither mesh comes near the border of the other one. Then all that is
    /// near one loop of a border is on one side of the other surface. If that is inside, so are the
    /// faces at the loop, and these or a contact of their sheet show it.
    fn have_clear_borders(&self) -> bool {
        let [a, b] = &self.placed;
        a.has_border_clear_of(b) && b.has_border_clear_of(a)
    }
}

/// Returns for each part a face that counts, if it has one: the first one, or, if the outer mesh is
/// open, the one whose corners have the least coordinates.
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

/// Reports whether a face of one mesh has its own solid beside it where it is inside the other mesh.
/// Returns `None` if the points that are asked about do not tell.
fn is_inside(judge: &mut Judge<'_>, mesh: &Mesh, placement: &Placement, face: u32) -> Option<Penetrates> {
    let [p, q, r] = sorted_corners(mesh, face);
    [[p, q, r], [q, r, p], [r, p, q]].into_iter().find_map(|corners| {
        match judge.containment(&PosedPoint::new(placement, Spot::Within(corners))) {
            Containment::Outside => Some(Penetrates::No),
            Containment::Undecided => Some(Penetrates::Undecided),
            Containment::Inside => mesh.is_solid_beside(&corners, &mut Vec::new()).then_some(Penetrates::Yes),
            Containment::Surface => None,
        }
    })
}

/// The faces of one mesh that some contacts depend on.
struct Side {
    walls: Walls,
    /// All faces that count at each edge that a contact is in.
    at_edge: HashMap<[u32; 2], Vec<u32>>,
}

impl Side {
    fn of(mesh: &Mesh, side: usize, contacts: &[Touching]) -> Self {
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
        Self { walls: Walls::of(mesh, faces), at_edge }
    }

    fn at_edge(&self, edge: [u32; 2]) -> &[u32] {
        self.at_edge.get(&edge).map_or(&[], Vec::as_slice)
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

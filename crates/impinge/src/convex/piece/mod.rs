//! Convex pieces of a surface: groups of neighboring faces that lie on the border of one convex
//! set.
//!
//! A face alone does not know its neighbors: the shortest way out of a floor's triangle may lead
//! sideways, through the next triangle. A piece knows them. Its faces are in convex position: all
//! its corners are below the planes of its faces. They are also below the planes of the faces
//! beyond its convex edges, and inside the borders of the surface that it reaches. So the hull of a
//! piece fills no hole, and no notch, of the surface. A contact with a piece is a contact of two
//! convex sets, and has the depth that the whole convex part of the surface would have.
//!
//! A piece is first flooded from a seed over touched faces, and `body` lets it grow over faces that
//! nothing touches where the direction of a contact needs them.
//!
//! The tests are in `tests/it/shapes/mesh_contacts.rs`.

mod body;
mod listed;
mod polytope;
mod resolve;
mod touched;

use crate::budget::Budget;
use crate::math::vec3::{cross, dot, sub};
use crate::mesh::{Across, FaceAcross, Mesh, Positions};

use super::posed::to_unit_length;
pub(crate) use body::{Body, contacts_of_bodies};
use listed::Listed;
pub(crate) use resolve::{Found, unresolved};
pub(crate) use touched::Touched;

/// Maximum number of planes of a piece. A surface with more of them in one touched region is cut
/// into several pieces. More planes make each added face cost more.
const MAX_PLANES: usize = 256;

/// A face and the side that counts as outside: the side from which its corners turn left, or the
/// other side if it is flipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OrientedFace {
    pub(crate) face: u32,
    pub(crate) is_flipped: bool,
}

/// A plane that bounds a piece, in the frame of the mesh.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: [f64; 3],
    /// A point of the plane.
    base: [f64; 3],
    /// Whether a face of the piece lies in the plane.
    is_of_face: bool,
}

impl Plane {
    fn height(&self, point: &[f64; 3]) -> f64 {
        dot(&self.normal, &sub(point, &self.base))
    }

    fn holds(&self, points: &[[f64; 3]], normal: &[f64; 3], slack: f64) -> bool {
        dot(&self.normal, normal) > 0.5 && points.iter().all(|point| self.height(point).abs() <= slack)
    }
}

/// The surface beyond an edge of a face.
#[derive(Clone, Copy)]
enum Beyond {
    /// No face: the edge is on the border of the surface.
    Nothing,
    /// One face.
    Face(Neighbor),
    /// Several faces, of which none continues the surface.
    Unclear,
}

/// A face beyond an edge of another face.
#[derive(Clone, Copy)]
struct Neighbor {
    face: OrientedFace,
    /// Number of the corner that is not on the edge.
    opposite: u8,
}

/// All corners of a face.
const ALL_CORNERS: &[u8] = &[0, 1, 2];

/// A mesh with its connectivity, as slices, because pieces read them for every face.
#[derive(Clone, Copy, Debug)]
struct Connected<'m> {
    mesh: &'m Mesh,
    positions: &'m Positions,
    /// Vertices of each face.
    faces: &'m [[u32; 3]],
    /// For each vertex the first vertex at its position.
    first_at: &'m [u32],
    across: &'m [[Across; 3]],
}

impl<'m> Connected<'m> {
    fn new(mesh: &'m Mesh) -> Self {
        let (positions, first_at) = (mesh.positions(), &mesh.topology().first_at);
        Self { mesh, positions, faces: mesh.faces(), first_at, across: mesh.all_across() }
    }

    #[inline]
    fn position(&self, vertex: u32) -> [f64; 3] {
        self.positions.get(vertex as usize)
    }

    #[inline]
    fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        let [p, q, r] = self.faces[face as usize];
        [self.position(p), self.position(q), self.position(r)]
    }

    /// Returns the plane of a face, or `None` if the face has no area.
    #[inline]
    fn plane(&self, of: OrientedFace) -> Option<Plane> {
        plane_of(&self.corners(of.face), of.is_flipped)
    }

    /// Returns the surface beyond each edge of a face. Edge k runs from corner k to the next.
    #[inline]
    fn beyond(&self, of: OrientedFace) -> [Beyond; 3] {
        self.across[of.face as usize].map(|across| match across {
            Across::Nothing => Beyond::Nothing,
            Across::Several => Beyond::Unclear,
            Across::Face(FaceAcross { face, opposite, runs_along }) => {
                let face = OrientedFace { face, is_flipped: of.is_flipped != runs_along };
                Beyond::Face(Neighbor { face, opposite })
            }
        })
    }
}

/// Returns the plane of a face with these corners, or `None` if the face has no area.
#[inline]
fn plane_of([p, q, r]: &[[f64; 3]; 3], is_flipped: bool) -> Option<Plane> {
    let area = cross(&sub(q, p), &sub(r, p));
    let sign = if is_flipped { -1.0 } else { 1.0 };
    (area != [0.0; 3]).then(|| Plane { normal: to_unit_length(area.map(|x| sign * x)), base: *p, is_of_face: true })
}

/// Faces in the order in which pieces start with them.
pub(crate) trait Seeds {
    /// Returns the next face that is not in a piece yet, or `None` if there is no other face.
    fn next(&mut self, is_taken: &dyn Fn(u32) -> bool) -> Option<OrientedFace>;
}

impl<I: Iterator<Item = OrientedFace>> Seeds for I {
    fn next(&mut self, is_taken: &dyn Fn(u32) -> bool) -> Option<OrientedFace> {
        self.find(|seed| !is_taken(seed.face))
    }
}

/// A group of faces in convex position.
#[derive(Debug)]
pub(crate) struct Piece<'m> {
    mesh: Connected<'m>,
    faces: Vec<OrientedFace>,
    planes: Vec<Plane>,
    /// Corners of the faces, by the first vertex at each position, each with the number of the
    /// plane of such a face. A corner of several faces may occur more than once.
    corners: Vec<(u32, u32)>,
    slack: f64,
}

impl Piece<'_> {
    /// Returns the faces of the piece.
    pub(crate) fn faces(&self) -> impl Iterator<Item = u32> {
        self.faces.iter().map(|face| face.face)
    }

    /// Adds a face if the piece stays in convex position, and returns the surface beyond its edges.
    /// Returns `None` if the face was not added. `new_corners` are the numbers of its corners that
    /// may not be in the piece. The others are known to be below all planes.
    fn add(&mut self, face: OrientedFace, new_corners: &[u8]) -> Option<[Beyond; 3]> {
        let (mesh, slack) = (self.mesh, self.slack);
        let corners = mesh.corners(face.face);
        let own = plane_of(&corners, face.is_flipped)?;
        let is_above = |plane: &Plane, at: u8| plane.height(&corners[usize::from(at)]) > slack;
        if self.planes.iter().any(|plane| new_corners.iter().any(|&at| is_above(plane, at))) {
            return None;
        }
        let known = self.planes.iter().position(|plane| plane.holds(&corners, &own.normal, slack));
        let mut new: Vec<Plane> = Vec::new();
        if known.is_none() {
            new.push(own);
        }
        let surroundings = mesh.beyond(face);
        for (edge, beyond) in surroundings.into_iter().enumerate() {
            let ends = [corners[edge], corners[(edge + 1) % 3]];
            let bound = match beyond {
                Beyond::Unclear => continue,
                Beyond::Nothing => {
                    let sign = if face.is_flipped { -1.0 } else { 1.0 };
                    let along = sub(&ends[1], &ends[0]).map(|x| sign * x);
                    Plane { normal: to_unit_length(cross(&along, &own.normal)), base: ends[0], is_of_face: false }
                }
                Beyond::Face(Neighbor { face, opposite }) => {
                    // The corners on the edge are in the plane.
                    let opposite = mesh.faces[face.face as usize][usize::from(opposite)];
                    if own.height(&mesh.position(opposite)) >= -slack {
                        continue;
                    }
                    let Some(plane) = mesh.plane(face) else { continue };
                    Plane { is_of_face: false, ..plane }
                }
            };
            let is_known = |plane: &Plane| plane.holds(&ends, &bound.normal, slack) && is_same_direction(plane, &bound);
            if !self.planes.iter().chain(&new).any(is_known) {
                new.push(bound);
            }
        }
        if !new.is_empty() {
            let is_above = |plane: &Plane| self.corners.iter().any(|&(at, _)| plane.height(&mesh.position(at)) > slack);
            let is_full = self.planes.len() + new.len() > MAX_PLANES && !self.planes.is_empty();
            if is_full || new.iter().any(is_above) {
                return None;
            }
        }
        let plane = known.unwrap_or(self.planes.len());
        if let Some(known) = known {
            self.planes[known].is_of_face = true;
        }
        self.planes.extend(new);
        let vertices = mesh.faces[face.face as usize];
        for &at in new_corners {
            self.corners.push((mesh.first_at[vertices[usize::from(at)] as usize], plane as u32));
        }
        self.faces.push(face);
        Some(surroundings)
    }
}

fn is_same_direction(one: &Plane, other: &Plane) -> bool {
    dot(&one.normal, &other.normal) > 1.0 - 1.0 / (1 << 20) as f64
}

/// Divides some faces of a mesh into convex pieces. A piece starts with the first seed that is in
/// no piece yet; the seeds must be among the faces. A seed beside a face of an earlier piece has
/// the orientation of that face; any other seed has its given one. Faces without area are in no
/// piece.
///
/// # Complexity
/// O(n) for n faces in a few planes. A face in a new plane takes linear time in its piece, whose
/// number of planes is limited. If the budget is spent, pieces are missing.
pub(crate) fn pieces<'m>(mesh: &'m Mesh, faces: &[u32], mut seeds: impl Seeds, budget: &Budget<'_>) -> Vec<Piece<'m>> {
    /// Number of faces between two looks at the budget: about 100 microseconds.
    const FACES_PER_LOOK: usize = 64;
    let mut listed = Listed::new(faces);
    let mesh = Connected::new(mesh);
    let slack = slack(&mesh, faces);
    let mut found = Vec::new();
    while listed.has_open()
        && let Some(given) = seeds.next(&|face| !listed.is_open(face))
    {
        if budget.is_spent() {
            break;
        }
        let mut seed = given;
        for beyond in mesh.beyond(given) {
            if let Beyond::Face(Neighbor { face: other, .. }) = beyond
                && let Some(is_flipped) = listed.flipped_in_piece(other.face)
            {
                seed.is_flipped = given.is_flipped != (other.is_flipped != is_flipped);
                break;
            }
        }
        let mut piece = Piece { mesh, faces: vec![], planes: vec![], corners: vec![], slack };
        listed.take(seed.face, seed.is_flipped);
        let Some(surroundings) = piece.add(seed, ALL_CORNERS) else { continue };
        let mut queue = vec![surroundings];
        let mut next = 0;
        while let Some(&surroundings) = queue.get(next) {
            next += 1;
            if next % FACES_PER_LOOK == 0 && budget.is_spent() {
                break;
            }
            for beyond in surroundings {
                if let Beyond::Face(Neighbor { face: other, opposite }) = beyond
                    && listed.is_open(other.face)
                    && let Some(surroundings) = piece.add(other, &[opposite])
                {
                    listed.take(other.face, other.is_flipped);
                    queue.push(surroundings);
                }
            }
        }
        found.push(piece);
    }
    found
}

/// Returns the height above a plane up to which a corner counts as in it. It is larger than the
/// rounding of the coordinates.
fn slack(mesh: &Connected<'_>, faces: &[u32]) -> f64 {
    /// Part of the size of the faces: 2^-32. Less would cut rounded planes into pieces. More would
    /// take low steps for flat.
    const OF_SIZE: f64 = 1.0 / (1_u64 << 32) as f64;
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for corner in faces.iter().flat_map(|&face| mesh.corners(face)) {
        for k in 0..3 {
            bounds[0][k] = if corner[k] < bounds[0][k] { corner[k] } else { bounds[0][k] };
            bounds[1][k] = if corner[k] > bounds[1][k] { corner[k] } else { bounds[1][k] };
        }
    }
    let size = (0..3).map(|k| bounds[1][k] - bounds[0][k]).fold(0.0, f64::max);
    let far = bounds.as_flattened().iter().fold(0.0_f64, |far, x| far.max(x.abs()));
    let rounding = match mesh.positions {
        Positions::F32(_) => f64::from(f32::EPSILON),
        Positions::F64(_) => f64::EPSILON,
    };
    size * OF_SIZE + 4.0 * rounding * far
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::{Rng, solids};

    /// Grids whose heights are small integers have flat parts, ridges and valleys, and many corners
    /// that are in the planes of other faces.
    #[test]
    fn all_corners_of_a_piece_are_below_its_planes() {
        let mut rng = Rng::new(64);
        let (mut large, mut many) = (0, 0);
        for round in 0..100 {
            let mut grid = solids::plane_grid(8, 8);
            let steps = round % 4;
            grid.vertices.iter_mut().for_each(|[.., z]| *z = rng.integer(0, steps) as f64 * 0.25);
            let mesh = Mesh::new(grid.vertices, grid.faces).expect("a mesh");
            let faces: Vec<u32> = (0..128).filter(|_| !rng.one_in(10)).collect();
            let seeds = faces.iter().map(|&face| OrientedFace { face, is_flipped: round % 2 == 0 });
            let found = pieces(&mesh, &faces, seeds, Budget::unlimited());
            let mut members: Vec<u32> = found.iter().flat_map(Piece::faces).collect();
            members.sort_unstable();
            assert_eq!(members, faces);
            for piece in &found {
                for plane in &piece.planes {
                    let corners = piece.faces().flat_map(|face| mesh.corners(face));
                    assert!(corners.into_iter().all(|corner| plane.height(&corner) <= piece.slack));
                }
                let mut corners: Vec<u32> = piece.corners.iter().map(|corner| corner.0).collect();
                corners.sort_unstable();
                corners.dedup();
                let mut vertices: Vec<u32> = piece.faces().flat_map(|face| mesh.faces()[face as usize]).collect();
                vertices.sort_unstable();
                vertices.dedup();
                assert_eq!(corners, vertices);
                large += usize::from(piece.faces.len() > 10);
            }
            many += usize::from(found.len() > 10);
        }
        assert!(large >= 25 && many > 30, "{large} {many}");
    }
}

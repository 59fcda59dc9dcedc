//! Intersection curves: what pairs of triangles have in common, linked into polylines.
//!
//! Each end of a piece lies on one corner, edge or face of either mesh, decided exactly; pieces are linked where these
//! names agree and never by comparing coordinates. Where two closed meshes meet in general position every end is shared
//! by two pieces, so that every curve closes.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::exact::{Corners, Crossing, Feature, Joint, Placement, joints};
use crate::mesh::{DisjointSets, Mesh, PlacedMesh};
use crate::query::intersecting_pairs;

/// Where two surfaces meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Polylines in the world frame and unit; closed where the last point repeats the first. They end where a mesh has
    /// a border, and where more than two pieces come together.
    pub polylines: Vec<Vec<[f64; 3]>>,
    /// Points at which the surfaces touch without a curve.
    pub points: Vec<[f64; 3]>,
    /// Pairs of faces that meet within one plane: no curve of their own, but their neighbours' curves run along them.
    pub coplanar_pairs: usize,
}

impl Curves {
    /// How many polylines are closed.
    #[must_use]
    pub fn closed(&self) -> usize {
        self.polylines.iter().filter(|line| line.first() == line.last()).count()
    }

    /// The length of all polylines, in world units, rounded.
    #[must_use]
    pub fn length(&self) -> f64 {
        let length = |line: &Vec<[f64; 3]>| -> f64 { line.windows(2).map(|ends| distance(ends[0], ends[1])).sum() };
        self.polylines.iter().map(length).sum()
    }
}

fn distance(from: [f64; 3], to: [f64; 3]) -> f64 {
    (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f64>().sqrt()
}

/// The curves in which the surfaces of two meshes meet.
///
/// # Accuracy
/// Which pieces there are and how they link up is exact; a point is the exact one, each coordinate rounded to nearest.
///
/// # Complexity
/// That of [`intersecting_pairs`], and O(k log k) for k pairs.
///
/// ```
/// use impinge::{Mesh, Positions, query};
///
/// let floor = vec![[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [0.0, 4.0, 0.0]];
/// let wall = vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
/// let floor = Mesh::new(Positions::F32(floor), vec![[0, 1, 2]])?;
/// let wall = Mesh::new(Positions::F32(wall), vec![[0, 1, 2]])?;
/// let curves = query::intersection_curves(&floor, &wall);
/// assert_eq!(curves.polylines.len(), 1);
/// assert_eq!(curves.length(), 1.0);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn intersection_curves<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Curves {
    let (a, b) = (a.into(), b.into());
    curves_of_pairs(a, b, &intersecting_pairs(a, b))
}

/// [`intersection_curves`], for pairs that were computed before: what [`intersecting_pairs`] returned, or some of it.
///
/// # Panics
/// Where a pair names a face that a mesh does not have.
#[must_use]
pub fn curves_of_pairs<'a, 'b>(
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    pairs: &[[u32; 2]],
) -> Curves {
    let placed = [a.into(), b.into()];
    Linked::new(placed, &met(placed, pairs)).curves()
}

/// A pair of faces that meet, and in what.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    pub(super) pair: [u32; 2],
    pub(super) crossing: Crossing<Joint>,
}

/// Pairs of faces below which threads cost more than they save.
const FEW: usize = 64;

/// In what these pairs of faces meet.
pub(super) fn met(placed: [PlacedMesh<'_>; 2], pairs: &[[u32; 2]]) -> Vec<Met> {
    let placement = Placement::new(&placed[0].world_from_mesh, &placed[1].world_from_mesh);
    let meet = |&pair: &[u32; 2]| {
        let [a, b] = corners(placed, pair);
        Met { pair, crossing: joints(&placement, &a, &b) }
    };
    pairs.par_iter().with_min_len(FEW).map(meet).collect()
}

fn corners(placed: [PlacedMesh<'_>; 2], pair: [u32; 2]) -> [Corners; 2] {
    [0, 1].map(|side| placed[side].mesh.corners(pair[side]))
}

/// The pieces of some pairs of faces, whose ends are one where they have the same name.
pub(super) struct Linked {
    /// The ends, in the world frame.
    pub(super) points: Vec<[f64; 3]>,
    /// In what each pair meets, with the numbers of its ends.
    pub(super) pieces: Vec<Crossing<usize>>,
}

impl Linked {
    pub(super) fn new(placed: [PlacedMesh<'_>; 2], met: &[Met]) -> Self {
        let mut names = placed.map(|placed| Names::new(placed.mesh));
        let mut numbers = HashMap::new();
        let mut ends = Vec::new();
        let mut number = |name: [Name; 2], pair: [u32; 2], joint: Joint| {
            *numbers.entry(name).or_insert_with(|| {
                ends.push((pair, joint));
                ends.len() - 1
            })
        };
        let mut pieces: Vec<Crossing<usize>> = met
            .iter()
            .map(|met| {
                met.crossing.map(|joint| {
                    let on = [joint.on_a, joint.on_b];
                    let name = [0, 1].map(|side| names[side].name(met.pair[side], &ALL_CORNERS, on[side]));
                    number(name, met.pair, joint)
                })
            })
            .collect();
        let placement = Placement::new(&placed[0].world_from_mesh, &placed[1].world_from_mesh);
        // The edges of a face without area overlap. A point on it lies on two or three of them, and each gives it
        // another name.
        let mut same = Vec::new();
        for (met, piece) in met.iter().zip(&pieces) {
            let &Crossing::Point(end) = piece else { continue };
            let flat = [0, 1].map(|side| placed[side].mesh.is_degenerate(met.pair[side]));
            if flat == [false; 2] {
                continue;
            }
            let whole = corners(placed, met.pair);
            for at_a in edges_of(flat[0]) {
                for at_b in edges_of(flat[1]) {
                    let at = [at_a, at_b];
                    let [a, b] = [0, 1].map(|side| at[side].map(|corner| whole[side][usize::from(corner)]));
                    if let Crossing::Point(joint) = joints(&placement, &a, &b) {
                        let on = [joint.on_a, joint.on_b];
                        let name = [0, 1].map(|side| names[side].name(met.pair[side], &at[side], on[side]));
                        same.push([end, number(name, met.pair, joint)]);
                    }
                }
            }
        }
        let mut sets = DisjointSets::new(ends.len());
        same.iter().for_each(|&[one, other]| sets.join(one as u32, other as u32));
        pieces.iter_mut().for_each(|piece| *piece = piece.map(|end| sets.root(end as u32) as usize));
        let point = |&(pair, joint): &([u32; 2], Joint)| {
            let [a, b] = corners(placed, pair);
            joint.point(&placement, &a, &b)
        };
        Self { points: ends.par_iter().with_min_len(FEW).map(point).collect(), pieces }
    }

    pub(super) fn curves(&self) -> Curves {
        let mut graph = Graph { points: &self.points, neighbours: vec![Vec::new(); self.points.len()] };
        let mut coplanar_pairs = 0;
        let mut touching = Vec::new();
        for piece in &self.pieces {
            match *piece {
                Crossing::Apart => {}
                Crossing::Coplanar => coplanar_pairs += 1,
                Crossing::Point(end) => touching.push(end),
                Crossing::Segment(from, to) => graph.link(from, to),
            }
        }
        let mut seen = HashSet::new();
        touching.retain(|&end| graph.neighbours[end].is_empty() && seen.insert(end));
        let points = touching.into_iter().map(|end| self.points[end]).collect();
        Curves { polylines: graph.into_polylines(), points, coplanar_pairs }
    }
}

/// All corners of a face.
const ALL_CORNERS: [u8; 3] = [0, 1, 2];

/// The corners of each edge of a face without area, as a triangle that is a segment; or all corners
/// of another face.
fn edges_of(is_flat: bool) -> impl Iterator<Item = [u8; 3]> + Clone {
    let edges = (0..3).map(|corner| [corner, (corner + 1) % 3, (corner + 1) % 3]);
    edges.take(if is_flat { 3 } else { 0 }).chain((!is_flat).then_some(ALL_CORNERS))
}

/// A corner, edge or face of a mesh, whichever faces share it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Name {
    Vertex(u32),
    Edge(u32, u32),
    Face(u32),
}

/// Names of a mesh's parts; vertices at one position have one name, as many formats repeat a vertex for each of its
/// faces.
struct Names<'a> {
    mesh: &'a Mesh,
    vertices: HashMap<[u64; 3], u32>,
}

impl<'a> Names<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, vertices: HashMap::new() }
    }

    /// The name of a feature of a triangle whose corners are these ones of a face.
    fn name(&mut self, face: u32, corners: &[u8; 3], feature: Feature) -> Name {
        match feature {
            Feature::Vertex(corner) => Name::Vertex(self.vertex(face, corners[usize::from(corner)])),
            Feature::Edge(corner) => {
                let [from, to] = [corner, (corner + 1) % 3].map(|end| self.vertex(face, corners[usize::from(end)]));
                if from == to { Name::Vertex(from) } else { Name::Edge(from.min(to), from.max(to)) }
            }
            Feature::Face => Name::Face(face),
        }
    }

    /// The first vertex met that lies where this one does.
    fn vertex(&mut self, face: u32, corner: u8) -> u32 {
        let vertex = self.mesh.faces()[face as usize][usize::from(corner)];
        let position = self.mesh.positions().get(vertex as usize);
        // Adding zero turns the negative zero into the positive one.
        *self.vertices.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(vertex)
    }
}

/// Ends of pieces and the pieces between them.
struct Graph<'p> {
    points: &'p [[f64; 3]],
    neighbours: Vec<Vec<usize>>,
}

impl Graph<'_> {
    /// Joins two ends, once: a piece along an edge is found from both faces of the edge.
    fn link(&mut self, from: usize, to: usize) {
        if !self.neighbours[from].contains(&to) {
            self.neighbours[from].push(to);
            self.neighbours[to].push(from);
        }
    }

    /// Open polylines first, from the ends and junctions; what is left over are rings.
    fn into_polylines(mut self) -> Vec<Vec<[f64; 3]>> {
        let is_passage: Vec<bool> = self.neighbours.iter().map(|neighbours| neighbours.len() == 2).collect();
        let mut polylines = Vec::new();
        for start in 0..is_passage.len() {
            while !is_passage[start] && !self.neighbours[start].is_empty() {
                polylines.push(self.walk(start, &is_passage));
            }
        }
        for start in 0..is_passage.len() {
            if !self.neighbours[start].is_empty() {
                polylines.push(self.walk(start, &is_passage));
            }
        }
        polylines
    }

    /// Follows and removes pieces from `start` to the next node that is no passage, or back to the start.
    fn walk(&mut self, start: usize, is_passage: &[bool]) -> Vec<[f64; 3]> {
        let mut line = vec![self.points[start]];
        let mut at = start;
        while let Some(next) = self.neighbours[at].pop() {
            self.neighbours[next].retain(|&node| node != at);
            line.push(self.points[next]);
            at = next;
            if at == start || !is_passage[at] {
                break;
            }
        }
        line
    }
}

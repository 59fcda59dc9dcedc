//! Intersection curves of two surfaces: the intersections of pairs of triangles, linked into
//! polylines.
//!
//! Each end of a piece lies on one corner, edge or face of each mesh, which is decided exactly.
//! Pieces are linked if these names agree; coordinates are never compared. If two closed meshes
//! intersect in general position, every end is shared by two pieces, so that every curve is closed.
//!
//! Tests: `tests/it/engine/curves.rs`, `tests/it/solids/patches.rs`.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::budget::Budget;
use crate::exact::{Corners, Crossing, Feature, Joint, Placement, joints};
use crate::mesh::{DisjointSets, Mesh, PlacedMesh};
use crate::query::Query;

/// Intersection curves of two surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Polylines in the world frame, each coordinate rounded to nearest. A polyline is closed if
    /// its last point repeats the first. An open polyline ends at the border of a mesh, or at a
    /// point where more than two pieces come together.
    pub polylines: Vec<Vec<[f64; 3]>>,
    /// Points at which the surfaces touch without a curve, in the world frame, each coordinate
    /// rounded to nearest.
    pub points: Vec<[f64; 3]>,
    /// Number of pairs of faces that intersect within one plane. They have no curve of their own,
    /// but the curves of their neighbors run along them.
    pub coplanar_pairs: usize,
}

impl Curves {
    /// Returns the number of closed polylines.
    #[must_use]
    pub fn closed(&self) -> usize {
        self.polylines.iter().filter(|line| line.first() == line.last()).count()
    }

    /// Returns the total length of all polylines, in world units, rounded.
    #[must_use]
    pub fn length(&self) -> f64 {
        let length = |line: &Vec<[f64; 3]>| -> f64 { line.windows(2).map(|ends| distance(ends[0], ends[1])).sum() };
        self.polylines.iter().map(length).sum()
    }
}

fn distance(from: [f64; 3], to: [f64; 3]) -> f64 {
    (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Computes the curves in which the surfaces of two meshes intersect, in the world frame.
///
/// The function never fails. Without an intersection there are no curves and no points. A solid
/// counts as its surface here.
///
/// # Accuracy
/// The pieces and their links are exact. Each coordinate of a point is the exact one, rounded to
/// nearest.
///
/// # Complexity
/// The time of [`intersecting_pairs`](super::intersecting_pairs()), and O(k log k) for k pairs.
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
    Query::new().intersection_curves(a, b)
}

impl Query<'_> {
    /// Computes [`intersection_curves`] of two meshes. If the budget ends the work, there are no
    /// curves.
    #[must_use]
    pub fn intersection_curves<'a, 'b>(self, a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Curves {
        let (a, b) = (a.into(), b.into());
        let budget = self.options.budget;
        let pairs = self.intersecting_pairs(a, b);
        if budget.stopped().is_some() {
            return Curves::default();
        }
        let curves = curves_within([a, b], &pairs, budget);
        if budget.stopped().is_none() { curves } else { Curves::default() }
    }
}

/// Computes the curves in which some pairs of faces intersect, in the world frame. `pairs` are
/// pairs that [`intersecting_pairs`](super::intersecting_pairs()) returned for the same meshes and
/// poses, or some of them.
/// Accuracy is that of [`intersection_curves`].
///
/// # Panics
/// If a face index of a pair is out of range.
#[must_use]
pub fn curves_of_pairs<'a, 'b>(
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    pairs: &[[u32; 2]],
) -> Curves {
    curves_within([a.into(), b.into()], pairs, Budget::unlimited())
}

/// Computes [`curves_of_pairs`] with a budget. If it is spent, curves are missing.
fn curves_within(placed: [PlacedMesh<'_>; 2], pairs: &[[u32; 2]], budget: &Budget<'_>) -> Curves {
    let crossings = crossings(placed, pairs, budget);
    if budget.stopped().is_some() { Curves::default() } else { Linked::new(placed, &crossings, budget).curves() }
}

/// Pair of faces with its intersection.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairCrossing {
    pub(super) pair: [u32; 2],
    pub(super) crossing: Crossing<Joint>,
}

/// Minimum number of pairs that a thread takes at a time. With fewer pairs, threads cost more than
/// they save.
const MIN_PAIRS_PER_TASK: usize = 64;

/// Number of pairs between two checks of the budget.
const PAIRS_PER_STEP: usize = 64;

/// Computes the intersection of each pair of faces. If the budget is spent, there may be none, or
/// some may be left apart.
pub(super) fn crossings(placed: [PlacedMesh<'_>; 2], pairs: &[[u32; 2]], budget: &Budget<'_>) -> Vec<PairCrossing> {
    let placement = Placement::new(&placed[0].world_from_mesh, &placed[1].world_from_mesh);
    let of_pair = |(at, &pair): (usize, &[u32; 2])| {
        if budget.stopped().is_some() || (at % PAIRS_PER_STEP == 0 && budget.is_spent()) {
            return PairCrossing { pair, crossing: Crossing::Apart };
        }
        let [a, b] = corners(placed, pair);
        PairCrossing { pair, crossing: joints(&placement, &a, &b) }
    };
    let mut found = Vec::new();
    if budget.reserve(&mut found, pairs.len()) {
        pairs.par_iter().enumerate().with_min_len(MIN_PAIRS_PER_TASK).map(of_pair).collect_into_vec(&mut found);
    }
    found
}

fn corners(placed: [PlacedMesh<'_>; 2], pair: [u32; 2]) -> [Corners; 2] {
    [0, 1].map(|side| placed[side].mesh.corners(pair[side]))
}

/// Pieces of the intersection of some pairs of faces. Ends with equal names are one point.
pub(super) struct Linked {
    /// Ends of all pieces, in the world frame.
    pub(super) points: Vec<[f64; 3]>,
    /// Intersection of each pair of faces, with indices into `points` as its ends.
    pub(super) pieces: Vec<Crossing<usize>>,
}

impl Linked {
    /// Links the intersections of pairs of faces. If the budget is spent, there are no pieces.
    pub(super) fn new(placed: [PlacedMesh<'_>; 2], crossings: &[PairCrossing], budget: &Budget<'_>) -> Self {
        let mut names = placed.map(|placed| Names::new(placed.mesh));
        let mut numbers = HashMap::new();
        let mut ends = Vec::new();
        let mut number = |name: [Name; 2], pair: [u32; 2], joint: Joint| {
            if !(budget.reserve(&mut ends, 1) && budget.reserve_entries(&mut numbers, 1)) {
                return 0;
            }
            *numbers.entry(name).or_insert_with(|| {
                ends.push((pair, joint));
                ends.len() - 1
            })
        };
        let mut pieces: Vec<Crossing<usize>> = Vec::new();
        if budget.reserve(&mut pieces, crossings.len()) {
            pieces.extend(crossings.iter().map(|found| {
                found.crossing.map(|joint| {
                    let on = [joint.on_a, joint.on_b];
                    let name = [0, 1].map(|side| names[side].name(found.pair[side], &ALL_CORNERS, on[side]));
                    number(name, found.pair, joint)
                })
            }));
        }
        let placement = Placement::new(&placed[0].world_from_mesh, &placed[1].world_from_mesh);
        // The edges of a face without area overlap. A point on the face lies on two or three of its
        // edges, and each of them gives the point another name.
        let mut same = Vec::new();
        for (found, piece) in crossings.iter().zip(&pieces) {
            let &Crossing::Point(end) = piece else { continue };
            let flat = [0, 1].map(|side| placed[side].mesh.is_degenerate(found.pair[side]));
            if flat == [false; 2] {
                continue;
            }
            let whole = corners(placed, found.pair);
            for at_a in edges_of(flat[0]) {
                for at_b in edges_of(flat[1]) {
                    let at = [at_a, at_b];
                    let [a, b] = [0, 1].map(|side| at[side].map(|corner| whole[side][usize::from(corner)]));
                    if let Crossing::Point(joint) = joints(&placement, &a, &b) {
                        let on = [joint.on_a, joint.on_b];
                        let name = [0, 1].map(|side| names[side].name(found.pair[side], &at[side], on[side]));
                        same.push([end, number(name, found.pair, joint)]);
                    }
                }
            }
        }
        if budget.stopped().is_some() {
            return Self { points: Vec::new(), pieces: Vec::new() };
        }
        let mut sets = DisjointSets::new(ends.len());
        same.iter().for_each(|&[one, other]| sets.join(one as u32, other as u32));
        pieces.iter_mut().for_each(|piece| *piece = piece.map(|end| sets.root(end as u32) as usize));
        let point = |&(pair, joint): &([u32; 2], Joint)| {
            let [a, b] = corners(placed, pair);
            joint.point(&placement, &a, &b)
        };
        Self { points: ends.par_iter().with_min_len(MIN_PAIRS_PER_TASK).map(point).collect(), pieces }
    }

    /// Returns the curves that the pieces make.
    pub(super) fn curves(&self) -> Curves {
        let mut graph = Graph { points: &self.points, neighbors: vec![Vec::new(); self.points.len()] };
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
        touching.retain(|&end| graph.neighbors[end].is_empty() && seen.insert(end));
        let points = touching.into_iter().map(|end| self.points[end]).collect();
        Curves { polylines: graph.into_polylines(), points, coplanar_pairs }
    }
}

/// All corners of a face, as indices into it.
const ALL_CORNERS: [u8; 3] = [0, 1, 2];

/// Returns the corners of each edge of a face without area, each edge as a triangle that is a
/// segment. Returns all corners of any other face.
fn edges_of(is_flat: bool) -> impl Iterator<Item = [u8; 3]> + Clone {
    let edges = (0..3).map(|corner| [corner, (corner + 1) % 3, (corner + 1) % 3]);
    edges.take(if is_flat { 3 } else { 0 }).chain((!is_flat).then_some(ALL_CORNERS))
}

/// Name of a corner, edge or face of a mesh. It is the same from every face that shares the
/// feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Name {
    Vertex(u32),
    Edge(u32, u32),
    Face(u32),
}

/// Names of the features of a mesh. Vertices at one position have one name, because many file
/// formats repeat a vertex for each of its faces.
struct Names<'a> {
    mesh: &'a Mesh,
    vertices: HashMap<[u64; 3], u32>,
}

impl<'a> Names<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, vertices: HashMap::new() }
    }

    /// Returns the name of a feature of a triangle whose corners are the given corners of a face.
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

    /// Returns the first vertex seen at the position of a corner.
    fn vertex(&mut self, face: u32, corner: u8) -> u32 {
        let vertex = self.mesh.faces()[face as usize][usize::from(corner)];
        let position = self.mesh.positions().get(vertex as usize);
        // Adding zero turns the negative zero into the positive one.
        *self.vertices.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(vertex)
    }
}

/// Graph of the ends of pieces; its edges are the pieces.
struct Graph<'p> {
    points: &'p [[f64; 3]],
    neighbors: Vec<Vec<usize>>,
}

impl Graph<'_> {
    /// Links two ends, once: a piece along an edge of a mesh is found from both faces at the edge.
    fn link(&mut self, from: usize, to: usize) {
        if !self.neighbors[from].contains(&to) {
            self.neighbors[from].push(to);
            self.neighbors[to].push(from);
        }
    }

    /// Returns the polylines: first the open ones, from ends and junctions, then the closed ones.
    fn into_polylines(mut self) -> Vec<Vec<[f64; 3]>> {
        let is_passage: Vec<bool> = self.neighbors.iter().map(|neighbors| neighbors.len() == 2).collect();
        let mut polylines = Vec::new();
        for start in 0..is_passage.len() {
            while !is_passage[start] && !self.neighbors[start].is_empty() {
                polylines.push(self.walk(start, &is_passage));
            }
        }
        for start in 0..is_passage.len() {
            if !self.neighbors[start].is_empty() {
                polylines.push(self.walk(start, &is_passage));
            }
        }
        polylines
    }

    /// Follows and removes pieces from `start` to the next node that does not have two neighbors,
    /// or back to the start. Returns the points on the way.
    fn walk(&mut self, start: usize, is_passage: &[bool]) -> Vec<[f64; 3]> {
        let mut line = vec![self.points[start]];
        let mut at = start;
        while let Some(next) = self.neighbors[at].pop() {
            self.neighbors[next].retain(|&node| node != at);
            line.push(self.points[next]);
            at = next;
            if at == start || !is_passage[at] {
                break;
            }
        }
        line
    }
}

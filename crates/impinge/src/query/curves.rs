//! Intersection curves: what pairs of triangles have in common, linked into polylines.
//!
//! Each end of a piece lies on one corner, edge or face of either mesh, decided exactly; pieces are linked where these
//! names agree and never by comparing coordinates. Where two closed meshes meet in general position every end is shared
//! by two pieces, so that every curve closes.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::exact::{Crossing, Endpoint, Feature, Placement, crossing};
use crate::mesh::{Mesh, Placed};
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
pub fn intersection_curves<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Curves {
    let (a, b) = (a.into(), b.into());
    curves_of_pairs(a, b, &intersecting_pairs(a, b))
}

/// [`intersection_curves`], for pairs that are at hand already: what [`intersecting_pairs`] returned, or some of it.
///
/// # Panics
/// Where a pair names a face that a mesh does not have.
#[must_use]
pub fn curves_of_pairs<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, pairs: &[[u32; 2]]) -> Curves {
    let (a, b) = (a.into(), b.into());
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let crossings: Vec<Crossing> = pairs
        .par_iter()
        .map(|&[face_a, face_b]| crossing(&placement, &a.mesh.corners(face_a), &b.mesh.corners(face_b)))
        .collect();
    curves_of_crossings([a.mesh, b.mesh], pairs.iter().copied().zip(&crossings))
}

/// The curves of pairs of faces of two meshes, and of what these have in common.
pub(super) fn curves_of_crossings<'c>(
    meshes: [&Mesh; 2],
    met: impl Iterator<Item = ([u32; 2], &'c Crossing)>,
) -> Curves {
    let mut names = meshes.map(Names::new);
    let mut graph = Graph::default();
    let mut coplanar_pairs = 0;
    let mut touching = Vec::new();
    for (pair, crossing) in met {
        let mut node = |end: &Endpoint| {
            let [on_a, on_b] = &mut names;
            graph.node((on_a.name(pair[0], end.on_a), on_b.name(pair[1], end.on_b)), end.point)
        };
        match crossing {
            Crossing::Apart => {}
            Crossing::Coplanar => coplanar_pairs += 1,
            Crossing::Point(end) => touching.push(node(end)),
            Crossing::Segment(from, to) => {
                let (from, to) = (node(from), node(to));
                graph.link(from, to);
            }
        }
    }
    let mut seen = HashSet::new();
    touching.retain(|&node| graph.neighbours[node].is_empty() && seen.insert(node));
    let points = touching.into_iter().map(|node| graph.points[node]).collect();
    Curves { polylines: graph.into_polylines(), points, coplanar_pairs }
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

    fn name(&mut self, face: u32, feature: Feature) -> Name {
        match feature {
            Feature::Vertex(corner) => Name::Vertex(self.vertex(face, corner)),
            Feature::Edge(corner) => {
                let (from, to) = (self.vertex(face, corner), self.vertex(face, (corner + 1) % 3));
                Name::Edge(from.min(to), from.max(to))
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
#[derive(Default)]
struct Graph {
    nodes: HashMap<(Name, Name), usize>,
    points: Vec<[f64; 3]>,
    neighbours: Vec<Vec<usize>>,
}

impl Graph {
    fn node(&mut self, name: (Name, Name), point: [f64; 3]) -> usize {
        *self.nodes.entry(name).or_insert_with(|| {
            self.points.push(point);
            self.neighbours.push(Vec::new());
            self.points.len() - 1
        })
    }

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

//! Vertices that are moved to an earlier one within a tolerance.
//!
//! Space is divided into cells whose edge is the tolerance. Vertices that stay are farther apart than
//! that, so a cell and its neighbors hold a bounded number of them.

use std::collections::{BTreeSet, HashMap};

use super::super::topology::Topology;
use super::super::{Mesh, Positions};

/// Maximum number of open edges for which a tolerance is searched. A mesh with more of them is no
/// cracked solid, and each step of the search takes some microseconds an edge.
const MOST_OPEN_EDGES: usize = 1 << 17;

/// Positions after welding.
pub(super) struct Welded {
    pub(super) positions: Positions,
    /// The vertices that were moved, ascending.
    pub(super) moved: Vec<u32>,
    pub(super) greatest_move: f64,
}

/// Moves each vertex to the nearest earlier one that has stayed, if it is within the tolerance.
pub(super) fn welded(positions: &Positions, tolerance: f64) -> Welded {
    let mut positions = positions.clone();
    let (mut moved, mut greatest_move) = (Vec::new(), 0.0_f64);
    let mut stayed = Stayed::new(tolerance);
    for vertex in 0..positions.len() as u32 {
        let at = positions.get(vertex as usize);
        let Some(target) = stayed.nearest_or_insert(vertex, at) else { continue };
        let move_by = distance(at, positions.get(target as usize));
        if move_by > 0.0 {
            match &mut positions {
                Positions::F32(vertices) => vertices[vertex as usize] = vertices[target as usize],
                Positions::F64(vertices) => vertices[vertex as usize] = vertices[target as usize],
            }
            moved.push(vertex);
            greatest_move = greatest_move.max(move_by);
        }
    }
    Welded { positions, moved, greatest_move }
}

/// See [`Mesh::closing_tolerance`].
pub(super) fn closing_tolerance(mesh: &Mesh) -> Option<f64> {
    let open = open_edges(mesh.faces(), |vertex| mesh.topology().first_at[vertex as usize]);
    let mut vertices: Vec<u32> = open.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    if open.is_empty() || open.len() > MOST_OPEN_EDGES {
        return None;
    }
    let [least, greatest] = mesh.local_bounds()?;
    let size = (0..3).fold(0.0_f64, |size, axis| size.max(greatest[axis] - least[axis]));
    if size == 0.0 {
        return None;
    }
    let exponent = size.log10().ceil() as i32;
    (exponent - 16..=exponent - 4).map(power_of_ten).filter(|&tolerance| tolerance > 0.0).find(|&tolerance| {
        let mut stayed = Stayed::new(tolerance);
        let target = |&vertex: &u32| {
            let found = stayed.nearest_or_insert(vertex, mesh.positions().get(vertex as usize));
            (vertex, found.unwrap_or(vertex))
        };
        let targets: HashMap<u32, u32> = vertices.iter().map(target).collect();
        let mut left = BTreeSet::new();
        for edge in &open {
            let [p, q] = edge.map(|vertex| targets[&vertex]);
            // Twice the same edge closes it.
            if p != q && !left.insert([p.min(q), p.max(q)]) {
                left.remove(&[p.min(q), p.max(q)]);
            }
        }
        // Vertices of no open edge may draw others away from their counterparts.
        left.is_empty() && {
            let positions = welded(mesh.positions(), tolerance).positions;
            let names = Topology::of(&positions, mesh.faces()).first_at;
            open_edges(mesh.faces(), |vertex| names[vertex as usize]).is_empty()
        }
    })
}

/// Returns the floating-point number nearest to a power of ten. `powi` may round otherwise, and
/// differently on other machines.
fn power_of_ten(power: i32) -> f64 {
    format!("1e{power}").parse().unwrap_or(0.0)
}

/// Returns the edges that an odd number of faces have, between the names of their vertices.
fn open_edges(faces: &[[u32; 3]], name: impl Fn(u32) -> u32) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = faces
        .iter()
        .map(|face| face.map(&name))
        .flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]])
        .filter(|[p, q]| p != q)
        .map(|[p, q]| [p.min(q), p.max(q)])
        .collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect()
}

/// Returns the distance of two points without overflow or underflow on the way.
fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    let step: [f64; 3] = std::array::from_fn(|k| (p[k] - q[k]).abs());
    let most = step.into_iter().fold(0.0, f64::max);
    if most == 0.0 { 0.0 } else { most * step.iter().map(|x| (x / most).powi(2)).sum::<f64>().sqrt() }
}

/// Vertices that have stayed, by the cell that they are in.
struct Stayed {
    tolerance: f64,
    cells: HashMap<[i64; 3], Vec<(u32, [f64; 3])>>,
}

impl Stayed {
    fn new(tolerance: f64) -> Self {
        Self { tolerance, cells: HashMap::new() }
    }

    /// Returns the nearest vertex that has stayed, the first of equally near ones. If none is within
    /// the tolerance, this vertex stays.
    fn nearest_or_insert(&mut self, vertex: u32, at: [f64; 3]) -> Option<u32> {
        let places = at.map(|x| Place::of(x, self.tolerance));
        let mut nearest: Option<(f64, u32)> = None;
        for x in places[0].neighbors() {
            for y in places[1].neighbors() {
                for z in places[2].neighbors() {
                    for &(other, point) in self.cells.get(&[x, y, z]).into_iter().flatten() {
                        // In units of the tolerance, so that no square vanishes or overflows.
                        let step = [0, 1, 2].map(|k| (at[k] - point[k]) / self.tolerance);
                        let distance = step.iter().map(|x| x * x).sum::<f64>().sqrt();
                        if distance <= 1.0 && nearest.is_none_or(|found| (distance, other) < found) {
                            nearest = Some((distance, other));
                        }
                    }
                }
            }
        }
        if nearest.is_none() {
            self.cells.entry(places.map(Place::cell)).or_default().push((vertex, at));
        }
        nearest.map(|(_, other)| other)
    }
}

/// Where a coordinate is on the grid.
#[derive(Clone, Copy)]
enum Place {
    /// The number of its cell.
    Cell(i64),
    /// Where neighboring floating-point numbers are farther apart than the tolerance, the bits of
    /// the number.
    Alone(i64),
}

impl Place {
    fn of(x: f64, tolerance: f64) -> Self {
        /// From here on neighboring numbers differ by at least two.
        const SPARSE: f64 = (1_u64 << 54) as f64;
        let cell = (x / tolerance).floor();
        // Adding zero turns the negative zero into the positive one.
        if cell.abs() < SPARSE { Self::Cell(cell as i64) } else { Self::Alone((x + 0.0).to_bits().cast_signed()) }
    }

    fn cell(self) -> i64 {
        match self {
            Self::Cell(cell) | Self::Alone(cell) => cell,
        }
    }

    /// The cells in which a number within the tolerance may be.
    fn neighbors(self) -> std::ops::RangeInclusive<i64> {
        match self {
            Self::Cell(cell) => cell - 1..=cell + 1,
            Self::Alone(cell) => cell..=cell,
        }
    }
}

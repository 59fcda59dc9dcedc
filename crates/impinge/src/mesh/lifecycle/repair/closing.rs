//! Finds a tolerance at which welding closes a cracked mesh.
//!
//! An edge is open if an odd number of faces have it. Each power of ten is first tried with the
//! vertices of open edges alone, and then with all vertices, as other vertices may attract some of
//! them.

use std::collections::HashMap;

use super::weld::{Stayed, welded};
use crate::mesh::Mesh;
use crate::mesh::derived::topology::Topology;

/// Maximum number of open edges for which a tolerance is searched. A mesh with more of them is not
/// a cracked solid, and each step of the search takes some microseconds per edge.
const MAX_OPEN_EDGES: usize = 1 << 17;

/// Returns the tolerance of [`Mesh::closing_tolerance`].
pub(super) fn closing_tolerance(mesh: &Mesh) -> Option<f64> {
    let open = open_edges(mesh.faces(), &mesh.topology().first_at);
    if open.is_empty() || open.len() > MAX_OPEN_EDGES {
        return None;
    }
    let mut vertices: Vec<u32> = open.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let closes_alone = |tolerance: f64| {
        let mut stayed = Stayed::new(tolerance);
        let target = |&vertex: &u32| {
            let found = stayed.nearest_or_insert(vertex, mesh.positions().get(vertex as usize));
            (vertex, found.unwrap_or(vertex))
        };
        let targets: HashMap<u32, u32> = vertices.iter().map(target).collect();
        odd_edges(open.iter().map(|edge| edge.map(|vertex| targets[&vertex]))).is_empty()
    };
    let closes = |tolerance: f64| {
        let positions = welded(mesh.positions(), tolerance).positions;
        open_edges(mesh.faces(), &Topology::of(&positions, mesh.faces()).first_at).is_empty()
    };
    let [least, greatest] = mesh.local_bounds()?;
    let size = (0..3).fold(0.0_f64, |size, axis| size.max(greatest[axis] - least[axis]));
    let exponent = (size > 0.0).then(|| size.log10().ceil() as i32)?;
    (exponent - 16..=exponent - 4)
        .map(power_of_ten)
        .find(|&tolerance| tolerance > 0.0 && closes_alone(tolerance) && closes(tolerance))
}

/// Returns the floating-point number nearest to a power of ten, or zero if it is too small. `powi`
/// rounds differently, and not the same on all machines.
fn power_of_ten(power: i32) -> f64 {
    format!("1e{power}").parse().unwrap_or(0.0)
}

/// Returns the open edges of some faces. A vertex is replaced by its name: the first vertex at its
/// position.
fn open_edges(faces: &[[u32; 3]], names: &[u32]) -> Vec<[u32; 2]> {
    let named = faces.iter().map(|face| face.map(|vertex| names[vertex as usize]));
    odd_edges(named.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]))
}

/// Returns the edges that occur an odd number of times, in either direction, and that have two
/// different ends.
fn odd_edges(edges: impl Iterator<Item = [u32; 2]>) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = edges.filter(|[p, q]| p != q).map(|[p, q]| [p.min(q), p.max(q)]).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect()
}

//! Regions in which two surfaces intersect, each with its curves, a normal, an area and a depth.
//!
//! Two pairs of intersecting faces belong to one region if they share a face. A piece of the curve
//! runs along the cross product of the normals of its two faces. So the curve goes around the inner
//! part of either surface in one sense. Half the sum of the cross products of the ends of the
//! pieces is the area of the region as a vector. The vector points from A to B whatever the shape
//! of the region is, and holes are subtracted. The depth of the region along this normal comes from
//! the vertices of each mesh that are inside the other (`interior`). They are found from the
//! vertices at the curve by going from vertex to vertex.
//!
//! Tests: `tests/it/solids/patches.rs`.

mod contacts;
mod interior;
mod near;

use std::collections::{HashMap, HashSet};

use super::Query;
use super::curves::{Curves, Linked, PairCrossing, crossings};
use crate::budget::Budget;
use crate::convex::to_unit_length;
use crate::exact::Crossing;
use crate::math::vec3::{cross, dot, length, sub};
use crate::mesh::PlacedMesh;
pub(crate) use contacts::contacts_of_patches;
use interior::Interior;

/// A connected group of intersecting faces of two meshes: pairs of faces that share a face belong
/// together. It has the curves along which the surfaces intersect there, and a normal, an area and
/// a depth. [`contact_patches`] states how accurate they are.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPatch {
    /// Direction of length 1 from the first mesh to the second, in the world frame, rounded. It is
    /// the direction of the vector area that the curves enclose, or the normal of a face of the
    /// first mesh if that is zero. Corners of faces must be in counterclockwise order seen from
    /// outside.
    pub normal: [f64; 3],
    /// Area that the curves enclose, seen along the normal, in square world units, rounded.
    pub area: f64,
    /// Depth of the region along the normal, in world units, rounded; never negative. It is how far
    /// the part of the first mesh that is inside the second reaches beyond the part of the second
    /// mesh that is inside the first.
    pub depth: f64,
    /// Curves in which the surfaces intersect in this region, in the world frame.
    pub curves: Curves,
    /// Pairs of faces that intersect in this region, sorted: the index of a face of the first mesh,
    /// then of a face of the second.
    pub pairs: Vec<[u32; 2]>,
    /// For each mesh, the indices of its vertices that are inside the other mesh and connected to
    /// the curves of this region, in ascending order. Of several vertices at one position only the
    /// first is listed.
    pub inside: [Vec<u32>; 2],
}

/// Computes the regions in which the surfaces of two meshes intersect, ordered by their first pairs
/// of faces.
///
/// The function never fails. The list is empty if the surfaces do not intersect. A solid counts as
/// its surface here.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // Its tip, one unit deep in the floor of a copy.
/// let patches = query::contact_patches(&mesh, mesh.at(Pose::from_translation([-1.0, -1.0, 7.0])?));
/// assert_eq!(patches.len(), 1);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// Pairs, curves and vertices of a region are exact for closed meshes. Its normal, area and depth
/// are sums of floats. A region without area, for example of surfaces that only touch, gets the
/// normal of a face of the first mesh.
///
/// # Complexity
/// The time of [`intersecting_pairs`](super::intersecting_pairs()), and O(k log k) for k pairs.
/// Each side of each curve takes the time of [`Mesh::contains`](crate::Mesh::contains) for one
/// point; if a mesh is open, each vertex at the curve does. A region with vertices inside takes
/// linear time in their number. The first such query of a mesh takes O(n).
#[must_use]
pub fn contact_patches<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Vec<ContactPatch> {
    regions_of([a.into(), b.into()], Budget::unlimited()).into_iter().map(|region| region.patch).collect()
}

/// Returns the area and the normal of each region in which the surfaces of two meshes intersect, as
/// [`ContactPatch`] has them. If the budget is spent, there may be none.
pub(crate) fn normals_of_regions(placed: [PlacedMesh<'_>; 2], budget: &Budget<'_>) -> Vec<(f64, [f64; 3])> {
    let pairs = Query::new().with_budget(budget).intersecting_pairs(placed[0], placed[1]);
    let all = crossings(placed, &pairs, budget);
    if budget.stopped().is_some() {
        return Vec::new();
    }
    let area = |found: Vec<PairCrossing>| area_and_normal(placed, &found, &Linked::new(placed, &found, budget));
    connected(all, |crossing| crossing.pair).into_iter().map(area).collect()
}

/// A region with its pairs and the pieces of its curves.
struct Region {
    patch: ContactPatch,
    crossings: Vec<PairCrossing>,
    linked: Linked,
}

/// Returns the regions in which two meshes intersect. If the budget is spent, some are missing.
fn regions_of(placed: [PlacedMesh<'_>; 2], budget: &Budget<'_>) -> Vec<Region> {
    let pairs = Query::new().with_budget(budget).intersecting_pairs(placed[0], placed[1]);
    if pairs.is_empty() {
        return Vec::new();
    }
    let all = crossings(placed, &pairs, budget);
    if budget.stopped().is_some() {
        return Vec::new();
    }
    let mut sides = [0, 1].map(|side| Interior::new(placed, &all, side, budget));
    let regions = connected(all, |crossing| crossing.pair).into_iter().take_while(|_| !budget.is_spent());
    regions.map(|crossings| region(placed, &mut sides, crossings, budget)).collect()
}

/// Groups things by their pairs of faces: pairs that share a face are in one group.
fn connected<T>(all: Vec<T>, pair_of: impl Fn(&T) -> [u32; 2]) -> Vec<Vec<T>> {
    let mut roots: Vec<usize> = (0..all.len()).collect();
    let mut first: [HashMap<u32, usize>; 2] = Default::default();
    for (number, thing) in all.iter().enumerate() {
        let pair = pair_of(thing);
        for side in 0..2 {
            let other = *first[side].entry(pair[side]).or_insert(number);
            let (one, other) = (root(&mut roots, number), root(&mut roots, other));
            roots[one.max(other)] = one.min(other);
        }
    }
    let mut found: Vec<Vec<T>> = Vec::new();
    let mut number_of = HashMap::new();
    for (number, thing) in all.into_iter().enumerate() {
        let root = root(&mut roots, number);
        let group = *number_of.entry(root).or_insert(found.len());
        if group == found.len() {
            found.push(Vec::new());
        }
        found[group].push(thing);
    }
    found
}

fn root(roots: &mut [usize], mut number: usize) -> usize {
    while roots[number] != number {
        roots[number] = roots[roots[number]];
        number = roots[number];
    }
    number
}

fn region(
    placed: [PlacedMesh<'_>; 2],
    sides: &mut [Interior<'_>; 2],
    crossings: Vec<PairCrossing>,
    budget: &Budget<'_>,
) -> Region {
    let linked = Linked::new(placed, &crossings, budget);
    let curves = linked.curves();
    let (area, normal) = area_and_normal(placed, &crossings, &linked);
    let inside = [0, 1].map(|side| sides[side].of_region(crossings.iter().map(|found| found.pair[side])));
    let pairs = crossings.iter().map(|found| found.pair).collect();
    let line = || curves.polylines.iter().flatten().chain(&curves.points).map(|point| dot(&normal, point));
    let heights = |side: usize| {
        let PlacedMesh { mesh, world_from_mesh, .. } = placed[side];
        inside[side]
            .iter()
            .map(move |&vertex| dot(&normal, &world_from_mesh.apply(mesh.positions().get(vertex as usize))))
    };
    let top = heights(0).chain(line()).fold(f64::NEG_INFINITY, f64::max);
    let bottom = heights(1).chain(line()).fold(f64::INFINITY, f64::min);
    let depth = if top > bottom { top - bottom } else { 0.0 };
    Region { patch: ContactPatch { normal, area, depth, curves, pairs, inside }, crossings, linked }
}

/// Returns the area that the curves of a region go around, and a direction of length 1 across it.
fn area_and_normal(placed: [PlacedMesh<'_>; 2], crossings: &[PairCrossing], linked: &Linked) -> (f64, [f64; 3]) {
    let mirrors = placed[0].world_from_mesh.mirrors() != placed[1].world_from_mesh.mirrors();
    let mut pieces = HashSet::new();
    let mut area = [0.0; 3];
    let mut about: Option<[f64; 3]> = None;
    for piece in &linked.pieces {
        let Crossing::Segment(from, to) = piece.map(|end| linked.points[end]) else { continue };
        // A piece along an edge of a mesh is found from every face at the edge.
        if !pieces.insert([from, to].map(|end| end.map(f64::to_bits))) {
            continue;
        }
        let origin = *about.get_or_insert(from);
        let product = cross(&sub(&from, &origin), &sub(&to, &origin));
        area = std::array::from_fn(|k| area[k] + 0.5 * product[k]);
    }
    if mirrors {
        area = area.map(|x| -x);
    }
    let magnitude = length(&area);
    let normal = if magnitude > 0.0 { to_unit_length(area) } else { face_normal(placed[0], crossings[0].pair[0]) };
    (magnitude, normal)
}

/// Returns the normal of a face in the world frame. A face without area gets a coordinate axis.
fn face_normal(placed: PlacedMesh<'_>, face: u32) -> [f64; 3] {
    let [p, q, r] = placed.mesh.corners(face).map(|corner| placed.world_from_mesh.apply(corner));
    let area = cross(&sub(&q, &p), &sub(&r, &p));
    let sign = if placed.world_from_mesh.mirrors() { -1.0 } else { 1.0 };
    to_unit_length(area.map(|x| sign * x))
}

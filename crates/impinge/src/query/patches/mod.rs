//! The regions in which two surfaces go through each other, each with its curves, a normal, an area and a depth.
//!
//! Pairs of faces that meet are one region where they share a face. A piece of the curve runs along the product of its
//! faces' normals, so it goes round what either surface has inside the other in one sense, and half the sum of the
//! products of its ends is the region's area as a vector: its direction is from A to B, whatever the region's shape is,
//! and holes count against it. How deep the region is along that normal is read off the corners of either surface inside
//! the other, which are found from those at the curve by going from corner to corner (`interior`).

mod contacts;
mod interior;

use std::collections::{HashMap, HashSet};

use super::curves::{Curves, Linked, Met, met};
use super::intersecting_pairs;
use crate::convex::to_unit_length;
use crate::exact::Crossing;
use crate::math::vec3::{cross, dot, length, sub};
use crate::mesh::PlacedMesh;
pub(crate) use contacts::contacts_of_patches;
use interior::Interior;

/// A region in which the surfaces of two meshes go through each other.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPatch {
    /// A direction of length 1 from the first mesh to the second, in the world frame: that of the area that the curves go
    /// round. Faces are taken to turn left seen from outside.
    pub normal: [f64; 3],
    /// The area that the curves go round, seen along the normal, in square world units, rounded.
    pub area: f64,
    /// How far the part of the first mesh inside the second reaches along the normal beyond that of the second inside the
    /// first, in world units, rounded; never negative.
    pub depth: f64,
    /// The curves in which the surfaces meet here, in the world frame.
    pub curves: Curves,
    /// The pairs of faces that meet here, sorted.
    pub pairs: Vec<[u32; 2]>,
    /// The vertices of either mesh that are inside the other and hang together with the curves, ascending.
    pub inside: [Vec<u32>; 2],
}

/// The regions in which the surfaces of two meshes meet, by their first pairs.
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
/// Which pairs, curves and vertices a region has is exact for closed meshes; its normal, area and depth are sums in floats. A region
/// that has no area, as of surfaces that only touch, has as its normal that of a face of the first mesh.
///
/// # Complexity
/// That of [`intersecting_pairs`], O(k log k) for k pairs, and for each side of each curve, or each vertex there where a mesh is
/// open, that of [`Mesh::contains`](crate::Mesh::contains) for one point. Regions with vertices inside take as long as these are
/// many; O(n) the first time that a mesh is asked.
#[must_use]
pub fn contact_patches<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Vec<ContactPatch> {
    regions_of([a.into(), b.into()]).into_iter().map(|region| region.patch).collect()
}

/// The area of each region in which the surfaces of two meshes meet, and its normal, as [`ContactPatch`] tells them.
pub(crate) fn normals_of_regions(placed: [PlacedMesh<'_>; 2]) -> Vec<(f64, [f64; 3])> {
    let pairs = intersecting_pairs(placed[0], placed[1]);
    let area = |met: Vec<Met>| area_and_normal(placed, &met, &Linked::new(placed, &met));
    connected(met(placed, &pairs)).into_iter().map(area).collect()
}

/// A region, with its pairs and the pieces of its curves.
struct Region {
    patch: ContactPatch,
    met: Vec<Met>,
    linked: Linked,
}

/// The regions in which two meshes meet.
fn regions_of(placed: [PlacedMesh<'_>; 2]) -> Vec<Region> {
    let pairs = intersecting_pairs(placed[0], placed[1]);
    if pairs.is_empty() {
        return Vec::new();
    }
    let met = met(placed, &pairs);
    let mut sides = [0, 1].map(|side| Interior::new(placed, &met, side));
    connected(met).into_iter().map(|met| region(placed, &mut sides, met)).collect()
}

/// Pairs that are connected by faces that they share.
fn connected(all: Vec<Met>) -> Vec<Vec<Met>> {
    let mut roots: Vec<usize> = (0..all.len()).collect();
    let mut first: [HashMap<u32, usize>; 2] = Default::default();
    for (number, met) in all.iter().enumerate() {
        for side in 0..2 {
            let other = *first[side].entry(met.pair[side]).or_insert(number);
            let (one, other) = (root(&mut roots, number), root(&mut roots, other));
            roots[one.max(other)] = one.min(other);
        }
    }
    let mut found: Vec<Vec<Met>> = Vec::new();
    let mut number_of = HashMap::new();
    for (number, met) in all.into_iter().enumerate() {
        let root = root(&mut roots, number);
        let region = *number_of.entry(root).or_insert(found.len());
        if region == found.len() {
            found.push(Vec::new());
        }
        found[region].push(met);
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

fn region(placed: [PlacedMesh<'_>; 2], sides: &mut [Interior<'_>; 2], met: Vec<Met>) -> Region {
    let linked = Linked::new(placed, &met);
    let curves = linked.curves();
    let (area, normal) = area_and_normal(placed, &met, &linked);
    let inside = [0, 1].map(|side| sides[side].of_region(met.iter().map(|met| met.pair[side])));
    let pairs = met.iter().map(|met| met.pair).collect();
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
    Region { patch: ContactPatch { normal, area, depth, curves, pairs, inside }, met, linked }
}

/// The area that the curves of a region go round, and a direction of length 1 across it.
fn area_and_normal(placed: [PlacedMesh<'_>; 2], met: &[Met], linked: &Linked) -> (f64, [f64; 3]) {
    let mirrors = placed[0].world_from_mesh.mirrors() != placed[1].world_from_mesh.mirrors();
    let mut pieces = HashSet::new();
    let mut area = [0.0; 3];
    let mut about: Option<[f64; 3]> = None;
    for piece in &linked.pieces {
        let Crossing::Segment(from, to) = piece.map(|end| linked.points[end]) else { continue };
        // A piece along an edge is found from every face there.
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
    let normal = if magnitude > 0.0 { to_unit_length(area) } else { face_normal(placed[0], met[0].pair[0]) };
    (magnitude, normal)
}

/// The normal of a face in the world; along an axis where it has none.
fn face_normal(placed: PlacedMesh<'_>, face: u32) -> [f64; 3] {
    let [p, q, r] = placed.mesh.corners(face).map(|corner| placed.world_from_mesh.apply(corner));
    let area = cross(&sub(&q, &p), &sub(&r, &p));
    let sign = if placed.world_from_mesh.mirrors() { -1.0 } else { 1.0 };
    to_unit_length(area.map(|x| sign * x))
}

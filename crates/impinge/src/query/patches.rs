//! The regions in which two surfaces go through each other, each with its curves, a normal, an area and a depth.
//!
//! Pairs of faces that meet are one region where they share a face. A piece of the curve runs along the product of its
//! faces' normals, so it goes round what either surface has inside the other in one sense, and half the sum of the
//! products of its ends is the region's area as a vector: its direction is from A to B, whatever the region's shape is,
//! and holes count against it. How deep the region is along that normal is read off the corners of either surface inside
//! the other, which are found from those at the curve by going from corner to corner.

use std::collections::{HashMap, HashSet};

use super::curves::{Curves, curves_of_pairs};
use super::intersecting_pairs;
use crate::convex::{Contact, Contacts, Feature, to_unit_length};
use crate::exact::{self, Crossing, Placement, PosedPoint, Spot, crossing};
use crate::mesh::{Containment, Judge, Mesh, Placed, Ray};
use crate::primitive::{cross, dot, length, sub};

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
/// That of [`intersecting_pairs`], O(k log k) for k pairs, and for each vertex at the curve that of [`Mesh::contains`]. Regions with
/// vertices inside take one look at all faces.
#[must_use]
pub fn contact_patches<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Vec<ContactPatch> {
    let (a, b) = (a.into(), b.into());
    let pairs = intersecting_pairs(a, b);
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let sides = [Side::new(a, b, &pairs, 0), Side::new(b, a, &pairs, 1)];
    regions(&pairs).into_iter().map(|pairs| patch([a, b], &placement, &sides, pairs)).collect()
}

/// The contacts of the regions in which two meshes meet: the vertices of either that are inside the other, over the face that is
/// there along the normal; where there are none, the ends of the curve's pieces, as deep as the region at most.
pub(crate) fn contacts_of_patches(a: Placed<'_>, b: Placed<'_>) -> Vec<Contacts> {
    let placed = [a, b];
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let of_patch = |patch: ContactPatch| {
        let mut contacts = Vec::new();
        for side in 0..2 {
            let (own, other) = (placed[side], placed[1 - side]);
            // Out of the other mesh: back along the normal for the first, along it for the second.
            let out = if side == 0 { patch.normal.map(|x| -x) } else { patch.normal };
            for &vertex in &patch.inside[side] {
                let point = own.world_from_mesh.apply(own.mesh.positions().get(vertex as usize));
                let Some((t, face)) = cast(other, point, out) else { continue };
                let there = std::array::from_fn(|k| point[k] + t * out[k]);
                let slack = t * CAST_ERROR + point.iter().map(|x| x.abs()).sum::<f64>() * CAST_ERROR;
                let (mut points, mut features) = ([point, there], [Feature::Vertex(vertex), Feature::Face(face)]);
                if side == 1 {
                    points.swap(0, 1);
                    features.swap(0, 1);
                }
                contacts.push(Contact { points, lower: t - slack, upper: t + slack, features });
            }
        }
        if contacts.is_empty() {
            contacts = contacts_of_curve(placed, &placement, &patch);
        }
        Contacts { normal: patch.normal, contacts }
    };
    contact_patches(a, b).into_iter().map(of_patch).collect()
}

/// The points of a region's curve, by the corners, edges and faces that they are on.
fn contacts_of_curve(placed: [Placed<'_>; 2], placement: &Placement, patch: &ContactPatch) -> Vec<Contact> {
    let feature = |side: usize, face: u32, on: exact::Feature| {
        let vertices = placed[side].mesh.faces()[face as usize];
        match on {
            exact::Feature::Vertex(corner) => Feature::Vertex(vertices[usize::from(corner)]),
            exact::Feature::Edge(corner) => {
                let (from, to) = (vertices[usize::from(corner)], vertices[(usize::from(corner) + 1) % 3]);
                Feature::Edge(from.min(to), from.max(to))
            }
            exact::Feature::Face => Feature::Face(face),
        }
    };
    let mut known = HashSet::new();
    let mut contacts = Vec::new();
    for &[a, b] in &patch.pairs {
        let ends = match crossing(placement, &placed[0].mesh.corners(a), &placed[1].mesh.corners(b)) {
            Crossing::Segment(from, to) => vec![from, to],
            Crossing::Point(only) => vec![only],
            Crossing::Apart | Crossing::Coplanar => continue,
        };
        for end in ends {
            if known.insert(end.point.map(f64::to_bits)) {
                let features = [feature(0, a, end.on_a), feature(1, b, end.on_b)];
                contacts.push(Contact { points: [end.point; 2], lower: 0.0, upper: patch.depth, features });
            }
        }
    }
    if let (true, Some(&[a, b])) = (contacts.is_empty(), patch.pairs.first()) {
        // Faces in one plane whose borders do not meet are in each other: a corner of the first tells of them.
        let point = placed[0].world_from_mesh.apply(placed[0].mesh.corners(a)[0]);
        let features = [Feature::Face(a), Feature::Face(b)];
        contacts.push(Contact { points: [point; 2], lower: 0.0, upper: patch.depth, features });
    }
    contacts
}

/// What a ray's way and its start in another mesh's frame may be off by, next to their sizes: that of a ray, 2^-40, and of a pose that
/// is inverted.
const CAST_ERROR: f64 = 1.0 / (1_u64 << 38) as f64;

/// How far along a direction of length 1 a mesh's surface is from a point, and which face that is.
fn cast(placed: Placed<'_>, point: [f64; 3], direction: [f64; 3]) -> Option<(f64, u32)> {
    let [x, y, z] = *placed.world_from_mesh.linear();
    let columns = [cross(&y, &z), cross(&z, &x), cross(&x, &y)];
    let determinant = dot(&x, &columns[0]);
    let turn = |v: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|j| (columns[0][j] * v[0] + columns[1][j] * v[1] + columns[2][j] * v[2]) / determinant)
    };
    let ray = Ray::new(turn(&sub(&point, placed.world_from_mesh.translation())), turn(&direction)).ok()?;
    placed.mesh.ray_cast(&ray).map(|hit| (hit.t, hit.face))
}

/// Pairs that are connected by faces that they share.
fn regions(pairs: &[[u32; 2]]) -> Vec<Vec<[u32; 2]>> {
    let mut roots: Vec<usize> = (0..pairs.len()).collect();
    let mut first: [HashMap<u32, usize>; 2] = Default::default();
    for (number, pair) in pairs.iter().enumerate() {
        for side in 0..2 {
            let other = *first[side].entry(pair[side]).or_insert(number);
            let (one, other) = (root(&mut roots, number), root(&mut roots, other));
            roots[one.max(other)] = one.min(other);
        }
    }
    let mut found: Vec<Vec<[u32; 2]>> = Vec::new();
    let mut number_of = HashMap::new();
    for (number, pair) in pairs.iter().enumerate() {
        let root = root(&mut roots, number);
        let region = *number_of.entry(root).or_insert(found.len());
        if region == found.len() {
            found.push(Vec::new());
        }
        found[region].push(*pair);
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

fn patch(placed: [Placed<'_>; 2], placement: &Placement, sides: &[Side<'_>; 2], pairs: Vec<[u32; 2]>) -> ContactPatch {
    let curves = curves_of_pairs(placed[0], placed[1], &pairs);
    let corners = |side: usize, face: u32| placed[side].mesh.corners(face);
    let mirrors = placed[0].world_from_mesh.mirrors() != placed[1].world_from_mesh.mirrors();
    let mut pieces = HashSet::new();
    let mut area = [0.0; 3];
    let mut about: Option<[f64; 3]> = None;
    for &[a, b] in &pairs {
        let Crossing::Segment(from, to) = crossing(placement, &corners(0, a), &corners(1, b)) else { continue };
        // A piece along an edge is found from every face there.
        if !pieces.insert([from.point, to.point].map(|end| end.map(f64::to_bits))) {
            continue;
        }
        let origin = *about.get_or_insert(from.point);
        let product = cross(&sub(&from.point, &origin), &sub(&to.point, &origin));
        area = std::array::from_fn(|k| area[k] + 0.5 * product[k]);
    }
    if mirrors {
        area = area.map(|x| -x);
    }
    let magnitude = length(&area);
    let normal = if magnitude > 0.0 { to_unit_length(area) } else { face_normal(placed[0], pairs[0][0]) };
    let inside = [0, 1].map(|side| sides[side].inside(pairs.iter().map(|pair| pair[side])));
    let line = || curves.polylines.iter().flatten().chain(&curves.points).map(|point| dot(&normal, point));
    let heights = |side: usize| {
        let Placed { mesh, world_from_mesh } = placed[side];
        inside[side]
            .iter()
            .map(move |&vertex| dot(&normal, &world_from_mesh.apply(mesh.positions().get(vertex as usize))))
    };
    let top = heights(0).chain(line()).fold(f64::NEG_INFINITY, f64::max);
    let bottom = heights(1).chain(line()).fold(f64::INFINITY, f64::min);
    let depth = if top > bottom { top - bottom } else { 0.0 };
    ContactPatch { normal, area: magnitude, depth, curves, pairs, inside }
}

/// The normal of a face in the world; along an axis where it has none.
fn face_normal(placed: Placed<'_>, face: u32) -> [f64; 3] {
    let [p, q, r] = placed.mesh.corners(face).map(|corner| placed.world_from_mesh.apply(corner));
    let area = cross(&sub(&q, &p), &sub(&r, &p));
    let sign = if placed.world_from_mesh.mirrors() { -1.0 } else { 1.0 };
    to_unit_length(area.map(|x| sign * x))
}

/// A mesh beside another, with the faces that meet it.
struct Side<'m> {
    mesh: &'m Mesh,
    other: &'m Mesh,
    placement: Placement,
    touched: HashSet<u32>,
    /// The faces at each vertex, named by the first vertex at its position; made when a region has vertices inside.
    faces_at: std::cell::OnceCell<HashMap<u32, Vec<u32>>>,
}

impl<'m> Side<'m> {
    fn new(own: Placed<'m>, other: Placed<'m>, pairs: &[[u32; 2]], side: usize) -> Self {
        Self {
            mesh: own.mesh,
            other: other.mesh,
            placement: Placement::new(&other.world_from_mesh, &own.world_from_mesh),
            touched: pairs.iter().map(|pair| pair[side]).collect(),
            faces_at: std::cell::OnceCell::new(),
        }
    }

    /// The vertices inside the other mesh that hang together with these faces by faces that do not meet it.
    fn inside(&self, faces: impl Iterator<Item = u32>) -> Vec<u32> {
        let first_at = &self.mesh.topology().first_at;
        let mut judge = Judge::new(self.other);
        let mut judged = HashSet::new();
        let mut inside = HashSet::new();
        let mut next = Vec::new();
        for vertex in faces.flat_map(|face| self.mesh.faces()[face as usize]) {
            let vertex = first_at[vertex as usize];
            if judged.insert(vertex) {
                let spot = Spot::At(self.mesh.positions().get(vertex as usize));
                if judge.containment(&PosedPoint::new(&self.placement, spot)) == Containment::Inside {
                    inside.insert(vertex);
                    next.push(vertex);
                }
            }
        }
        while let Some(vertex) = next.pop() {
            for &face in self.faces_at().get(&vertex).into_iter().flatten() {
                if self.touched.contains(&face) {
                    continue;
                }
                for corner in self.mesh.faces()[face as usize] {
                    let corner = first_at[corner as usize];
                    if inside.insert(corner) {
                        next.push(corner);
                    }
                }
            }
        }
        let mut inside: Vec<u32> = inside.into_iter().collect();
        inside.sort_unstable();
        inside
    }

    fn faces_at(&self) -> &HashMap<u32, Vec<u32>> {
        self.faces_at.get_or_init(|| {
            let first_at = &self.mesh.topology().first_at;
            let mut faces_at: HashMap<u32, Vec<u32>> = HashMap::new();
            for (face, corners) in (0..).zip(self.mesh.faces()) {
                for corner in corners {
                    faces_at.entry(first_at[*corner as usize]).or_default().push(face);
                }
            }
            faces_at
        })
    }
}

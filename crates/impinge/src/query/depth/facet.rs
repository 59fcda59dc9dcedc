//! A flat part of a surface in the frame of the search for a depth.
//!
//! A facet bounds the distance of a point from the surface in two ways. If the foot of the point is
//! in the facet, the facet is no farther than its plane. If the facet supports the solid, no part
//! of the solid is beyond its plane, so the way to the plane leaves the solid wherever it ends.
//!
//! Guarded by `tests/it/clash/cases.rs`.

use super::cell::{Cell, Plane};
use super::face::{Face, joined, stretch, world_face};
use crate::budget::Budget;
use crate::math::vec3::{Vector, cross, dot, length, scale, sub};
use crate::mesh::{FacetPlane, Facets, PlacedMesh};

/// A flat part of the surface, in the frame of the search.
pub(super) struct Facet {
    /// The plane. The front of the facet is beyond it.
    pub(super) plane: Plane,
    /// Greatest distance of a corner from the plane.
    flatness: f64,
    /// No point of the solid is farther than this beyond the plane. Infinite if the facet does not
    /// support the solid.
    overhang: f64,
    pub(super) bounds: [Vector; 2],
    pub(super) faces: Vec<u32>,
    /// The planes through the edges of the border, at right angles to the facet, with the ends of
    /// the edge. The facet is inside, near the edge.
    border: Vec<(Plane, [Vector; 2])>,
}

/// Share of the extent of a face that must be above the rounding errors, if its plane counts for
/// the whole solid.
const STEADY: f64 = 1.0 / (1_u64 << 24) as f64;

impl Facet {
    /// Returns the facet of some faces, which have consecutive numbers from `first` on in the
    /// search. A facet without area is `None`.
    pub(super) fn new(
        (placed, facets): (&PlacedMesh<'_>, &Facets),
        faces: &[(u32, Face)],
        first: u32,
        (origin, slack): (&Vector, f64),
    ) -> Option<Self> {
        let of_mesh = &facets.planes[facets.parts.of_face[faces.first()?.0 as usize] as usize];
        let (plane, overhang) = plane_of(placed, of_mesh, (origin, slack))?;
        let mut bounds = faces.first()?.1.bounds;
        let (mut flatness, mut border) = (0.0_f64, Vec::new());
        for (number, face) in faces {
            bounds = joined(&bounds, &face.bounds);
            flatness = face.corners.iter().fold(flatness, |most, corner| most.max(plane.beyond(corner).abs()));
            for edge in (0..3).filter(|&edge| placed.mesh.is_border_of_facet(facets, *number, edge)) {
                let ends = [face.corners[edge], face.corners[(edge + 1) % 3]];
                border.extend(face.edge_plane(edge).map(|plane| (plane, ends)));
            }
        }
        let faces = (first..first + faces.len() as u32).collect();
        Some(Self { plane, flatness, overhang, bounds, faces, border })
    }

    /// Reports whether no part of the solid is beyond the plane, up to rounding.
    pub(super) fn supports(&self) -> bool {
        self.overhang.is_finite()
    }

    /// Returns an upper bound of the distance of a point of the solid from its surface: the way to
    /// the plane of a facet that supports the solid. It may be negative at other points.
    pub(super) fn way_out(&self, point: &Vector) -> f64 {
        self.overhang - self.plane.beyond(point)
    }

    /// Returns the longest way out from a corner of a cell. No point of the cell has a longer one.
    pub(super) fn longest_way_out(&self, cell: &Cell) -> f64 {
        cell.corners().map(|corner| self.way_out(corner)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns the plane beyond which no point of the solid is.
    pub(super) fn limit(&self, slack: f64) -> Plane {
        Plane { height: self.plane.height + self.overhang + slack, ..self.plane }
    }

    /// Returns the plane of the points that have equal ways out to two facets, or `None` if they
    /// are about parallel.
    pub(super) fn bisector(&self, other: &Self) -> Option<Plane> {
        let normal = sub(&self.plane.normal, &other.plane.normal);
        let size = length(&normal);
        let height = (self.plane.height + self.overhang) - (other.plane.height + other.overhang);
        (size > 1e-6).then(|| Plane { normal: scale(&normal, 1.0 / size), height: height / size })
    }

    /// Returns the greatest distance of a point of a cell from the facet's plane, and more if the
    /// facet is not flat.
    pub(super) fn height(&self, cell: &Cell) -> f64 {
        cell.corners().map(|corner| self.plane.beyond(corner).abs()).fold(0.0, f64::max) + self.flatness
    }

    /// Reports whether the box about the facet holds the foot of a point.
    pub(super) fn may_be_below(&self, point: &Vector, slack: f64) -> bool {
        let foot = sub(point, &scale(&self.plane.normal, self.plane.beyond(point)));
        let margin = self.flatness + 4.0 * slack;
        let [low, high] = &self.bounds;
        (0..3).all(|axis| foot[axis] >= low[axis] - margin && foot[axis] <= high[axis] + margin)
    }

    /// Returns the plane through an edge of the border that may divide the feet of a cell's points,
    /// or `None` if no edge does. Of several it is the one that divides the cell most evenly.
    pub(super) fn edge_below(&self, cell: &Cell, slack: f64) -> Option<Plane> {
        let mut best: Option<(f64, Plane)> = None;
        for (plane, ends) in &self.border {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for corner in cell.corners() {
                let beyond = plane.beyond(corner);
                (low, high) = (low.min(beyond), high.max(beyond));
            }
            let evenness = high.min(-low);
            if evenness <= slack || best.is_some_and(|(most, _)| evenness <= most) {
                continue;
            }
            if !self.is_beside(cell, ends) {
                best = Some((evenness, *plane));
            }
        }
        best.map(|(_, plane)| plane)
    }

    /// Reports whether an edge of the border is known to be beside the feet of a cell's points.
    fn is_beside(&self, cell: &Cell, ends: &[Vector; 2]) -> bool {
        let along = sub(&ends[1], &ends[0]);
        let (from, to) = (dot(&along, &ends[0]), dot(&along, &ends[1]));
        let places = || cell.corners().map(|corner| dot(&along, corner));
        if places().all(|at| at <= from) || places().all(|at| at >= to) {
            return true;
        }
        let height = cell.corners().map(|corner| self.plane.beyond(corner).abs()).fold(0.0, f64::max);
        // A foot is as far from its point as the point is high.
        let is_beyond = |plane: &Plane| {
            let shift = height * dot(&plane.normal, &self.plane.normal).abs();
            ends.iter().all(|end| plane.beyond(end) >= shift)
        };
        cell.planes().any(is_beyond)
    }
}

/// Maximum number of facets of a convex solid whose planes are compared with each vertex of
/// another.
const MAX_PLANES: usize = 64;

/// Returns the planes between which a convex solid lies, and which it touches up to their overhang,
/// in the frame of the search. Returns `None` unless the mesh is closed and has few facets, and
/// each of them supports the solid, or if the budget is spent.
pub(super) fn planes_of_convex(
    placed: &PlacedMesh<'_>,
    (origin, slack): (&Vector, f64),
    budget: &Budget<'_>,
) -> Option<Vec<(Plane, f64)>> {
    let planes = &placed.mesh.facets(budget)?.planes;
    if planes.len() > MAX_PLANES || !placed.mesh.is_closed() {
        return None;
    }
    let supporting = |of_mesh| plane_of(placed, of_mesh, (origin, slack)).filter(|(_, overhang)| overhang.is_finite());
    planes.iter().map(supporting).collect()
}

/// Returns the plane of a facet in the frame of the search, and how far the solid reaches beyond
/// it. A facet without area has none.
fn plane_of(placed: &PlacedMesh<'_>, facet: &FacetPlane, (origin, slack): (&Vector, f64)) -> Option<(Plane, f64)> {
    let face = world_face(placed, facet.face, origin);
    let plane = Plane { normal: face.normal?, height: dot(&face.normal?, &face.corners[0]) };
    Some((plane, overhang(placed, facet.overhang, (&face.corners, slack))))
}

/// Returns how far a solid reaches beyond the plane of a face, given how far its mesh does in its
/// own frame. `corners` are those of the face in the search.
fn overhang(placed: &PlacedMesh<'_>, of_mesh: f64, (corners, slack): (&[Vector; 3], f64)) -> f64 {
    let [p, q, r] = corners;
    let longest = [sub(q, p), sub(r, q), sub(p, r)].iter().map(length).fold(0.0, f64::max);
    let height = length(&cross(&sub(q, p), &sub(r, p))) / longest;
    let Some([low, high]) = placed.mesh.local_bounds() else { return f64::INFINITY };
    let stretch = stretch(&placed.world_from_mesh);
    let size = stretch * length(&sub(&high, &low));
    // Errors of the corners tilt the plane.
    if slack > STEADY * height {
        return f64::INFINITY;
    }
    stretch * of_mesh + 4.0 * slack * (1.0 + size / height)
}

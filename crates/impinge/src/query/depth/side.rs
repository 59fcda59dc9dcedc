//! One solid of the search for a depth: its faces near the search, and which points are inside.

use std::ops::ControlFlow::{self, Break, Continue};

use super::border::Border;
use super::cell::Cell;
use super::face::{Face, box_about, gap, world_box, world_corners};
use super::facet::Facet;
use super::nearest::{NOT_NEAR, Nearest};
use crate::budget::Budget;
use crate::exact::{Placement, PosedPoint, Spot};
use crate::math::Pose;
use crate::math::vec3::{Vector, add, scale, sub};
use crate::mesh::{Containment, FaceSearch, PlacedMesh, PointClassifier};

/// Number of distances at which points around a point are compared with an open solid.
const RADII: usize = 8;

/// Number of faces of a solid up to which its corners are compared with the facets of another.
const MAX_FACES: usize = 4096;

/// Number of facets up to which they are compared with the corners of another solid.
const MAX_SUPPORTING: usize = 256;

/// Number of faces up to which the nearest to a point is found by comparing all of them, and not
/// through the tree of the mesh.
const MAX_SCANNED: usize = 512;

/// Number of faces that are collected between two checks of the budget.
const FACES_PER_CHECK: usize = 1 << 10;

/// Number of facets that are prepared between two checks of the budget.
const FACETS_PER_CHECK: usize = 1 << 8;

/// Directions to the corners and the middles of the sides of a cube, of length 1.
const AROUND: [Vector; 14] = {
    const S: f64 = 0.577_350_269_189_625_7;
    [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [S, S, S],
        [S, S, -S],
        [S, -S, S],
        [S, -S, -S],
        [-S, S, S],
        [-S, S, -S],
        [-S, -S, S],
        [-S, -S, -S],
    ]
};

/// A solid in the frame of the search: the world frame less an origin that is near both solids.
pub(super) struct Side<'m> {
    placed: PlacedMesh<'m>,
    /// Places points of the world in the frame of the mesh.
    placement: Placement,
    origin: Vector,
    /// The faces that may be within the margin of the box of the search.
    pub(super) faces: Vec<Face>,
    /// The index of each face's facet. Equal numbers follow each other.
    pub(super) facet_of: Vec<u32>,
    /// The flat parts that these faces make up.
    pub(super) facets: Vec<Facet>,
    /// The index of each face of the mesh in the list of faces, or [`NOT_NEAR`]. `None` if the list
    /// is short.
    place_of: Option<Vec<u32>>,
    /// Boxes about the holes of an open mesh. A cell that no face and none of these boxes reaches
    /// is on one side of the solid (docs/notes/proof.md, L19a).
    holes: Vec<[Vector; 2]>,
    /// The border, if a hole is near.
    border: Option<Border>,
    /// Number of edges of the border that winding numbers near holes have summed up so far.
    summed: std::cell::Cell<usize>,
}

impl<'m> Side<'m> {
    /// Number in place of that of a facet, for a face without area.
    const NO_FACET: u32 = u32::MAX;

    /// Collects the faces of a solid within a margin of a box, which is in the frame of the search.
    /// `slack` bounds the rounding errors of corners. Returns `None` if the budget is spent.
    pub(super) fn new(
        placed: PlacedMesh<'m>,
        origin: Vector,
        bounds: &[Vector; 2],
        (margin, slack): (f64, f64),
        budget: &Budget<'_>,
    ) -> Option<Self> {
        let of_mesh = placed.mesh.facets(budget)?;
        let mut near = Near { placed: &placed, origin, bounds, margin, found: Vec::new(), budget };
        placed.mesh.search(&mut near);
        let of_face = &of_mesh.parts.of_face;
        near.found.sort_unstable_by_key(|&(face, _)| (of_face[face as usize], face));
        let same_facet = |x: &(u32, Face), y: &(u32, Face)| of_face[x.0 as usize] == of_face[y.0 as usize];
        let (mut facets, mut facet_of) = (Vec::new(), Vec::with_capacity(near.found.len()));
        for faces in near.found.chunk_by(same_facet) {
            if facets.len().is_multiple_of(FACETS_PER_CHECK) && budget.is_spent() {
                return None;
            }
            let facet = Facet::new((&placed, of_mesh), faces, facet_of.len() as u32, (&origin, slack));
            let number = if facet.is_some() { facets.len() as u32 } else { Self::NO_FACET };
            facet_of.extend(faces.iter().map(|_| number));
            facets.extend(facet);
        }
        let placement = Placement::new(&placed.world_from_mesh, &Pose::IDENTITY);
        let place_of = (near.found.len() > MAX_SCANNED).then(|| {
            let mut place_of = vec![NOT_NEAR; placed.mesh.faces().len()];
            for (place, &(face, _)) in (0..).zip(&near.found) {
                place_of[face as usize] = place;
            }
            place_of
        });
        let faces: Vec<Face> = near.found.into_iter().map(|(_, face)| face).collect();
        let holes = holes_near(&placed, &origin, (bounds, margin));
        let border = (!holes.is_empty()).then(|| Border::new(&placed, &origin));
        let summed = Default::default();
        Some(Self { placed, placement, origin, faces, facet_of, facets, place_of, holes, border, summed })
    }

    /// Returns the facet of a face that supports the solid.
    pub(super) fn supporting(&self, face: u32) -> Option<&Facet> {
        self.facets.get(self.facet_of[face as usize] as usize).filter(|facet| facet.supports())
    }

    /// Returns the length of the shortest way along the normal of a facet that takes another solid
    /// out of this one, if it is at most `longest`. Large meshes are not compared.
    pub(super) fn way_out_along_facet(&self, other: &Self, longest: f64) -> Option<f64> {
        let faces = other.placed.mesh.faces().as_flattened();
        let supporting = self.facets.iter().filter(|facet| facet.supports());
        if faces.len() > 3 * MAX_FACES || supporting.clone().count() > MAX_SUPPORTING {
            return None;
        }
        let place = |&vertex: &u32| {
            let local = other.placed.mesh.positions().get(vertex as usize);
            sub(&other.placed.world_from_mesh.apply(local), &self.origin)
        };
        let way_out = |facet: &Facet| {
            faces.iter().map(place).try_fold(f64::NEG_INFINITY, |way, corner| {
                let way = way.max(facet.way_out(&corner));
                (way <= longest).then_some(way)
            })
        };
        supporting.filter_map(way_out).min_by(f64::total_cmp)
    }

    /// Returns the facet with the least bound of the ways out of a cell, among those that support
    /// the solid, and the corner of the cell from which the way is longest.
    pub(super) fn nearest_way_out(&self, cell: &Cell, facets: &[u32]) -> Option<(&Facet, Vector)> {
        let supporting = facets.iter().map(|&facet| &self.facets[facet as usize]).filter(|facet| facet.supports());
        let (_, facet) =
            supporting.map(|facet| (facet.longest_way_out(cell), facet)).min_by(|x, y| x.0.total_cmp(&y.0))?;
        let corner = cell.corners().max_by(|x, y| facet.way_out(x).total_cmp(&facet.way_out(y)))?;
        Some((facet, *corner))
    }

    /// Reports whether a box is known to be away from the holes of the solid.
    pub(super) fn is_clear_of_holes(&self, bounds: &[Vector; 2]) -> bool {
        self.holes.iter().all(|hole| gap(hole, bounds) > 0.0)
    }

    /// Returns how far a point is inside the solid, given the distance of the nearest face: less
    /// near a hole, through which the solid ends without a face. There the distances of some points
    /// outside are compared. An open solid ends at the planes that support it, too. A distance that
    /// is not above `least` may be returned as zero.
    pub(super) fn distance_from_outside(&self, point: &Vector, to_faces: f64, least: f64) -> f64 {
        let to_faces = if self.placed.mesh.is_closed() {
            to_faces
        } else {
            let supporting = self.facets.iter().filter(|facet| facet.supports());
            supporting.map(|facet| facet.way_out(point)).fold(to_faces, f64::min).max(0.0)
        };
        let ball = [point.map(|x| x - to_faces), point.map(|x| x + to_faces)];
        if self.is_clear_of_holes(&ball) {
            return to_faces;
        }
        let is_out = |radius: f64| {
            let at = |way: &Vector| add(point, &scale(way, radius));
            AROUND.iter().any(|way| self.containment(&at(way)) == Containment::Outside)
        };
        let radii = || (1..=RADII).map(|step| to_faces * step as f64 / RADII as f64);
        // Most points are not deeper than the best so far, and one radius shows that.
        if radii().find(|&radius| radius > least).is_none_or(is_out) {
            return 0.0;
        }
        radii().take_while(|&radius| !is_out(radius)).last().unwrap_or(0.0)
    }

    /// Returns the number of edges of the border that winding numbers near holes have summed up.
    pub(super) fn summed(&self) -> usize {
        self.summed.get()
    }

    /// Counts a winding number, if a hole is near.
    fn count_border(&self) {
        self.summed.set(self.summed.get() + self.border.as_ref().map_or(0, Border::cost));
    }

    /// Returns the position of a point of the search relative to the solid. The point is rounded to
    /// the world's numbers.
    pub(super) fn containment(&self, point: &Vector) -> Containment {
        self.count_border();
        PointClassifier::new(self.placed.mesh).containment(&self.posed(point))
    }

    fn posed(&self, point: &Vector) -> PosedPoint<'_> {
        PosedPoint::new(&self.placement, Spot::At(add(point, &self.origin)))
    }

    /// Returns whether all points within a radius are inside the solid, if no face crosses the
    /// straight way to them from the point in the middle. Returns `None` if that is not decided.
    pub(super) fn is_inside_around(&self, point: &Vector, radius: f64) -> Option<bool> {
        let variation = self.border.as_ref()?.variation(point, radius);
        // Winding numbers from 0 to 1 are no farther than that from 1/2.
        if variation >= 0.5 {
            return None;
        }
        self.count_border();
        let number = PointClassifier::new(self.placed.mesh).winding_number(&self.posed(point));
        let [lower, upper] = [number.lower - variation, number.upper + variation];
        if lower > 0.5 || upper < -0.5 { Some(true) } else { (lower >= -0.5 && upper <= 0.5).then_some(false) }
    }

    /// Returns the squared distance of a point from the nearest of some faces, the nearest point
    /// and the face. No other face may be nearer.
    pub(super) fn nearest(&self, point: &Vector, faces: &[u32]) -> Option<(f64, Vector, u32)> {
        if let Some(place_of) = self.place_of.as_ref().filter(|_| faces.len() > MAX_SCANNED) {
            return Nearest::new((&self.placed, &self.origin), (&self.faces, place_of), point).find();
        }
        let mut best: Option<(f64, Vector, u32)> = None;
        for &face in faces {
            let least = best.map_or(f64::INFINITY, |(least, ..)| least);
            if let Some((squared, foot)) = self.faces[face as usize].nearest_within(point, least)
                && squared < least
            {
                best = Some((squared, foot, face));
            }
        }
        best
    }

    /// Reports whether all points of a cell are over a facet: their feet in its plane are in it.
    pub(super) fn is_over(&self, facet: &Facet, cell: &Cell, slack: f64) -> bool {
        let center = cell.center();
        facet.may_be_below(&center, slack)
            && facet.edge_below(cell, slack).is_none()
            && facet.faces.iter().any(|&face| self.faces[face as usize].is_below(&center, slack))
    }
}

/// Returns the boxes about the holes of a mesh that are within a margin of a box of the search.
fn holes_near(placed: &PlacedMesh<'_>, origin: &Vector, (bounds, margin): (&[Vector; 2], f64)) -> Vec<[Vector; 2]> {
    let Ok(holes) = placed.mesh.cap().within_reach(&placed.world_from_mesh) else {
        return vec![[[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]]];
    };
    let local = holes.iter().map(|hole| [hole.min(), hole.max()].map(|corner| sub(&corner, origin)));
    local.filter(|hole| gap(hole, bounds) <= margin).collect()
}

/// A search for the faces near a box.
struct Near<'s, 'm> {
    placed: &'s PlacedMesh<'m>,
    origin: Vector,
    bounds: &'s [Vector; 2],
    margin: f64,
    found: Vec<(u32, Face)>,
    budget: &'s Budget<'s>,
}

impl FaceSearch for Near<'_, '_> {
    fn bound(&self, center: &Vector, half_extents: &Vector) -> f64 {
        gap(&world_box(&self.placed.world_from_mesh, &self.origin, center, half_extents), self.bounds)
    }

    fn cut(&self) -> f64 {
        self.margin
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let corners = world_corners(self.placed, face, &self.origin);
        if gap(&box_about(&corners), self.bounds) <= self.margin {
            self.found.push((face, Face::new(corners, self.placed.world_from_mesh.mirrors())));
            if self.found.len().is_multiple_of(FACES_PER_CHECK) && self.budget.is_spent() {
                return Break(());
            }
        }
        Continue(())
    }
}

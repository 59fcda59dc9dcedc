//! Where the search for a depth cuts a cell.

use super::cell::{Cell, Plane};
use super::face::{Face, largest_in};
use super::facet::Facet;
use super::piece::Local;
use super::side::Side;
use crate::math::vec3::{dot, scale, sub, unit};

/// Number of flat parts of both solids in a cell above which the cell is halved, and not divided
/// along one of them.
const MANY_FACETS: usize = 12;

/// Difference of two ways out, relative to the target, up to which they count as equal.
const EVEN: f64 = 1.0 / 4096.0;

/// Lengths and solids on which the cuts depend.
pub(super) struct Divider<'s, 'm> {
    pub(super) sides: &'s [Side<'m>; 2],
    /// The solids whose surfaces count.
    pub(super) measured: [bool; 2],
    /// The solids whose inside counts.
    pub(super) bounded: [bool; 2],
    pub(super) slack: f64,
    /// Distance up to which points are near a surface.
    pub(super) target: f64,
    /// Half of the thickness of the cells along faces.
    pub(super) half_thickness: f64,
}

impl Divider<'_, '_> {
    /// Returns the planes that divide a cell best. `is_far` tells for each solid whether points of
    /// the cell may be too far from its surface.
    pub(super) fn planes(&self, cell: &Cell, local: &[Local; 2], is_far: [bool; 2]) -> Vec<Plane> {
        let mut far = (0..2).filter(|&side| is_far[side]);
        if let Some(plane) = far.find_map(|side| self.edge_of_thin_cell(cell, side, &local[side])) {
            return vec![plane];
        }
        // Outside of one solid is enough, so the solid with fewer flat parts in the cell comes
        // first.
        let inner = [0, 1].map(|side| self.faces_in(cell, side, &local[side]));
        let mut sides: Vec<(bool, usize, usize)> =
            (0..2).map(|side| (!is_far[side], self.flat_parts(side, &inner[side]), side)).collect();
        sides.sort_unstable();
        for (_, count, side) in sides {
            let of_face = |&face: &u32| (face, &self.sides[side].faces[face as usize]);
            let wide = inner[side].iter().map(of_face).filter(|(_, face)| self.is_wide_along(cell, face));
            if count > MANY_FACETS {
                if wide.take(1).count() > 0 {
                    return vec![self.fewest_faces(cell, local)];
                }
            } else if let Some((number, _)) = largest_in(cell, wide, self.slack) {
                return match self.supporting(side, number) {
                    Some(facet) => vec![facet.limit(2.0 * self.slack)],
                    None => self.around(&self.sides[side].faces[number as usize]),
                };
            }
        }
        let far = (0..2).filter(|&side| is_far[side] && self.bounded[side]);
        let bisector = far.filter_map(|side| self.between_ways_out(cell, side, &local[side])).next();
        bisector.or_else(|| self.beside_face(cell, local)).into_iter().collect()
    }

    /// Returns the facet of a face, if no part of the solid is beyond it.
    fn supporting(&self, side: usize, face: u32) -> Option<&Facet> {
        self.sides[side].supporting(face).filter(|_| self.bounded[side])
    }

    /// Returns the faces that divide a cell. A face of a facet that supports the solid, and that
    /// the cell does not reach beyond, does not.
    fn faces_in(&self, cell: &Cell, side: usize, local: &Local) -> Vec<u32> {
        let divides = |&face: &u32| {
            self.supporting(side, face).is_none_or(|facet| {
                let limit = facet.limit(2.0 * self.slack);
                cell.corners().any(|corner| limit.beyond(corner) > 4.0 * self.slack)
            })
        };
        local.touching.iter().copied().filter(divides).collect()
    }

    /// Returns the plane between the points of a cell with a shorter way out at one facet and those
    /// with a shorter way at another. The facets are the one that bounds all ways best, and the one
    /// with the shortest way from the corner where that bound is reached. `None` if this is the
    /// same facet, or an equally long way.
    fn between_ways_out(&self, cell: &Cell, side: usize, local: &Local) -> Option<Plane> {
        let own = &self.sides[side];
        let (facet, corner) = own.nearest_way_out(cell, &local.facets)?;
        let supporting = local.facets.iter().map(|&facet| &own.facets[facet as usize]).filter(|facet| facet.supports());
        let other = supporting.min_by(|x, y| x.way_out(&corner).total_cmp(&y.way_out(&corner)))?;
        let difference = facet.way_out(&corner) - other.way_out(&corner);
        if difference <= (EVEN * self.target).max(8.0 * self.slack) { None } else { facet.bisector(other) }
    }

    /// Returns the number of flat parts of some faces.
    fn flat_parts(&self, side: usize, faces: &[u32]) -> usize {
        faces.chunk_by(|&x, &y| self.sides[side].facet_of[x as usize] == self.sides[side].facet_of[y as usize]).count()
    }

    /// Returns a plane through the border of a facet that a cell is thin along, if the border
    /// divides the cell.
    fn edge_of_thin_cell(&self, cell: &Cell, side: usize, local: &Local) -> Option<Plane> {
        let target = self.target;
        let facets = local.facets.iter().map(|&facet| &self.sides[side].facets[facet as usize]);
        facets.filter(|facet| facet.height(cell) <= target).find_map(|facet| facet.edge_below(cell, self.slack))
    }

    /// Returns the plane across the middle of a cell that leaves the fewest faces in both halves.
    /// The halves of a long rod, cut across, have all its faces.
    fn fewest_faces(&self, cell: &Cell, local: &[Local; 2]) -> Plane {
        let [low, high] = cell.bounds();
        let faces = |axis: usize| {
            let at = 0.5 * (low[axis] + high[axis]);
            let count = |side: usize| {
                let bounds = local[side].touching.iter().map(|&face| &self.sides[side].faces[face as usize].bounds);
                bounds.map(|[low, high]| usize::from(low[axis] < at) + usize::from(high[axis] > at)).sum::<usize>()
            };
            count(0) + count(1)
        };
        let extent = |axis: usize| high[axis] - low[axis];
        let is_long = |&axis: &usize| extent(axis) > 4.0 * self.half_thickness;
        let best =
            (0..3).filter(is_long).min_by(|&x, &y| faces(x).cmp(&faces(y)).then(extent(y).total_cmp(&extent(x))));
        best.map_or_else(|| middle(cell), |axis| across(axis, 0.5 * (low[axis] + high[axis])))
    }

    /// Reports whether a cell is thicker, at right angles to a face, than the cells around faces.
    fn is_wide_along(&self, cell: &Cell, face: &Face) -> bool {
        let half = self.half_thickness + self.slack;
        face.normal.is_some_and(|normal| {
            let level = dot(&normal, &face.corners[0]);
            cell.corners().any(|corner| (dot(&normal, corner) - level).abs() > half)
        })
    }

    /// Returns the planes that cut a thin cell out around a face.
    fn around(&self, face: &Face) -> Vec<Plane> {
        let Some(normal) = face.normal else { return Vec::new() };
        let (level, half) = (dot(&normal, &face.corners[0]), self.half_thickness);
        vec![Plane { normal, height: level + half }, Plane { normal: scale(&normal, -1.0), height: half - level }]
    }

    /// Returns the plane between the center of a cell and the surface that is nearest to it.
    fn beside_face(&self, cell: &Cell, local: &[Local; 2]) -> Option<Plane> {
        let measured = (0..2).filter(|&side| self.measured[side]);
        let side = measured.max_by(|&x, &y| local[x].reach.total_cmp(&local[y].reach))?;
        let center = cell.center();
        let (_, foot, face) = self.sides[side].nearest(&center, &local[side].near)?;
        let normal = unit(&sub(&center, &foot)).or(self.sides[side].faces[face as usize].normal)?;
        Some(Plane { normal, height: dot(&normal, &center) })
    }
}

/// Returns the plane across the longest extent of a cell, through its middle.
pub(super) fn middle(cell: &Cell) -> Plane {
    let [low, high] = cell.bounds();
    let extent = |axis: usize| high[axis] - low[axis];
    let longest = (0..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best });
    across(longest, 0.5 * (low[longest] + high[longest]))
}

/// Returns the plane across an axis at a height.
fn across(axis: usize, height: f64) -> Plane {
    let mut normal = [0.0; 3];
    normal[axis] = 1.0;
    Plane { normal, height }
}

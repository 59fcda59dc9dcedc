//! Best-first search for the deepest common point of two solids.
//!
//! The common part of both boxes is one cell at first, less what is beyond facets that support a
//! solid. Such facets bound the distance of all points of the solid from its surface, and a cell is
//! divided where two of them bound it alike. Otherwise a cell is divided by the planes of faces,
//! until none of a solid's faces reaches it: then the cell lies wholly inside or wholly outside the
//! solid. Around the plane of a face, a cell as thin as the search allows is cut out: all of its
//! points over the face are near the surface, whatever is inside. A cell is done if it lies outside
//! a solid, or if all of its points are known to be near the surfaces. The distance of a convex
//! face is convex, so its maximum over a cell is that of a corner.
//!
//! So parts with common flat walls need as many cells as faces touch, however large the walls are;
//! cubes would have to be as small as the depth.
//!
//! `witness` finds deep points.
//!
//! Proof: docs/notes/proof.md, L42. Guarded by `tests/it/clash/cases.rs`.

mod witness;

use std::collections::BinaryHeap;

use super::cell::{Cell, Plane};
use super::divide::{Divider, middle};
use super::face::gap;
use super::goal::{Effort, Found, Goal};
use super::piece::{Local, Piece};
use super::side::Side;
use crate::budget::Budget;
use crate::math::vec3::{Vector, add, scale, squared_distance};
use crate::mesh::Containment;

/// Maximum number of planes of facets by which the first cell is cut.
const MAX_LIMITS: usize = 24;

/// Number of facets whose normals are tried as the way out for a cell.
const MAX_WAYS_OUT: usize = 4;

/// Relative difference from the threshold below which the bound of a cell is a tie. More than a few
/// ties mean that the depth is about the threshold, and more cells would not decide.
const TIE: f64 = 1.0 / 4096.0;

/// Number of cells with ties that are divided.
const MAX_TIES: usize = 64;

/// Distance up to which faces are near a cell, in units of the threshold. Faces that are farther do
/// not decide whether a point is deeper.
const RANGE: f64 = 1.5;

/// A search for the deepest common point.
pub(super) struct Search<'s, 'm> {
    sides: &'s [Side<'m>; 2],
    goal: Goal,
    /// Bound of the rounding errors of coordinates and distances in the search.
    slack: f64,
    /// No face that was not collected is nearer than this to the box of the search.
    margin: f64,
    found: Found,
    /// The greatest depth that the cells that are done may have.
    settled: f64,
    heap: BinaryHeap<Piece>,
    /// Number of cells so far.
    count: usize,
    /// Number of faces with which cells were compared so far.
    compared: usize,
    /// Number of summed edges of borders at which the search ends.
    last_edge: usize,
}

impl<'s, 'm> Search<'s, 'm> {
    /// Prepares a search. A point that is known to be deep is the first result.
    pub(super) fn new(
        sides: &'s [Side<'m>; 2],
        goal: Goal,
        (slack, margin): (f64, f64),
        known: Option<(f64, Vector)>,
    ) -> Self {
        let (lower, point) = known.map_or((0.0, None), |(depth, point)| (depth, Some(point)));
        let found = Found { lower, upper: f64::INFINITY, point, resolution: 16.0 * slack };
        Self {
            sides,
            goal,
            slack,
            margin,
            found,
            settled: 0.0,
            heap: BinaryHeap::new(),
            count: 0,
            compared: 0,
            last_edge: sides.iter().map(Side::summed).sum::<usize>() + goal.effort.border_edges,
        }
    }

    /// Searches the points of a box.
    pub(super) fn run(mut self, bounds: &[Vector; 2], budget: &Budget<'_>) -> Found {
        // The box is grown, so that a box without thickness has some.
        let grown = [bounds[0].map(|x| x - 4.0 * self.slack), bounds[1].map(|x| x + 4.0 * self.slack)];
        let local = self.sides.each_ref().map(|side| Local {
            facets: (0..side.facets.len() as u32).collect(),
            near: (0..side.faces.len() as u32).collect(),
            touching: (0..side.faces.len() as u32).collect(),
            is_inside: false,
            reach: f64::INFINITY,
        });
        let cell = self.without_far_parts(Cell::cuboid(&grown));
        self.push(cell, &local, f64::INFINITY);
        let mut ties = 0;
        while let Some(piece) = self.heap.pop() {
            if piece.upper <= self.target() || self.is_decided() {
                self.settled = self.settled.max(piece.upper);
                break;
            }
            // The bounds of all cells that are left are about the threshold.
            let is_tie = self.goal.threshold.is_some_and(|threshold| piece.upper <= threshold * (1.0 + TIE));
            ties += usize::from(is_tie);
            let edges: usize = self.sides.iter().map(Side::summed).sum();
            let Effort { cells, faces, .. } = self.goal.effort;
            let is_long = self.count > cells || self.compared > faces || edges > self.last_edge;
            if ties > MAX_TIES || is_long || budget.is_spent() {
                self.settled = self.settled.max(piece.upper);
                break;
            }
            self.try_points(&piece);
            if self.is_decided() {
                break;
            }
            self.divide(piece);
        }
        if self.is_decided() {
            self.settled = f64::INFINITY;
        }
        Found { upper: self.settled.max(self.found.lower), ..self.found }
    }

    /// Reports whether the points inside a solid count, so that the facets that support the solid
    /// bound them and their distances.
    fn is_bounded(&self, side: usize) -> bool {
        side == 1 || !self.goal.outside_first
    }

    /// Cuts off the parts of the first cell that are beyond facets that support a solid.
    fn without_far_parts(&self, mut cell: Cell) -> Cell {
        let facets = (0..2).filter(|&side| self.is_bounded(side)).flat_map(|side| &self.sides[side].facets);
        let mut limits: Vec<(f64, Plane)> = facets
            .filter(|facet| facet.supports())
            .map(|facet| {
                let limit = facet.limit(2.0 * self.slack);
                (cell.corners().map(|corner| limit.beyond(corner)).fold(f64::NEG_INFINITY, f64::max), limit)
            })
            .filter(|(beyond, _)| *beyond > 4.0 * self.slack)
            .collect();
        // A cell has few planes, so those that cut off most come first.
        limits.sort_by(|x, y| y.0.total_cmp(&x.0));
        for (_, limit) in limits.iter().take(MAX_LIMITS) {
            if let Some([Some(below), _]) = cell.cut(limit, self.slack) {
                cell = below;
            }
        }
        cell
    }

    fn is_decided(&self) -> bool {
        self.goal.threshold.is_some() && self.found.lower > self.target()
    }

    /// Returns the depth up to which cells are done.
    fn target(&self) -> f64 {
        match self.goal.threshold {
            Some(threshold) if self.goal.outside_first => threshold.max(self.found.resolution),
            Some(threshold) => threshold,
            None => (self.found.lower * (1.0 + self.goal.effort.relative_width)).max(self.found.resolution),
        }
    }

    /// Adds a cell, unless it is done. `parent` has the lists of a cell that holds it.
    fn push(&mut self, cell: Cell, parent: &[Local; 2], upper: f64) {
        self.count += 1;
        self.compared += parent.iter().map(|local| local.near.len() + local.touching.len()).sum::<usize>();
        let bounds = cell.bounds_grown(self.slack);
        let mut local = [0, 1].map(|side| {
            let faces = &self.sides[side].faces;
            let reaches = |&&face: &&u32| {
                let face = &faces[face as usize];
                gap(&face.bounds, &bounds) <= 0.0 && face.reaches(&cell, self.slack)
            };
            let Local { is_inside, reach, .. } = parent[side];
            let touching = parent[side].touching.iter().filter(reaches).copied().collect();
            Local { facets: Vec::new(), near: Vec::new(), touching, is_inside, reach }
        });
        for side in 0..2 {
            if local[side].touching.is_empty() && !local[side].is_inside {
                match self.side_of(side, &cell, &bounds) {
                    Some(false) => return,
                    Some(true) => local[side].is_inside = true,
                    None => {}
                }
            }
        }
        let mut cell_upper: f64 = 0.0;
        for side in (0..2).filter(|&side| self.goal.measured[side]) {
            let own = &mut local[side];
            own.reach = self.reach(side, &cell, &parent[side]).min(parent[side].reach);
            cell_upper = cell_upper.max(own.reach);
            let Side { faces, facets, .. } = &self.sides[side];
            let range = if self.goal.threshold.is_some() { RANGE * self.target() } else { own.reach };
            let is_near = |&&face: &&u32| gap(&faces[face as usize].bounds, &bounds) <= range;
            own.near = parent[side].near.iter().filter(is_near).copied().collect();
            let is_near = |&&facet: &&u32| gap(&facets[facet as usize].bounds, &bounds) <= range;
            own.facets = parent[side].facets.iter().filter(is_near).copied().collect();
        }
        let upper = upper.min(cell_upper);
        if upper <= self.target() {
            self.settled = self.settled.max(upper);
            return;
        }
        self.heap.push(Piece { cell, local, upper, number: self.count });
    }

    /// Returns whether a cell that no face reaches is on the side of a solid that counts, or `None`
    /// if the solid is open and this differs in the cell. `bounds` is the grown box of the cell.
    fn side_of(&self, side: usize, cell: &Cell, bounds: &[Vector; 2]) -> Option<bool> {
        let center = cell.center();
        if self.sides[side].is_clear_of_holes(bounds) {
            return self.counts(side, &center);
        }
        let radius = cell.corners().map(|corner| squared_distance(&center, corner)).fold(0.0, f64::max).sqrt();
        if let Some(is_inside) = self.sides[side].is_inside_around(&center, radius) {
            return Some(is_inside != (side == 0 && self.goal.outside_first));
        }
        let first = self.counts(side, &center);
        // The winding number is harmonic here, so it is greatest and least on the boundary.
        let corners: Vec<Vector> = cell.corners().copied().collect();
        let pairs = corners.iter().enumerate().flat_map(|(at, a)| corners[..at].iter().map(move |b| (a, b)));
        let middles = pairs.map(|(a, b)| scale(&add(a, b), 0.5));
        let mut points = corners.iter().copied().chain(middles);
        points.all(|point| self.counts(side, &point) == first).then_some(first).flatten()
    }

    /// Returns whether a point is on the side of a solid that counts, or `None` if that is not
    /// decided.
    fn counts(&self, side: usize, point: &Vector) -> Option<bool> {
        let outside_counts = side == 0 && self.goal.outside_first;
        match self.sides[side].containment(point) {
            Containment::Inside => Some(!outside_counts),
            Containment::Outside => Some(outside_counts),
            Containment::Surface => Some(true),
            Containment::Undecided => None,
        }
    }

    /// Returns an upper bound of the distance of all points of a cell from the surface of a solid.
    fn reach(&self, side: usize, cell: &Cell, parent: &Local) -> f64 {
        let own = &self.sides[side];
        let mut best = f64::INFINITY;
        let facets = || parent.facets.iter().map(|&facet| &own.facets[facet as usize]);
        if self.is_bounded(side) {
            let supporting = facets().filter(|facet| facet.supports());
            best = supporting.map(|facet| facet.longest_way_out(cell)).fold(best, f64::min);
        }
        let center = cell.center();
        for facet in facets().filter(|facet| facet.may_be_below(&center, self.slack)) {
            let height = facet.height(cell);
            if height < best && own.is_over(facet, cell, self.slack) {
                best = height;
            }
        }
        let target = self.target();
        if best + 2.0 * self.slack > target && self.can_leave(side, cell, parent) {
            best = target - 2.0 * self.slack;
        }
        if best + 2.0 * self.slack <= target {
            return best + 2.0 * self.slack;
        }
        if let Some((squared, _, face)) = own.nearest(&center, &parent.near) {
            let radius = cell.corners().map(|corner| squared_distance(&center, corner)).fold(0.0, f64::max).sqrt();
            let face = &own.faces[face as usize];
            let farthest = cell.corners().map(|corner| face.squared_distance(corner)).fold(0.0, f64::max);
            best = best.min(farthest.sqrt()).min(squared.sqrt() + radius);
        }
        best + 2.0 * self.slack
    }

    /// Reports whether some translation no longer than the target moves all of a cell that is thin
    /// along a facet to the other side of the surface. Then all of its points are that near.
    fn can_leave(&self, side: usize, cell: &Cell, parent: &Local) -> bool {
        let own = &self.sides[side];
        let length = self.target() - 4.0 * self.slack;
        let facets = parent.facets.iter().map(|&facet| &own.facets[facet as usize]);
        let thin = facets.filter(|facet| facet.height(cell) <= 0.5 * length);
        thin.take(MAX_WAYS_OUT).any(|facet| {
            let outward = if self.is_bounded(side) { length } else { -length };
            let moved = cell.translated(&scale(&facet.plane.normal, outward));
            let stays = parent.near.iter().any(|&face| own.faces[face as usize].reaches(&moved, self.slack));
            !stays && self.side_of(side, &moved, &moved.bounds_grown(self.slack)) == Some(false)
        })
    }

    /// Divides a cell, and adds its parts.
    fn divide(&mut self, piece: Piece) {
        let Piece { cell, local, upper, .. } = piece;
        let target = self.target();
        let is_far = [0, 1].map(|side| self.goal.measured[side] && local[side].reach > target);
        // The points of a cell around a face that are outside count, too, so the cell must be
        // thinner than the depth is to be known.
        let share = if self.goal.threshold.is_some() { 0.25 } else { 0.5 * self.goal.effort.relative_width };
        let divider = Divider {
            sides: self.sides,
            measured: self.goal.measured,
            bounded: [0, 1].map(|side| self.is_bounded(side)),
            slack: self.slack,
            target,
            half_thickness: (share * target).max(4.0 * self.slack),
        };
        let planes = divider.planes(&cell, &local, is_far);
        let mut rest = vec![cell];
        let mut done = Vec::new();
        for plane in &planes {
            let Some(cell) = rest.pop() else { break };
            match cell.cut(plane, self.slack) {
                Some([below, above]) => {
                    done.extend(above);
                    rest.extend(below);
                }
                None => rest.push(cell),
            }
        }
        done.append(&mut rest);
        if let [cell] = &done[..] {
            match cell.cut(&middle(cell), self.slack) {
                Some([Some(below), Some(above)]) => done = vec![below, above],
                // The cell has too many planes to be cut, but its box can be.
                None => done = vec![Cell::cuboid(&cell.bounds())],
                // The cell is as small as the rounding.
                _ => {
                    self.settled = self.settled.max(upper);
                    return;
                }
            }
        }
        for cell in done {
            self.push(cell, &local, upper);
        }
    }
}

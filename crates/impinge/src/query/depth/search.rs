//! Best-first search for the deepest common point of two solids.
//!
//! The common part of both boxes is one cell at first. A cell is divided by the planes of faces,
//! until none of a solid's faces reaches it: then the cell lies wholly inside or wholly outside the
//! solid. Around the plane of a face, a cell as thin as the search allows is cut out: all of its
//! points over the face are near the surface, whatever is inside. A cell is done if it lies outside
//! a solid, or if all of its points are known to be near the surfaces. The distance of a convex
//! face is convex, so its maximum over a cell is that of a corner.
//!
//! So parts with common flat walls need as many cells as faces touch, however large the walls are;
//! cubes would have to be as small as the depth.
//!
//! Proof: docs/notes/proof.md, L41. Guarded by `tests/it/solids/depth.rs`. Benchmark: `clash`.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::cell::{Cell, Plane};
use super::side::{Face, Side, gap};
use crate::budget::Budget;
use crate::math::vec3::{Vector, add, cross, dot, scale, squared_distance, sub, unit};
use crate::mesh::Containment;
use crate::primitive::point_triangle;

/// The points whose depth is searched, and how far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// Depth above which the search stops, as soon as a point proves it. Without it the greatest
    /// depth is searched.
    pub(super) threshold: Option<f64>,
    /// Whether the points outside the first solid are searched, in place of those inside.
    pub(super) outside_first: bool,
    /// The solids whose surfaces count: the depth is the greatest distance from one of them.
    pub(super) measured: [bool; 2],
    /// Maximum number of cells.
    pub(super) max_cells: usize,
}

/// The answer of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Depth that some point has at least, and that no point exceeds.
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// The point with the depth `lower`, in the frame of the search.
    pub(super) point: Option<Vector>,
    /// Whether a solid is open where the answer depends on it.
    pub(super) is_open: bool,
}

/// Number of faces in a cell above which the cell is halved, and not divided along one of them.
const MANY_FACES: usize = 12;

/// Relative width of the interval at which the search for the greatest depth stops.
const RELATIVE_WIDTH: f64 = 1.0 / 1024.0;

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
}

/// A cell that is not done.
struct Piece {
    cell: Cell,
    local: [Local; 2],
    /// No point of the cell that counts is deeper.
    upper: f64,
    number: usize,
}

/// One solid, seen from a cell.
#[derive(Clone)]
struct Local {
    /// The faces that may be the nearest to a point of the cell.
    near: Vec<u32>,
    /// The faces that reach the cell.
    touching: Vec<u32>,
    /// Whether all points of the cell are known to be on the side of the surface that counts.
    is_inside: bool,
    /// No point of the cell is farther from the surface.
    reach: f64,
}

impl<'s, 'm> Search<'s, 'm> {
    pub(super) fn new(sides: &'s [Side<'m>; 2], goal: Goal, slack: f64, margin: f64) -> Self {
        let found = Found { lower: 0.0, upper: f64::INFINITY, point: None, is_open: false };
        Self { sides, goal, slack, margin, found, settled: 0.0, heap: BinaryHeap::new(), count: 0 }
    }

    /// Searches the points of a box.
    pub(super) fn run(mut self, bounds: &[Vector; 2], budget: &Budget<'_>) -> Found {
        // The box is grown, so that a box without thickness has some.
        let grown = [bounds[0].map(|x| x - 4.0 * self.slack), bounds[1].map(|x| x + 4.0 * self.slack)];
        let all = [0, 1].map(|side| (0..self.sides[side].faces.len() as u32).collect::<Vec<_>>());
        let local =
            all.map(|faces| Local { near: faces.clone(), touching: faces, is_inside: false, reach: f64::INFINITY });
        self.push(Cell::cuboid(&grown), &local, f64::INFINITY);
        while let Some(piece) = self.heap.pop() {
            if piece.upper <= self.target() || self.is_decided() {
                self.settled = self.settled.max(piece.upper);
                break;
            }
            if self.count > self.goal.max_cells || budget.is_spent() {
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

    fn is_decided(&self) -> bool {
        self.goal.threshold.is_some_and(|threshold| self.found.lower > threshold)
    }

    /// Returns the depth up to which cells are done.
    fn target(&self) -> f64 {
        match self.goal.threshold {
            Some(threshold) => threshold,
            None => (self.found.lower * (1.0 + RELATIVE_WIDTH)).max(16.0 * self.slack),
        }
    }

    /// Returns half of the thickness of the cells along faces.
    fn half_thickness(&self) -> f64 {
        (0.25 * self.target()).max(4.0 * self.slack)
    }

    /// Adds a cell, unless it is done. `parent` has the lists of a cell that holds it.
    fn push(&mut self, cell: Cell, parent: &[Local; 2], upper: f64) {
        self.count += 1;
        let [low, high] = cell.bounds();
        let bounds = [low.map(|x| x - self.slack), high.map(|x| x + self.slack)];
        let mut local = [0, 1].map(|side| {
            let faces = &self.sides[side].faces;
            let reaches = |&&face: &&u32| {
                let face = &faces[face as usize];
                gap(&face.bounds, &bounds) <= 0.0 && self.reaches(face, &cell)
            };
            Local {
                near: Vec::new(),
                touching: parent[side].touching.iter().filter(reaches).copied().collect(),
                ..parent[side]
            }
        });
        for side in 0..2 {
            if local[side].touching.is_empty() && !local[side].is_inside {
                match self.side_of(side, &cell) {
                    Some(false) => return,
                    Some(true) => local[side].is_inside = true,
                    None => {}
                }
            }
        }
        let mut cell_upper: f64 = 0.0;
        for side in (0..2).filter(|&side| self.goal.measured[side]) {
            let own = &mut local[side];
            own.reach = self.reach(side, &cell, &parent[side].near).min(parent[side].reach);
            cell_upper = cell_upper.max(own.reach);
            let faces = &self.sides[side].faces;
            let is_near = |&&face: &&u32| gap(&faces[face as usize].bounds, &bounds) <= own.reach;
            own.near = parent[side].near.iter().filter(is_near).copied().collect();
        }
        let upper = upper.min(cell_upper);
        if upper <= self.target() {
            self.settled = self.settled.max(upper);
            return;
        }
        self.heap.push(Piece { cell, local, upper, number: self.count });
    }

    /// Reports whether a face may reach a cell.
    fn reaches(&self, face: &Face, cell: &Cell) -> bool {
        if let Some(normal) = face.normal {
            let level = dot(&normal, &face.corners[0]);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for corner in cell.corners() {
                let height = dot(&normal, corner) - level;
                (low, high) = (low.min(height), high.max(height));
            }
            if low > self.slack || high < -self.slack {
                return false;
            }
        }
        !cell.clip(&face.corners, self.slack).is_empty()
    }

    /// Returns whether a cell that no face reaches is on the side of a solid that counts, or `None`
    /// if the solid is open and this differs in the cell.
    fn side_of(&mut self, side: usize, cell: &Cell) -> Option<bool> {
        let first = self.counts(side, &cell.center());
        if self.sides[side].is_closed {
            return first;
        }
        self.found.is_open = true;
        cell.corners().all(|corner| self.counts(side, corner) == first).then_some(first).flatten()
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
    fn reach(&self, side: usize, cell: &Cell, near: &[u32]) -> f64 {
        let mut best = f64::INFINITY;
        for &face in near {
            let corners = &self.sides[side].faces[face as usize].corners;
            let mut worst: f64 = 0.0;
            for corner in cell.corners() {
                worst = worst.max(point_triangle(corner, corners).0);
                if worst >= best {
                    break;
                }
            }
            best = best.min(worst);
        }
        let center = cell.center();
        let radius = cell.corners().map(|corner| squared_distance(&center, corner)).fold(0.0, f64::max).sqrt();
        let around = self.sides[side].nearest(&center, near).map_or(f64::INFINITY, |(squared, ..)| squared.sqrt());
        best.sqrt().min(around + radius) + self.slack
    }

    /// Tries the center of a cell, and the middle of each face in it, as the deepest point.
    fn try_points(&mut self, piece: &Piece) {
        self.try_point(piece, piece.cell.center());
        for side in 0..2 {
            let faces = &self.sides[side].faces;
            let largest = piece.local[side]
                .touching
                .iter()
                .map(|&face| piece.cell.clip(&faces[face as usize].corners, 0.0))
                .filter(|polygon| !polygon.is_empty())
                .max_by(|a, b| area(a).total_cmp(&area(b)));
            if let Some(polygon) = largest {
                let sum = polygon.iter().fold([0.0; 3], |sum, point| add(&sum, point));
                self.try_point(piece, scale(&sum, 1.0 / polygon.len() as f64));
            }
        }
    }

    /// Records a point, if it is the deepest so far.
    fn try_point(&mut self, piece: &Piece, point: Vector) {
        let depth = |side: usize| {
            let nearest = self.sides[side].nearest(&point, &piece.local[side].near);
            nearest.map_or(0.0, |(squared, ..)| squared.sqrt()).min(self.margin) - self.slack
        };
        let measured = (0..2).filter(|&side| self.goal.measured[side]);
        let deepest = measured.map(depth).fold(0.0, f64::max);
        if deepest <= self.found.lower {
            return;
        }
        let mut is_open = false;
        for side in 0..2 {
            is_open |= !self.sides[side].is_closed;
            if !piece.local[side].is_inside && self.counts(side, &point) != Some(true) {
                return;
            }
        }
        self.found.lower = deepest;
        self.found.point = Some(point);
        self.found.is_open |= is_open;
    }

    /// Divides a cell, and adds its parts.
    fn divide(&mut self, piece: Piece) {
        let Piece { cell, local, upper, .. } = piece;
        let mut planes: Vec<Plane> = Vec::new();
        let count: usize = local.iter().map(|own| own.touching.len()).sum();
        if count <= MANY_FACES {
            if let Some(face) = self.widest(&cell, &local) {
                planes = self.around(face);
            } else {
                planes.extend(self.beside_face(&cell, &local));
            }
        }
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
                // The cell is as small as the rounding, or has too many planes.
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

    /// Returns the face with the largest part in a cell, of those that the cell is not thin along.
    fn widest(&self, cell: &Cell, local: &[Local; 2]) -> Option<&Face> {
        let half = self.half_thickness() + self.slack;
        let faces = (0..2).flat_map(|side| local[side].touching.iter().map(move |&face| (side, face)));
        let faces = faces.map(|(side, face)| &self.sides[side].faces[face as usize]);
        let is_wide =
            |face: &&Face| cell.corners().any(|corner| face.height(corner).is_some_and(|height| height.abs() > half));
        let sized = faces.filter(is_wide).map(|face| (area(&cell.clip(&face.corners, self.slack)), face));
        sized.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, face)| face)
    }

    /// Returns the planes that cut a thin cell out around a face.
    fn around(&self, face: &Face) -> Vec<Plane> {
        let Some(normal) = face.normal else { return Vec::new() };
        let (level, half) = (dot(&normal, &face.corners[0]), self.half_thickness());
        vec![Plane { normal, height: level + half }, Plane { normal: scale(&normal, -1.0), height: half - level }]
    }

    /// Returns the plane that divides a cell best where only distances matter: beside the face that
    /// is nearest to its center, or else between the center and that face.
    fn beside_face(&self, cell: &Cell, local: &[Local; 2]) -> Option<Plane> {
        let side = (0..2)
            .filter(|&side| self.goal.measured[side])
            .max_by(|&x, &y| local[x].reach.total_cmp(&local[y].reach))?;
        let center = cell.center();
        let (squared, foot, face) = self.sides[side].nearest(&center, &local[side].near)?;
        let face = &self.sides[side].faces[face as usize];
        let edges = (0..3).filter_map(|at| edge_plane(face, at));
        let outermost = edges
            .map(|plane| {
                let beyond = cell.corners().map(|corner| plane.beyond(corner));
                (beyond.fold(f64::NEG_INFINITY, f64::max), plane)
            })
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((beyond, plane)) = outermost
            && beyond > self.half_thickness()
            && cell.corners().any(|corner| plane.beyond(corner) < -self.slack)
        {
            return Some(plane);
        }
        if squared.sqrt() <= 4.0 * self.slack {
            return None;
        }
        let normal = unit(&sub(&center, &foot))?;
        Some(Plane { normal, height: dot(&normal, &center) })
    }
}

/// Returns the plane through an edge of a face, at right angles to the face. The face is inside.
fn edge_plane(face: &Face, at: usize) -> Option<Plane> {
    let (from, to) = (face.corners[at], face.corners[(at + 1) % 3]);
    let normal = unit(&cross(&sub(&to, &from), &face.normal?))?;
    Some(Plane { normal, height: dot(&normal, &from) })
}

/// Returns the plane across the longest extent of a cell, through its middle.
fn middle(cell: &Cell) -> Plane {
    let [low, high] = cell.bounds();
    let extent = |axis: usize| high[axis] - low[axis];
    let longest = (0..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best });
    let mut normal = [0.0; 3];
    normal[longest] = 1.0;
    Plane { normal, height: 0.5 * (low[longest] + high[longest]) }
}

/// Returns twice the area of a polygon in a plane.
fn area(polygon: &[Vector]) -> f64 {
    let Some((first, rest)) = polygon.split_first() else { return 0.0 };
    let sum =
        rest.windows(2).fold([0.0; 3], |sum, pair| add(&sum, &cross(&sub(&pair[0], first), &sub(&pair[1], first))));
    dot(&sum, &sum).sqrt()
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    /// The greatest bound comes first; of equal ones, the cell that was added first.
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper).then(other.number.cmp(&self.number))
    }
}

//! Points of a cell that may be the deepest.

use super::super::cell::Polygon;
use super::super::face::largest_in;
use super::super::piece::Piece;
use super::{RANGE, Search};
use crate::math::vec3::{Vector, add, scale, sub};

/// Distance from a face at which a point in a cell is tried, in units of the slack.
const OFF_FACE: f64 = 4.0;

/// Share of the way to the center by which a corner of a cell is moved into it.
const INWARD: f64 = 1.0 / 4096.0;

/// Maximum number of faces in a cell whose parts are compared, to find a point to try.
const MAX_CLIPPED: usize = 32;

impl Search<'_, '_> {
    /// Returns the point behind the middle of a part of a face, on the side that counts.
    fn behind(&self, side: usize, normal: &Vector, part: &Polygon) -> Vector {
        let sum = part.iter().fold([0.0; 3], |sum, point| add(&sum, point));
        // Rounding may put a point of a face on its wrong side.
        let inward = if self.is_bounded(side) { -OFF_FACE * self.slack } else { OFF_FACE * self.slack };
        add(&scale(&sum, 1.0 / part.len() as f64), &scale(normal, inward))
    }

    /// Tries some points of a cell as the deepest: its center, the point behind the middle of the
    /// largest part of a face in it, and the corner with the longest way out.
    pub(super) fn try_points(&mut self, piece: &Piece) {
        let center = piece.cell.center();
        self.try_point(piece, center);
        for side in 0..2 {
            let faces =
                piece.local[side].touching.iter().take(MAX_CLIPPED).map(|&face| &self.sides[side].faces[face as usize]);
            let largest = largest_in(&piece.cell, faces.map(|face| (face.normal, face)), 0.0);
            if let Some((Some(normal), polygon)) = largest.filter(|(_, polygon)| !polygon.is_empty()) {
                self.try_point(piece, self.behind(side, &normal, &polygon));
            }
            if self.goal.measured[side]
                && self.is_bounded(side)
                && let Some((_, corner)) = self.sides[side].nearest_way_out(&piece.cell, &piece.local[side].facets)
            {
                self.try_point(piece, add(&corner, &scale(&sub(&center, &corner), INWARD)));
            }
        }
    }

    /// Records a point, if it is the deepest so far.
    fn try_point(&mut self, piece: &Piece, point: Vector) {
        let to_faces = |side: usize| {
            let nearest = self.sides[side].nearest(&point, &piece.local[side].near);
            let range = if self.goal.threshold.is_some() { RANGE * self.target() } else { self.margin };
            nearest.map_or(range, |(squared, ..)| squared.sqrt().min(range)) - self.slack
        };
        let measured = (0..2).filter(|&side| self.goal.measured[side]);
        let distances: Vec<(usize, f64)> = measured.map(|side| (side, to_faces(side))).collect();
        let is_deeper = |(_, distance): &&(usize, f64)| *distance > self.found.lower;
        if !distances.iter().any(|distance| is_deeper(&distance)) {
            return;
        }
        for side in 0..2 {
            if !piece.local[side].is_inside && self.counts(side, &point) != Some(true) {
                return;
            }
        }
        let depths = distances.iter().filter(is_deeper).map(|&(side, distance)| {
            if self.is_bounded(side) {
                self.sides[side].distance_from_outside(&point, distance, self.found.lower)
            } else {
                distance
            }
        });
        let deepest = depths.fold(0.0, f64::max);
        if deepest <= self.found.lower {
            return;
        }
        self.found.lower = deepest;
        self.found.point = Some(point);
    }
}

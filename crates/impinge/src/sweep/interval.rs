//! Two bodies over an interval of time: whether a plane or a distance keeps two pieces apart.
//!
//! # Source
//! Conservative advancement: Mirtich, *Impulse-based Dynamic Simulation of Rigid Body Systems*,
//! 1996, section 2.3. Bounds along a direction: Zhang, Lee, Kim, *Interactive continuous collision
//! detection for non-convex polyhedra*, The Visual Computer 22, 2006. Ours bounds the heights of
//! both pieces above planes of one fixed direction, by chords of their paths or by circles about
//! their axes, so that motion along the planes costs nothing.
//!
//! The proof is docs/notes/proof.md, L34. The tests are in `tests/it/sweep`.

use std::cell::Cell;

use super::body::Body;
use super::piece::{ABOVE, Piece, Volume};
use crate::convex::{parting, separation};
use crate::math::Pose;
use crate::math::vec3::{Vector, cross, dot, normalized, scale, scaled_length, sub};

/// Added to a required gap, so that products that underflow cannot prove one.
const VANISHING: f64 = 1e-150;

/// Both bodies at one time.
struct Moment {
    t: f64,
    poses: [Pose; 2],
    pivots: [Vector; 2],
}

impl Moment {
    fn at(bodies: &[Body<'_>; 2], t: f64) -> Self {
        let [a, b] = bodies;
        Self { t, poses: [a.motion.at(t), b.motion.at(t)], pivots: [a.motion.pivot_at(t), b.motion.pivot_at(t)] }
    }
}

/// Two bodies over an interval of time.
pub(super) struct Interval {
    ends: [Moment; 2],
    middle: Moment,
    /// Length of the interval.
    length: f64,
}

/// Whether two pieces are proved to be apart over an interval.
pub(super) enum Verdict {
    Apart,
    /// Nothing is proved. The direction from A to B is the one along which the gap is widest.
    Unknown(Vector),
}

impl Interval {
    pub(super) fn new(bodies: &[Body<'_>; 2], [low, high]: [f64; 2]) -> Self {
        let ends = [Moment::at(bodies, low), Moment::at(bodies, high)];
        Self { ends, middle: Moment::at(bodies, 0.5 * (low + high)), length: high - low }
    }

    /// Returns an upper bound on the distance by which two pieces approach each other over the
    /// interval.
    pub(super) fn approach(&self, bodies: &[Body<'_>; 2], pieces: [&Piece; 2]) -> f64 {
        let [a, b] = bodies;
        let linear = sub(&a.motion.linear(), &b.motion.linear());
        let turning: f64 = bodies
            .iter()
            .zip(pieces)
            .map(|(body, piece)| {
                let turn = body.motion.turn();
                turn.rate * piece.reach.across + turn.drift * body.reach
            })
            .sum();
        (scaled_length(&linear) + turning) * self.length * ABOVE + VANISHING
    }

    /// Tries to prove that two pieces are farther apart than a gap over the whole interval, up to
    /// rounding, starting with the direction `known`.
    /// Counts the distances that were computed exactly in `exact_distances`.
    pub(super) fn classify(
        &self,
        bodies: &[Body<'_>; 2],
        pieces: [&Piece; 2],
        known: Vector,
        gap: f64,
        exact_distances: &Cell<u64>,
    ) -> Verdict {
        let needed = gap + VANISHING;
        let mut best = Best { gap: f64::NEG_INFINITY, direction: known };
        let mut is_apart = |direction: Vector| {
            let found = self.gap_along(bodies, pieces, &direction);
            if found > best.gap {
                best = Best { gap: found, direction };
            }
            found > needed
        };
        if is_apart(known) {
            return Verdict::Apart;
        }
        if let Some(normal) = plane_normal(pieces) {
            is_apart(normal);
            return best.verdict(needed);
        }
        for direction in self.directions(bodies, pieces) {
            if is_apart(direction) {
                return Verdict::Apart;
            }
        }
        if pieces.iter().all(|piece| matches!(piece.volume, Volume::Box(_))) {
            return best.verdict(needed);
        }
        let approach = 0.5 * self.approach(bodies, pieces);
        let [pose_a, pose_b] = &self.middle.poses;
        let found = bodies[0].at(pieces[0], pose_a, |a| {
            bodies[1].at(pieces[1], pose_b, |b| {
                let found = parting(a, b);
                let is_proved = is_apart(normalized(&found.direction).unwrap_or(known));
                let enough = needed + approach;
                if is_proved || found.lower > enough || found.upper <= enough {
                    return is_proved || found.lower > enough;
                }
                exact_distances.set(exact_distances.get() + 1);
                separation(a, b).lower > enough
            })
        });
        if found.flatten() == Some(true) { Verdict::Apart } else { best.verdict(needed) }
    }

    /// Returns a lower bound on the gap between two pieces along a unit direction from A to B, at
    /// any time of the interval.
    fn gap_along(&self, bodies: &[Body<'_>; 2], pieces: [&Piece; 2], direction: &Vector) -> f64 {
        let heights_a = self.heights(0, &bodies[0], pieces[0], direction);
        let heights_b = self.heights(1, &bodies[1], pieces[1], &direction.map(|x| -x));
        let mut gap = f64::NEG_INFINITY;
        for a in heights_a.into_iter().flatten() {
            for b in heights_b.into_iter().flatten() {
                // Both heights are convex over time, so their sum is greatest at an end.
                gap = gap.max((-(a[0] + b[0])).min(-(a[1] + b[1])));
            }
        }
        gap
    }

    /// Returns upper bounds on the height of a piece along a direction: a convex function of time,
    /// by its values at both ends of the interval. The first bounds the paths of points by their
    /// chords, the second by circles about the axis and by a sphere about the pivot.
    fn heights(&self, side: usize, body: &Body<'_>, piece: &Piece, direction: &Vector) -> [Option<[f64; 2]>; 2] {
        if let Volume::HalfSpace { normal, base, level } = &piece.volume {
            let linear = body.motion.linear();
            let height = |t: f64| {
                let moved = [0, 1, 2].map(|k| base[k] + t * linear[k]);
                if direction == normal { dot(direction, &moved) + level } else { f64::INFINITY }
            };
            return [Some(self.ends.each_ref().map(|end| height(end.t))), None];
        }
        let turn = body.motion.turn();
        let chord = self.ends.each_ref().map(|end| {
            let pose = &end.poses[side];
            let along = body.turned(direction, pose);
            body.height(piece, &along) + dot(direction, pose.translation()) + piece.radius
        });
        if turn.rate == 0.0 {
            return [Some(chord), None];
        }
        let across = scaled_length(&cross(direction, &turn.axis)) * ABOVE + 4.0 * f64::EPSILON;
        let angle = turn.rate * self.length;
        let sagitta = 0.125 * angle * angle * across * piece.reach.across * ABOVE;
        let share = dot(direction, &turn.axis);
        let [low, high] = piece.reach.along;
        let level = if share > 0.0 { share * high } else { share * low };
        let circle = (across * piece.reach.across * ABOVE + level).min(piece.reach.from_pivot * ABOVE);
        let circle = circle + turn.drift * body.reach + piece.radius;
        let circle = self.ends.each_ref().map(|end| dot(direction, &end.pivots[side]) + circle);
        [Some(chord.map(|height| height + sagitta)), Some(circle)]
    }

    /// Returns directions along which two bounded pieces may be apart in the middle of the
    /// interval: between their centers, across the faces of boxes, across slabs and triangles, and
    /// across pairs of edges of triangles.
    fn directions(&self, bodies: &[Body<'_>; 2], pieces: [&Piece; 2]) -> impl Iterator<Item = Vector> {
        let mut found = Candidates { directions: [[0.0; 3]; 32], count: 0 };
        let mut centers = [[0.0; 3]; 2];
        let mut edges = [[[0.0; 3]; 3]; 2];
        for side in 0..2 {
            let (body, piece, pose) = (&bodies[side], pieces[side], &self.middle.poses[side]);
            let turned = |axis: &Vector| pose.linear().map(|row| dot(&row, axis));
            let center = match &piece.volume {
                Volume::Box(volume) => {
                    let [x, y, z] = volume.half_axes.each_ref().map(turned);
                    if let Some((normal, _)) = &volume.slab {
                        found.push(turned(normal));
                    }
                    [cross(&y, &z), cross(&z, &x), cross(&x, &y)].into_iter().for_each(|axis| found.push(axis));
                    volume.center
                }
                Volume::Triangle([p, q, r]) => {
                    edges[side] = [sub(q, p), sub(r, q), sub(p, r)].each_ref().map(turned);
                    found.push(cross(&edges[side][0], &edges[side][1]));
                    [0, 1, 2].map(|k| p[k] / 3.0 + q[k] / 3.0 + r[k] / 3.0)
                }
                Volume::Core(point) => {
                    found.push(body.motion.turn().axis);
                    // The faces of boxes are across the axes of their frame, and so are the ends of
                    // cylinders and cones.
                    (0..3).for_each(|k| found.push(pose.linear().map(|row| row[k])));
                    *point
                }
                Volume::HalfSpace { .. } => [0.0; 3],
            };
            centers[side] = pose.apply(center);
        }
        let towards_b = sub(&centers[1], &centers[0]);
        found.push(towards_b);
        for side in 0..2 {
            // A body that turns stays inside the circles about its axis. The direction from the
            // axis to the other piece is where they leave the widest gap.
            let axis = bodies[side].motion.turn().axis;
            let away = sub(&centers[1 - side], &self.middle.pivots[side]);
            if axis != [0.0; 3] {
                found.push(sub(&away, &scale(&axis, dot(&away, &axis))));
            }
        }
        if let [Volume::Triangle(_), Volume::Triangle(_)] = pieces.map(|piece| piece.volume.clone()) {
            for edge in &edges[0] {
                edges[1].iter().for_each(|other| found.push(cross(edge, other)));
            }
        }
        let Candidates { directions, count } = found;
        directions.into_iter().take(count).filter_map(move |direction| {
            let unit = normalized(&direction)?;
            Some(if dot(&unit, &towards_b) < 0.0 { unit.map(|x| -x) } else { unit })
        })
    }
}

/// The direction along which two pieces have the widest gap so far.
struct Best {
    gap: f64,
    direction: Vector,
}

impl Best {
    fn verdict(self, needed: f64) -> Verdict {
        if self.gap > needed { Verdict::Apart } else { Verdict::Unknown(self.direction) }
    }
}

/// A list of directions of a limited length.
struct Candidates {
    directions: [Vector; 32],
    count: usize,
}

impl Candidates {
    fn push(&mut self, direction: Vector) {
        if self.count < self.directions.len() {
            self.directions[self.count] = direction;
            self.count += 1;
        }
    }
}

/// Returns the only direction from A to B along which a half-space can be apart from another piece,
/// or `None` if both pieces are bounded.
fn plane_normal(pieces: [&Piece; 2]) -> Option<Vector> {
    match pieces.map(|piece| &piece.volume) {
        [Volume::HalfSpace { normal, .. }, _] => Some(*normal),
        [_, Volume::HalfSpace { normal, .. }] => Some(normal.map(|x| -x)),
        _ => None,
    }
}

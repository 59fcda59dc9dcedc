//! Both solids of a depth query: their boxes in the world, and the frame and the precision of the
//! search.

use super::face::{gap, world_box, world_corners};
use super::facet::planes_of_convex;
use super::goal::{Found, Goal};
use super::search::Search;
use super::side::Side;
use super::volume::common_volume;
use crate::budget::Budget;
use crate::math::vec3::{Vector, add, scale, sub};
use crate::mesh::{Mesh, PlacedMesh};
use crate::primitive::CLOSED_FORM_ERROR;

/// Two solids with their boxes in the world.
pub(super) struct Solids<'m> {
    placed: [PlacedMesh<'m>; 2],
    boxes: [[Vector; 2]; 2],
}

/// The box that is searched, with the faces of both solids near it.
struct Site<'m> {
    /// The box, in the frame of the search.
    bounds: [Vector; 2],
    /// Origin of the frame of the search, in the world.
    origin: Vector,
    slack: f64,
    margin: f64,
    sides: [Side<'m>; 2],
}

impl Site<'_> {
    /// Returns bounds of the volume of the points of the box that are in both solids.
    fn volume(&self, budget: &Budget<'_>) -> [f64; 2] {
        common_volume(&self.sides, &self.bounds, self.slack, budget)
    }

    /// Returns the answer if some way along the normal of a facet takes one solid out of the other,
    /// and is no longer than the threshold.
    fn apart_along_facet(&self, goal: &Goal) -> Option<Found> {
        let threshold = goal.threshold.filter(|_| !goal.outside_first)?;
        let [a, b] = &self.sides;
        let longest = threshold - 2.0 * self.slack;
        let way_out = a.way_out_along_facet(b, longest).or_else(|| b.way_out_along_facet(a, longest))?;
        Some(Found { upper: way_out.max(0.0) + 2.0 * self.slack, resolution: 16.0 * self.slack, ..NOTHING })
    }

    /// Searches a goal, from a point in the world whose depth is known.
    fn search(&self, goal: Goal, known: Option<(f64, Vector)>, budget: &Budget<'_>) -> Found {
        if let Some(found) = self.apart_along_facet(&goal) {
            return found;
        }
        let known = known.map(|(depth, point)| (depth, sub(&point, &self.origin)));
        let found = Search::new(&self.sides, goal, (self.slack, self.margin), known).run(&self.bounds, budget);
        Found { point: found.point.map(|point| add(&point, &self.origin)), ..found }
    }
}

/// The budget ended the preparation of a search.
struct Spent;

/// The answer about solids whose boxes have no common point.
const NOTHING: Found = Found { lower: 0.0, upper: 0.0, point: None, resolution: 0.0 };

/// Ratio of each threshold to the one before, in the search for the greatest depth.
const STEP: f64 = 1.0 / 32.0;

/// Smallest threshold in units of the resolution. Cells along faces must be much thicker than
/// rounding, or rounding adds corners to them.
const SMALLEST: f64 = 64.0;

/// Distance that is added to bounds of depths, in units of the slack.
const MARGIN: f64 = 64.0;

/// Maximum number of thresholds.
const STEPS: i32 = 8;

/// Number of vertices up to which the box of a mesh is that of its vertices in the world, which is
/// smaller than the box of a turned box.
const MAX_VERTICES: usize = 4096;

impl<'m> Solids<'m> {
    /// Returns both solids, or `None` if one of them has no faces. If the question is the same for
    /// both orders, the solids get an order that depends on them alone, so that both orders have
    /// the same answer.
    pub(super) fn new(a: PlacedMesh<'m>, b: PlacedMesh<'m>, is_symmetric: bool) -> Option<Self> {
        let (mut placed, mut boxes) = ([a, b], [bounds(&a)?, bounds(&b)?]);
        if is_symmetric && comes_first((&b, &boxes[1]), (&a, &boxes[0])) {
            placed.swap(0, 1);
            boxes.swap(0, 1);
        }
        Some(Self { placed, boxes })
    }

    /// Reports whether the box of the first solid, grown by a margin, holds that of the second.
    pub(super) fn first_box_holds_second(&self, margin: f64) -> bool {
        let [[low, high], [inner_low, inner_high]] = &self.boxes;
        (0..3).all(|axis| inner_low[axis] >= low[axis] - margin && inner_high[axis] <= high[axis] + margin)
    }

    /// Reports whether the first solid, if it is convex and has common material with the second,
    /// holds the second up to a tolerance. Returns `None` if the vertices do not tell.
    pub(super) fn convex_holds_second(&self, tolerance: f64, budget: &Budget<'_>) -> Option<bool> {
        let [outer, inner] = &self.placed;
        let origin = middle(&self.boxes[1]);
        let slack = self.slack(&origin);
        let planes = planes_of_convex(outer, (&origin, slack), budget)?;
        let (mut is_held, mut overhang) = (true, 0.0_f64);
        for (plane, beyond_plane) in &planes {
            overhang = overhang.max(*beyond_plane);
            for face in 0..inner.mesh.faces().len() as u32 {
                let corners = world_corners(inner, face, &origin);
                let beyond = corners.iter().map(|corner| plane.beyond(corner)).fold(f64::NEG_INFINITY, f64::max);
                if beyond > tolerance + beyond_plane + slack {
                    return Some(false);
                }
                is_held &= beyond <= 4.0 * slack;
            }
        }
        (is_held && overhang + 64.0 * slack <= tolerance).then_some(true)
    }

    /// Returns the part of space that the goal is about: the common part of both boxes, or the box
    /// of the second solid. `None` if it is empty.
    fn region(&self, goal: &Goal) -> Option<[Vector; 2]> {
        let [[a_low, a_high], [b_low, b_high]] = self.boxes;
        if goal.outside_first {
            return Some(self.boxes[1]);
        }
        let low: Vector = std::array::from_fn(|axis| a_low[axis].max(b_low[axis]));
        let high: Vector = std::array::from_fn(|axis| a_high[axis].min(b_high[axis]));
        (gap(&self.boxes[0], &self.boxes[1]) <= 0.0).then_some([low, high])
    }

    /// Returns the greatest distance from the surface that a point of a measured solid can have, up
    /// to rounding.
    fn inradius_bound(&self, goal: &Goal) -> f64 {
        let half = |&[low, high]: &[Vector; 2]| {
            (0..3).map(|axis| 0.5 * (high[axis] - low[axis])).fold(f64::INFINITY, f64::min)
        };
        if goal.outside_first { f64::INFINITY } else { half(&self.boxes[0]).max(half(&self.boxes[1])) }
    }

    /// Returns the length of the shortest way along an axis that takes one box out of the other. It
    /// takes each common point out of one solid, and its reverse out of the other.
    fn way_out_of_boxes(&self) -> f64 {
        let [[a_low, a_high], [b_low, b_high]] = self.boxes;
        let along = |axis: usize| (a_high[axis] - b_low[axis]).min(b_high[axis] - a_low[axis]);
        (0..3).map(along).fold(f64::INFINITY, f64::min)
    }

    /// Reports whether the inside of both solids is known everywhere: both meshes are closed.
    pub(super) fn are_closed(&self) -> bool {
        self.placed.iter().all(|placed| placed.mesh.is_closed())
    }

    /// Searches the goal. The point of the answer is in the world frame.
    pub(super) fn search(&self, goal: Goal, budget: &Budget<'_>) -> Found {
        let range = goal.threshold.map_or(f64::INFINITY, |threshold| 2.0 * threshold);
        self.apart_along_axis(&goal).unwrap_or_else(|| match self.site(&goal, range, budget) {
            Ok(site) => site.map_or(NOTHING, |site| site.search(goal, None, budget)),
            Err(Spent) => self.unknown(&goal),
        })
    }

    /// Returns the answer of a search that did not begin.
    fn unknown(&self, goal: &Goal) -> Found {
        let slack = self.region(goal).map_or(0.0, |region| self.slack(&middle(&region)));
        Found { upper: self.inradius_bound(goal) + MARGIN * slack, ..NOTHING }
    }

    /// Searches the greatest depth. A search with a threshold costs less the larger the threshold
    /// is. So thresholds fall until a point is deeper, and the last search starts from that point.
    pub(super) fn greatest(&self, goal: Goal, budget: &Budget<'_>) -> Found {
        let site = match self.site(&goal, f64::INFINITY, budget) {
            Ok(Some(site)) => site,
            Ok(None) => return NOTHING,
            Err(Spent) => return self.unknown(&goal),
        };
        let beyond = |threshold: f64| {
            let goal = Goal { threshold: Some(threshold), ..goal };
            self.apart_along_axis(&goal).unwrap_or_else(|| site.search(goal, None, budget))
        };
        let [low, high] = site.bounds;
        let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        // Without a range, the margin bounds the depth. The box of the search does not: one solid
        // may be much larger.
        let mut best = Found { upper: site.margin, ..NOTHING };
        for step in 1..=STEPS {
            let threshold = size * STEP.powi(step);
            let found = beyond(threshold);
            // A tie leaves the bound of the threshold before.
            best = Found { upper: found.upper.min(best.upper), ..found };
            if found.lower > threshold {
                break;
            }
            if threshold * STEP < SMALLEST * found.resolution || budget.is_spent() {
                return best;
            }
        }
        let Some(point) = best.point else { return best };
        let last = site.search(goal, Some((best.lower, point)), budget);
        Found { upper: last.upper.min(best.upper).max(last.lower), ..last }
    }

    /// Returns bounds of the volume of the points that are in both solids.
    pub(super) fn common_volume(&self, goal: &Goal, budget: &Budget<'_>) -> [f64; 2] {
        match self.site(goal, 0.0, budget) {
            Ok(site) => site.map_or([0.0; 2], |site| site.volume(budget)),
            Err(Spent) => {
                let volume = |[low, high]: [Vector; 2]| (0..3).map(|axis| high[axis] - low[axis]).product::<f64>();
                [0.0, self.region(goal).map_or(0.0, volume)]
            }
        }
    }

    /// Returns the answer if some way along an axis takes one box out of the other, and is no
    /// longer than the threshold.
    fn apart_along_axis(&self, goal: &Goal) -> Option<Found> {
        let threshold = goal.threshold.filter(|_| !goal.outside_first)?;
        let slack = self.slack(&middle(&self.region(goal)?));
        let way_out = self.way_out_of_boxes() + 2.0 * slack;
        (way_out <= threshold).then_some(Found { upper: way_out, resolution: 16.0 * slack, ..NOTHING })
    }

    /// Returns the box of a search with the faces near it, or `None` if the box is empty. A face
    /// beyond the range is farther than any depth that decides.
    fn site(&self, goal: &Goal, range: f64, budget: &Budget<'_>) -> Result<Option<Site<'m>>, Spent> {
        let Some(region) = self.region(goal) else { return Ok(None) };
        let origin = middle(&region);
        let slack = self.slack(&origin);
        let margin = range.min(self.inradius_bound(goal)) + MARGIN * slack;
        let bounds = region.map(|corner| sub(&corner, &origin));
        let side = |placed| Side::new(placed, origin, &bounds, (margin, slack), budget).ok_or(Spent);
        let [a, b] = self.placed;
        Ok(Some(Site { bounds, origin, slack, margin, sides: [side(a)?, side(b)?] }))
    }

    /// Returns a bound of the rounding errors in the search: of the coordinates, which are rounded
    /// in the world and then taken relative to the origin, and of the closed forms of distances.
    fn slack(&self, origin: &Vector) -> f64 {
        let largest = |points: &[Vector]| points.iter().flatten().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let local: Vec<Vector> = self.boxes.iter().flatten().map(|corner| sub(corner, origin)).collect();
        let world = self.placed.map(|placed| magnitude(&placed)).into_iter().fold(0.0, f64::max);
        16.0 * CLOSED_FORM_ERROR * largest(&local) + 8.0 * f64::EPSILON * world
    }
}

fn middle([low, high]: &[Vector; 2]) -> Vector {
    std::array::from_fn(|axis| 0.5 * low[axis] + 0.5 * high[axis])
}

/// Returns the box about the faces of a mesh in the world, rounded, or `None` without faces.
fn bounds(placed: &PlacedMesh<'_>) -> Option<[Vector; 2]> {
    let [low, high] = placed.mesh.local_bounds()?;
    if placed.mesh.faces().len() > MAX_VERTICES {
        let center = middle(&[low, high]);
        let half = scale(&sub(&high, &low), 0.5 * (1.0 + 4.0 * f64::EPSILON));
        return Some(world_box(&placed.world_from_mesh, &[0.0; 3], &center, &half));
    }
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for &vertex in placed.mesh.faces().as_flattened() {
        let at = placed.world_from_mesh.apply(position(placed.mesh, vertex));
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(at[axis]);
            bounds[1][axis] = bounds[1][axis].max(at[axis]);
        }
    }
    Some(bounds)
}

fn position(mesh: &Mesh, vertex: u32) -> Vector {
    mesh.positions().get(vertex as usize)
}

/// Returns a bound of the numbers that are added up to place a mesh in the world.
fn magnitude(placed: &PlacedMesh<'_>) -> f64 {
    let Some([low, high]) = placed.mesh.local_bounds() else { return 0.0 };
    let (linear, translation) = (placed.world_from_mesh.linear(), placed.world_from_mesh.translation());
    let row = |axis: usize| {
        let terms = (0..3).map(|k| linear[axis][k].abs() * low[k].abs().max(high[k].abs()));
        translation[axis].abs() + terms.sum::<f64>()
    };
    (0..3).map(row).fold(0.0, f64::max)
}

/// Reports whether a solid comes before another in an order that depends on their places and
/// faces, and not on the order of a caller.
fn comes_first(a: (&PlacedMesh<'_>, &[Vector; 2]), b: (&PlacedMesh<'_>, &[Vector; 2])) -> bool {
    let key = |(placed, bounds): (&PlacedMesh<'_>, &[Vector; 2])| (*bounds, placed.mesh.faces().len());
    let (first, second) = (key(a), key(b));
    if first != second {
        return first < second;
    }
    let corners = |placed: &PlacedMesh<'_>| {
        let (mesh, pose) = (placed.mesh.clone(), placed.world_from_mesh);
        (0..mesh.faces().len() as u32).map(move |face| mesh.corners(face).map(|corner| pose.apply(corner)))
    };
    corners(a.0).lt(corners(b.0))
}

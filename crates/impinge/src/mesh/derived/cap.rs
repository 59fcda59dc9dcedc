//! The distance from the border beyond which an open mesh may be treated as closed
//! (docs/notes/proof.md, L19a).
//!
//! Let the cap be a surface that has the border of the mesh, reversed, as its own border. The mesh
//! and the cap together are closed and wind around every point off them an integer number of times.
//! The winding number of the mesh alone is that integer less the solid angle of the cap over 4π. A
//! cap of area S is seen from a point at distance d under a solid angle of at most S / d². So
//! beyond the reach of the border, d = √(S / 2π), the two differ by less than 1/2: a point is in
//! the solid of the mesh exactly if the integer is not zero. Beyond twice the reach they differ by
//! less than 1/8.
//!
//! Any cap is valid, and a smaller cap proves more. Each loop of the border is closed by clipping
//! the ear of least area repeatedly. A crack between faces whose edges do not quite fit has a cap
//! of nearly no area.
//!
//! Guarded by `tests/it/solids/open.rs`.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use super::topology::BorderEdge;
use crate::exact::{AxisRay, Corners, PosedPoint};
use crate::input::InputError;
use crate::math::Pose;
use crate::math::vec3::{cross, length};
use crate::mesh::storage::positions::Positions;
use crate::volume::{BoundingVolume, MinMax};

/// The boxes about the loops of a border, and the distance from them beyond which the solid of the
/// mesh is that of a closed mesh. There are no boxes if the mesh is closed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cap {
    /// The boxes, in the mesh's own frame.
    boxes: Vec<MinMax>,
    /// Distance from the boxes, in the unit of the mesh's own frame.
    reach: f64,
}

/// Maximum number of loops that have a box of their own. Every face in question is compared to each
/// box, so more boxes cost time, and fewer boxes prove less about a mesh with many small holes.
const MAX_BOXES: usize = 256;

/// Error bound of one triangle's area, in units of the squared size of the border. The differences,
/// the cross product and the root add up to less than 16 units of 2^-53, because no coordinate of a
/// difference is above 1. This is four times as much.
const AREA_ERROR: f64 = 1.0 / (1_u64 << 47) as f64;

impl Cap {
    /// Computes the boxes about the cap of a border between vertices at these positions.
    ///
    /// # Complexity
    /// O(n log n) in the edges of the border.
    pub(in crate::mesh) fn of(positions: &Positions, border: &[BorderEdge]) -> Self {
        let at = |vertex: u32| positions.get(vertex as usize);
        let loops = loops_of(border);
        let mut boxes: Vec<MinMax> =
            loops.iter().filter_map(|path| bounds_of(path.iter().map(|&vertex| at(vertex)))).collect();
        let Some(all) = boxes.iter().copied().reduce(|a, b| a.merged(&b)) else { return Self::default() };
        if boxes.len() > MAX_BOXES {
            boxes = vec![all];
        }
        // Areas are in units of the squared size of the border, so that no square vanishes or
        // overflows.
        let size = (0..3).fold(f64::MIN_POSITIVE, |most, k| most.max(all.max()[k] - all.min()[k]));
        let area: f64 = loops.iter().map(|path| area_of_cap(path, |p, q| scaled_difference(at(p), at(q), size))).sum();
        let reach = (area / std::f64::consts::TAU).sqrt() * size * (1.0 + 1e-9);
        Self { boxes, reach }
    }

    /// Reports whether a triangle of the mesh, in the mesh's own frame, is proved to be beyond
    /// twice the reach of the border.
    pub(crate) fn is_far_from(&self, corners: &Corners) -> bool {
        let bounds = bounds_of(corners.iter().copied());
        bounds.is_some_and(|bounds| self.boxes.iter().all(|near| !grown(near, 2.0 * self.reach).overlaps(&bounds)))
    }

    /// Reports whether the start of a ray is proved to be beyond the reach of the border, and the
    /// ray to cross no cap. Then the point is in the solid of the mesh exactly if the crossings of
    /// the ray with faces of the mesh do not add up to zero.
    pub(in crate::mesh) fn is_clear_of(&self, point: &PosedPoint<'_>, ray: AxisRay) -> bool {
        let low: [f64; 3] = std::array::from_fn(|k| (point.approximate[k] - point.error[k]).next_down());
        let high: [f64; 3] = std::array::from_fn(|k| (point.approximate[k] + point.error[k]).next_up());
        self.boxes.iter().all(|near| {
            let (min, max) = (near.min(), near.max());
            let is_within_reach = (0..3)
                .all(|k| (min[k] - self.reach).next_down() <= high[k] && low[k] <= (max[k] + self.reach).next_up());
            let may_cross = (0..3).all(|k| {
                let [rises, falls] = [ray.ascending, !ray.ascending].map(|is_along| is_along && k == ray.axis);
                (falls || low[k] <= max[k]) && (rises || min[k] <= high[k])
            });
            !is_within_reach && !may_cross
        })
    }

    /// Returns boxes in the world frame, rounded outward, that hold everything within reach of the
    /// border.
    ///
    /// # Errors
    /// Returns an error if a box is beyond the range of [`MinMax`].
    pub(crate) fn within_reach(&self, world_from_mesh: &Pose) -> Result<Vec<MinMax>, InputError> {
        self.boxes.iter().map(|near| grown(near, self.reach).moved(world_from_mesh)).collect()
    }
}

/// Splits a border into loops, each a list of vertices.
fn loops_of(border: &[BorderEdge]) -> Vec<Vec<u32>> {
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut starts = Vec::new();
    for edge in border {
        let (from, to) = if edge.times > 0 { (edge.from, edge.to) } else { (edge.to, edge.from) };
        for _ in 0..edge.times.unsigned_abs() {
            next.entry(from).or_default().push(to);
            starts.push(from);
        }
    }
    // Each vertex has as many edges that lead to it as edges that leave it, so a walk can only end
    // at a vertex that it has passed.
    let mut loops = Vec::new();
    for start in starts {
        let mut path = vec![start];
        let mut place = HashMap::from([(start, 0)]);
        while let Some(to) = path.last().and_then(|from| next.get_mut(from)).and_then(Vec::pop) {
            if let Some(&since) = place.get(&to) {
                let closed: Vec<u32> = path.drain(since..).collect();
                closed.iter().for_each(|vertex| {
                    place.remove(vertex);
                });
                loops.push(closed);
            }
            place.insert(to, path.len());
            path.push(to);
        }
    }
    loops
}

/// Returns an upper bound for the area of a cap of a loop, by clipping the ear of least area
/// repeatedly. `between` returns the vector from one vertex to another.
fn area_of_cap(path: &[u32], between: impl Fn(u32, u32) -> [f64; 3]) -> f64 {
    let len = path.len();
    let (mut before, mut after): (Vec<usize>, Vec<usize>) =
        ((0..len).map(|i| (i + len - 1) % len).collect(), (0..len).map(|i| (i + 1) % len).collect());
    let ear = |before: &[usize], after: &[usize], i: usize| {
        let (u, v) = (between(path[i], path[before[i]]), between(path[i], path[after[i]]));
        let area = 0.5 * length(&cross(&u, &v));
        // Numbers that are not negative have the same order as their bits.
        (Reverse(area.to_bits()), i)
    };
    let mut ears: BinaryHeap<(Reverse<u64>, usize)> = (0..len).map(|i| ear(&before, &after, i)).collect();
    let mut is_clipped = vec![false; len];
    let (mut area, mut left) = (0.0, len);
    while left > 2
        && let Some(least) = ears.pop()
    {
        let (Reverse(bits), i) = least;
        if is_clipped[i] || ear(&before, &after, i) != least {
            continue;
        }
        is_clipped[i] = true;
        area += f64::from_bits(bits) + AREA_ERROR;
        left -= 1;
        let (p, q) = (before[i], after[i]);
        (after[p], before[q]) = (q, p);
        ears.extend([p, q].map(|end| ear(&before, &after, end)));
    }
    area
}

fn scaled_difference(from: [f64; 3], to: [f64; 3], size: f64) -> [f64; 3] {
    std::array::from_fn(|k| (to[k] - from[k]) / size)
}

/// Returns the smallest box that holds some points, or `None` if there are no points.
pub(in crate::mesh) fn bounds_of(points: impl Iterator<Item = [f64; 3]>) -> Option<MinMax> {
    points.map(|point| MinMax::from_ordered(point, point)).reduce(|all, point| all.merged(&point))
}

/// Returns a box, grown on every side by a distance and rounded outward.
fn grown(bounds: &MinMax, by: f64) -> MinMax {
    MinMax::from_ordered(bounds.min().map(|x| (x - by).next_down()), bounds.max().map(|x| (x + by).next_up()))
}

//! The parts of a scene as obstacles of a robot: they stay in their places.

use std::collections::HashSet;
use std::ops::ControlFlow;

use super::cull::Limb;
use super::links::PlacedLink;
use crate::convex::{self, Core, Surface, Swept};
use crate::math::Pose;
use crate::math::vec3::{length, sub};
use crate::partition::{BoxTree, Partition};
use crate::scene::{PartId, Scene};
use crate::shape::Form;
use crate::volume::{MinMax, Proximity};

/// Maximum number of obstacles whose boxes are compared one by one. For more of them a tree finds
/// the boxes that are near.
const MAX_LISTED: usize = 16;

/// Maximum magnitude of a coordinate of a capsule that is compared with shapes, 2^100.
const MAX_COORDINATE: f64 = (1_u128 << 100) as f64;

/// Obstacles at their places.
#[derive(Debug)]
pub(super) struct Obstacles {
    parts: Vec<(PartId, PlacedLink)>,
    /// Tree of the boxes of the bounded obstacles, if there are many. Keys are indices.
    tree: Option<BoxTree>,
    /// Indices of the obstacles without a box.
    unbounded: Vec<usize>,
    /// Pairs of a link and an obstacle that are not checked.
    ignored: HashSet<(usize, PartId)>,
}

impl Obstacles {
    pub(super) fn new(scene: Option<&Scene>, ignored: &[(usize, PartId)]) -> Self {
        let place = |scene: &Scene, part| PlacedLink::new(scene.shape(part), Some(*scene.pose(part)));
        let parts: Vec<(PartId, PlacedLink)> =
            scene.map(|scene| scene.parts().map(|part| (part, place(scene, part))).collect()).unwrap_or_default();
        let boxes = || parts.iter().map(|(_, placed)| placed.bounds());
        let unbounded = (0..parts.len()).filter(|&at| parts[at].1.bounds().is_none() && !parts[at].1.is_nowhere());
        let bounded = |(at, bounds): (usize, Option<[[f64; 3]; 2]>)| {
            let [min, max] = bounds?;
            Some((at as u32, MinMax::new(min, max).ok()?))
        };
        let tree = (parts.len() > MAX_LISTED).then(|| boxes().enumerate().filter_map(bounded).collect());
        let unbounded = unbounded.collect();
        Self { parts, tree, unbounded, ignored: ignored.iter().copied().collect() }
    }

    /// Calls `visit` with the index of each obstacle that is compared with a link and may be within
    /// a limit, and with a lower bound of its distance. `limbs` are the capsules about the link, if
    /// any are known, and the rounding of their places.
    pub(super) fn distances(
        &self,
        link: usize,
        limbs: Option<(&[Limb], f64)>,
        limit: f64,
        mut visit: impl FnMut(usize, f64),
    ) {
        for (at, (part, placed)) in self.parts.iter().enumerate() {
            if placed.is_nowhere() || self.ignored.contains(&(link, *part)) {
                continue;
            }
            let least = match (limbs, placed.bounds()) {
                (Some((limbs, slack)), Some(bounds)) => {
                    let gaps = limbs.iter().map(|limb| gap_of_box(limb, bounds));
                    (gaps.fold(f64::INFINITY, f64::min) - slack).max(0.0)
                }
                _ => 0.0,
            };
            if least <= limit {
                visit(at, least);
            }
        }
    }

    /// Finds the obstacles that may be within a clearance of a link, in the order of the scene.
    /// `limbs` are the capsules about the link, if any are known, and the rounding of their places.
    pub(super) fn near(&self, link: usize, limbs: Option<(&[Limb], f64)>, clearance: f64, found: &mut Vec<usize>) {
        found.clear();
        let Some((limbs, slack)) = limbs else {
            found.extend((0..self.parts.len()).filter(|&at| self.is_compared(link, at)));
            return;
        };
        let clearance = clearance_with(clearance, slack);
        let Some(all) = ball_about(limbs) else { return };
        _ = self.overlapping(&all, clearance, &mut |at| {
            if self.is_compared(link, at) && may_reach(&all, &self.parts[at].1, clearance) {
                found.push(at);
            }
            ControlFlow::Continue(())
        });
        found.retain(|&at| limbs.iter().any(|limb| may_reach(limb, &self.parts[at].1, clearance)));
        found.sort_unstable();
    }

    /// Reports whether an obstacle may be within a clearance of a link that is in some capsules.
    pub(super) fn may_reach(&self, (limbs, slack): (&[Limb], f64), at: usize, clearance: f64) -> bool {
        let clearance = clearance_with(clearance, slack);
        limbs.iter().any(|limb| may_reach(limb, &self.parts[at].1, clearance))
    }

    /// Returns a lower bound of the distance of an obstacle and a link that is in some capsules: at
    /// least 7/8 of the distance of the nearest capsule, or of `within` if all are farther away.
    pub(super) fn least_distance(&self, (limbs, slack): (&[Limb], f64), at: usize, within: f64) -> f64 {
        let placed = &self.parts[at].1;
        let gap = |limb: &Limb| placed.bounds().map_or(0.0, |bounds| gap_of_box(limb, bounds));
        let nearest = limbs.iter().min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let mut least = clearance_with(within, slack);
        for limb in nearest.into_iter().chain(limbs) {
            if gap(limb) < least {
                least = least_distance(limb, placed, least);
            }
        }
        (least - slack).max(0.0)
    }

    /// Reports whether an obstacle is compared with a link.
    fn is_compared(&self, link: usize, at: usize) -> bool {
        let (part, placed) = &self.parts[at];
        !placed.is_nowhere() && (self.ignored.is_empty() || !self.ignored.contains(&(link, *part)))
    }

    /// Reports whether capsules may be within a clearance of an obstacle, by the box of each.
    pub(super) fn may_be_near(&self, limbs: &[Limb], clearance: f64) -> bool {
        let found = |_| ControlFlow::Break(());
        limbs.iter().any(|limb| self.overlapping(limb, clearance, &mut { found }).is_break())
    }

    /// Calls `visit` with the index of each obstacle that may be within a clearance of a capsule,
    /// by the boxes of both, until it breaks.
    fn overlapping(
        &self,
        limb: &Limb,
        clearance: f64,
        visit: &mut impl FnMut(usize) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let [start, end] = limb.ends;
        let reach = (limb.radius + clearance).next_up();
        let min = std::array::from_fn(|k| (start[k].min(end[k]) - reach).next_down());
        let max = std::array::from_fn(|k| (start[k].max(end[k]) + reach).next_up());
        self.unbounded.iter().try_for_each(|&at| visit(at))?;
        if let (Some(tree), Ok(bounds)) = (&self.tree, MinMax::new(min, max)) {
            return tree.overlapping(&bounds, &mut |key| visit(key as usize));
        }
        // Bounds that are not numbers overlap everything.
        let overlaps = |[low, high]: [[f64; 3]; 2]| (0..3).all(|k| !(min[k] > high[k] || low[k] > max[k]));
        let mut all = (0..self.parts.len()).filter(|&at| self.parts[at].1.bounds().is_some_and(overlaps));
        all.try_for_each(visit)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Returns an obstacle.
    pub(super) fn part(&self, at: usize) -> (PartId, &PlacedLink) {
        let (part, placed) = &self.parts[at];
        (*part, placed)
    }
}

/// Returns a ball that holds all capsules, or `None` for an empty list.
fn ball_about(limbs: &[Limb]) -> Option<Limb> {
    let ends = || limbs.iter().flat_map(|limb| limb.ends);
    let first = ends().next()?;
    let bounds = ends().fold([first; 2], |[min, max], end| {
        [std::array::from_fn(|k| min[k].min(end[k])), std::array::from_fn(|k| max[k].max(end[k]))]
    });
    let center: [f64; 3] = std::array::from_fn(|k| 0.5 * bounds[0][k] + 0.5 * bounds[1][k]);
    let reach = |limb: &Limb| limb.ends.iter().map(|end| length(&sub(end, &center))).fold(0.0, f64::max) + limb.radius;
    // The last term is more than squares that underflow lose.
    let radius = limbs.iter().map(reach).fold(0.0, f64::max) * (1.0 + 16.0 * f64::EPSILON) + 1e-150;
    Some(Limb { ends: [center; 2], radius })
}

/// Returns a clearance and the rounding of the places of capsules, rounded up.
fn clearance_with(clearance: f64, slack: f64) -> f64 {
    if slack > 0.0 { (clearance + slack).next_up() } else { clearance }
}

/// Returns a lower bound of the distance of a capsule and a box: that of the box about the capsule.
fn gap_of_box(limb: &Limb, [min, max]: [[f64; 3]; 2]) -> f64 {
    let [start, end] = limb.ends;
    let gap = |k: usize| (min[k] - start[k].max(end[k])).max(start[k].min(end[k]) - max[k]).max(0.0);
    let squared = (0..3).map(|k| gap(k) * gap(k)).sum::<f64>();
    squared.sqrt() * (1.0 - 16.0 * f64::EPSILON) - limb.radius
}

/// Reports whether a capsule may be within a clearance of an obstacle.
fn may_reach(limb: &Limb, placed: &PlacedLink, clearance: f64) -> bool {
    let (PlacedLink::At(shape), Some(capsule)) = (placed, capsule_of(limb, clearance)) else { return true };
    shape.parts_near(Some(capsule.world_bounds()), clearance).into_iter().any(|part| {
        let proximity = match shape.parts()[part as usize].form() {
            Form::Surface(surface) if is_open_solid(&surface) => Proximity::Undecided,
            Form::Surface(surface) => surface.nearness(&capsule, clearance),
            Form::Field(field) => field.nearness(&capsule, clearance),
            Form::Convex(set) => convex::nearness(&capsule, &set, clearance),
            Form::HalfSpace(plane) => plane.nearness(&capsule, clearance),
        };
        proximity != Proximity::Apart
    })
}

/// Returns a lower bound of the distance of a capsule and an obstacle: at least 7/8 of it, or of
/// `within` if they are farther apart. It is zero if they may intersect.
fn least_distance(limb: &Limb, placed: &PlacedLink, within: f64) -> f64 {
    let (PlacedLink::At(shape), Some(capsule)) = (placed, capsule_of(limb, 0.0)) else { return 0.0 };
    let near = shape.parts_near(Some(capsule.world_bounds()), within);
    near.into_iter().fold(within, |least, part| match shape.parts()[part as usize].form() {
        Form::Surface(surface) if is_open_solid(&surface) => 0.0,
        Form::Surface(surface) => surface.least_distance(&capsule, least),
        Form::Field(field) => field.least_distance(&capsule, least),
        Form::Convex(set) => least.min(convex::separation(&capsule, &set).lower),
        Form::HalfSpace(plane) => least.min(plane.separation(&capsule).lower),
    })
}

/// Returns a capsule as a convex set, or `None` if it is too far away or too large.
fn capsule_of(limb: &Limb, clearance: f64) -> Option<Swept<'_>> {
    let mut numbers = limb.ends.as_flattened().iter().chain([&limb.radius, &clearance]);
    let capsule = Swept { core: Core::Points(&limb.ends), pose: &Pose::IDENTITY, radius: [limb.radius; 2] };
    numbers.all(|x| x.abs() <= MAX_COORDINATE).then_some(capsule)
}

/// Reports whether a surface is that of a solid with holes. It may enclose a point of a link and no
/// point that was tested of the capsule about the link.
fn is_open_solid(surface: &Surface<'_>) -> bool {
    surface.is_solid && !surface.mesh.is_closed()
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;
    use impinge_testkit::generate::solids::cuboid;

    use super::*;
    use crate::mesh::{Mesh, Positions};
    use crate::query;
    use crate::shape::Shape;

    fn mesh(plain: impinge_testkit::Mesh) -> Mesh {
        Mesh::new(Positions::F64(plain.vertices), plain.faces).expect("a mesh")
    }

    /// Capsules on a half-integer grid among shapes of all kinds that are near by their boxes. The
    /// obstacles that are found are exactly those that queries find, except for an open solid.
    #[test]
    fn obstacles_near_capsules_are_those_of_queries() {
        let room = mesh(cuboid([-4.0; 3], [4.0; 3]));
        let block = mesh(cuboid([-0.5; 3], [0.5; 3]));
        let mut open = cuboid([1.0; 3], [3.0; 3]);
        open.faces.truncate(11);
        let open = mesh(open);
        let bars = [-1.0, 1.0].map(|x| {
            let bar = Shape::cuboid([0.25, 2.0, 0.25]).expect("a bar");
            (bar, Pose::from_translation([x, 0.0, 0.0]).expect("a pose"))
        });
        let shapes = [
            Shape::from(&room),
            Shape::from(block.solid()),
            Shape::from(open.solid()),
            Shape::compound(&bars).expect("a compound"),
            Shape::sphere([0.0; 3], 1.0).expect("a sphere"),
            Shape::half_space([0.0, 0.0, 1.0], -3.0).expect("a half-space"),
        ];
        let mut rng = Rng::new(56);
        let (mut near, mut apart, mut of_boxes) = (0, 0, 0);
        for round in 0..200 {
            let mut scene = Scene::new();
            for part in 0..[shapes.len(), 4 * shapes.len()][round % 2] {
                let moved = Pose::from_translation([0; 3].map(|_| rng.integer(-4, 4) as f64));
                let (shape, moved) = (shapes[part % shapes.len()].clone(), moved.expect("a pose"));
                scene.add(part.to_string(), shape, moved).expect("a part");
            }
            let ignored: Vec<_> = scene.parts().filter(|part| part.index() % 5 == 4).map(|part| (1, part)).collect();
            let obstacles = Obstacles::new(Some(&scene), &ignored);
            let limbs: Vec<Limb> = (0..2)
                .map(|_| Limb { ends: [[0; 3]; 2].map(|x| x.map(|_| 0.5 * rng.integer(-8, 8) as f64)), radius: 0.5 })
                .collect();
            let (link, clearance) = (round / 2 % 2, 0.25 * (round / 4 % 3) as f64);
            let mut found = Vec::new();
            obstacles.near(link, Some((&limbs, 0.0)), clearance, &mut found);
            for (at, part) in scene.parts().enumerate() {
                let obstacle = scene.shape(part).at(*scene.pose(part)).expect("a place");
                let is_near = limbs.iter().any(|limb| {
                    let capsule = Shape::capsule(limb.ends[0], limb.ends[1], limb.radius + clearance);
                    let capsule = capsule.expect("a capsule").at(Pose::IDENTITY).expect("a place");
                    query::proximity(&capsule, &obstacle) != Proximity::Apart
                });
                let is_near = is_near && !ignored.contains(&(link, part));
                if at % shapes.len() == 2 {
                    assert!(!is_near || found.contains(&at), "{limbs:?}");
                    continue;
                }
                assert_eq!(found.contains(&at), is_near, "part {at}: {limbs:?} {clearance}");
                near += u32::from(is_near);
                let has_near_box = limbs
                    .iter()
                    .any(|limb| obstacle.bounds().is_none_or(|bounds| gap_of_box(limb, bounds) <= clearance));
                of_boxes += u32::from(!is_near && has_near_box && !ignored.contains(&(link, part)));
                apart += u32::from(!is_near);
            }
            assert!(found.is_sorted());
        }
        assert!(near > 400 && apart > 400 && of_boxes > 100, "{near} {apart} {of_boxes}");
    }

    /// Capsules on a half-integer grid, which touch faces and are inside of solids.
    #[test]
    fn least_distances_are_within_an_eighth_of_those_of_queries() {
        let block = mesh(cuboid([-2.0; 3], [2.0; 3]));
        let waves: Vec<f32> = (0..81_i16).map(|at| f32::from(at * at % 7) * 0.25).collect();
        let field = crate::HeightField::new(9, 9, [0.5, 0.5], waves).expect("a field");
        let balls = [-2.0, 0.0, 2.0].map(|x| {
            (Shape::sphere([0.0; 3], 0.25).expect("a ball"), Pose::from_translation([x, 1.0, 0.0]).expect("a pose"))
        });
        let shapes = [
            Shape::from(&block),
            Shape::from(block.solid()),
            Shape::compound(&balls).expect("a compound"),
            Shape::half_space([0.0, 0.0, 1.0], -3.0).expect("a half-space"),
            Shape::from(&field),
        ];
        let mut scene = Scene::new();
        for (number, shape) in shapes.iter().enumerate() {
            scene.add(number.to_string(), shape.clone(), Pose::IDENTITY).expect("a part");
        }
        let obstacles = Obstacles::new(Some(&scene), &[]);
        let mut rng = Rng::new(57);
        let (mut zero, mut near, mut beyond) = (0, 0, 0);
        for round in 0..400 {
            let limbs: Vec<Limb> = (0..1 + round % 3)
                .map(|_| Limb { ends: [[0; 3]; 2].map(|x| x.map(|_| 0.5 * rng.integer(-8, 8) as f64)), radius: 0.25 })
                .collect();
            let within = [0.25, 1.0, 4.0, f64::INFINITY][round % 4];
            for (at, part) in scene.parts().enumerate() {
                let obstacle = scene.shape(part).at(Pose::IDENTITY).expect("a place");
                let distances = limbs.iter().map(|limb| {
                    let capsule = Shape::capsule(limb.ends[0], limb.ends[1], limb.radius).expect("a capsule");
                    let found = query::distance(capsule.at(Pose::IDENTITY).expect("a place"), &obstacle);
                    [found.lower, found.upper]
                });
                let [lower, upper] = distances.fold([f64::INFINITY; 2], |a, b| [a[0].min(b[0]), a[1].min(b[1])]);
                let least = obstacles.least_distance((&limbs, 0.0), at, within);
                assert!(least <= upper, "part {at}: {least} above {upper}, {limbs:?}");
                assert!(least >= 0.875 * lower.min(within) * (1.0 - 1e-12), "part {at}: {least}, {lower}, {limbs:?}");
                zero += u32::from(least == 0.0);
                near += u32::from(least > 0.0 && lower <= within);
                beyond += u32::from(lower > within);
            }
        }
        assert!(zero > 200 && near > 200 && beyond > 200, "{zero} {near} {beyond}");
    }
}

//! The nearest points of two meshes, by branch and bound over both trees.
//!
//! Source: Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*, ICRA 2000, for distance by
//! the descent of two trees; ours opens eight children against eight, nearest first, on bounds that are proved.
//!
//! Every pair of faces has a *value*: zero where they intersect, by the exact predicate, else the distance of their metric
//! corners by the closed form, which depends on nothing but the pair and the query. The answer is the least (value, face
//! of a, face of b) of all pairs. A pair is left out only where it is proved to be worse, or to be no better and later.
//! So neither the order of the descent nor the vector unit can be seen in the answer.

mod bounds;
mod leaf;
mod profile;

use std::ops::ControlFlow::{self, Break, Continue};

use fearless_simd::{Simd, dispatch};

use super::metric::Metric;
use super::{Mesh, Options, Placed};
use crate::exact::{Placement, triangles_intersect, triangles_within};
use crate::hierarchy::{BoxLanes, Child, Node, bits};
use crate::primitive::{Vector, Witness, common_point, separation, triangle_triangle};
use crate::simd::{LANES, by_axis};
use crate::volume::Aabb;
use bounds::Bounds;
use leaf::{Facing, Leaf};
use profile::Profiles;

/// The nearest points of two meshes, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) points: [Vector; 2],
    pub(crate) faces: [u32; 2],
}

/// The nearest points, none where a mesh has no faces. The faces of `seed`, if there are such, are tried first.
pub(crate) fn nearest(a: Placed<'_>, b: Placed<'_>, seed: Option<[u32; 2]>, options: &Options) -> Option<Nearest> {
    let mut search = Search::new(a, b, options, f64::INFINITY)?;
    search.run(seed, options);
    search.answer.best.map(|best| search.scene.finish(&best, search.answer.values_left == 0))
}

/// Faces that are no farther apart than `clearance`, if there are such; those of `seed` are tried first.
pub(crate) fn within(
    a: Placed<'_>,
    b: Placed<'_>,
    clearance: f64,
    seed: Option<[u32; 2]>,
    options: &Options,
) -> Option<[u32; 2]> {
    if clearance.is_nan() || clearance < 0.0 {
        return None;
    }
    let mut search = Search::new(a, b, options, clearance)?;
    search.run(seed, options);
    search.answer.kept
}

/// How many pairs of faces get a value at most, before only such are looked for as are nearer by more than what values may
/// be off by. Only meshes of which millions of pairs are equally near reach it, such as flat ones far apart; the
/// interval stays proved. A value takes about a microsecond.
const MOST_VALUES: usize = 1 << 24;

/// Children whose boxes differ in size by more than this are not opened together: the larger one alone comes nearer to
/// the other's size.
const OPENED_TOGETHER: f32 = 4.0;

/// Leaves of either mesh that are kept at hand; a power of two. They fill half of a second cache.
const LEAVES_AT_HAND: usize = 128;

/// Guest nodes whose boxes are kept carried over; a power of two.
const CARRIED_AT_HAND: usize = 32;

/// A pair of faces with its value, in metric units.
#[derive(Clone, Copy, Debug)]
struct Valued {
    value: f64,
    faces: [u32; 2],
    witness: Witness,
}

impl Valued {
    fn precedes(&self, other: &Self) -> bool {
        self.value < other.value || (self.value == other.value && self.faces < other.faces)
    }
}

/// What does not change during a search.
struct Scene<'a> {
    meshes: [&'a Mesh; 2],
    metric: Metric,
    placement: Placement,
    bounds: Bounds,
    /// The clearance that is asked for, in world units; infinite where the nearest points are.
    clearance: f64,
}

/// What is known so far.
struct Answer {
    best: Option<Valued>,
    /// Faces that are within the clearance.
    kept: Option<[u32; 2]>,
    /// What is farther than this, in metric units, does not matter; the same in single precision; and for nodes.
    cut: f64,
    limit: f32,
    node_limit: f32,
    values_left: usize,
}

/// A child of a node.
#[derive(Clone, Copy, Debug)]
struct Slot {
    node: u32,
    lane: u8,
}

/// Two children whose triangles are still to be compared, and a bound of their distance.
#[derive(Clone, Copy, Debug)]
struct Task {
    bound: f32,
    host: Slot,
    guest: Slot,
}

struct Search<'a> {
    scene: Scene<'a>,
    answer: Answer,
    host: &'a [Node],
    guest: &'a [Node],
    tasks: Vec<Task>,
    leaves: [AtHand<Leaf>; 2],
    carried_host: AtHand<Carried>,
    carried_guest: AtHand<Carried>,
    profiles: Profiles,
}

#[derive(Clone, Debug)]
struct Carried {
    node: u32,
    boxes: BoxLanes,
}

impl<'a> Search<'a> {
    /// None where a mesh has no faces.
    fn new(a: Placed<'a>, b: Placed<'a>, options: &Options, clearance: f64) -> Option<Self> {
        if a.mesh.faces().is_empty() || b.mesh.faces().is_empty() {
            return None;
        }
        let metric = Metric::new(a, b);
        let bounds = Bounds::new(a, b, &metric, options.host);
        let (host, guest) = if bounds.swapped { (b.mesh, a.mesh) } else { (a.mesh, b.mesh) };
        let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
        let scene = Scene { meshes: [a.mesh, b.mesh], metric, placement, bounds, clearance };
        let mut answer = Answer {
            best: None,
            kept: None,
            cut: f64::INFINITY,
            limit: f32::INFINITY,
            node_limit: f32::INFINITY,
            values_left: MOST_VALUES,
        };
        let metric = &scene.metric;
        let farthest = if clearance == f64::INFINITY { metric.diagonal } else { clearance * metric.scale };
        answer.cut(&scene, farthest + 2.0 * metric.error);
        Some(Self {
            scene,
            answer,
            host: host.0.tree.nodes(),
            guest: guest.0.tree.nodes(),
            tasks: Vec::new(),
            leaves: [AtHand::new(LEAVES_AT_HAND), AtHand::new(LEAVES_AT_HAND)],
            carried_host: AtHand::new(CARRIED_AT_HAND),
            carried_guest: AtHand::new(CARRIED_AT_HAND),
            profiles: Profiles::new(),
        })
    }

    fn run(&mut self, seed: Option<[u32; 2]>, options: &Options) {
        let scene = &self.scene;
        let exists = |faces: &[u32; 2]| [0, 1].iter().all(|&m| (faces[m] as usize) < scene.meshes[m].faces().len());
        if let Some(faces) = seed.filter(exists)
            && self.answer.meet(scene, faces, &scene.corners(faces)).is_break()
        {
            return;
        }
        if let Some(best) = &self.answer.best {
            let ([on_host, on_guest], on) = (self.scene.sides(), [&best.witness.on_a, &best.witness.on_b]);
            self.profiles.take(on[on_host], on[on_guest], best.value);
        }
        let level = options.level;
        let _ = dispatch!(level, simd => self.descend(simd));
    }

    #[inline(always)]
    fn descend<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        self.open_both(simd, 0, 0);
        while let Some(task) = self.tasks.pop() {
            if task.bound > self.answer.node_limit {
                continue;
            }
            let host = self.host[task.host.node as usize].child(usize::from(task.host.lane));
            let guest = self.guest[task.guest.node as usize].child(usize::from(task.guest.lane));
            match (host, guest) {
                (Child::Leaf(host), Child::Leaf(guest)) => self.meet_leaves(simd, host, guest)?,
                (Child::Inner(host), Child::Leaf(_)) => self.open_host(simd, host, task.guest),
                (Child::Leaf(_), Child::Inner(guest)) => self.open_guest(simd, guest, task.host),
                (Child::Inner(host), Child::Inner(guest)) => {
                    let (host_size, guest_size) =
                        (size(&self.host_box(simd, task.host)), size(&self.guest_box(simd, task.guest)));
                    if host_size > OPENED_TOGETHER * guest_size {
                        self.open_host(simd, host, task.guest);
                    } else if guest_size > OPENED_TOGETHER * host_size {
                        self.open_guest(simd, guest, task.host);
                    } else {
                        self.open_both(simd, host, guest);
                    }
                }
            }
        }
        Continue(())
    }

    #[inline(always)]
    fn open_both<S: Simd>(&mut self, simd: S, host: u32, guest: u32) {
        let Self { scene, answer, tasks, carried_host, carried_guest, profiles, .. } = self;
        let (host_node, guest_node) = (&self.host[host as usize], &self.guest[guest as usize]);
        let [on_host, on_guest] = scene.sides();
        let side = |side: usize, node: u32| (scene.meshes[side], &scene.metric.maps[side], node);
        let error = scene.metric.error;
        let reached = match profiles.reached(side(on_host, host), side(on_guest, guest), answer.cut, error) {
            profile::Facing::Apart => return,
            profile::Facing::Leaves(reached) => Some(reached),
            profile::Facing::Unknown => None,
        };
        let host_boxes = carried(carried_host, host, || scene.bounds.carry_host(simd, host_node));
        let guest_boxes = carried(carried_guest, guest, || scene.bounds.carry_guest(simd, guest_node));
        let mut found = Sorted::new();
        for guest_lane in 0..guest_node.count() {
            let bounds = scene.bounds.of(simd, host_boxes, &guest_boxes.lane(guest_lane), false);
            for (host_lane, &bound) in bounds[..host_node.count()].iter().enumerate() {
                if !reached.as_ref().is_some_and(|reached| reached.is_apart(host_lane, guest_lane)) {
                    found.add_below(answer.node_limit, bound, host_lane, guest_lane);
                }
            }
        }
        found.push(tasks, |host_lane, guest_lane| {
            (Slot { node: host, lane: host_lane }, Slot { node: guest, lane: guest_lane })
        });
    }

    /// The children of a host node against one child of a guest node.
    #[inline(always)]
    fn open_host<S: Simd>(&mut self, simd: S, host: u32, guest: Slot) {
        let one = self.guest_box(simd, guest);
        let Self { scene, answer, tasks, carried_host, .. } = self;
        let node = &self.host[host as usize];
        let many = carried(carried_host, host, || scene.bounds.carry_host(simd, node));
        let bounds = scene.bounds.of(simd, many, &one, false);
        let mut found = Sorted::new();
        for (lane, &bound) in bounds[..node.count()].iter().enumerate() {
            found.add_below(answer.node_limit, bound, lane, 0);
        }
        found.push(tasks, |lane, _| (Slot { node: host, lane }, guest));
    }

    /// The children of a guest node against one child of a host node.
    #[inline(always)]
    fn open_guest<S: Simd>(&mut self, simd: S, guest: u32, host: Slot) {
        let one = self.host_box(simd, host);
        let Self { scene, answer, tasks, carried_guest, .. } = self;
        let node = &self.guest[guest as usize];
        let many = carried(carried_guest, guest, || scene.bounds.carry_guest(simd, node));
        let bounds = scene.bounds.of(simd, many, &one, true);
        let mut found = Sorted::new();
        for (lane, &bound) in bounds[..node.count()].iter().enumerate() {
            found.add_below(answer.node_limit, bound, 0, lane);
        }
        found.push(tasks, |_, lane| (host, Slot { node: guest, lane }));
    }

    #[inline(always)]
    fn host_box<S: Simd>(&mut self, simd: S, slot: Slot) -> Aabb {
        let node = &self.host[slot.node as usize];
        carried(&mut self.carried_host, slot.node, || self.scene.bounds.carry_host(simd, node))
            .lane(usize::from(slot.lane))
    }

    #[inline(always)]
    fn guest_box<S: Simd>(&mut self, simd: S, slot: Slot) -> Aabb {
        let node = &self.guest[slot.node as usize];
        carried(&mut self.carried_guest, slot.node, || self.scene.bounds.carry_guest(simd, node))
            .lane(usize::from(slot.lane))
    }

    #[inline(always)]
    fn meet_leaves<S: Simd>(&mut self, simd: S, host: u32, guest: u32) -> ControlFlow<()> {
        let Self { scene, answer, leaves: [at_host, at_guest], profiles, .. } = self;
        let [on_host, on_guest] = scene.sides();
        let take_up = |leaf: u32, side: usize| Leaf::new(scene.meshes[side], leaf, &scene.metric.maps[side]);
        let host = at_host.get(host, |kept| kept.leaf, |leaf| take_up(leaf, on_host));
        let guest = at_guest.get(guest, |kept| kept.leaf, |leaf| take_up(leaf, on_guest));
        let facing = Facing::new(simd, host, guest, scene.metric.error);
        for guest_lane in bits(guest.lanes_in_use) {
            let mut near = facing.near_boxes(guest_lane, answer.limit);
            if near == 0 {
                continue;
            }
            let lower = facing.lower_bounds(guest_lane, answer.limit);
            while near != 0 {
                let nearest = bits(near).fold(near.trailing_zeros() as usize, |least, lane| {
                    if lower[lane] < lower[least] { lane } else { least }
                });
                near &= !(1 << nearest);
                if lower[nearest] > answer.limit {
                    continue;
                }
                let (face_host, face_guest) = (host.faces[nearest], guest.faces[guest_lane]);
                let (of_host, of_guest) = (host.corners[nearest], guest.corners[guest_lane]);
                if scene.bounds.swapped {
                    answer.meet(scene, [face_guest, face_host], &[of_guest, of_host])?;
                } else {
                    answer.meet(scene, [face_host, face_guest], &[of_host, of_guest])?;
                }
            }
        }
        if let Some(best) = &answer.best {
            let on = [&best.witness.on_a, &best.witness.on_b];
            profiles.take(on[on_host], on[on_guest], best.value);
        }
        Continue(())
    }
}

impl Answer {
    fn cut(&mut self, scene: &Scene<'_>, metric: f64) {
        self.cut = metric;
        self.limit = (metric as f32).next_up();
        self.node_limit = scene.bounds.limit(metric);
    }

    /// Gives a pair its value, and keeps it where it is better; breaks off where there is nothing more to know.
    #[inline(never)]
    fn meet(&mut self, scene: &Scene<'_>, faces: [u32; 2], corners: &[[Vector; 3]; 2]) -> ControlFlow<()> {
        // Where faces meet already, only earlier ones that meet are better.
        if self.best.is_some_and(|best| best.value == 0.0 && best.faces <= faces) {
            return Continue(());
        }
        let error = scene.metric.error;
        let witness = triangle_triangle(&corners[0], &corners[1]);
        let value = witness.squared.sqrt().max(f64::MIN_POSITIVE);
        let are_separated = separation(&corners[0], &corners[1], &witness) > error;
        if scene.clearance < f64::INFINITY {
            // What the value leaves open is decided exactly, and so is everything about triangles that may cross.
            let is_open = !(are_separated && scene.lower(value) > scene.clearance);
            if is_open && (scene.upper(value) <= scene.clearance || scene.within(faces)) {
                self.kept = Some(faces);
                return Break(());
            }
            return Continue(());
        }
        let value = if !are_separated && scene.intersects(faces) { 0.0 } else { value };
        let valued = Valued { value, faces, witness };
        self.values_left = self.values_left.saturating_sub(1);
        if self.best.is_none_or(|best| valued.precedes(&best)) || self.values_left == 0 {
            let best = self.best.filter(|best| best.precedes(&valued)).unwrap_or(valued);
            self.best = Some(best);
            let doubt = if self.values_left == 0 { -4.0 } else { 2.0 };
            self.cut(scene, (best.value + doubt * error).max(2.0 * error));
        }
        Continue(())
    }
}

impl Scene<'_> {
    /// Which mesh is the host, and which the guest.
    #[inline(always)]
    fn sides(&self) -> [usize; 2] {
        if self.bounds.swapped { [1, 0] } else { [0, 1] }
    }

    fn corners(&self, faces: [u32; 2]) -> [[Vector; 3]; 2] {
        [0, 1].map(|m| self.meshes[m].corners(faces[m]).map(|corner| self.metric.maps[m].apply(corner)))
    }

    fn intersects(&self, faces: [u32; 2]) -> bool {
        let [a, b] = [0, 1].map(|m| self.meshes[m].corners(faces[m]));
        triangles_intersect(&self.placement, &a, &b)
    }

    fn within(&self, faces: [u32; 2]) -> bool {
        let [a, b] = [0, 1].map(|m| self.meshes[m].corners(faces[m]));
        triangles_within(&self.placement, &a, &b, self.clearance)
    }

    /// No less than the distance of triangles of this value, in world units.
    fn upper(&self, value: f64) -> f64 {
        ((value * (1.0 + 4.0 * f64::EPSILON) + self.metric.error) / self.metric.scale).next_up()
    }

    /// No more than the distance of any two triangles where none has a smaller value.
    fn lower(&self, value: f64) -> f64 {
        ((value * (1.0 - 4.0 * f64::EPSILON) - self.metric.error) / self.metric.scale).next_down().max(0.0)
    }

    fn finish(&self, best: &Valued, is_spent: bool) -> Nearest {
        let faces = best.faces;
        let Witness { on_a, on_b, .. } = best.witness;
        if best.value > 0.0 {
            let lower = self.lower(if is_spent { best.value - 6.0 * self.metric.error } else { best.value });
            let points = [on_a, on_b].map(|point| self.metric.to_world(point));
            return Nearest { lower, upper: self.upper(best.value), points, faces };
        }
        let [a, b] = [0, 1].map(|m| self.meshes[m].corners(faces[m]));
        let common = common_point(&self.placement, &a, &b).unwrap_or_else(|| self.metric.to_world(on_a));
        Nearest { lower: 0.0, upper: 0.0, points: [common; 2], faces }
    }
}

/// The greatest extent of a box.
#[inline(always)]
fn size(bounds: &Aabb) -> f32 {
    let [x, y, z] = by_axis!(axis => bounds.max[axis] - bounds.min[axis]);
    x.max(y).max(z)
}

#[inline(always)]
fn carried(at_hand: &mut AtHand<Carried>, node: u32, carry: impl FnOnce() -> BoxLanes) -> &BoxLanes {
    &at_hand.get(node, |kept| kept.node, |node| Carried { node, boxes: carry() }).boxes
}

/// The last few of many things that are dear to make, by number.
struct AtHand<T> {
    /// One more than the place of the thing whose number ends in this index.
    places: Vec<u16>,
    kept: Vec<T>,
}

impl<T> AtHand<T> {
    fn new(most: usize) -> Self {
        Self { places: vec![0; most], kept: Vec::new() }
    }

    /// The thing of this number, made where it is not at hand.
    #[inline(always)]
    fn get(&mut self, number: u32, number_of: impl Fn(&T) -> u32, make: impl FnOnce(u32) -> T) -> &T {
        self.get_current(number, |kept| number_of(kept) == number, make)
    }

    /// The thing of this number, made where what is at hand in its place is another or no longer right.
    #[inline(always)]
    fn get_current(&mut self, number: u32, is_current: impl Fn(&T) -> bool, make: impl FnOnce(u32) -> T) -> &T {
        let index = number as usize % self.places.len();
        let place = match self.places[index] {
            0 => {
                self.kept.push(make(number));
                self.places[index] = self.kept.len() as u16;
                self.kept.len() - 1
            }
            place => {
                let place = usize::from(place) - 1;
                if !is_current(&self.kept[place]) {
                    self.kept[place] = make(number);
                }
                place
            }
        };
        &self.kept[place]
    }
}

/// Pairs of children by their bounds.
struct Sorted {
    keys: [u64; LANES * LANES],
    count: usize,
}

impl Sorted {
    #[inline(always)]
    fn new() -> Self {
        Self { keys: [0; LANES * LANES], count: 0 }
    }

    #[inline(always)]
    fn add_below(&mut self, limit: f32, bound: f32, host_lane: usize, guest_lane: usize) {
        // A bound that is not a number proves nothing.
        if bound > limit {
            return;
        }
        // Floats order like integers once those of negative ones are turned over.
        let ordered = bound.to_bits() ^ (((bound.to_bits() as i32 >> 31) as u32) | 1 << 31);
        self.keys[self.count] = u64::from(ordered) << 32 | (host_lane * LANES + guest_lane) as u64;
        self.count += 1;
    }

    /// Appends tasks, the nearest last.
    #[inline(always)]
    fn push(&mut self, tasks: &mut Vec<Task>, slots: impl Fn(u8, u8) -> (Slot, Slot)) {
        let keys = &mut self.keys[..self.count];
        keys.sort_unstable_by(|x, y| y.cmp(x));
        tasks.extend(keys.iter().map(|&key| {
            let ordered = (key >> 32) as u32;
            let bits = ordered ^ ((!(ordered as i32 >> 31)) as u32 | 1 << 31);
            let lanes = key as u8;
            let (host, guest) = slots(lanes / LANES as u8, lanes % LANES as u8);
            Task { bound: f32::from_bits(bits), host, guest }
        }));
    }
}

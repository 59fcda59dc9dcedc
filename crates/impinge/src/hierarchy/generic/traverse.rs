//! The simultaneous descent of two generic trees, or of one with itself. It counts its operations.

use super::volume::NodeVolume;
use super::{GenericNode, GenericTree};
use crate::hierarchy::cost::Counters;
use crate::hierarchy::wide::Child;
use crate::math::Pose;
use crate::simd::{best_level, bits, dispatch};

/// Two subtrees whose volumes overlap. The guest's volume is in the host's frame. `None` is an
/// unbounded volume, which overlaps everything.
#[derive(Clone, Copy)]
struct Task<V> {
    host: Child,
    guest: Child,
    host_volume: V,
    guest_volume: Option<V>,
}

impl<V: NodeVolume, const DEGREE: usize> GenericTree<V, DEGREE> {
    /// Visits all pairs of an item of this tree and an item of the guest whose leaves have
    /// overlapping volumes. Returns the numbers of operations. The pose maps the guest's frame to
    /// the frame of this tree. Each pair is visited once, in no particular order. All pairs of
    /// items with a common point are among them.
    pub fn pairs(&self, guest: &Self, self_from_guest: &Pose, visit: impl FnMut(u32, u32)) -> Counters {
        let mut descent = Descent { host: self, guest, pose: self_from_guest, visit, work: Counters::default() };
        dispatch!(best_level(), simd => {
            let _ = simd; // the loops over lanes are compiled for it
            descent.run()
        });
        descent.work
    }

    /// Visits all pairs of different items in the same leaf, or in two leaves with overlapping
    /// volumes. Returns the numbers of operations. Each pair is visited once, in no particular
    /// order of pairs or within them.
    pub fn self_pairs(&self, mut visit: impl FnMut(u32, u32)) -> Counters {
        let mut within = vec![0_u32; usize::from(!self.nodes.is_empty())];
        let mut work = Counters::default();
        let mut across = Vec::new();
        while let Some(at) = within.pop() {
            let node = &self.nodes[at as usize];
            for lane in 0..node.count {
                match node.children[lane] {
                    Child::Inner(child) => within.push(child),
                    Child::Leaf(leaf) => {
                        let held = self.held(leaf);
                        for (at, &item) in held.iter().enumerate() {
                            held[..at].iter().for_each(|&other| visit(other, item));
                            work.primitive_tests += at as u64;
                        }
                    }
                }
                let Some(volume) = V::lane(&node.volumes, lane) else { continue };
                work.volume_tests += lane as u64;
                for other in bits(V::overlapping(&node.volumes, &volume) & low_bits(lane)) {
                    let Some(host_volume) = V::lane(&node.volumes, other) else { continue };
                    let (host, guest) = (node.children[other], node.children[lane]);
                    across.push(Task { host, guest, host_volume, guest_volume: Some(volume) });
                }
            }
        }
        let pose = &Pose::IDENTITY;
        let mut descent = Descent { host: self, guest: self, pose, visit, work };
        dispatch!(best_level(), simd => {
            let _ = simd;
            descent.finish(&mut across, &|volume| Some(*volume))
        });
        descent.work
    }
}

struct Descent<'a, V: NodeVolume, F, const DEGREE: usize> {
    host: &'a GenericTree<V, DEGREE>,
    guest: &'a GenericTree<V, DEGREE>,
    pose: &'a Pose,
    visit: F,
    work: Counters,
}

/// The last transformed guest node, and its volumes in the host's frame.
struct Carried<V, const DEGREE: usize> {
    node: u32,
    volumes: [Option<V>; DEGREE],
}

impl<V: NodeVolume, F: FnMut(u32, u32), const DEGREE: usize> Descent<'_, V, F, DEGREE> {
    #[inline(always)]
    fn run(&mut self) {
        let (Some(host_volume), Some(guest_volume)) = (self.host.root, self.guest.root) else { return };
        let guest_volume = guest_volume.moved(self.pose);
        self.work.updates += 1;
        self.work.volume_tests += 1;
        let root = V::lanes::<1>([Some(host_volume)]);
        if guest_volume.is_some_and(|guest| V::overlapping(&root, &guest) & 1 == 0) {
            return;
        }
        let pose = self.pose;
        let mut tasks = vec![Task { host: Child::Inner(0), guest: Child::Inner(0), host_volume, guest_volume }];
        self.finish(&mut tasks, &|volume: &V| volume.moved(pose));
    }

    /// Processes tasks, the last one first. `carry` transforms a guest volume to the host's frame.
    #[inline(always)]
    fn finish(&mut self, tasks: &mut Vec<Task<V>>, carry: &impl Fn(&V) -> Option<V>) {
        let mut carried = Carried { node: u32::MAX, volumes: [None; DEGREE] };
        while let Some(task) = tasks.pop() {
            match (task.host, task.guest) {
                (Child::Leaf(host), Child::Leaf(guest)) => self.visit_leaves(host, guest),
                (Child::Inner(host), Child::Leaf(_)) => {
                    let node = &self.host.nodes[host as usize];
                    for lane in self.overlapping(node, task.guest_volume.as_ref()) {
                        let Some(host_volume) = V::lane(&node.volumes, lane) else { continue };
                        tasks.push(Task { host: node.children[lane], host_volume, ..task });
                    }
                }
                (host, Child::Inner(guest)) => {
                    if carried.node != guest {
                        self.carry(guest, &mut carried, carry);
                    }
                    self.open_guest(host, guest, &task, &carried, tasks);
                }
            }
        }
    }

    /// Pairs the children of a guest node with the children of a host node, or with a host leaf.
    /// The tasks of one guest child are consecutive, so that its own children are transformed once
    /// for all of them.
    #[inline(always)]
    fn open_guest(
        &mut self,
        host: Child,
        guest: u32,
        task: &Task<V>,
        carried: &Carried<V, DEGREE>,
        tasks: &mut Vec<Task<V>>,
    ) {
        let guest_node = &self.guest.nodes[guest as usize];
        for lane in 0..guest_node.count {
            let (guest, guest_volume) = (guest_node.children[lane], carried.volumes[lane]);
            match host {
                Child::Inner(host) => {
                    let node = &self.host.nodes[host as usize];
                    for lane in self.overlapping(node, guest_volume.as_ref()) {
                        let Some(host_volume) = V::lane(&node.volumes, lane) else { continue };
                        tasks.push(Task { host: node.children[lane], guest, host_volume, guest_volume });
                    }
                }
                Child::Leaf(_) => {
                    self.work.volume_tests += 1;
                    let own = V::lanes::<1>([Some(task.host_volume)]);
                    if guest_volume.is_none_or(|volume| V::overlapping(&own, &volume) & 1 == 1) {
                        tasks.push(Task { guest, guest_volume, ..*task });
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn carry(&mut self, guest: u32, carried: &mut Carried<V, DEGREE>, carry: &impl Fn(&V) -> Option<V>) {
        let node = &self.guest.nodes[guest as usize];
        carried.node = guest;
        for lane in 0..node.count {
            carried.volumes[lane] = V::lane(&node.volumes, lane).as_ref().and_then(carry);
        }
        self.work.updates += node.count as u64;
    }

    /// Returns the used lanes that are not proved apart from a volume. `None` overlaps all.
    #[inline(always)]
    fn overlapping(
        &mut self,
        node: &GenericNode<V, DEGREE>,
        volume: Option<&V>,
    ) -> impl Iterator<Item = usize> + use<V, F, DEGREE> {
        self.work.volume_tests += node.count as u64;
        bits(volume.map_or(u32::MAX, |volume| V::overlapping(&node.volumes, volume)) & low_bits(node.count))
    }

    fn visit_leaves(&mut self, host: u32, guest: u32) {
        let (host, guest) = (self.host.held(host), self.guest.held(guest));
        self.work.primitive_tests += (host.len() * guest.len()) as u64;
        for &a in host {
            guest.iter().for_each(|&b| (self.visit)(a, b));
        }
    }
}

/// Returns the lowest `count` bits set, at most 32.
#[inline(always)]
fn low_bits(count: usize) -> u32 {
    ((1_u64 << count.min(32)) - 1) as u32
}

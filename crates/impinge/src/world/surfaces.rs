//! Surfaces of several bodies: static bodies that lie side by side, such as the tiles of a floor,
//! and are one surface for all that slides over them.
//!
//! The contacts of a moving body with all bodies of one surface are found together, by the rules
//! for the parts of a compound (`query/shapes/seams.rs`). So the contacts of a pair depend on the
//! bodies beside it. If such a body changes, pairs are processed again whose own bodies did not
//! change.
//!
//! Bodies of a surface are neighbors if their boxes overlap after one of them is grown a little, so
//! that neighbors are found by a search for one box.
//!
//! Guarded by `tests/it/worlds/tiles.rs`, which compares such a floor with a compound.

use rayon::prelude::*;

use super::body::Kind;
use super::broad::Among;
use super::narrow::Meeting;
use super::outline::Bounds;
use super::search::Candidates;
use super::{Change, NarrowPhase, State, World};
use crate::budget::Budget;
use crate::query::{Manifold, Member, SurfacePair, Surroundings, contacts_of_surface};
use crate::shape::PlacedShape;
use crate::volume::MinMax;

/// Share of the size of its box by which the box of a body is grown to find its neighbors. It is
/// the distance up to which flush parts of a compound may be apart.
const BESIDE: f64 = 1.0 / (1 << 15) as f64;

/// The pairs of one surface with one body: the key of the surface, and the slot of the body.
type Group = (u64, u32);

impl State {
    /// Returns the surface of the body in a slot, if it is static and has one.
    fn surface_of(&self, place: u32) -> Option<u64> {
        let traits = &self.residents.at(place)?.1.traits;
        traits.surface.filter(|_| traits.kind == Kind::Static)
    }

    /// Returns the group of a pair, or `None` if neither body is of a surface.
    fn group_of(&self, [a, b]: [u32; 2]) -> Option<Group> {
        // Two static bodies are never a pair.
        self.surface_of(a).map(|surface| (surface, b)).or_else(|| Some((self.surface_of(b)?, a)))
    }

    /// Returns the bounds of the body in a slot, grown so that its neighbors overlap them.
    fn surroundings_of(&self, place: u32) -> Bounds {
        let bounds = *self.bounds_of(place);
        let Bounds::Box(own) = &bounds else { return bounds };
        let [min, max] = [own.min(), own.max()];
        let size = (0..3).map(|k| max[k] - min[k]).fold(0.0, f64::max);
        bounds.grown(BESIDE * size)
    }

    /// Visits the other bodies of a surface whose bounds overlap some bounds.
    fn for_each_of_surface(&self, surface: u64, bounds: &Bounds, visit: &mut dyn FnMut(u32)) {
        let mut of_surface = |place: u32| {
            if self.surface_of(place) == Some(surface) && bounds.overlap(self.bounds_of(place)) {
                visit(place);
            }
        };
        match bounds {
            Bounds::Nowhere => {}
            Bounds::Box(bounds) => {
                self.broad.for_each_overlapping(Among::Guided, bounds, &mut of_surface);
                self.broad.for_each_unbounded(Among::Guided, &mut of_surface);
            }
            Bounds::Behind(_) | Bounds::Anywhere => self.broad.for_each(Among::Guided, &mut of_surface),
        }
    }

    /// Marks the neighbors of a body that is about to change, because contacts with them may depend
    /// on its place before. Its place afterwards is found by the next step.
    pub(super) fn mark_neighbors(&mut self, place: u32) {
        let Some(surface) = self.surface_of(place) else { return };
        let mut neighbors = Vec::new();
        self.for_each_of_surface(surface, &self.surroundings_of(place), &mut |other| neighbors.push(other));
        neighbors
            .into_iter()
            .filter(|&other| other != place)
            .for_each(|other| _ = self.changed.mark(other, Change::Moved));
    }
}

impl World {
    /// Adds to the candidates the stored pairs whose contacts depend on a changed body of a
    /// surface, or on another candidate of the same surface and the same body.
    pub(super) fn add_surfaces(&self, changed: &[u32], candidates: &mut Candidates) {
        let state = &self.state;
        if state.surface_bodies == 0 || self.options.narrow_phase != NarrowPhase::Contacts {
            return;
        }
        let kept = candidates.kept.iter().filter_map(|&pair| state.pairs.get(pair)).map(|entry| entry.bodies);
        let all = kept.chain(candidates.found.iter().copied());
        let mut groups: Vec<Group> = all.filter_map(|bodies| state.group_of(bodies)).collect();
        for &place in changed {
            let Some(surface) = state.surface_of(place) else { continue };
            state.for_each_of_surface(surface, &state.surroundings_of(place), &mut |neighbor| {
                groups.extend(state.pairs.of(neighbor).iter().map(|link| (surface, link.other)));
            });
        }
        groups.sort_unstable();
        groups.dedup();
        let mut known = [&candidates.kept[..], &candidates.lost].concat();
        known.sort_unstable();
        for (surface, body) in groups {
            let of_group = state.pairs.of(body).iter().filter(|link| state.surface_of(link.other) == Some(surface));
            let unknown = of_group.map(|link| link.pair).filter(|pair| known.binary_search(pair).is_err());
            candidates.kept.extend(unknown);
        }
    }

    /// Reports whether the contacts of a pair are found by
    /// [`find_surface_contacts`](Self::find_surface_contacts).
    pub(super) fn is_of_surface(&self, bodies: [u32; 2]) -> bool {
        self.state.surface_bodies > 0
            && self.options.narrow_phase == NarrowPhase::Contacts
            && self.state.group_of(bodies).is_some()
    }

    /// Finds the contacts of the pairs with bodies of surfaces, which must intersect. If the budget
    /// is spent, some are missing.
    pub(super) fn find_surface_contacts(
        &self,
        candidates: &Candidates,
        found: &mut [Option<Meeting>],
        budget: &Budget<'_>,
    ) {
        let state = &self.state;
        if state.surface_bodies == 0 || self.options.narrow_phase != NarrowPhase::Contacts {
            return;
        }
        let kept = candidates.kept.iter().map(|&pair| state.pairs.get(pair).map(|entry| entry.bodies));
        let pairs: Vec<Option<[u32; 2]>> = kept.chain(candidates.found.iter().copied().map(Some)).collect();
        let mut rows: Vec<(Group, usize)> = (0..pairs.len())
            .filter(|&row| found[row].is_some())
            .filter_map(|row| Some((state.group_of(pairs[row]?)?, row)))
            .collect();
        rows.sort_unstable();
        let groups: Vec<&[(Group, usize)]> = rows.chunk_by(|one, other| one.0 == other.0).collect();
        let of_group = |group: &&[(Group, usize)]| -> Vec<Vec<Manifold>> {
            let members: Vec<SurfacePair<'_>> =
                group.iter().filter_map(|&(_, row)| self.surface_pair(pairs[row]?)).collect();
            contacts_of_surface(&members, &Neighbors { state, surface: group[0].0.0 }, budget)
        };
        let contacts: Vec<Vec<Vec<Manifold>>> = groups.par_iter().map(of_group).collect();
        for (&(_, row), manifolds) in rows.iter().zip(contacts.into_iter().flatten()) {
            if let Some(meeting) = &mut found[row] {
                meeting.manifolds = manifolds;
            }
        }
    }

    fn surface_pair(&self, places: [u32; 2]) -> Option<SurfacePair<'_>> {
        let [a, b] = places.map(|place| self.state.residents.at(place).map(|(_, resident)| resident));
        let (a, b) = (a?, b?);
        let surface = usize::from(self.state.surface_of(places[0]).is_none());
        let shapes = [a.placed.in_world(), b.placed.in_world()];
        Some(SurfacePair { shapes, bodies: places, surface, margin: a.margin + b.margin })
    }
}

/// The bodies of one surface.
struct Neighbors<'w> {
    state: &'w State,
    surface: u64,
}

impl Surroundings for Neighbors<'_> {
    fn for_each_near(&self, own: Member, point: [f64; 3], near: f64, visit: &mut dyn FnMut(Member, &PlacedShape)) {
        let around = MinMax::new(point, point).ok().and_then(|bounds| bounds.grown(near));
        let around = around.map_or(Bounds::Anywhere, Bounds::Box);
        let own_bounds = self.state.bounds_of(own.body);
        self.state.for_each_of_surface(self.surface, &around, &mut |body| {
            let is_neighbor = body == own.body || self.state.surroundings_of(body).overlap(own_bounds);
            if let Some((_, resident)) = self.state.residents.at(body).filter(|_| is_neighbor) {
                let shape = resident.placed.in_world();
                for part in shape.parts_near(Some([point; 2]), near) {
                    visit(Member { body, part }, &shape.parts()[part as usize]);
                }
            }
        });
    }
}

//! A mesh or a height field and a half-space: finds the faces that reach lowest, through the tree.

use std::ops::ControlFlow::{self, Continue};

use super::HalfSpace;
use super::depth::Depth;
use super::facing::Corner;
use super::half_space::Heights;
use super::interval::Separation;
use super::manifold::Contacts;
use super::posed::{Core, Pair, Swept};
use super::surface::{Surface, corners_of_box};
use crate::math::vec3::length;
use crate::mesh::{FaceSearch, Faces};
use crate::volume::Proximity;

impl HalfSpace<'_> {
    /// Reports whether a mesh is within `clearance` of this half-space, in world units. The
    /// clearance must be finite and not negative. The answer is exact.
    pub(crate) fn nearness_of_surface<F: Faces>(&self, surface: &Surface<'_, F>, clearance: f64) -> Proximity {
        let mut answer = Proximity::Apart;
        self.search(surface, clearance, |face, cut| {
            if self.nearness(face, clearance) == Proximity::Intersects {
                answer = Proximity::Intersects;
                return f64::NEG_INFINITY;
            }
            cut
        });
        answer
    }

    /// Returns the distance of a mesh, in world units. It is infinite if the mesh has no faces.
    pub(crate) fn separation_of_surface<F: Faces>(&self, surface: &Surface<'_, F>) -> Separation {
        let mut best: Option<Separation> = None;
        self.search(surface, f64::INFINITY, |face, cut| {
            let found = self.separation(face);
            let lower = best.map_or(found.lower, |best| best.lower.min(found.lower));
            if best.is_none_or(|best| found.upper < best.upper) {
                best = Some(found);
            }
            if let Some(best) = &mut best {
                best.lower = lower;
            }
            cut.min(found.upper)
        });
        let nothing = [f64::INFINITY; 2];
        best.unwrap_or(Separation {
            lower: nothing[0],
            upper: nothing[1],
            points: [[0.0; 3]; 2],
            proximity: Proximity::Apart,
        })
    }

    /// Returns the depth of a mesh in this half-space, in world units, with the half-space's
    /// normal. Returns `None` if the mesh has no faces.
    pub(crate) fn depth_of_surface<F: Faces>(&self, surface: &Surface<'_, F>) -> Option<Depth> {
        let mut best: Option<Depth> = None;
        self.search(surface, 0.0, |face, cut| {
            let found = self.depth(face);
            let lower = best.map_or(found.lower, |best| best.lower.max(found.lower));
            if best.is_none_or(|best| found.upper > best.upper) {
                best = Some(found);
            }
            if let Some(best) = &mut best {
                best.lower = lower;
            }
            cut.min(-found.lower)
        });
        best
    }

    /// Returns the contacts of the vertices of a mesh's faces that are in the half-space, or at
    /// most `margin` above it. Of several vertices at one position only the first is a contact.
    ///
    /// # Complexity
    /// O(n) for n faces that are that near.
    pub(crate) fn contacts_of_surface<F: Faces>(&self, surface: &Surface<'_, F>, margin: f64) -> Contacts {
        let mesh = surface.mesh;
        let Some(corners) = mesh.local_bounds().map(corners_of_box) else { return self.no_contacts() };
        let bounds = Swept { core: Core::Points(&corners), pose: surface.pose, radius: [0.0; 2] };
        let pair = self.pair(&bounds);
        let mut vertices = Vec::new();
        self.faces(surface, margin, |face, cut| {
            vertices.extend(mesh.places(face));
            cut
        });
        let (heights, vertices) = (self.heights(&pair), distinct(vertices));
        let corner = |number: u32| Corner { number, point: pair.b.spot(mesh.position(number)).point };
        let contacts = vertices.into_iter().map(|vertex| heights.contact([0.0; 2], &corner(vertex)));
        Contacts { contacts: contacts.filter(|contact| contact.upper >= -margin).collect(), ..self.no_contacts() }
    }

    fn no_contacts(&self) -> Contacts {
        Contacts { normal: self.unit_normal(), contacts: Vec::new() }
    }

    fn search<F: Faces>(&self, surface: &Surface<'_, F>, cut: f64, mut visit: impl FnMut(&Swept<'_>, f64) -> f64) {
        self.faces(surface, cut, |face, cut| visit(&surface.face(&surface.mesh.corners(face)), cut));
    }

    /// Visits the faces whose lowest point may be below `cut`, a height above the plane in world
    /// units. Each call of `visit` returns the new cut.
    fn faces<F: Faces>(&self, surface: &Surface<'_, F>, cut: f64, visit: impl FnMut(u32, f64) -> f64) {
        let Some(corners) = surface.mesh.local_bounds().map(corners_of_box) else { return };
        let bounds = Swept { core: Core::Points(&corners), pose: surface.pose, radius: [0.0; 2] };
        let pair = self.pair(&bounds);
        let heights = self.heights(&pair);
        surface.mesh.search(&mut Lowest { direction: self.direction(), surface, pair: &pair, heights, cut, visit });
    }
}

/// Returns numbers in ascending order, each once.
fn distinct(mut numbers: Vec<u32>) -> Vec<u32> {
    /// Maximum range of the numbers, as a multiple of their count, for which a table is faster than
    /// sorting them.
    const MAX_RANGE: usize = 32;
    let (Some(&least), Some(&greatest)) = (numbers.iter().min(), numbers.iter().max()) else { return numbers };
    if ((greatest - least) as usize) < MAX_RANGE * numbers.len() {
        let mut is_there = vec![false; (greatest - least) as usize + 1];
        numbers.iter().for_each(|number| is_there[(number - least) as usize] = true);
        return (least..=greatest).zip(is_there).filter_map(|(number, is_there)| is_there.then_some(number)).collect();
    }
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

struct Lowest<'q, F, V> {
    direction: [f64; 3],
    surface: &'q Surface<'q, F>,
    pair: &'q Pair<'q>,
    heights: Heights<'q>,
    cut: f64,
    visit: V,
}

impl<F: Faces, V: FnMut(u32, f64) -> f64> FaceSearch for Lowest<'_, F, V> {
    fn bound(&self, center: &[f64; 3], half_extents: &[f64; 3]) -> f64 {
        let direction = self.direction;
        let [lower, _] = self.heights.of(&self.pair.b.spot(*center).point);
        let linear = self.surface.pose.linear();
        let reach: f64 = (0..3)
            .map(|j| (0..3).map(|k| linear[k][j] * direction[k]).sum::<f64>().abs() * half_extents[j])
            .sum::<f64>()
            / length(&direction);
        lower - reach * (1.0 + 1e-12)
    }

    fn cut(&self) -> f64 {
        self.cut
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        self.cut = (self.visit)(face, self.cut);
        Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    #[test]
    fn dense_and_sparse_numbers_are_distinct_alike() {
        let mut rng = Rng::new(66);
        for reach in [0, 3, 100, 3000, 1_000_000] {
            for count in [0, 1, 2, 50] {
                let numbers: Vec<u32> = (0..count).map(|_| rng.integer(0, reach) as u32 + 5).collect();
                let expected: Vec<u32> =
                    numbers.iter().copied().collect::<std::collections::BTreeSet<u32>>().into_iter().collect();
                assert_eq!(distinct(numbers), expected);
            }
        }
    }
}

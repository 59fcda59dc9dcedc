//! Implements [`BoundingVolume`] for lozenges.

use std::f64::consts::PI;

use crate::input::InputError;
use crate::math::Pose;
use crate::math::vec3::{add, dot, scale, sub};
use crate::volume::rigid::{direction, image, stretch};
use crate::volume::rounding::{add_up, mul_up};
use crate::volume::{BoundingSphere, BoundingVolume, Lozenge, Round, fit};

impl BoundingVolume for Lozenge {
    /// Uses [`fit::lozenge`].
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        fit::lozenge(points)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.meets(other)
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        self.meets(&BoundingSphere::from_valid(point, 0.0))
    }

    /// Returns the smaller of the two lozenges that have the directions of one of the inputs.
    fn merged(&self, other: &Self) -> Self {
        let spheres: Vec<([f64; 3], f64)> = [self, other]
            .into_iter()
            .flat_map(|part| part.core().corners().map(|corner| (corner, part.widened())))
            .collect();
        let candidates = [self, other].map(|part| {
            let frame = part.frame();
            let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
            for (center, _) in &spheres {
                let offset = sub(center, &part.corner);
                for (range, &axis) in ranges.iter_mut().zip(&frame) {
                    let t = dot(&axis, &offset);
                    *range = [range[0].min(t), range[1].max(t)];
                }
            }
            let middle = 0.5 * (ranges[2][0] + ranges[2][1]);
            let offsets = [scale(&frame[0], ranges[0][0]), scale(&frame[1], ranges[1][0]), scale(&frame[2], middle)];
            let corner = offsets.into_iter().fold(part.corner, |sum, offset| add(&sum, &offset));
            let edges = [0, 1].map(|k| scale(&frame[k], ranges[k][1] - ranges[k][0]));
            Self::about(corner, edges, &spheres)
        });
        let key = |lozenge: &Self| (lozenge.volume(), lozenge.corner);
        let [first, second] = candidates;
        if key(&first) <= key(&second) { first } else { second }
    }

    /// Accepts poses that are rigid within 1e-4.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let stretch = stretch(world_from_local)?;
        let (corner, off_corner) = image(world_from_local, self.corner);
        let [(u, off_u), (v, off_v)] = self.edges.map(|edge| direction(world_from_local, edge));
        let off = add_up(off_corner, add_up(off_u, off_v));
        Self::new(corner, [u, v], add_up(mul_up(self.radius, stretch), off))
    }

    fn volume(&self) -> f64 {
        let (r, [a, b], area) = (self.radius, self.lengths(), self.area());
        2.0 * r * area + PI * r * r * (a + b) + 4.0 / 3.0 * PI * r * r * r
    }

    fn surface_area(&self) -> f64 {
        let (r, [a, b], area) = (self.radius, self.lengths(), self.area());
        2.0 * area + 2.0 * PI * r * (a + b) + 4.0 * PI * r * r
    }
}

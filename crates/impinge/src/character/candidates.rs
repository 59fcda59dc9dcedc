//! Volumes of every kind around one part, their costs, and how they grow to enclose given points.

use crate::hull::Hull;
use crate::input::InputError;
use crate::volume::{BoundingSphere, Capsule, Lozenge, Obb, fit};

use super::volume::{HitHull, HitVolume, VolumeKind, cube_about};
use crate::math::vec3::{Vector, add, dot, length, scale, sub};

/// Cost of a ray against a volume of each kind, in nanoseconds, in the order of
/// [`VolumeKind::ALL`]; for a hull the cost per face. Measured by the `characters` benchmark. Only
/// the ratios matter.
const RAY_COSTS: [f64; 5] = [60.0, 80.0, 90.0, 190.0, 3.0];

/// Cost of a ray that hits a volume but not the part, in nanoseconds. This is a choice: about the
/// time of a query against a skinned mesh of some thousand faces. A larger value favors tighter
/// volumes.
const FALSE_STRIKE_COST: f64 = 400.0;

/// One volume of each kind around one part.
pub(super) struct Candidates {
    pub(super) sphere: BoundingSphere,
    pub(super) capsule: Capsule,
    pub(super) obb: Obb,
    pub(super) lozenge: Lozenge,
    pub(super) hull: HitHull,
    /// Surface area of the convex hull of the points that were fitted to.
    pub(super) area: f64,
}

impl Candidates {
    /// Fits all volumes to points. The hull is built from `hull_points` instead.
    pub(super) fn about(points: &[Vector], hull_points: &[Vector]) -> Result<Self, InputError> {
        Ok(Self {
            sphere: fit::minimal_sphere(points)?.sphere,
            capsule: fit::capsule(points)?,
            obb: fit::obb(points)?.obb,
            lozenge: fit::lozenge(points)?,
            hull: HitHull::new(hull_points)?,
            area: HitVolume::Hull(HitHull::new(points)?).surface_area(),
        })
    }

    pub(super) fn volume(&self, kind: VolumeKind) -> HitVolume {
        match kind {
            VolumeKind::Sphere => HitVolume::Sphere(self.sphere),
            VolumeKind::Capsule => HitVolume::Capsule(self.capsule),
            VolumeKind::Box => HitVolume::Box(self.obb),
            VolumeKind::Lozenge => HitVolume::Lozenge(self.lozenge),
            VolumeKind::Hull => HitVolume::Hull(self.hull.clone()),
        }
    }

    /// Returns the surface area of a volume divided by that of the convex hull of the points.
    /// Returns 1 if the hull has no area.
    pub(super) fn looseness(&self, volume: &HitVolume) -> f64 {
        if self.area > 0.0 { volume.surface_area() / self.area } else { 1.0 }
    }

    /// Returns the volume of the given kind, or the volume with the lowest cost if no kind is
    /// given.
    pub(super) fn best(&self, kind: Option<VolumeKind>) -> HitVolume {
        let cost = |at: usize| {
            let looseness = self.looseness(&self.volume(VolumeKind::ALL[at]));
            let faces = if VolumeKind::ALL[at] == VolumeKind::Hull { self.hull.planes().len() as f64 } else { 1.0 };
            RAY_COSTS[at] * faces + FALSE_STRIKE_COST * (looseness - 1.0)
        };
        let chosen =
            kind.unwrap_or_else(|| VolumeKind::ALL[(0..5).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(0)]);
        self.volume(chosen)
    }
}

/// The sizes that the volumes need to enclose all points given so far.
#[derive(Clone)]
pub(super) struct Needs {
    pub(super) sphere: f64,
    pub(super) capsule: f64,
    pub(super) lozenge: f64,
    /// Minimum and maximum coordinate along each axis of the box, relative to its center.
    pub(super) obb: [[f64; 2]; 3],
    /// For each face of the hull: the height of the farthest point above it, and that point.
    pub(super) out: Vec<(f64, Vector)>,
}

impl Needs {
    pub(super) fn new(candidates: &Candidates) -> Self {
        let out = vec![(0.0, [0.0; 3]); candidates.hull.planes().len()];
        Self { sphere: 0.0, capsule: 0.0, lozenge: 0.0, obb: [[f64::INFINITY, f64::NEG_INFINITY]; 3], out }
    }

    pub(super) fn include(&mut self, candidates: &Candidates, volumes: &[HitVolume; 3], point: Vector) {
        let reach = |volume: &HitVolume| length(&sub(&point, &volume.closest_on_core(point)));
        self.sphere = self.sphere.max(reach(&volumes[0]));
        self.capsule = self.capsule.max(reach(&volumes[1]));
        self.lozenge = self.lozenge.max(reach(&volumes[2]));
        let offset = sub(&point, &candidates.obb.center());
        for (range, axis) in self.obb.iter_mut().zip(candidates.obb.axes()) {
            let t = dot(&axis, &offset);
            *range = [range[0].min(t), range[1].max(t)];
        }
        for (out, &(normal, level)) in self.out.iter_mut().zip(candidates.hull.planes()) {
            let excess = dot(&normal, &point) - level;
            if excess > 0.0 {
                *out = farther(*out, (excess, point));
            }
        }
    }

    pub(super) fn merged(mut self, other: &Self) -> Self {
        self.sphere = self.sphere.max(other.sphere);
        self.capsule = self.capsule.max(other.capsule);
        self.lozenge = self.lozenge.max(other.lozenge);
        self.obb = [0, 1, 2].map(|k| [self.obb[k][0].min(other.obb[k][0]), self.obb[k][1].max(other.obb[k][1])]);
        self.out.iter_mut().zip(&other.out).for_each(|(own, other)| *own = farther(*own, *other));
        self
    }
}

/// Returns the farther of two points; of equally far points the lexicographically larger one. So
/// the result does not depend on the order.
pub(super) fn farther(a: (f64, Vector), b: (f64, Vector)) -> (f64, Vector) {
    if b > a { b } else { a }
}

impl Candidates {
    /// Grows all volumes to enclose the points behind `needs`, and everything within `margin` of
    /// these points. The hull only gains the points outside its faces;
    /// [`grow_hull`](Self::grow_hull) adds the rest.
    pub(super) fn grow(&mut self, needs: &Needs, margin: f64) -> Result<(), InputError> {
        let radius = |need: f64| need * (1.0 + 1e-12) + margin;
        self.sphere = BoundingSphere::new(self.sphere.center(), radius(needs.sphere))?;
        let [from, to] = self.capsule.ends();
        self.capsule = Capsule::new(from, to, radius(needs.capsule))?;
        self.lozenge = Lozenge::new(self.lozenge.corner(), self.lozenge.edges(), radius(needs.lozenge))?;
        let axes = self.obb.axes();
        let middle = [0, 1, 2].map(|k| 0.5 * (needs.obb[k][0] + needs.obb[k][1]));
        let center = (0..3).fold(self.obb.center(), |at, k| add(&at, &scale(&axes[k], middle[k])));
        // The axes are orthonormal within 2^-40.
        let most = needs.obb.iter().flatten().fold(length(&self.obb.center()), |most, x| most.max(x.abs()));
        let half = needs.obb.map(|[low, high]| 0.5 * (high - low) + 4e-12 * most + margin);
        self.obb = Obb::new(center, axes, half)?;
        let mut points = self.hull.hull().positions().to_vec();
        points.extend(needs.out.iter().filter(|out| out.0 > 0.0).map(|out| out.1));
        self.hull = HitHull::new(&points)?;
        Ok(())
    }

    /// Grows the hull to enclose its image enlarged by `gauge` around its middle, and everything
    /// within `margin` of that image.
    ///
    /// If a sphere of radius ρ around the middle is inside the enlarged hull, then everything
    /// within m of that hull is inside the hull enlarged once more by 1 + m / ρ. If m / ρ is large,
    /// cubes around the corners give a smaller hull.
    pub(super) fn grow_hull(&mut self, gauge: f64, margin: f64) -> Result<(), InputError> {
        const MAX_SHARE: f64 = 0.05;
        let middle = middle(self.hull.hull());
        let inner = self.hull.planes().iter().map(|&(n, level)| level - dot(&n, &middle)).fold(f64::INFINITY, f64::min);
        let enlarge = |factor: f64| {
            let image = |&corner: &Vector| add(&middle, &scale(&sub(&corner, &middle), factor * (1.0 + 1e-12)));
            self.hull.hull().positions().iter().map(image).collect::<Vec<_>>()
        };
        let share = margin / (inner * gauge);
        let corners = if share < MAX_SHARE {
            enlarge(gauge * (1.0 + share))
        } else {
            enlarge(gauge).into_iter().flat_map(|corner| cube_about(corner, margin)).collect()
        };
        self.hull = HitHull::new(&corners)?;
        Ok(())
    }
}

/// Returns a point inside the hull: the mean of its corners.
pub(super) fn middle(hull: &Hull) -> Vector {
    let positions = hull.positions();
    let sum = positions.iter().fold([0.0; 3], |sum, &p| add(&sum, &p));
    scale(&sum, 1.0 / positions.len() as f64)
}

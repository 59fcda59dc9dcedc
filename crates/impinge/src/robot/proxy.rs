//! Volumes about a link: a sphere and one to four capsules that contain its shape.

use super::outline::{Ball, Outline};
use super::shell::Shell;
use crate::shape::Shape;
use crate::volume::{BoundingSphere, BoundingVolume, Capsule, Round, fit};

/// Maximum number of capsules of a link. More of them are tighter, but take longer to compare.
const MAX_CAPSULES: usize = 4;

/// Minimum factor by which one more capsule must reduce the volume.
const MIN_GAIN: f64 = 1.1;

/// Maximum number of points from which the axis of a capsule is computed. All points are in the
/// capsule. With more of them a robot takes longer to load.
const MAX_SAMPLES: usize = 256;

/// Share of the size of a shape by which volumes are enlarged, 2^-42. It covers the rounding of
/// points, of crossings and of the poses of parts (lemma L43 of the proofs).
const ENLARGEMENT: f64 = 1024.0 * f64::EPSILON;

/// Maximum stretch of a link for which volumes are used. A link whose pose is farther from a rigid
/// motion may have no valid place.
const MAX_STRETCH: f64 = 1.0 + 1e-5;

/// Volumes that contain the shape of a link, in the frame of the link.
#[derive(Clone, Debug)]
pub(super) enum Proxy {
    /// The link has no shape, or its shape is empty.
    Nowhere,
    /// Nothing is known.
    Anywhere,
    /// Volumes that each contain the shape, and the rounding errors of its place.
    Within(Volumes),
}

/// A sphere, and capsules that together contain what the sphere contains of a shape.
#[derive(Clone, Debug)]
pub(super) struct Volumes {
    pub(super) sphere: Ball,
    pub(super) capsules: Vec<Capsule>,
    /// For each capsule the hull of what it contains of the shape, if it is known.
    pub(super) shells: Vec<Option<Shell>>,
}

impl Proxy {
    /// Returns volumes about the shape of a link, given a bound on the factor by which the pose of
    /// the link stretches lengths.
    pub(super) fn of(shape: Option<&Shape>, stretch: f64) -> Self {
        let Some(shape) = shape else { return Self::Nowhere };
        let outline = Outline::of(shape).filter(|outline| stretch <= MAX_STRETCH && outline.size.is_finite());
        let Some(outline) = outline else { return Self::Anywhere };
        if outline.spheres.is_empty() {
            return Self::Nowhere;
        }
        Volumes::of(&outline, stretch).map_or(Self::Anywhere, Self::Within)
    }
}

impl Volumes {
    fn of(outline: &Outline, stretch: f64) -> Option<Self> {
        let [min, max] = outline.bounds();
        let center = std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]);
        let point = Capsule::new(center, center, 0.0).ok()?;
        let grown = |radius: f64| (radius * stretch + ENLARGEMENT * outline.size) * (1.0 + ENLARGEMENT);
        let sphere = (center, grown(reach(&point, &outline.spheres)));
        let mut slabs = vec![outline.spheres.clone()];
        let mut capsules = vec![about(&outline.spheres)?];
        let mut volume = total(&capsules);
        for axis in 0..3 {
            for count in 2..=MAX_CAPSULES {
                let level = |cut: usize| min[axis] + (max[axis] - min[axis]) * (cut as f64 / count as f64);
                // The outermost slabs have no end, so that no rounded level leaves a point out.
                let low = |cut: usize| if cut == 0 { f64::NEG_INFINITY } else { level(cut) };
                let high = |cut: usize| if cut == count { f64::INFINITY } else { level(cut) };
                let divided = (0..count).map(|at| outline.slab(axis, [low(at), high(at + 1)]));
                let divided: Vec<Vec<Ball>> = divided.filter(|slab| !slab.is_empty()).collect();
                let found: Option<Vec<Capsule>> = divided.iter().map(|slab| about(slab)).collect();
                let Some(found) = found else { continue };
                let more = found.len().saturating_sub(capsules.len()) as i32;
                let fewer = capsules.len().saturating_sub(found.len()) as i32;
                let new = total(&found);
                if new * MIN_GAIN.powi(more) < volume * MIN_GAIN.powi(fewer) {
                    (slabs, capsules, volume) = (divided, found, new);
                }
            }
        }
        let grow = |capsule: &Capsule| {
            let [start, end] = capsule.ends();
            Capsule::new(start, end, grown(capsule.radius())).ok()
        };
        let capsules = capsules.iter().map(grow).collect::<Option<_>>()?;
        let shells = slabs.iter().map(|slab| Shell::about(slab, grown)).collect();
        Some(Self { sphere, capsules, shells })
    }
}

fn total(capsules: &[Capsule]) -> f64 {
    capsules.iter().map(BoundingVolume::volume).sum()
}

/// Returns a capsule that contains spheres.
fn about(spheres: &[Ball]) -> Option<Capsule> {
    let mut sample: Vec<[f64; 3]> =
        spheres.iter().step_by(spheres.len().div_ceil(MAX_SAMPLES)).map(|(center, _)| *center).collect();
    // The points that are farthest along the axes and the diagonals.
    for direction in (0..13_i32).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1].map(f64::from)) {
        let height = |(point, _): &Ball| (0..3).map(|k| direction[k] * point[k]).sum::<f64>();
        let ends = [
            spheres.iter().min_by(|a, b| height(a).total_cmp(&height(b))),
            spheres.iter().max_by(|a, b| height(a).total_cmp(&height(b))),
        ];
        sample.extend(ends.into_iter().flatten().map(|(center, _)| *center));
    }
    let [start, end] = fit::capsule(&sample).ok()?.ends();
    let core = Capsule::new(start, end, 0.0).ok()?;
    Capsule::new(start, end, reach(&core, spheres)).ok()
}

/// Returns the greatest distance of the points of spheres from a core, rounded up.
fn reach(core: &Capsule, spheres: &[Ball]) -> f64 {
    let of = |&(center, radius): &Ball| {
        let point = BoundingSphere::new(center, 0.0).ok();
        point.map_or(f64::INFINITY, |point| (core.distance(&point).upper + radius).next_up())
    };
    spheres.iter().map(of).fold(0.0, f64::max)
}

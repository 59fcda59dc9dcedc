//! Whether two volumes in their frames meet.

use crate::input::InputError;
use crate::query::shapes;
use crate::volume::Proximity;

use super::frame::Frame;
use super::transform::{Vector, apply_transposed};
use super::vector::{add, dot, length, scale, sub, unit};
use super::volume::HitVolume;

/// Whether two volumes are not proved apart.
pub(super) fn meet(a: &HitVolume, frame_a: &Frame, b: &HitVolume, frame_b: &Frame) -> Result<bool, InputError> {
    // Spheres and pills make most of a character: in closed form, with more than what rounding takes.
    if let (Some(core_a), Some(core_b)) = (segment(a), segment(b)) {
        let [ends_a, ends_b] = [core_a.map(|p| frame_a.apply(p)), core_b.map(|p| frame_b.apply(p))];
        let (p, q) = super::segments::closest(ends_a, ends_b);
        let sum = a.radius() + b.radius();
        let size = [p, q, frame_a.origin, frame_b.origin].into_iter().map(length).sum::<f64>() + sum;
        let between = sub(q, p);
        let reach = sum + 1e-13 * size;
        if dot(between, between) <= reach * reach {
            return Ok(true);
        }
        // A plane between them proves it, whatever rounding did to the closest points.
        let most = |ends: [Vector; 2]| dot(between, ends[0]).max(dot(between, ends[1]));
        let least = |ends: [Vector; 2]| dot(between, ends[0]).min(dot(between, ends[1]));
        let gap = least(ends_b) - most(ends_a);
        return Ok(gap <= (reach + 1e-13 * size) * length(between));
    }
    if let Some(found) = by_supports(a, frame_a, b, frame_b) {
        return Ok(found);
    }
    let (placed_a, placed_b) = (a.placed(frame_a.pose()?)?, b.placed(frame_b.pose()?)?);
    Ok(shapes::proximity(&placed_a, &placed_b) != Proximity::Apart)
}

/// Whether two volumes meet, where a few planes or a point between them prove it with more than rounding to spare.
///
/// # Source
/// Chung and Wang, *Quick collision detection of polytopes in virtual environments*, 1996: a plane that does not separate is
/// turned away from the points which show that.
fn by_supports(a: &HitVolume, frame_a: &Frame, b: &HitVolume, frame_b: &Frame) -> Option<bool> {
    const TURNS: usize = 4;
    let (centre_a, centre_b) = (frame_a.apply(a.bounding_sphere().0), frame_b.apply(b.bounding_sphere().0));
    let size = [centre_a, centre_b, frame_a.origin, frame_b.origin].into_iter().map(length).sum::<f64>()
        + a.bounding_sphere().1
        + b.bounding_sphere().1;
    let slack = 1e-12 * size;
    let support = |volume: &HitVolume, frame: &Frame, direction: Vector| {
        frame.apply(volume.support(apply_transposed(&frame.rotation, direction)))
    };
    let mut normal = unit(sub(centre_b, centre_a))?;
    for _ in 0..TURNS {
        let (p, q) = (support(a, frame_a, normal), support(b, frame_b, scale(normal, -1.0)));
        let between = sub(q, p);
        if dot(normal, between) > slack {
            return Some(false);
        }
        let middle = scale(add(p, q), 0.5);
        let inside = |volume: &HitVolume, frame: &Frame| volume.signed_distance(frame.local(middle)) < -slack;
        if inside(a, frame_a) && inside(b, frame_b) {
            return Some(true);
        }
        let away = unit(between)?;
        normal = unit(sub(normal, scale(away, 2.0 * dot(normal, away))))?;
    }
    None
}

/// The segment that a sphere sweeps.
fn segment(volume: &HitVolume) -> Option<[Vector; 2]> {
    match volume {
        HitVolume::Sphere(sphere) => Some([sphere.centre(); 2]),
        HitVolume::Capsule(capsule) => Some(capsule.ends()),
        _ => None,
    }
}

/// What a volume's sphere sweeps, or the surface of one without, as a mesh; points and segments as triangles without area.
pub(super) fn core(volume: &HitVolume) -> (Vec<Vector>, Vec<[u32; 3]>) {
    match volume {
        HitVolume::Sphere(sphere) => (vec![sphere.centre()], vec![[0; 3]]),
        HitVolume::Capsule(capsule) => (capsule.ends().to_vec(), vec![[0, 1, 1]]),
        HitVolume::Lozenge(lozenge) => {
            let ([u, v], c) = (lozenge.edges(), lozenge.corner());
            (vec![c, add(c, u), add(c, v), add(add(c, u), v)], vec![[0, 1, 2], [1, 3, 2]])
        }
        HitVolume::Box(obb) => {
            const FACES: [[u32; 3]; 12] = [
                [0, 2, 1],
                [1, 2, 3],
                [4, 5, 6],
                [5, 7, 6],
                [0, 1, 4],
                [1, 5, 4],
                [2, 6, 3],
                [3, 6, 7],
                [0, 4, 2],
                [2, 4, 6],
                [1, 3, 5],
                [3, 7, 5],
            ];
            (obb.corners().to_vec(), FACES.to_vec())
        }
        HitVolume::Hull(hull) => (hull.hull().positions().to_vec(), hull.hull().faces().to_vec()),
    }
}

//! Two poses, and the values that are derived from them once for all pairs of triangles.

use crate::math::dyadic::Dyadic;
use crate::math::relative::Offset;
use crate::math::{Pose, RelativeMap};

/// The poses of two meshes, A and B, with the values that all exact tests of their triangles share.
#[derive(Clone, Debug)]
pub struct Placement {
    world_from_a: Pose,
    world_from_b: Pose,
    relative: RelativeMap,
    frame: Frame,
}

/// A frame in which the corners of both meshes have exact coordinates. An affine map keeps all
/// orientations or flips all of them, so any frame serves, up to that flip.
#[derive(Clone, Debug)]
pub(super) enum Frame {
    /// The common local frame of equal poses.
    Local,
    /// The world, moved by A's translation, if all entries of both linear parts are -1, 0 or 1.
    /// Coordinates are sums of given floats, on a grid no finer than theirs.
    Grid { linear_a: [[i64; 3]; 3], linear_b: [[i64; 3]; 3], offset: [f64; 3] },
    /// The world.
    World,
}

impl Placement {
    /// Computes the values that all exact tests of triangles of two meshes share: the poses, the
    /// map from B to A, and the frame of the arithmetic.
    #[must_use]
    pub fn new(world_from_a: &Pose, world_from_b: &Pose) -> Self {
        let relative = RelativeMap::a_from_b(world_from_a, world_from_b);
        let frame = if world_from_a == world_from_b { Frame::Local } else { Frame::of(world_from_a, world_from_b) };
        Self { world_from_a: *world_from_a, world_from_b: *world_from_b, relative, frame }
    }

    /// Returns the map from the frame of mesh B to the frame of mesh A, with its error bounds.
    #[must_use]
    pub fn relative(&self) -> &RelativeMap {
        &self.relative
    }

    /// Returns the pose of mesh A: the map from its own frame to the world frame.
    #[must_use]
    pub fn world_from_a(&self) -> &Pose {
        &self.world_from_a
    }

    /// Returns the pose of mesh B: the map from its own frame to the world frame.
    #[must_use]
    pub fn world_from_b(&self) -> &Pose {
        &self.world_from_b
    }

    /// Reports whether both poses are equal. Answers then follow from the coordinates in the common
    /// mesh frame alone.
    #[must_use]
    pub fn is_shared(&self) -> bool {
        matches!(self.frame, Frame::Local)
    }

    pub(super) fn frame(&self) -> &Frame {
        &self.frame
    }
}

impl Frame {
    fn of(world_from_a: &Pose, world_from_b: &Pose) -> Self {
        let offset = Offset::between(world_from_a, world_from_b);
        match (unit_entries(world_from_a), unit_entries(world_from_b)) {
            (Some(linear_a), Some(linear_b)) if offset.is_exact() => {
                Self::Grid { linear_a, linear_b, offset: offset.rounded }
            }
            _ => Self::World,
        }
    }
}

/// Returns the exact image in the world of a point of the local frame.
pub(crate) fn world_point(world_from_local: &Pose, point: &[f64; 3]) -> [Dyadic; 3] {
    [0, 1, 2].map(|axis| world_coordinate(world_from_local, axis, point))
}

/// Returns one coordinate of the exact image in the world of a point of the local frame.
pub(super) fn world_coordinate(world_from_local: &Pose, axis: usize, point: &[f64; 3]) -> Dyadic {
    let row = &world_from_local.linear()[axis];
    let product = |k: usize| Dyadic::product(row[k], point[k]);
    &(&(&product(0) + &product(1)) + &product(2)) + &Dyadic::from_f64(world_from_local.translation()[axis])
}

fn unit_entries(pose: &Pose) -> Option<[[i64; 3]; 3]> {
    let is_unit = |entry: &f64| *entry == 0.0 || entry.abs() == 1.0;
    pose.linear().iter().flatten().all(is_unit).then(|| pose.linear().map(|row| row.map(|entry| entry as i64)))
}

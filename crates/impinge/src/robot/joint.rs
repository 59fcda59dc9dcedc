//! Joints: how the child link moves in the frame of its parent.

use super::frame::{Frame, rotation};
use crate::math::Pose;
use crate::math::sine::{MAX_ANGLE, sine_and_cosine};

/// How a joint moves. The axis of a joint has length 1, in the frame of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// The child does not move. No coordinates.
    Fixed,
    /// The child turns about the axis, right-handed. One coordinate in radians.
    Revolute,
    /// The child turns about the axis without limits. One coordinate in radians.
    Continuous,
    /// The child slides along the axis. One coordinate, in units of length.
    Prismatic,
    /// The child slides in the plane across the axis and turns about it. Three coordinates: `x`,
    /// `y` and `theta`. The directions of `x` and `y` are those of the coordinate axes after the
    /// smallest rotation that takes z to the axis.
    Planar,
    /// The child moves freely. Seven coordinates: the translation `x`, `y`, `z` and a quaternion
    /// `qx`, `qy`, `qz`, `qw`, which is normalized.
    Floating,
}

/// Rule by which a joint of one coordinate follows another joint: `multiplier * q + offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// Name of the joint that is followed.
    pub joint: String,
    /// Factor of the coordinate of that joint.
    pub multiplier: f64,
    /// Value that is added, in radians or units of length.
    pub offset: f64,
}

/// A joint between two links.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name, which no other joint of the robot has.
    pub name: String,
    /// How the joint moves.
    pub kind: JointKind,
    /// Name of the parent link.
    pub parent: String,
    /// Name of the child link.
    pub child: String,
    /// Pose that maps the frame of the joint, which is the frame of the child when all coordinates
    /// are zero, to the frame of the parent. It must be rigid within 1e-4.
    pub parent_from_joint: Pose,
    /// Axis in the frame of the joint. Its length may be anything but zero, and is normalized. Not
    /// used by fixed and floating joints.
    pub axis: [f64; 3],
    /// Lower and upper limit of the coordinate of a revolute or prismatic joint. `None` if there is
    /// no limit.
    pub limits: Option<[f64; 2]>,
    /// Joint that this joint follows, if any. A joint that follows another has no coordinate of its
    /// own.
    pub mimic: Option<Mimic>,
}

impl Joint {
    /// Returns a fixed joint between two links that are given by their names.
    #[must_use]
    pub fn fixed(
        name: impl Into<String>,
        parent: impl Into<String>,
        child: impl Into<String>,
        parent_from_joint: Pose,
    ) -> Self {
        Self {
            name: name.into(),
            kind: JointKind::Fixed,
            parent: parent.into(),
            child: child.into(),
            parent_from_joint,
            axis: [1.0, 0.0, 0.0],
            limits: None,
            mimic: None,
        }
    }

    /// Returns this joint with another kind and axis.
    #[must_use]
    pub fn moving(self, kind: JointKind, axis: [f64; 3]) -> Self {
        Self { kind, axis, ..self }
    }

    /// Returns this joint with limits of its coordinate.
    #[must_use]
    pub fn limited(self, lower: f64, upper: f64) -> Self {
        Self { limits: Some([lower, upper]), ..self }
    }
}

impl JointKind {
    /// Returns the suffixes of the names of the coordinates: one for each coordinate. That of a
    /// single coordinate is empty.
    pub(super) fn coordinates(self) -> &'static [&'static str] {
        match self {
            Self::Fixed => &[],
            Self::Revolute | Self::Continuous | Self::Prismatic => &[""],
            Self::Planar => &["/x", "/y", "/theta"],
            Self::Floating => &["/x", "/y", "/z", "/qx", "/qy", "/qz", "/qw"],
        }
    }

    /// Reports whether a coordinate of the joint, given by its index, is an angle.
    pub(super) fn is_angle(self, coordinate: usize) -> bool {
        match self {
            Self::Revolute | Self::Continuous => true,
            Self::Planar => coordinate == 2,
            Self::Fixed | Self::Prismatic | Self::Floating => false,
        }
    }

    /// Reports whether the limits of a joint are those of its coordinate.
    pub(super) fn has_limits(self) -> bool {
        matches!(self, Self::Revolute | Self::Prismatic)
    }

    /// Returns the range of a coordinate without limits.
    pub(super) fn range(self, coordinate: usize) -> [f64; 2] {
        if self == Self::Floating && coordinate >= 3 { [-1.0, 1.0] } else { [f64::NEG_INFINITY, f64::INFINITY] }
    }

    pub(super) fn has_axis(self) -> bool {
        !matches!(self, Self::Fixed | Self::Floating)
    }
}

/// A joint as the kinematics use it.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    pub(super) kind: JointKind,
    pub(super) parent_from_joint: Frame,
    /// Axis of length 1.
    pub(super) axis: [f64; 3],
    /// Directions of x and y of a planar joint.
    pub(super) plane: [[f64; 3]; 2],
}

/// Reason why a value of a coordinate is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InvalidValue {
    NonFinite,
    OutOfRange,
    ZeroQuaternion,
}

impl Motion {
    /// Returns the motion of a joint, or `None` if its axis has no direction.
    pub(super) fn of(joint: &Joint) -> Option<Self> {
        let axis = if joint.kind.has_axis() { normalized(joint.axis)? } else { [0.0, 0.0, 1.0] };
        let plane = across(axis);
        Some(Self { kind: joint.kind, parent_from_joint: Frame::of(&joint.parent_from_joint), axis, plane })
    }

    /// Returns the index and the sign of the axis if it is a coordinate axis.
    pub(super) fn coordinate_axis(&self) -> Option<(usize, f64)> {
        let is_along = |&k: &usize| self.axis[(k + 1) % 3] == 0.0 && self.axis[(k + 2) % 3] == 0.0;
        (0..3).find(is_along).map(|k| (k, self.axis[k]))
    }

    /// Validates the values of the coordinates of the joint. Returns the index of the first invalid
    /// value.
    pub(super) fn check(&self, values: &[f64]) -> Result<(), (usize, InvalidValue)> {
        /// Maximum magnitude of a length, 2^128, as for shapes.
        const MAX_LENGTH: f64 = (1_u128 << 127) as f64 * 2.0;
        // Most joints have one coordinate, which is valid. A limit also excludes NaN.
        if let &[value] = values
            && value.abs() <= if self.kind == JointKind::Prismatic { MAX_LENGTH } else { MAX_ANGLE }
        {
            return Ok(());
        }
        for (at, value) in values.iter().enumerate() {
            let limit = if self.kind.is_angle(at) { MAX_ANGLE } else { MAX_LENGTH };
            if !value.is_finite() {
                return Err((at, InvalidValue::NonFinite));
            }
            if value.abs() > limit {
                return Err((at, InvalidValue::OutOfRange));
            }
        }
        match self.kind {
            JointKind::Floating if normalized4(&values[3..]).is_none() => Err((3, InvalidValue::ZeroQuaternion)),
            _ => Ok(()),
        }
    }

    /// Returns the map from the frame of the child to the frame of the parent. The values must be
    /// valid.
    pub(super) fn parent_from_child(&self, values: &[f64]) -> Frame {
        let along = |x: f64| self.axis.map(|a| a * x);
        match (self.kind, values) {
            (JointKind::Revolute | JointKind::Continuous, &[angle]) => {
                let turned = rotation(self.axis, sine_and_cosine(angle));
                self.parent_from_joint.after(&Frame::new(turned, [0.0; 3]))
            }
            (JointKind::Prismatic, &[length]) => self.parent_from_joint.translated(along(length)),
            (JointKind::Planar, &[x, y, angle]) => {
                let [u, v] = self.plane;
                let moved = std::array::from_fn(|k| u[k] * x + v[k] * y);
                let turned = rotation(self.axis, sine_and_cosine(angle));
                self.parent_from_joint.after(&Frame::new(turned, moved))
            }
            (JointKind::Floating, &[x, y, z, ..]) => {
                let [i, j, k, w] = normalized4(&values[3..]).unwrap_or([0.0, 0.0, 0.0, 1.0]);
                let moved = Pose::from_quaternion_wxyz([x, y, z], [w, i, j, k]);
                self.parent_from_joint.after(&moved.map_or(Frame::IDENTITY, |pose| Frame::of(&pose)))
            }
            _ => self.parent_from_joint,
        }
    }
}

/// Returns a vector of length 1 in the same direction. One along a coordinate axis is exact.
/// Returns `None` if the vector is zero, NaN or infinite.
fn normalized(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if !vector.iter().all(|x| x.is_finite()) || largest == 0.0 {
        return None;
    }
    // Dividing by the largest entry first avoids overflow and underflow of squares.
    let scaled = vector.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    Some(scaled.map(|x| x / length))
}

/// Returns four numbers scaled so that the sum of their squares is about 1, or `None` if all are
/// zero.
fn normalized4(values: &[f64]) -> Option<[f64; 4]> {
    let &[a, b, c, d] = values else { return None };
    let largest = values.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let scaled = [a, b, c, d].map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    (largest > 0.0).then(|| scaled.map(|x| x / length))
}

/// Returns the images of x and y under the smallest rotation that takes z to an axis of length 1.
/// For the axis -z it is the half turn about x.
fn across([x, y, z]: [f64; 3]) -> [[f64; 3]; 2] {
    if z == -1.0 {
        return [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    }
    // Half of the rotation's quaternion is (1 + z, -y, x, 0), up to its length.
    let k = 1.0 / (1.0 + z);
    [[1.0 - x * x * k, -x * y * k, -x], [-x * y * k, 1.0 - y * y * k, -y]]
}

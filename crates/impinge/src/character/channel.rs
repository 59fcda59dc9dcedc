//! Channels as they are given: keys of one property of a bone, or of one morph target.

use super::error::{RigError, RigErrorKind, RigPlace, check_numbers};
use super::timeline::Property;
use super::transform::normalized;

/// The property that a channel animates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// The translation of the bone with this index, relative to its parent: three values per key.
    Translation(u32),
    /// The rotation of the bone with this index, relative to its parent: a quaternion (w, x, y, z)
    /// per key.
    Rotation(u32),
    /// The scale of the bone with this index along its own axes: three values per key.
    Scale(u32),
    /// The weight of the morph target with this index: one value per key.
    MorphWeight(u32),
}

impl Target {
    /// Number of values per key, without slopes.
    pub(super) fn width(self) -> usize {
        match self {
            Self::Translation(_) | Self::Scale(_) => 3,
            Self::Rotation(_) => 4,
            Self::MorphWeight(_) => 1,
        }
    }

    /// Returns the property and the bone, or `None` for a morph weight.
    pub(super) fn bone_property(self) -> Option<(Property, u32)> {
        match self {
            Self::Translation(bone) => Some((Property::Translation, bone)),
            Self::Rotation(bone) => Some((Property::Rotation, bone)),
            Self::Scale(bone) => Some((Property::Scale, bone)),
            Self::MorphWeight(_) => None,
        }
    }
}

/// The interpolation between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// The value of the earlier key.
    Step,
    /// Linear interpolation. Rotations take the shorter arc at constant speed.
    Linear,
    /// A cubic Hermite spline. Each key has the slope before it per second, its value, and the
    /// slope after it per second. Interpolated rotations are normalized to length 1.
    CubicSpline,
}

/// One channel as it is given: the keys of one animated property.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The property that the channel animates.
    pub target: Target,
    /// The interpolation between its keys.
    pub interpolation: Interpolation,
    /// The times of its keys in seconds, strictly increasing. The first value holds before the
    /// first key, the last value after the last key.
    pub times: Vec<f64>,
    /// The values, key by key: as many as the target needs, or three times as many for splines.
    pub values: Vec<f64>,
}

/// Validates a channel. Rotations are normalized to length 1, except those of splines.
pub(super) fn validated(mut channel: Channel, animation: usize, at: usize) -> Result<Channel, RigError> {
    let Channel { target, interpolation, times, values } = &mut channel;
    let place = RigPlace::Channel { animation, channel: at };
    let key = |key: usize| RigPlace::Key { animation, channel: at, key };
    let of_key = values_per_key(*target, *interpolation);
    let expected = times.len() * of_key;
    if values.len() != expected || times.is_empty() {
        let kind = RigErrorKind::OtherCount { what: "values", count: values.len(), expected: expected.max(1) };
        return Err(RigError::new(kind, place));
    }
    for (i, &time) in times.iter().enumerate() {
        check_numbers(&[time], "time", key(i))?;
        if i > 0 && time <= times[i - 1] {
            return Err(RigError::new(RigErrorKind::TimesNotIncreasing, key(i)));
        }
    }
    let width = target.width();
    for (i, all) in values.chunks_mut(of_key).enumerate() {
        check_numbers(all, "key", key(i))?;
        let start = if *interpolation == Interpolation::CubicSpline { width } else { 0 };
        let own = &mut all[start..start + width];
        match target {
            Target::Scale(_) if own.contains(&0.0) => {
                return Err(RigError::new(RigErrorKind::ZeroScale, key(i)));
            }
            Target::Rotation(_) => {
                let zero = || RigError::new(RigErrorKind::ZeroRotation, key(i));
                let unit = normalized([own[0], own[1], own[2], own[3]]).ok_or_else(zero)?;
                if *interpolation != Interpolation::CubicSpline {
                    own.copy_from_slice(&unit);
                }
            }
            _ => {}
        }
    }
    Ok(channel)
}

pub(super) fn values_per_key(target: Target, interpolation: Interpolation) -> usize {
    target.width() * if interpolation == Interpolation::CubicSpline { 3 } else { 1 }
}

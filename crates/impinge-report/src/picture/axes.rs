//! The directions of a picture: right, down, and away from the viewer.

use super::vector::{Vector, cross, unit};

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// The first axis.
    X,
    /// The second axis.
    Y,
    /// The third axis.
    Z,
}

impl Axis {
    /// Returns the unit vector along the axis.
    #[must_use]
    pub fn direction(self) -> [f64; 3] {
        let mut direction = [0.0; 3];
        direction[self as usize] = 1.0;
        direction
    }

    /// Returns the name: `x`, `y` or `z`.
    #[must_use]
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self as usize]
    }
}

/// Directions right, down and away from the viewer, as perpendicular unit vectors of the world.
pub(crate) type Directions = [Vector; 3];

/// Returns the directions of a viewer who looks along `away`, with `up` upwards in the picture.
/// The two must not be parallel.
pub(crate) fn looking(away: Vector, up: Axis) -> Directions {
    let away = unit(away);
    let right = unit(cross(away, up.direction()));
    [right, cross(away, right), away]
}

/// Returns the directions of a viewer at the front right and a little above, turned by less than
/// 45 degrees, so that no two edges of a box hide each other.
pub(crate) fn from_front_right(up: Axis) -> Directions {
    let mut away = [0.0; 3];
    let up_index = up as usize;
    away[up_index] = -0.42;
    away[(up_index + 1) % 3] = -0.88;
    away[(up_index + 2) % 3] = -0.5;
    looking(away, up)
}

/// Returns the directions of a viewer who looks from the front, then walks to the right by an
/// azimuth and climbs by an elevation, both in degrees.
///
/// The front is where Y has its minimum if Z is up, and where Z has its maximum if Y is up.
pub(crate) fn orbit([azimuth, elevation]: [f64; 2], up: Axis) -> Directions {
    let [(sa, ca), (se, ce)] = [azimuth, elevation].map(|angle| angle.to_radians().sin_cos());
    // In a frame with Y up and Z towards a viewer in front.
    let right = [ca, 0.0, -sa];
    let down = [se * sa, -ce, se * ca];
    let away = [-ce * sa, -se, -ce * ca];
    [right, down, away].map(|[x, y, z]| match up {
        Axis::X => [y, z, x],
        Axis::Y => [x, y, z],
        Axis::Z => [x, -z, y],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::vector::dot;

    #[test]
    fn directions_are_perpendicular_and_up_is_up() {
        for up in [Axis::X, Axis::Y, Axis::Z] {
            for [right, down, away] in [from_front_right(up), orbit([-35.0, 25.0], up), orbit([150.0, -30.0], up)] {
                assert!(dot(down, up.direction()) < -0.5);
                assert!(dot(right, up.direction()).abs() < 1e-12);
                let turned = cross(right, down);
                assert!((0..3).all(|k| (turned[k] - away[k]).abs() < 1e-12), "{right:?} {down:?} {away:?}");
            }
        }
    }
}

//! Colors, and how surfaces are lit.

use super::camera::Seen;
use super::vector::{Vector, cross, dot, length, times, unit};

/// Red, green and blue.
pub(crate) type Color = [u8; 3];

/// Colors that people with every kind of color vision tell apart (Okabe, Ito, *Color universal
/// design*, 2008, without yellow and black).
pub const DISTINCT: [[u8; 3]; 6] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0]];

/// Names of the [`DISTINCT`] colors.
pub const DISTINCT_NAMES: [&str; 6] = ["blue", "red", "green", "pink", "sky", "orange"];

/// Color of the first of two things.
pub(crate) const FIRST: Color = [74, 144, 196];
/// Color of the second of two things.
pub(crate) const SECOND: Color = [230, 159, 0];
/// Color of the curves in which two things intersect.
pub(crate) const CURVE: Color = [196, 22, 96];
/// Color of things that are not the subject of a picture.
pub(crate) const GHOST: Color = [196, 202, 210];
/// Color of a mesh on its own.
pub(crate) const MESH: Color = [206, 209, 214];
/// Color of letters and thin lines.
pub(crate) const INK: Color = [48, 54, 64];

/// Directions towards the lights, right, down and away from the viewer, and their intensities.
const LIGHTS: [(Vector, f64); 3] = [([-0.5, -0.7, -0.8], 0.5), ([0.9, -0.2, -0.4], 0.2), ([0.0, 0.5, -0.6], 0.1)];
/// Light that comes from everywhere.
const AMBIENT: f64 = 0.46;
/// Maximum brightness. More makes bright faces lose their color.
const BRIGHTEST: f64 = 1.08;

/// Returns a color lit by Lambert's law, the same from both sides of the surface. The normal has
/// any length, and components right, down and away from the viewer.
pub(crate) fn lit(color: Color, normal: Vector, ambient: f64) -> Color {
    let size = length(normal);
    if !(size > 0.0 && size.is_finite()) {
        return shaded(color, ambient);
    }
    // Towards the viewer.
    let normal = times(normal, if normal[2] > 0.0 { -1.0 } else { 1.0 } / size);
    let light: f64 = LIGHTS.iter().map(|&(towards, strength)| strength * dot(normal, unit(towards)).max(0.0)).sum();
    shaded(color, (ambient + light).min(BRIGHTEST))
}

/// Returns the color of a triangle, given by its projected corners.
pub(crate) fn lit_triangle(color: Color, [a, b, c]: &[Seen; 3]) -> Color {
    let edge = |to: &Seen| [0, 1, 2].map(|k| to[k] - a[k]);
    lit(color, cross(edge(b), edge(c)), AMBIENT)
}

/// Returns a color times a brightness.
pub(crate) fn shaded(color: Color, brightness: f64) -> Color {
    // The cast saturates.
    color.map(|part| (f64::from(part) * brightness).round() as u8)
}

/// Returns the mix of two colors; a share of 1 is the second.
pub(crate) fn mixed(from: Color, to: Color, share: f64) -> Color {
    mixer(share)(from, to)
}

/// Returns a function that mixes two colors; a share of 1 is the second.
pub(crate) fn mixer(share: f64) -> impl Fn(Color, Color) -> Color + Copy + Sync {
    // In units of 2^-16. The cast saturates.
    const ONE: u32 = 1 << 16;
    let to_share = ((share * f64::from(ONE)).round() as u32).min(ONE);
    let part =
        move |from: u8, to: u8| ((u32::from(from) * (ONE - to_share) + u32::from(to) * to_share + ONE / 2) / ONE) as u8;
    move |from, to| [0, 1, 2].map(|k| part(from[k], to[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_of_a_surface_are_lit_alike() {
        for normal in [[0.3, -0.2, 0.9], [1.0, 0.0, 0.01], [-4.0, 2.0, -0.1]] {
            assert_eq!(lit(FIRST, normal, 0.2), lit(FIRST, times(normal, -3.0), 0.2));
        }
        assert_eq!(lit(FIRST, [0.0; 3], 1.0), FIRST);
        assert!(lit(FIRST, [0.0, 0.0, 1.0], AMBIENT)[2] > lit(FIRST, [1.0, 0.5, 0.01], AMBIENT)[2]);
    }
}

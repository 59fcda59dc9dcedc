//! Numbers, points, poses and shapes on a small lattice, where most cases are ties.

use std::sync::Arc;

use arbitrary::{Result, Unstructured};
use impinge::hull::Hull;
use impinge::{Mesh, Pose, Positions, Shape};
use impinge_testkit::generate::solids::icosphere;

/// Returns a multiple of one half, at most 3 in magnitude. One in sixteen is one float beside it.
///
/// # Errors
/// Returns an error if the bytes do not suffice.
pub fn number(bytes: &mut Unstructured<'_>) -> Result<f64> {
    let on_grid = 0.5 * f64::from(bytes.int_in_range(-6..=6_i8)?);
    Ok(match bytes.int_in_range(0..=31_u8)? {
        0 => on_grid.next_up(),
        1 => on_grid.next_down(),
        _ => on_grid,
    })
}

/// Returns a point.
///
/// # Errors
/// Returns an error if the bytes do not suffice.
pub fn point(bytes: &mut Unstructured<'_>) -> Result<[f64; 3]> {
    Ok([number(bytes)?, number(bytes)?, number(bytes)?])
}

/// Returns a length that is not negative.
///
/// # Errors
/// Returns an error if the bytes do not suffice.
pub fn length(bytes: &mut Unstructured<'_>) -> Result<f64> {
    Ok(number(bytes)?.abs())
}

/// Returns a rigid pose: a turn about an axis by a multiple of a right angle, or by that of a 3-4-5
/// triangle, and a translation.
///
/// # Errors
/// Returns an error if the bytes do not suffice.
pub fn pose(bytes: &mut Unstructured<'_>) -> Result<Pose> {
    let [c, s] = *bytes.choose(&[[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [0.6, 0.8]])?;
    let [i, j, k] = *bytes.choose(&[[0, 1, 2], [1, 2, 0], [2, 0, 1]])?;
    let mut linear = [[0.0; 3]; 3];
    (linear[i][i], linear[i][j], linear[j][i], linear[j][j], linear[k][k]) = (c, -s, s, c, 1.0);
    Ok(Pose::new(linear, point(bytes)?).expect("finite"))
}

/// Returns a shape of any kind.
///
/// # Errors
/// Returns an error if the bytes do not suffice.
pub fn shape(bytes: &mut Unstructured<'_>) -> Result<Shape> {
    let kind = bytes.int_in_range(0..=13_u8)?;
    let made = match kind {
        0 => Shape::sphere(point(bytes)?, length(bytes)?),
        1 => Shape::capsule(point(bytes)?, point(bytes)?, length(bytes)?),
        2 => Shape::cuboid([length(bytes)?, length(bytes)?, length(bytes)?]),
        3 => Shape::cylinder(length(bytes)?, length(bytes)?),
        4 => Shape::cone(length(bytes)?, length(bytes)?),
        5 => Shape::ellipsoid([length(bytes)?, length(bytes)?, length(bytes)?]),
        6 => Shape::point(point(bytes)?),
        7 => Shape::segment([point(bytes)?, point(bytes)?]),
        8 => Shape::triangle([point(bytes)?, point(bytes)?, point(bytes)?]),
        9 => Shape::half_space(point(bytes)?, number(bytes)?),
        10 => {
            let points = (0..bytes.int_in_range(1..=8)?).map(|_| point(bytes)).collect::<Result<Vec<_>>>()?;
            Hull::new(&points).map(|hull| Shape::hull(Arc::new(hull)))
        }
        11 => Shape::cuboid([length(bytes)?, length(bytes)?, length(bytes)?]).and_then(|core| core.rounded(0.5)),
        12 => Shape::tapered_capsule(point(bytes)?, point(bytes)?, [length(bytes)?, length(bytes)?]),
        _ => {
            let solid = icosphere(0);
            Mesh::new(Positions::F64(solid.vertices), solid.faces).map(|mesh| {
                if bytes.ratio(1_u8, 2_u8).unwrap_or(false) { Shape::solid(&mesh) } else { Shape::mesh(&mesh) }
            })
        }
    };
    // A half-space without a normal is no shape.
    Ok(made.unwrap_or_else(|_| Shape::sphere([0.0; 3], 1.0).expect("a sphere")))
}

//! The transforms of nodes: translation, rotation and scale, or a matrix that is decomposed.

use impinge::character::{RigErrorKind, Transform};

use super::broken;
use crate::{error::LoadError, gltf::document::Node};

/// Returns the transform of a node; a matrix is decomposed. Returns an error if the matrix shears
/// or has a scale of zero.
pub(super) fn transform(node: &Node) -> Result<Transform, LoadError> {
    let Some(m) = node.matrix.as_deref() else {
        let [x, y, z, w] = node.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
        return Ok(Transform {
            translation: node.translation.as_deref().copied().unwrap_or([0.0; 3]),
            rotation_wxyz: [w, x, y, z],
            scale: node.scale.as_deref().copied().unwrap_or([1.0; 3]),
        });
    };
    // Maximum cosine between two axes of a matrix. It is larger than errors of single precision,
    // and far smaller than an intended shear.
    const SHEAR: f64 = 1e-3;
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let columns = [0, 1, 2].map(|k| [m[4 * k], m[4 * k + 1], m[4 * k + 2]]);
    let mut scale = columns.map(|column| dot(column, column).sqrt());
    if scale.contains(&0.0) {
        return Err(broken(RigErrorKind::ZeroScale, None));
    }
    let mut axes = [0, 1, 2].map(|k| columns[k].map(|x| x / scale[k]));
    let [x, y, z] = axes;
    let is_sheared = [dot(x, y), dot(y, z), dot(z, x)].iter().any(|cosine| cosine.abs() > SHEAR || cosine.is_nan());
    if is_sheared || [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
        return Err(LoadError::syntax("a matrix of translation, rotation and scale", format!("{m:?}").as_bytes()));
    }
    let across = [y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0]];
    if dot(x, across) < 0.0 {
        scale[0] = -scale[0];
        axes[0] = x.map(|x| -x);
    }
    Ok(Transform { translation: [m[12], m[13], m[14]], rotation_wxyz: quaternion(&axes), scale })
}

/// Returns a quaternion (w, x, y, z), of any length, of a rotation given by its columns: the
/// longest result of four formulas.
fn quaternion([x, y, z]: &[[f64; 3]; 3]) -> [f64; 4] {
    let (a, b, c) = (y[2] - z[1], z[0] - x[2], x[1] - y[0]);
    let (d, e, f) = (x[1] + y[0], y[2] + z[1], z[0] + x[2]);
    let (p, q, r) = (x[0], y[1], z[2]);
    let candidates = [
        [1.0 + p + q + r, a, b, c],
        [a, 1.0 + p - q - r, d, f],
        [b, d, 1.0 - p + q - r, e],
        [c, f, e, 1.0 - p - q + r],
    ];
    let size = |i: usize| candidates[i][i];
    candidates[(0..4).max_by(|&i, &j| size(i).total_cmp(&size(j))).unwrap_or(0)]
}

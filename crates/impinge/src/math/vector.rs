//! Vectors of three coordinates, in floats.

/// Three coordinates.
pub(crate) type Vector = [f64; 3];

#[inline(always)]
pub(crate) fn sub(a: &Vector, b: &Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The inner product: within 3.1 units of 2^-53 of the product of lengths.
#[inline(always)]
pub(crate) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product: each component within 2.1 units of 2^-53 of the magnitudes of its two products.
#[inline(always)]
pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length, of vectors whose squares neither overflow nor vanish.
#[inline(always)]
pub(crate) fn length(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The length, of any vector.
#[inline]
pub(crate) fn scaled_length(a: &Vector) -> f64 {
    let largest = a.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest > 0.0 { largest * length(&a.map(|x| x / largest)) } else { 0.0 }
}

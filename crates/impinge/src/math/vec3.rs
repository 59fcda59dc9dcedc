//! Vectors of three doubles. No operation is fused, and sums are added from left to right, because
//! error bounds rely on the order.

/// Three coordinates.
pub(crate) type Vector = [f64; 3];

#[inline(always)]
pub(crate) fn add(a: &Vector, b: &Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn sub(a: &Vector, b: &Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn scale(a: &Vector, factor: f64) -> Vector {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Returns the inner product. Its error is at most 3.1 * 2^-53 times the product of the lengths.
#[inline(always)]
pub(crate) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the cross product. The error of a component is at most 2.1 * 2^-53 times the sum of the
/// magnitudes of its two products.
#[inline(always)]
pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the length of a vector whose squared components neither overflow nor underflow.
#[inline(always)]
pub(crate) fn length(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Returns the length of any vector, without overflow in between.
#[inline]
pub(crate) fn scaled_length(a: &Vector) -> f64 {
    let largest = largest_magnitude(a);
    if largest > 0.0 { largest * length(&a.map(|x| x / largest)) } else { 0.0 }
}

/// Returns the squared distance of two points.
#[inline(always)]
pub(crate) fn squared_distance(p: &Vector, q: &Vector) -> f64 {
    let d = sub(p, q);
    dot(&d, &d)
}

/// Returns the rounded unit vector in the direction of any vector. Returns `None` if the vector is
/// zero or subnormal, or not finite.
pub(crate) fn normalized(a: &Vector) -> Option<Vector> {
    let largest = largest_magnitude(a);
    if largest < f64::MIN_POSITIVE || !largest.is_finite() {
        return None;
    }
    let a = a.map(|x| x / largest);
    let length = length(&a);
    Some(a.map(|x| x / length))
}

/// Returns the rounded unit vector in the direction of a vector. Returns `None` if the vector is
/// not finite or not longer than 1e-150. It is faster than [`normalized`].
#[inline(always)]
pub(crate) fn unit(a: &Vector) -> Option<Vector> {
    let length = length(a);
    (length > 1e-150 && length.is_finite()).then(|| scale(a, 1.0 / length))
}

#[inline]
fn largest_magnitude(a: &Vector) -> f64 {
    a.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()))
}

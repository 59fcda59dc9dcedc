//! Vectors of three numbers.

pub(crate) type Vector = [f64; 3];

pub(crate) fn add(u: Vector, v: Vector) -> Vector {
    [u[0] + v[0], u[1] + v[1], u[2] + v[2]]
}

pub(crate) fn minus(u: Vector, v: Vector) -> Vector {
    [u[0] - v[0], u[1] - v[1], u[2] - v[2]]
}

pub(crate) fn times(u: Vector, factor: f64) -> Vector {
    u.map(|x| x * factor)
}

pub(crate) fn dot(u: Vector, v: Vector) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

pub(crate) fn cross(u: Vector, v: Vector) -> Vector {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

pub(crate) fn length(v: Vector) -> f64 {
    dot(v, v).sqrt()
}

/// Returns the vector divided by its length.
pub(crate) fn unit(v: Vector) -> Vector {
    times(v, length(v).recip())
}

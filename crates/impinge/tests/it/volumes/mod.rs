//! Bounding volumes against rational arithmetic: they contain the points they were made from, and
//! overlapping volumes are never reported apart.

mod batch;
mod boxes;
mod exact;
mod fitted;
mod laws;
mod minimal;
mod points;
mod refusals;
mod round;
mod spheres;

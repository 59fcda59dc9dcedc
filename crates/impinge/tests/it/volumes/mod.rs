//! Bounding volumes against rational arithmetic: whatever is made of them holds what they were made from, and no test says
//! *apart* for volumes that meet.

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

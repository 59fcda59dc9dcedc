//! Solids: winding numbers, containment, overlap of interiors, and self-intersection.

mod bricks;
mod bsp;
mod containment;
mod convexity;
mod decomposition;
mod depths;
mod open;
mod order;
mod patches;
mod penetration;
mod self_intersection;
mod shapes;
mod winding;

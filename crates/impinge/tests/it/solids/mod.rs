//! What is inside: winding numbers, containment, interiors that meet, and meshes that meet themselves.

mod bricks;
mod bsp;
mod containment;
mod depths;
mod open;
mod order;
mod patches;
mod penetration;
mod self_intersection;
mod shapes;
mod winding;

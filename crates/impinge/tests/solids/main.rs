//! What is inside: winding numbers, containment, interiors that meet, and meshes that meet themselves.

mod shapes;
mod winding;

//! Convex hulls against exact oracles: which points are extreme, whether every point is inside, and
//! which vertex is farthest.

mod kinds;
mod large;
mod oracle;
mod proxies;
mod stored_hulls;
mod support;
mod surface;

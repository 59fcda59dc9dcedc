//! Convex hulls against exact oracles: which points are extreme, whether every point is inside, and
//! which vertex is farthest.

mod kinds;
mod large;
mod oracle;
mod proxies;
mod support;
mod surface;
mod stored_hulls;

//! Descriptions of a mesh.
//!
//! `health` counts its defects, `inspection` shows its hierarchy, and `proxies` makes the convex
//! hull and the bounding volumes that may replace it. The three files are independent.

pub(super) mod health;
pub(super) mod inspection;
pub(super) mod proxies;

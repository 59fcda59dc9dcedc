//! Distances, clearances, closest points and rays against rational arithmetic that shares no code
//! with the engine.

mod cases;
mod clearances;
mod meshes;
mod oracle;
mod plates;
mod points;
mod primitives;
mod rays;
mod ways;

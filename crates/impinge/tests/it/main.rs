//! Integration tests of the engine. They are one program, because each program is compiled and
//! linked separately.

mod clash;
mod distance;
mod engine;
mod exact_crossing;
mod exact_oracle;
mod exact_pose;
mod exact_relative_map;
mod exact_triangles;
mod hull;
mod interop;
mod partition;
mod realign;
mod robots;
mod scene;
mod shapes;
mod solids;
mod sweep;
mod trees;
mod volumes;
mod worlds;

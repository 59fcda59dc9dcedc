//! Scratch.
#[path = "it/clash/mod.rs"]
mod clash;

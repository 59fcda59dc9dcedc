//! Draws what `impinge` finds, and writes files that people hand on: pictures, HTML pages and BCF.
//!
//! The command line and the Python package draw with this crate alone.

pub mod bcf;
pub mod html;
pub mod picture;

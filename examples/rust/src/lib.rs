//! The Rust blocks of the README and of the documentation pages, as tests.
#![cfg(doctest)]

#[doc = include_str!("../../../README.md")]
struct Readme;

#[doc = include_str!("../../../docs/rust.md")]
struct RustPage;

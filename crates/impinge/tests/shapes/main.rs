//! Questions about two shapes, against rationals, closed forms and laws.

mod boxes;
mod contacts;
mod degenerate;
mod hulls;
mod pairs;
mod support;

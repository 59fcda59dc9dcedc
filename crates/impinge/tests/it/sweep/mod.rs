//! Times of first contact, against exact ones.

mod corners;
mod deforming;
mod recorded;
mod rigid;
mod shapes;

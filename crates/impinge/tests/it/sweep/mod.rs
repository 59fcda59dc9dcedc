//! Times of first contact, against exact times.

mod corners;
mod deforming;
mod gliding;
mod recorded;
mod rigid;
mod shapes;

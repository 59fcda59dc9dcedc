//! Times of first contact, against exact ones.

mod corners;
mod recorded;
mod rigid;

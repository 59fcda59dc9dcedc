//! Trees of every builder, degree, volume and enclosure, none of which may change an answer.

mod generic;

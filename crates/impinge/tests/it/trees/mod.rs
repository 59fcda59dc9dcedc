//! Trees of every builder, degree, volume and enclosure: none of them may change an answer.

mod generic;

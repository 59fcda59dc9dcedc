//! Predicates decided exactly.

//! Queries about two shapes, against rationals, closed forms and invariants.

mod boxes;
mod coherence;
mod compounds;
mod contacts;
mod degenerate;
mod depths;
mod ellipsoids;
mod height_fields;
mod hulls;
mod mesh_contacts;
mod pairs;
mod round_contacts;
mod rounded;
mod support;
mod surfaces;
mod tapered;
mod triangles;
mod twins;

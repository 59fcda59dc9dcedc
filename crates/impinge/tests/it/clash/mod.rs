//! Clash detection over scenes: reports, rules and statuses.

mod cases;
mod large;
mod laws;
mod models;
mod open;
mod reports;
mod rules;
mod statuses;
mod volumes;

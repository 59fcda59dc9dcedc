//! Clash detection over scenes: reports, rules and statuses.

mod cases;
mod models;
mod reports;
mod rules;
mod statuses;

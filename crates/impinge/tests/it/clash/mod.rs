//! Clash detection over scenes: reports, rules and statuses.

mod models;
mod reports;
mod rules;
mod statuses;

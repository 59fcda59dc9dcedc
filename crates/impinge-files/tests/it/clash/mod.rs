//! Files of clash detection: rules in three forms, and reports that read back.

mod mutations;
mod reports;
mod rules;

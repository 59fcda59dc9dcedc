//! Space partitions against brute force: every kind, every question, over thousands of random steps with churn.

mod brute;
mod built;
mod cells;
mod churn;
mod columns;
mod hostile;
mod kinds;
mod scenes;

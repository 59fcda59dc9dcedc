//! Space partitions against brute force: every kind and every query, over thousands of random
//! steps.

mod brute;
mod built;
mod cells;
mod churn;
mod columns;
mod gaps;
mod hostile;
mod kinds;
mod scenes;

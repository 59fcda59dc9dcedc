//! Generators and oracles for tests.

//! Reads and writes poses in the formats of `serde`. A pose is stored as the four rows of its
//! matrix and validated when it is read.
//!
//! ```
//! use impinge::Pose;
//!
//! let pose = Pose::from_translation([1.0, 0.0, 0.1])?;
//! let stored = toml::Value::try_from(pose)?;
//! let rows = "[[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.1], [0.0, 0.0, 0.0, 1.0]]";
//! assert_eq!(stored.to_string(), rows);
//! assert_eq!(stored.try_into::<Pose>()?, pose);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Entries are read as exactly as the format's crate reads floats. `serde_json` needs its feature
//! `float_roundtrip` to return the same bits.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

use crate::math::Pose;

impl Serialize for Pose {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [[a, b, c], [d, e, f], [g, h, i]] = *self.linear();
        let [x, y, z] = *self.translation();
        [[a, b, c, x], [d, e, f, y], [g, h, i, z], [0.0, 0.0, 0.0, 1.0]].serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Pose {
    /// Reads the four rows of a pose's matrix and validates them.
    ///
    /// # Errors
    /// As [`Pose::from_matrix`], wrapped in the error type of the format.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rows = <[[f64; 4]; 4]>::deserialize(deserializer)?;
        Self::from_matrix(rows).map_err(D::Error::custom)
    }
}

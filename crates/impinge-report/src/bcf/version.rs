//! Versions of BCF.

/// Version of BCF-XML.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BcfVersion {
    /// Version 2.1, which most programs read.
    #[default]
    V2,
    /// Version 3.0.
    V3,
}

impl BcfVersion {
    /// All versions, the oldest first.
    pub const ALL: [Self; 2] = [Self::V2, Self::V3];

    /// Returns the number of the version: `2.1` or `3.0`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::V2 => "2.1",
            Self::V3 => "3.0",
        }
    }
}

//! Units of length that a file may state.

use std::{fmt, str::FromStr};

/// A unit of length. The units are those of 3MF, which include the meter of glTF.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unit {
    /// 10⁻⁶ m, `um`.
    Micron,
    /// 10⁻³ m, `mm`.
    Millimeter,
    /// 10⁻² m, `cm`.
    Centimeter,
    /// 0.0254 m exactly, `in`.
    Inch,
    /// 0.3048 m exactly, `ft`.
    Foot,
    /// 1 m, `m`.
    Meter,
}

impl Unit {
    /// Every unit, from the shortest to the longest.
    pub const ALL: [Self; 6] = [Self::Micron, Self::Millimeter, Self::Centimeter, Self::Inch, Self::Foot, Self::Meter];

    /// Returns the length of the unit in meters, to the nearest f64.
    #[must_use]
    pub fn meters(self) -> f64 {
        match self {
            Self::Micron => 1e-6,
            Self::Millimeter => 1e-3,
            Self::Centimeter => 1e-2,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
            Self::Meter => 1.0,
        }
    }

    /// Returns the symbol of the unit: `um`, `mm`, `cm`, `in`, `ft` or `m`.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Micron => "um",
            Self::Millimeter => "mm",
            Self::Centimeter => "cm",
            Self::Inch => "in",
            Self::Foot => "ft",
            Self::Meter => "m",
        }
    }

    /// Returns the conversion of lengths in this unit to another one.
    ///
    /// ```
    /// use impinge_files::Unit;
    ///
    /// assert_eq!(Unit::Foot.to(Unit::Inch).apply(2.5), 30.0);
    /// ```
    #[must_use]
    pub fn to(self, other: Self) -> Conversion {
        // Whole numbers of micrometers.
        let [from, to] = [self, other].map(|unit| (unit.meters() * 1e6).round());
        match () {
            () if from % to == 0.0 => Conversion { times: from / to, over: 1.0 },
            () if to % from == 0.0 => Conversion { times: 1.0, over: to / from },
            () => Conversion { times: from, over: to },
        }
    }

    /// Returns the unit with a name of 3MF's `unit` attribute: `micron`, `millimeter`,
    /// `centimeter`, `inch`, `foot` or `meter`. Returns `None` for other names.
    pub(crate) fn from_3mf(name: &str) -> Option<Self> {
        Some(match name {
            "micron" => Self::Micron,
            "millimeter" => Self::Millimeter,
            "centimeter" => Self::Centimeter,
            "inch" => Self::Inch,
            "foot" => Self::Foot,
            "meter" => Self::Meter,
            _ => return None,
        })
    }
}

/// A conversion of lengths from one unit to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    times: f64,
    over: f64,
}

impl Conversion {
    /// Returns a length in the other unit. It is rounded once if one unit is a whole multiple of
    /// the other, and twice otherwise.
    #[must_use]
    pub fn apply(self, length: f64) -> f64 {
        length * self.times / self.over
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// The error that a word is not the symbol of a unit. Its text lists the symbols.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownUnit(String);

impl fmt::Display for UnknownUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unknown unit {:?}; the units are", self.0)?;
        for (i, unit) in Unit::ALL.iter().enumerate() {
            write!(f, "{} {unit}", if i == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

impl std::error::Error for UnknownUnit {}

/// Parses the symbol that [`Display`](fmt::Display) writes, in any case, or `µm`.
impl FromStr for Unit {
    type Err = UnknownUnit;

    fn from_str(text: &str) -> Result<Self, UnknownUnit> {
        let matches = |unit: &&Self| unit.symbol().eq_ignore_ascii_case(text);
        match text {
            "µm" | "μm" => Ok(Self::Micron),
            _ => Self::ALL.iter().find(matches).copied().ok_or_else(|| UnknownUnit(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_read_back() {
        for unit in Unit::ALL {
            assert_eq!(unit.to_string().parse(), Ok(unit));
            assert_eq!(unit.to_string().to_uppercase().parse(), Ok(unit));
        }
        assert_eq!("µm".parse(), Ok(Unit::Micron));
        let error = "furlong".parse::<Unit>().unwrap_err();
        assert_eq!(error.to_string(), "unknown unit \"furlong\"; the units are um, mm, cm, in, ft, m");
    }

    #[test]
    fn lengths_increase() {
        assert!(Unit::ALL.windows(2).all(|w| w[0].meters() < w[1].meters() && w[0] < w[1]));
        assert_eq!(Unit::Inch.meters() * 5000.0, 127.0);
        assert_eq!(Unit::Foot.meters() * 10000.0, 3048.0);
    }
}

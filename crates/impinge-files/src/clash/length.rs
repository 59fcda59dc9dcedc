//! Lengths with units, as people write them: `25mm`, `1/2in`, `0.025`.

use std::{fmt, str::FromStr};

use crate::unit::Unit;

/// A length that is not negative, with a unit or in the unit of the scene.
///
/// ```
/// use impinge_files::{Length, Unit};
///
/// let length: Length = "1/2in".parse()?;
/// assert_eq!(length.in_unit(Some(Unit::Millimeter)), Some(12.7));
/// assert_eq!(length.in_unit(None), None);
/// assert_eq!("25".parse::<Length>()?.in_unit(None), Some(25.0));
/// # Ok::<(), impinge_files::InvalidLength>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// The number, in the unit.
    pub value: f64,
    /// The unit, or `None` for the unit of the scene.
    pub unit: Option<Unit>,
}

/// The error that a text is not a length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidLength;

/// Form of a length, for errors.
pub(super) const FORM: &str = "a length of at least 0, such as 25mm, 1/2in or 0.025";

impl Length {
    /// Returns the length in the unit of the scene. Returns `None` if the length has a unit and the
    /// unit of the scene is not known.
    #[must_use]
    pub fn in_unit(self, scene: Option<Unit>) -> Option<f64> {
        // The quotient of whole numbers of micrometers is rounded only once.
        let micrometers = |unit: Unit| (unit.meters() * 1e6).round();
        match (self.unit, scene) {
            (None, _) => Some(self.value),
            (Some(own), Some(scene)) => Some(self.value * micrometers(own) / micrometers(scene)),
            (Some(_), None) => None,
        }
    }
}

/// Parses a number or a fraction, and a unit after it, with or without spaces.
impl FromStr for Length {
    type Err = InvalidLength;

    fn from_str(text: &str) -> Result<Self, InvalidLength> {
        let text = text.trim();
        let is_unit = |letter: char| letter.is_alphabetic();
        let bare = text.trim_end_matches(is_unit);
        let (number, unit) = match bare.len() {
            len if len == text.len() => (text, None),
            len => (bare, Some(text[len..].parse::<Unit>().map_err(|_| InvalidLength)?)),
        };
        let decimal = |text: &str| text.trim().parse::<f64>().map_err(|_| InvalidLength);
        let value = match number.split_once('/') {
            Some((above, below)) => decimal(above)? / decimal(below)?,
            None => decimal(number)?,
        };
        if value >= 0.0 && value.is_finite() { Ok(Self { value, unit }) } else { Err(InvalidLength) }
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.unit {
            Some(unit) => write!(f, "{} {unit}", self.value),
            None => write!(f, "{}", self.value),
        }
    }
}

impl fmt::Display for InvalidLength {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a length is a number of at least 0 with or without a unit, such as 25mm, 1/2in or 0.025")
    }
}

impl std::error::Error for InvalidLength {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_numbers_fractions_and_units() {
        let of = |text: &str| text.parse::<Length>().ok().map(|length| (length.value, length.unit));
        assert_eq!(of("25mm"), Some((25.0, Some(Unit::Millimeter))));
        assert_eq!(of(" 25 MM "), Some((25.0, Some(Unit::Millimeter))));
        assert_eq!(of("1/2in"), Some((0.5, Some(Unit::Inch))));
        assert_eq!(of("3 / 8 in"), Some((0.375, Some(Unit::Inch))));
        assert_eq!(of("1e-3m"), Some((1e-3, Some(Unit::Meter))));
        assert_eq!(of("10µm"), Some((10.0, Some(Unit::Micron))));
        assert_eq!(of("0"), Some((0.0, None)));
        for invalid in ["", "mm", "-1", "1/0", "0/0", "nan", "inf", "1e999", "5 furlongs", "1/2/3", "5 m m", "1,5mm"] {
            assert_eq!(of(invalid), None, "{invalid}");
        }
    }

    #[test]
    fn lengths_are_converted_with_one_rounding() {
        let millimeters = |value| Length { value, unit: Some(Unit::Millimeter) };
        assert_eq!(millimeters(2.0).in_unit(Some(Unit::Meter)), Some(0.002));
        assert_eq!(millimeters(25.4).in_unit(Some(Unit::Inch)), Some(1.0));
    }
}

//! Options of a search for clashes.

use super::error::ClashError;
use super::groups::Grouping;
use super::rules::Rules;
use super::status::Previous;

/// Options of a search for clashes. Lengths are in world units.
///
/// ```
/// use impinge::clash::Options;
///
/// let options = Options { clearance: Some(0.025), ..Options::new(0.0001) };
/// assert!(!options.contacts && !options.between);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Options<'o> {
    /// Depth up to which common material counts as contact. See
    /// [`default_tolerance`](super::default_tolerance).
    pub tolerance: f64,
    /// Required gap, or `None` if any gap is allowed.
    pub clearance: Option<f64>,
    /// Whether contacts are listed.
    pub contacts: bool,
    /// Whether the volumes of common material are computed.
    pub volume: bool,
    /// Whether only pairs of parts of different scenes are checked.
    pub between: bool,
    /// Rules, or `None` to check all pairs.
    pub rules: Option<&'o Rules>,
    /// Previous report, from which statuses carry over.
    pub previous: Option<&'o Previous>,
    /// How clashes are grouped.
    pub grouping: Grouping,
}

impl Options<'static> {
    /// Returns options with a tolerance. All pairs are checked, without a clearance, contacts are
    /// not listed, and volumes are not computed.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            clearance: None,
            contacts: false,
            volume: false,
            between: false,
            rules: None,
            previous: None,
            grouping: Grouping::default(),
        }
    }
}

impl Options<'_> {
    /// Validates all lengths, and returns the largest clearance, or 0 without a clearance.
    pub(super) fn validated_reach(&self) -> Result<f64, ClashError> {
        let rules = self.rules.map_or(&[][..], |rules| &rules.rules);
        let tolerances = rules.iter().filter_map(|rule| rule.tolerance).chain([self.tolerance]);
        let clearances = rules.iter().filter_map(|rule| rule.clearance).chain(self.clearance);
        let mut reach = 0.0_f64;
        for (name, value) in tolerances.map(|x| ("tolerance", x)).chain(clearances.map(|x| ("clearance", x))) {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(ClashError::Length { name, value });
            }
            if name == "clearance" {
                reach = reach.max(value);
            }
        }
        Ok(reach)
    }
}

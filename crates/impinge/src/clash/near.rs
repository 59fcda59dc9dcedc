//! The broad phase: finds the pairs of parts whose boxes are near each other.

use crate::budget::{Budget, Stopped};
use crate::partition::ColumnSweep;
use crate::shape::PlacedShape;
use crate::storage::TryPush;
use crate::volume::MinMax;

/// Returns the pairs of parts whose boxes are not farther apart than `reach` along an axis, for
/// which `is_wanted` returns `true`. The pairs are sorted, the smaller index first. An empty part
/// is near nothing, and an unbounded part is near everything else.
///
/// # Errors
/// Returns an error if the budget ended the search, or if there is not enough memory.
pub(super) fn pairs_near(
    parts: &[PlacedShape],
    reach: f64,
    budget: &Budget<'_>,
    is_wanted: impl Fn(u32, u32) -> bool,
) -> Result<Vec<[u32; 2]>, Stopped> {
    // Each box grows by half of the reach, rounded up.
    let grow = |x: f64| if reach > 0.0 { (x + (0.5 * reach).next_up()).next_up() } else { x };
    let (mut numbers, mut boxes, mut unbounded) = (Vec::new(), Vec::new(), Vec::new());
    for (number, part) in (0_u32..).zip(parts) {
        if part.is_unbounded() {
            unbounded.push(number);
        } else if let Some([min, max]) = part.bounds() {
            match MinMax::new(min.map(|x| -grow(-x)), max.map(grow)) {
                Ok(bounds) => {
                    numbers.push(number);
                    boxes.push(bounds);
                }
                Err(_) => unbounded.push(number),
            }
        }
    }
    let mut found = Vec::new();
    let mut offer = |a: u32, b: u32| -> Result<(), Stopped> {
        let [a, b] = [a.min(b), a.max(b)];
        if is_wanted(a, b) { found.try_push([a, b]).map_err(Stopped::from) } else { Ok(()) }
    };
    let mut pairs = Vec::new();
    ColumnSweep::new().try_find(&boxes, &mut pairs, budget)?;
    for [a, b] in pairs {
        offer(numbers[a as usize], numbers[b as usize])?;
    }
    for (at, &a) in unbounded.iter().enumerate() {
        budget.check()?;
        for &b in unbounded[at + 1..].iter().chain(&numbers) {
            offer(a, b)?;
        }
    }
    found.sort_unstable();
    Ok(found)
}

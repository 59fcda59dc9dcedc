//! Notes about input that does not fit the search.

use std::collections::HashSet;

use impinge::clash::{Previous, Report, Rules};
use impinge_files::{Asked, Unit, escaped, length_text};

use crate::console;
use crate::numerals::count;

/// Relative difference of two lengths up to which they are the same in different units.
const SAME: f64 = 1e-9;

/// Number of identities that a note names.
const NAMED: usize = 5;

/// Prints a note if the previous report has another tolerance or clearance. Clashes may then be new
/// or gone although no part moved.
pub(super) fn on_previous(previous: &Previous, asked: &Asked, unit: Option<Unit>) {
    let Some(tolerance) = previous.tolerance else { return };
    let length = |x: f64| length_text(x, unit);
    let pairs =
        [("tolerance", Some(tolerance), Some(asked.tolerance)), ("clearance", previous.clearance, asked.clearance)];
    for (name, before, now) in pairs {
        let is_same = match (before, now) {
            (Some(before), Some(now)) => (before - now).abs() <= SAME * now.abs(),
            _ => before == now,
        };
        if !is_same {
            let [before, now] = [before, now].map(|x| x.map_or_else(|| "none".to_owned(), length));
            console::note(&format!(
                "the {name} was {before} in the previous report and is {now} now, so clashes may be new or gone \
                 although no part moved"
            ));
        }
    }
}

/// Prints a note if clashes are accepted that the report does not have.
pub(super) fn on_accepts(rules: &Rules, report: &Report) {
    let clashes = report.clashes.iter().map(|clash| &clash.id);
    let present: HashSet<&String> = clashes.chain(report.duplicates.iter().map(|set| &set.id)).collect();
    let absent: Vec<&str> =
        rules.accepts.iter().filter(|accept| !present.contains(&accept.id)).map(|accept| accept.id.as_str()).collect();
    if absent.is_empty() {
        return;
    }
    let named = absent.iter().take(NAMED).map(|id| escaped(id)).collect::<Vec<_>>().join(", ");
    let more = if absent.len() > NAMED { ", ..." } else { "" };
    let clashes = if absent.len() == 1 { "clash" } else { "clashes" };
    console::note(&format!("the report does not have {} accepted {clashes}: {named}{more}", count(absent.len())));
}

//! Recommends a volume for each use, with one sentence that gives the measured reason.

use super::measure::{HullRow, Row};
use crate::numerals::{length, short_time};

/// A use, the recommended volume, and the reason.
pub(super) struct Advice {
    /// Key in the JSON object.
    pub(super) key: &'static str,
    pub(super) label: &'static str,
    pub(super) name: &'static str,
    pub(super) sentence: String,
}

/// A use: how to compute the cost of a volume for it, and how to describe a volume with a low cost.
struct Use {
    key: &'static str,
    label: &'static str,
    cost: fn(&Row) -> f64,
    merit: fn(&Row) -> String,
}

/// Minimum cost of a false alarm, in seconds, for example of one triangle test. It is added to the
/// time of an overlap test: a larger value favors tight volumes, a smaller one favors fast tests.
const FALSE_ALARM: f64 = 1e-7;

const USES: [Use; 4] = [
    Use {
        key: "static",
        label: "static",
        cost: |row| FALSE_ALARM + row.overlap,
        merit: |row| format!("tested in {}", short_time(row.overlap)),
    },
    Use {
        key: "spinning",
        label: "spinning",
        cost: |row| row.follow + row.overlap,
        merit: |row| {
            format!("follows a turn in {} and is tested in {}", short_time(row.follow), short_time(row.overlap))
        },
    },
    Use {
        key: "deforming",
        label: "deforming",
        cost: |row| row.build,
        merit: |row| format!("built anew in {}", short_time(row.build)),
    },
    Use {
        key: "many_copies",
        label: "many copies",
        cost: |row| row.bytes as f64,
        merit: |row| format!("{} bytes each", row.bytes),
    },
];

/// Returns one recommendation for each use. The recommended volume has the least product of cost
/// and size: twice the size causes about twice as many false alarms.
pub(super) fn advice(hull: &HullRow, rows: &[Row]) -> Vec<Advice> {
    // Volumes around a flat mesh may have size 0, so compare only their costs.
    let size = |row: &Row| if hull.volume > 0.0 { row.volume / hull.volume } else { 1.0 };
    let advice = USES.into_iter().filter_map(|Use { key, label, cost, merit }| {
        let of = |row: &Row| size(row) * cost(row);
        let row = rows.iter().min_by(|a, b| of(a).total_cmp(&of(b)))?;
        let relative =
            if hull.volume > 0.0 { format!("{} times the hull, ", length(size(row))) } else { String::new() };
        Some(Advice { key, label, name: row.name, sentence: format!("{}: {relative}{}", row.name, merit(row)) })
    });
    advice.collect()
}

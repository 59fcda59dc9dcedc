//! Which volume suits which use: a sentence each, from what was measured.

use super::measure::{HullRow, Row};
use crate::numerals::{length, short_time};

/// A use, the volume that suits it, and why.
pub(super) struct Advice {
    /// The key for programs.
    pub(super) key: &'static str,
    pub(super) label: &'static str,
    pub(super) name: &'static str,
    pub(super) sentence: String,
}

/// A use: what a volume costs there, and what to say of one that costs little.
struct Use {
    key: &'static str,
    label: &'static str,
    cost: fn(&Row) -> f64,
    merit: fn(&Row) -> String,
}

/// Seconds that a false alarm takes at least, by which a test is dear or cheap: two triangles, say.
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

/// One for each use. A volume is judged by what it costs there times its size: twice the size means about twice as many
/// false alarms.
pub(super) fn advice(hull: &HullRow, rows: &[Row]) -> Vec<Advice> {
    // A flat mesh has volumes of nothing; then only the costs count.
    let size = |row: &Row| if hull.volume > 0.0 { row.volume / hull.volume } else { 1.0 };
    let told = USES.into_iter().filter_map(|Use { key, label, cost, merit }| {
        let of = |row: &Row| size(row) * cost(row);
        let row = rows.iter().min_by(|a, b| of(a).total_cmp(&of(b)))?;
        let relative =
            if hull.volume > 0.0 { format!("{} times the hull, ", length(size(row))) } else { String::new() };
        Some(Advice { key, label, name: row.name, sentence: format!("{}: {relative}{}", row.name, merit(row)) })
    });
    told.collect()
}

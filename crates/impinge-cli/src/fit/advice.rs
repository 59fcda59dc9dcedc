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

/// One for each use. A volume is judged by what it costs there times its size: twice the size means about twice as many
/// false alarms, each of which costs more than any test.
pub(super) fn advice(hull: &HullRow, rows: &[Row]) -> Vec<Advice> {
    let reference = hull.volume;
    // A flat mesh has volumes of nothing; then only the costs count.
    let size = |row: &Row| if reference > 0.0 { row.volume / reference } else { 1.0 };
    let uses: [(&'static str, &'static str, &dyn Fn(&Row) -> f64, &dyn Fn(&Row) -> String); 4] = [
        ("static", "static", &|row| size(row) * (1.0 + row.overlap / 1e-7), &|row| {
            format!("tested in {}", short_time(row.overlap))
        }),
        ("spinning", "spinning", &|row| size(row) * (row.follow + row.overlap), &|row| {
            format!("follows a turn in {} and is tested in {}", short_time(row.follow), short_time(row.overlap))
        }),
        ("deforming", "deforming", &|row| size(row) * row.build, &|row| {
            format!("built anew in {}", short_time(row.build))
        }),
        ("many_copies", "many copies", &|row| size(row) * row.bytes as f64, &|row| format!("{} bytes each", row.bytes)),
    ];
    let best = |cost: &dyn Fn(&Row) -> f64| rows.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let told = uses.into_iter().filter_map(|(key, label, cost, merit)| {
        let row = best(cost)?;
        let relative = if reference > 0.0 { format!("{} times the hull, ", length(size(row))) } else { String::new() };
        Some(Advice { key, label, name: row.name, sentence: format!("{}: {relative}{}", row.name, merit(row)) })
    });
    told.collect()
}

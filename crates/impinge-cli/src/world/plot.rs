//! Draws the times of the phases over the steps as a stacked chart, as SVG.

use std::io::{self, Write};

use super::{Outcome, PHASES, Step};

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 420.0;
/// Space on each side for the axes and the legend.
const MARGIN: f64 = 56.0;

/// Colors of the phases, which most color-blind people can tell apart (Okabe, Ito, *Color universal
/// design*, 2008).
const COLORS: [&str; PHASES.len()] = ["#999999", "#56b4e9", "#0072b2", "#e69f00", "#009e73"];

/// Maximum number of columns. If there are more steps, a column shows the mean of several steps.
const MAX_COLUMNS: usize = 480;

/// Writes the chart.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(super) fn write(out: &mut dyn Write, outcome: &Outcome) -> io::Result<()> {
    let columns = columns(&outcome.steps);
    let most = columns.iter().map(|column| column.iter().sum::<f64>()).fold(1e-9, f64::max);
    let x = |column: usize| MARGIN + (WIDTH - 2.0 * MARGIN) * column as f64 / columns.len() as f64;
    let y = |seconds: f64| HEIGHT - MARGIN - (HEIGHT - 2.0 * MARGIN) * seconds / most;
    writeln!(
        out,
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="#fff"/>"##
    )?;
    let mut below = vec![0.0; columns.len()];
    for (phase, color) in COLORS.iter().enumerate() {
        write!(out, r#"<path fill="{color}" d=""#)?;
        for (at, column) in columns.iter().enumerate() {
            let (low, high) = (below[at], below[at] + column[phase]);
            below[at] = high;
            write!(out, "M{:.1} {:.1}V{:.1}H{:.1}V{:.1}Z", x(at), y(low), y(high), x(at + 1), y(low))?;
        }
        writeln!(out, r#""/>"#)?;
        let left = MARGIN + 90.0 * phase as f64;
        writeln!(
            out,
            r#"<rect x="{left}" y="18" width="12" height="12" fill="{color}"/><text x="{}" y="28">{}</text>"#,
            left + 18.0,
            PHASES[phase]
        )?;
    }
    for tick in 0..=4 {
        let seconds = most * f64::from(tick) / 4.0;
        writeln!(
            out,
            r##"<path stroke="#ccc" d="M{MARGIN} {0:.1}H{1}"/><text x="{2}" y="{0:.1}" text-anchor="end" dominant-baseline="middle">{3:.2} ms</text>"##,
            y(seconds),
            WIDTH - MARGIN,
            MARGIN - 4.0,
            seconds * 1e3
        )?;
    }
    writeln!(
        out,
        r#"<text x="{}" y="{}" text-anchor="middle">{} steps, {} bodies</text></svg>"#,
        0.5 * WIDTH,
        HEIGHT - 0.3 * MARGIN,
        outcome.steps.len(),
        outcome.recipe.bodies
    )
}

/// Returns the mean times of the phases in each column, in seconds.
fn columns(steps: &[Step]) -> Vec<[f64; PHASES.len()]> {
    let each = steps.len().div_ceil(MAX_COLUMNS).max(1);
    let mean = |steps: &[Step]| {
        std::array::from_fn(|phase| steps.iter().map(|step| step.seconds[phase]).sum::<f64>() / steps.len() as f64)
    };
    steps.chunks(each).map(mean).collect()
}

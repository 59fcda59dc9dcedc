//! Continuous collision: the recorded queries of a vertex and a face and of two edges, their answers and their times.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin ccd`
//!
//! A collision that is missed ends the run; what is reported though nothing touches is counted.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;

use anyhow::{Context, Result, ensure};
use impinge::sweep::{Impact, edge_edge, vertex_face};
use impinge_bench::samples::timed;
use impinge_bench::table::Table;
use impinge_testkit::ccd::{Query, QueryKind, read_all};
use impinge_testkit::env_rob::data_folder;

/// Rounds over all queries, of which the fastest counts for each query.
const ROUNDS: usize = 15;

fn main() -> Result<()> {
    let data = data_folder().context("IMPINGE_DATA must name the folder that holds ccd/")?;
    let mut table =
        Table::new(["queries", "number", "touch", "false alarms", "of misses", "undecided", "mean", "median", "worst"]);
    for kind in [QueryKind::VertexFace, QueryKind::EdgeEdge] {
        for (name, queries) in read_all(&data, kind)? {
            let (mut alarms, mut undecided) = (0, 0);
            for query in &queries {
                let impact = answer(query)?;
                ensure!(impact.hit() || !query.touches, "missed: {query:?}");
                alarms += usize::from(impact.hit() && !query.touches);
                undecided += usize::from(!impact.is_decided());
            }
            let seconds = fastest(&queries)?;
            let touch = queries.iter().filter(|query| query.touches).count();
            let nanoseconds = |x: f64| format!("{:.0} ns", 1e9 * x);
            table.row([
                format!("{kind:?} {name}"),
                queries.len().to_string(),
                touch.to_string(),
                alarms.to_string(),
                format!("{:.2} %", 100.0 * alarms as f64 / (queries.len() - touch).max(1) as f64),
                undecided.to_string(),
                nanoseconds(seconds.iter().sum::<f64>() / seconds.len() as f64),
                nanoseconds(seconds[seconds.len() / 2]),
                nanoseconds(seconds[seconds.len() - 1]),
            ]);
        }
    }
    print!("{table}");
    Ok(())
}

fn answer(query: &Query) -> Result<Impact> {
    Ok(match query.kind {
        QueryKind::VertexFace => vertex_face(&query.t0, &query.t1)?,
        QueryKind::EdgeEdge => edge_edge(&query.t0, &query.t1)?,
    })
}

/// Seconds that each query takes, sorted.
fn fastest(queries: &[Query]) -> Result<Vec<f64>> {
    let mut seconds = vec![f64::INFINITY; queries.len()];
    for _ in 0..ROUNDS {
        for (query, seconds) in queries.iter().zip(&mut seconds) {
            // A batch, as one query may be shorter than the clock's steps.
            let (taken, answers) = timed(|| [(); 8].map(|()| answer(black_box(query))));
            for answer in answers {
                black_box(answer?);
            }
            *seconds = seconds.min(taken / 8.0);
        }
    }
    seconds.sort_unstable_by(f64::total_cmp);
    Ok(seconds)
}

//! Continuous collision: recorded queries of a vertex and a face and of two edges, with answers and
//! times; and all contacts of a cloth with itself between two frames of a recorded simulation, on
//! one thread.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin ccd`
//!
//! A missed collision ends the run. False alarms are counted.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use impinge::sweep::{Deforming, Impact, edge_edge, vertex_face};
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, spread};
use impinge_testkit::ccd::{Query, QueryKind, read_all};
use impinge_testkit::env_rob::data_folder;

/// Number of rounds over all queries. For each query the minimum time counts.
const ROUNDS: usize = 15;

/// Number of runs of the cloth, each of which takes seconds.
const CLOTH_ROUNDS: usize = 3;

fn main() -> Result<()> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
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
    print!("{table}\n{}", cloth(&data)?);
    Ok(())
}

/// Times frames 92 to 93 of a cloth that falls over a sphere.
fn cloth(data: &Path) -> Result<Table<6>> {
    let frame = |number: u32| Surface::load(&data.join(format!("animation/cloth_ball{number}.ply")));
    let (from, to) = (frame(92)?, frame(93)?);
    ensure!(from.faces == to.faces, "the frames have other faces");
    let [t0, t1] = [&from.positions, &to.positions]
        .map(|positions| (0..positions.len()).map(|vertex| positions.get(vertex)).collect::<Vec<[f64; 3]>>());
    let faces = from.faces;
    let contacts = Deforming::new(&faces, &t0, &t1)?.self_contacts();
    let build = Samples::take(CLOTH_ROUNDS, || {
        let (seconds, cloth) = timed(|| Deforming::new(&faces, &t0, &t1));
        cloth.map(|_| seconds)
    })?;
    let all = Samples::take(CLOTH_ROUNDS, || {
        let cloth = Deforming::new(&faces, &t0, &t1)?;
        let (seconds, found) = timed(|| cloth.self_contacts());
        ensure!(found == contacts, "other contacts than before");
        Ok(seconds)
    })?;
    let mut table = Table::new(["cloth", "contacts", "tree min", "median", "all contacts min", "median"]);
    let ([build_min, build_median], [all_min, all_median]) = (spread(&build), spread(&all));
    let name = format!("{} triangles", faces.len());
    table.row([name, contacts.len().to_string(), build_min, build_median, all_min, all_median]);
    Ok(table)
}

fn answer(query: &Query) -> Result<Impact> {
    Ok(match query.kind {
        QueryKind::VertexFace => vertex_face(&query.t0, &query.t1)?,
        QueryKind::EdgeEdge => edge_edge(&query.t0, &query.t1)?,
    })
}

/// Returns the time of each query in seconds, sorted.
fn fastest(queries: &[Query]) -> Result<Vec<f64>> {
    let mut seconds = vec![f64::INFINITY; queries.len()];
    for _ in 0..ROUNDS {
        for (query, seconds) in queries.iter().zip(&mut seconds) {
            // A batch, because one query may be shorter than the steps of the clock.
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

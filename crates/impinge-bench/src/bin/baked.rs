//! Baked files: times to write, open, validate and trust them, compared with refits; and stored
//! proxies, compared with fitting them.
//!
//! `IMPINGE_DATA=... cargo run --release -p impinge-bench --bin baked`

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Parser;
use impinge::Mesh;
use impinge::volume::Proxies;
use impinge_bench::real_points::unpacked;
use impinge_bench::samples::{Samples, timed};
use impinge_bench::scene::Surface;
use impinge_bench::table::{Table, time};
use impinge_files::{Baked, Provenance, write_baked};
use impinge_testkit::env_rob::data_folder;

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");

/// Times baked files, and checks the meshes and proxies read back
#[derive(Parser)]
struct Arguments {
    /// Number of threads for building, refitting and validating
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Number of runs of each operation
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: usize,
}

fn main() -> Result<()> {
    let Arguments { threads, repeats } = Arguments::parse();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let mut meshes = vec![("human", PathBuf::from(HUMAN))];
    if let Some(folder) = data_folder() {
        meshes.push(("ventilator", unpacked(&folder.join("big/cad_ventilator.ply.gz"), "cad_ventilator.ply")?));
    }
    let mut of_meshes = Table::new(["mesh, baked", "bytes", "write", "open", "prove", "believe", "prove / refit"]);
    let mut of_proxies = Table::new(["proxies, baked", "corners", "bytes", "make", "prove", "believe", "make / prove"]);
    for (name, path) in meshes {
        let [mesh, proxies] = baked(&Surface::load(&path)?, repeats)?;
        of_meshes.row(named(name, mesh));
        of_proxies.row(named(name, proxies));
    }
    println!("{of_meshes}\n{of_proxies}");
    Ok(())
}

fn named(name: &str, cells: [String; 6]) -> [String; 7] {
    let mut cells = cells.into_iter();
    std::array::from_fn(|at| if at == 0 { name.to_owned() } else { cells.next().unwrap_or_default() })
}

/// Times a mesh and its proxies in a file, and returns the cells of both tables.
fn baked(surface: &Surface, repeats: usize) -> Result<[[String; 6]; 2]> {
    let (mut mesh, _) = surface.build(1)?;
    let refit = Samples::take(repeats, || {
        let positions = surface.positions.clone();
        timed_ok(|| mesh.refit(positions)).map(|(seconds, _)| seconds)
    })?;
    let proxies = mesh.proxies().context("a mesh without faces")?;
    let make = Samples::take(repeats, || {
        let (seconds, made) = timed(|| mesh.proxies());
        ensure!(made.is_some_and(|made| made.to_bytes() == proxies.to_bytes()), "other proxies of the same mesh");
        Ok(seconds)
    })?;
    let path = std::env::temp_dir().join(format!("impinge-baked-{}.impinge", std::process::id()));
    let (write, written) = timed(|| written(&mesh, &proxies, &path));
    written?;
    let read = opened(&path, &mesh, &proxies, repeats);
    std::fs::remove_file(&path).context("removing the baked file")?;
    let Opened { open, prove, believe, prove_proxies, believe_proxies, bytes } = read?;
    let [open, prove, believe] = [open, prove, believe].map(|samples| samples.min());
    let [make, prove_proxies, believe_proxies] = [make, prove_proxies, believe_proxies].map(|samples| samples.min());
    Ok([
        [
            format!("{:.1} MB", bytes as f64 / 1e6),
            time(write),
            time(open),
            time(prove),
            time(believe),
            format!("{:.2}", prove / refit.min()),
        ],
        [
            proxies.hull().vertices().len().to_string(),
            format!("{:.3} MB", proxies.to_bytes().len() as f64 / 1e6),
            time(make),
            time(prove_proxies),
            time(believe_proxies),
            format!("{:.2}", make / prove_proxies),
        ],
    ])
}

fn written(mesh: &Mesh, proxies: &Proxies, path: &Path) -> Result<()> {
    let faces = mesh.faces().len();
    let parts = vec![String::new()];
    let provenance = Provenance { sources: (0..faces as u32).collect(), part_of: vec![0; faces], parts, unit: None };
    let mut out = BufWriter::new(File::create(path)?);
    write_baked(mesh, &provenance, Some(proxies), &mut out)?;
    Ok(out.flush()?)
}

/// Times to open a baked file, and to read its mesh and proxies with (`prove`) and without
/// (`believe`) validation; and the size of the file.
struct Opened {
    open: Samples,
    prove: Samples,
    believe: Samples,
    prove_proxies: Samples,
    believe_proxies: Samples,
    bytes: u64,
}

fn opened(path: &Path, mesh: &Mesh, proxies: &Proxies, repeats: usize) -> Result<Opened> {
    let open = Samples::take(repeats, || timed_ok(|| Baked::open(path)).map(|(seconds, _)| seconds))?;
    let baked = Baked::open(path)?;
    let prove = Samples::take(repeats, || {
        let (seconds, proved) = timed_ok(|| baked.mesh())?;
        ensure!(proved.parts() == mesh.parts(), "what was baked is another mesh");
        Ok(seconds)
    })?;
    let believe = Samples::take(repeats, || timed_ok(|| baked.trusted_mesh()).map(|(seconds, _)| seconds))?;
    let mesh = baked.mesh()?;
    let is_same = |read: Option<Proxies>| read.is_some_and(|read| read.to_bytes() == proxies.to_bytes());
    let prove_proxies = Samples::take(repeats, || {
        let (seconds, proved) = timed_ok(|| baked.proxies(&mesh))?;
        ensure!(is_same(proved), "what was baked are other proxies");
        Ok(seconds)
    })?;
    let believe_proxies = Samples::take(repeats, || {
        let (seconds, believed) = timed_ok(|| baked.trusted_proxies(&mesh))?;
        ensure!(is_same(believed), "what was baked are other proxies");
        Ok(seconds)
    })?;
    let bytes = std::fs::metadata(path)?.len();
    Ok(Opened { open, prove, believe, prove_proxies, believe_proxies, bytes })
}

fn timed_ok<T, E: std::error::Error + Send + Sync + 'static>(run: impl FnOnce() -> Result<T, E>) -> Result<(f64, T)> {
    let (seconds, result) = timed(run);
    Ok((seconds, result?))
}

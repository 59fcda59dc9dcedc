//! tmp
#![allow(clippy::print_stdout)]
use impinge::{Mesh, Pose, Positions, mesh::Options, query};
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let name = &args[1];
    let f32s = args[2] == "f32";
    let ang: f64 = args[3].parse().unwrap();
    let off: Vec<f64> = args[4].split(',').map(|x| x.parse().unwrap()).collect();
    let threads: usize = args[5].parse().unwrap();
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().unwrap();
    let v = std::fs::read(format!("/tmp/{name}.v")).unwrap();
    let f = std::fs::read(format!("/tmp/{name}.f")).unwrap();
    let v: Vec<f64> = v.chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect();
    let f: Vec<u32> = f.chunks_exact(4).map(|c| u32::from_le_bytes(c.try_into().unwrap())).collect();
    let v: Vec<[f64; 3]> = v.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let f: Vec<[u32; 3]> = f.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let p = if f32s { Positions::F32(v.iter().map(|x| x.map(|y| y as f32)).collect()) } else { Positions::F64(v) };
    let (p2, f2) = (p.clone(), f.clone());
    let t = Instant::now();
    let mesh = Mesh::new(p, f).unwrap();
    println!("build {:?} memory {:.1} B/tri", t.elapsed(), mesh.memory() as f64 / mesh.faces().len() as f64);
    let t = Instant::now();
    let other = Mesh::new(p2, f2).unwrap();
    println!("build again {:?}", t.elapsed());
    let pose = Pose::from_axis_angle([1.0, 2.0, 3.0], ang, [off[0], off[1], off[2]]).unwrap();
    let levels = impinge::simd::levels();
    let only = args.get(6).cloned().unwrap_or_default(); let iters: usize = args.get(7).and_then(|x| x.parse().ok()).unwrap_or(9);
    for (name, level) in levels.into_iter().filter(|l| only.is_empty() || l.0 == only) {
        let o = Options { level, ..Options::default() };
        let mut best = f64::MAX;
        let mut n = 0;
        for _ in 0..iters {
            let t = Instant::now();
            n = query::intersecting_pairs_with(&mesh, other.at(pose), &o).len();
            best = best.min(t.elapsed().as_secs_f64());
        }
        let mut first = f64::MAX;
        for _ in 0..iters {
            let t = Instant::now();
            std::hint::black_box(query::intersects_with(&mesh, other.at(pose), &o));
            first = first.min(t.elapsed().as_secs_f64());
        }
        println!("{name}: K {n} all {:.2} ms first {:.1} us", best * 1e3, first * 1e6);
    }
}


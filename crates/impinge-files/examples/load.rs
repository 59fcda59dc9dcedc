//! Loads files and prints what they hold.
#![allow(clippy::print_stdout)]
fn main() {
    for path in std::env::args().skip(1) {
        let start = std::time::Instant::now();
        match impinge_files::load(&path) {
            Ok(m) => {
                let kind = if matches!(m.positions, impinge::Positions::F32(_)) { "f32" } else { "f64" };
                println!("{path}: {} {} v {} {kind} t {} polys {:?} parts {} unit {:?} {:?}", start.elapsed().as_millis(), m.format, m.positions.len(), m.faces.len(), m.sources.last(), m.parts.len(), m.unit, m.warnings.iter().map(ToString::to_string).collect::<Vec<_>>());
            }
            Err(e) => println!("ERR {} | {e}", e.kind().name()),
        }
    }
}

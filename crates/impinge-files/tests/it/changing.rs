//! Tests a baked file that another program changes while it is read.
#![cfg(unix)]

use std::{
    fs::File,
    os::unix::fs::FileExt,
    panic::catch_unwind,
    sync::atomic::{AtomicBool, Ordering},
    thread,
};

use impinge::{Mesh, Positions};
use impinge_files::{Baked, Provenance, replace_file, write_baked};
use tempfile::TempDir;

/// Offset of the table entry of the leaves, the fifth section. A leaf has eight faces and takes 32
/// bytes.
const LEAVES: usize = 64 + 24 * 4;

#[test]
fn leaves_that_change_after_validation_cause_no_access_outside_of_the_file() {
    let n = 40;
    let vertices = (0..=n).flat_map(|y| (0..=n).map(move |x| [f64::from(x), f64::from(y), f64::from(x * y % 7)]));
    let quads = (0..n).flat_map(|y| (0..n).map(move |x| y * (n + 1) + x));
    let faces: Vec<[u32; 3]> = quads.flat_map(|a| [[a, a + 1, a + n + 1], [a + n + 2, a + n + 1, a + 1]]).collect();
    let mesh = Mesh::new(Positions::F64(vertices.collect()), faces).unwrap();
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("changing.impinge");
    let of_faces = vec![0; mesh.faces().len()];
    let about = Provenance { sources: of_faces.clone(), part_of: of_faces, parts: vec![String::new()], unit: None };
    replace_file(&path, |out| write_baked(&mesh, &about, None, out)).unwrap();

    let bytes = std::fs::read(&path).unwrap();
    let number = |at: usize| u64::from_le_bytes(bytes[at..][..8].try_into().unwrap());
    let (start, len) = (number(LEAVES + 8), number(LEAVES + 16));
    let file = File::options().write(true).open(&path).unwrap();
    let is_done = AtomicBool::new(false);
    let (mut refused, mut changed) = (0, 0_u64);
    thread::scope(|scope| {
        let writer = scope.spawn(|| {
            let mut count = 0;
            while !is_done.load(Ordering::Relaxed) {
                // Set the fourth face of some leaves to an index far outside of the file, and back.
                for leaf in (0..len / 32).step_by(9) {
                    let at = start + 32 * leaf + 12;
                    let held = &bytes[at as usize..][..4];
                    for value in [&0xffff_fff0_u32.to_le_bytes()[..], held] {
                        file.write_all_at(value, at).unwrap();
                    }
                    count += 1;
                }
            }
            count
        });
        for _ in 0..3_000 {
            // An error, a panic or a mesh are fine. A read outside of the file would end this
            // program.
            refused += usize::from(!matches!(catch_unwind(|| Baked::open(&path).unwrap().mesh()), Ok(Ok(_))));
        }
        is_done.store(true, Ordering::Relaxed);
        changed = writer.join().unwrap();
    });
    assert!(refused > 10 && changed > 10_000, "{refused} refused, {changed} changes");
}

//! Baked meshes with changed bytes and right checksums: they must be rejected, or give a mesh whose
//! queries end.

#![no_main]

use std::sync::{Arc, LazyLock};

use impinge::storage::AlignedBytes;
use impinge::{Mesh, Positions, query};
use impinge_files::{Baked, Provenance, write_baked};
use impinge_testkit::correct_checksums;
use impinge_testkit::generate::solids::icosphere;
use libfuzzer_sys::fuzz_target;

static WHOLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let sphere = icosphere(2);
    let faces = sphere.faces.len();
    let mesh = Mesh::new(Positions::F64(sphere.vertices), sphere.faces).expect("a legal mesh");
    let provenance = Provenance {
        sources: (0..faces as u32).collect(),
        part_of: vec![0; faces],
        parts: vec!["sphere".into()],
        unit: None,
    };
    let mut bytes = Vec::new();
    write_baked(&mesh, &provenance, mesh.proxies().as_ref(), &mut bytes).expect("memory takes all bytes");
    bytes
});

/// Number of bytes per change: three for the place and four to write there.
const CHANGE: usize = 7;

fuzz_target!(|changes: &[u8]| {
    let mut bytes = AlignedBytes::zeroed(WHOLE.len());
    bytes.as_mut().copy_from_slice(&WHOLE);
    for change in changes.chunks_exact(CHANGE) {
        let place = u32::from_le_bytes([change[0], change[1], change[2], 0]) as usize % (WHOLE.len() - 3);
        bytes.as_mut()[place..place + 4].copy_from_slice(&change[3..]);
    }
    // So that the changes reach the validation of the arrays.
    correct_checksums(bytes.as_mut());
    let Ok(baked) = Baked::from_bytes(Arc::new(bytes)) else { return };
    // A trusted mesh is memory-safe, but its queries may panic or never end.
    let _ = baked.trusted_mesh();
    let Ok(mesh) = baked.mesh() else { return };
    let _ = query::intersecting_pairs_up_to(&mesh, &mesh, 100);
    let _ = baked.proxies(&mesh);
});

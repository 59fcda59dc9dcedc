//! Solids of bricks on a lattice, many in one mesh: `penetrates` must agree with their cells in any
//! order of the faces, and never be `Undecided` if all walls are cut alike.

#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use impinge::query::Penetrates;
use impinge::{Mesh, Positions, query};
use impinge_testkit::Mesh as Plain;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::bricks::{self, Brick, Cut, Scene};
use libfuzzer_sys::fuzz_target;

#[derive(Debug)]
struct Question {
    scene: Scene,
    cut: Cut,
    seed: u64,
}

impl<'a> Arbitrary<'a> for Question {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let cut = *bytes.choose(&[Cut::AsLattice, Cut::ByChance, Cut::Whole])?;
        let seed = u64::from(bytes.arbitrary::<u8>()?);
        let half_steps = [step(bytes)?, step(bytes)?, step(bytes)?];
        Ok(Self { scene: Scene { bricks: [set(bytes)?, set(bytes)?], half_steps }, cut, seed })
    }
}

fn step(bytes: &mut Unstructured<'_>) -> arbitrary::Result<i64> {
    bytes.int_in_range(-4..=4_i8).map(i64::from)
}

/// Returns up to eight bricks between points of a small lattice.
fn set(bytes: &mut Unstructured<'_>) -> arbitrary::Result<Vec<Brick>> {
    let mut bricks = Vec::new();
    for _ in 0..bytes.int_in_range(1..=8_u8)? {
        let (mut low, mut high) = ([0; 3], [0; 3]);
        for k in 0..3 {
            low[k] = i64::from(bytes.int_in_range(0..=3_u8)?);
            high[k] = low[k] + i64::from(bytes.int_in_range(0..=2_u8)?);
        }
        bricks.push(Brick { low, high, inside_out: bytes.ratio(1_u8, 5_u8)? });
    }
    Ok(bricks)
}

fn engine_mesh(mesh: &Plain) -> Mesh {
    Mesh::new(Positions::F64(mesh.vertices.clone()), mesh.faces.clone()).expect("legal")
}

fuzz_target!(|question: Question| {
    let Question { scene, cut, seed } = question;
    let mut rng = Rng::new(seed);
    let [a, mut b] = [0, 1].map(|side| bricks::mesh(&mut rng, &scene.bricks[side], cut));
    for vertex in &mut b.vertices {
        *vertex = std::array::from_fn(|k| vertex[k] + 0.5 * scene.half_steps[k] as f64);
    }
    let answer = query::penetrates(&engine_mesh(&a), &engine_mesh(&b));
    let expected = if scene.penetrates() { Penetrates::Yes } else { Penetrates::No };
    assert!(answer == expected || (answer == Penetrates::Undecided && cut != Cut::AsLattice));
    let (a, b) = (bricks::reordered(&mut rng, a), bricks::reordered(&mut rng, b));
    assert_eq!(query::penetrates(&engine_mesh(&b), &engine_mesh(&a)), answer);
});

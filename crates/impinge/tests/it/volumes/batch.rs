//! One box against many: every vector level against a plain loop. Guards `AabbBatch`.

use impinge::simd::levels;
use impinge::volume::{Aabb, AabbBatch};
use impinge_testkit::generate::Rng;

#[test]
fn every_vector_level_agrees_with_a_plain_loop() {
    let mut rng = Rng::new(21);
    let (mut met, mut asked, mut touching) = (0, 0, 0);
    for count in (0..40).chain([1000]) {
        let boxes: Vec<Aabb> = (0..count).map(|_| any_box(&mut rng)).collect();
        let batch: AabbBatch = boxes.iter().copied().collect();
        assert_eq!((batch.len(), batch.is_empty()), (count, count == 0));
        for _ in 0..20 {
            let one = any_box(&mut rng);
            let overlaps = |other: &Aabb| (0..3).all(|k| one.min[k] <= other.max[k] && other.min[k] <= one.max[k]);
            let touches = |other: &Aabb| (0..3).any(|k| one.min[k] == other.max[k] || other.min[k] == one.max[k]);
            let expected: Vec<u32> = (0..count as u32).filter(|&i| overlaps(&boxes[i as usize])).collect();
            for (name, level) in levels() {
                let mut found = vec![7];
                batch.overlapping_at(level, &one, &mut found);
                assert_eq!(found[1..], expected, "{name}");
            }
            met += expected.len();
            asked += count;
            touching += expected.iter().filter(|&&i| touches(&boxes[i as usize])).count();
        }
    }
    assert!((asked / 20..asked * 7 / 10).contains(&met) && touching > met / 10, "{met} of {asked}, {touching} touch");
}

/// Returns a box on a grid, so that boxes touch. Some are flat, and some are empty.
fn any_box(rng: &mut Rng) -> Aabb {
    if rng.one_in(20) {
        return Aabb::EMPTY;
    }
    let min: [f32; 3] = std::array::from_fn(|_| rng.integer(-4, 4) as f32);
    Aabb { min, max: min.map(|x| x + rng.integer(0, 5) as f32) }
}

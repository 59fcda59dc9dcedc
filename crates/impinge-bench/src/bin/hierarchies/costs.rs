//! Costs of a volume test, a primitive test and an update on this machine, for each volume and
//! mesh: the constants of `T = N_V C_V + N_P C_P + N_U C_U`.

use std::hint::black_box;

use impinge::hierarchy::{Builder, Costs, NodeVolume};
use impinge_bench::samples::{Samples, processor_timed};

use crate::question::Question;

/// Number of volumes measured. They fit the second-level cache, as the volumes of a descent mostly
/// do.
const SAMPLE: usize = 1 << 10;

/// Number of pairs of primitives measured.
const PRIMITIVES: usize = 1 << 14;

/// Returns the costs for one kind of volume, or `None` if no volume can be fitted.
///
/// The volumes enclose a few triangles of the mesh each. They are tested against neighbors as in a
/// descent, and moved as in a descent.
pub(crate) fn measure<V: NodeVolume>(question: &Question, repeats: usize) -> Option<Costs> {
    let tree = Builder::Median.build_with_leaves_of(8, &question.boxes);
    let leaves: Vec<u32> = (0..tree.nodes.len() as u32).filter(|&n| tree.nodes[n as usize].right.is_none()).collect();
    let mut points = Vec::new();
    let volumes: Vec<V> = leaves[..leaves.len().min(SAMPLE)]
        .iter()
        .filter_map(|&leaf| {
            points.clear();
            tree.held(leaf).iter().for_each(|&face| points.extend(question.corners(face)));
            V::of_points(&points)
        })
        .collect();
    let count = volumes.len();
    if count == 0 {
        return None;
    }
    let each = |secs: f64, of: usize| secs / of as f64;

    let update = least(repeats, || {
        volumes.iter().for_each(|volume| {
            black_box(black_box(volume).moved(&question.pose));
        });
    });
    // Half of the tests are with neighbors in the tree, which overlap, and half with distant
    // volumes, which do not.
    let lanes: Vec<V::Lanes<1>> = volumes.iter().map(|&volume| V::lanes([Some(volume)])).collect();
    let volume = least(repeats, || {
        for at in 0..count {
            for step in [1, 2, count / 2, count / 3] {
                black_box(V::overlapping(black_box(&lanes[at]), &volumes[(at + step) % count]));
            }
        }
    });
    // Intersecting pairs, and their neighbors, which mostly do not intersect.
    let pairs = &question.pairs[..question.pairs.len().min(PRIMITIVES)];
    let size = question.size() as u32;
    let primitive = least(repeats, || {
        for &[a, b] in pairs {
            for b in [b, (b + 1) % size, (b + 2) % size, (b + 3) % size] {
                black_box(question.meet(black_box(a), b));
            }
        }
    });
    Some(Costs {
        volume_secs: each(volume, 4 * count),
        primitive_secs: each(primitive, 4 * pairs.len()),
        update_secs: each(update, count),
    })
}

/// Returns the minimum time of some runs, in seconds.
fn least(repeats: usize, mut run: impl FnMut()) -> f64 {
    Samples::take(repeats.max(5), || Ok::<f64, ()>(processor_timed(&mut run).0))
        .map_or(f64::NAN, |samples| samples.min())
}

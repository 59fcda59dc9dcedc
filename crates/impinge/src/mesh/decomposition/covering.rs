//! Hulls that contain points which are known only up to rounding.
//!
//! Guarded by `tests/it/solids/decomposition.rs`.

use rayon::prelude::*;

use super::cut_point::CutPoint;
use crate::hull::Hull;
use crate::input::InputError;
use crate::math::vec3::Vector;

/// Factors by which a hull is enlarged about its middle until it contains the exact points. The
/// first suffices unless the hull is flat.
const GROWTHS: [f64; 4] = [
    1.0 + 1.0 / (1_u64 << 44) as f64,
    1.0 + 1.0 / (1_u64 << 38) as f64,
    1.0 + 1.0 / (1_u64 << 32) as f64,
    1.0 + 1.0 / (1_u64 << 26) as f64,
];

/// Returns a hull that contains the exact points, which is decided exactly. Its vertices are
/// numbered from zero.
///
/// It is the hull of the positions if all points are exact, or if the points with errors are well
/// inside. Otherwise it is that hull enlarged about its middle by less than 10^-7 of its size. If
/// that is not enough because the hull is flat, it is the hull of the boxes of all points.
///
/// # Errors
/// Those of [`Hull::new`]: there are no points, or a coordinate is out of range.
pub(super) fn covering_hull(points: &[CutPoint]) -> Result<Hull, InputError> {
    let rounded: Vec<Vector> = points.iter().map(|point| point.at).collect();
    let hull = Hull::new(&rounded)?;
    let uncertain: Vec<CutPoint> = points.iter().filter(|point| !point.is_exact()).copied().collect();
    let covers = |hull: &Hull, uncertain: &[CutPoint]| {
        uncertain.par_iter().with_min_len(64).all(|point| point.corners().all(|corner| hull.contains(corner)))
    };
    let is_covered: Vec<bool> =
        uncertain.par_iter().with_min_len(64).map(|point| covers(&hull, std::slice::from_ref(point))).collect();
    let uncertain: Vec<CutPoint> =
        uncertain.iter().zip(is_covered).filter(|(_, is_covered)| !is_covered).map(|(&point, _)| point).collect();
    if uncertain.is_empty() {
        return Hull::new(hull.positions());
    }
    let share = 1.0 / hull.positions().len() as f64;
    let middle: Vector = std::array::from_fn(|k| hull.positions().iter().map(|at| at[k] * share).sum());
    for growth in GROWTHS {
        let enlarged =
            hull.positions().iter().map(|at| std::array::from_fn(|k| middle[k] + growth * (at[k] - middle[k])));
        let enlarged = Hull::new(&enlarged.collect::<Vec<Vector>>())?;
        if covers(&enlarged, &uncertain) && hull.positions().iter().all(|&at| enlarged.contains(at)) {
            return Hull::new(enlarged.positions());
        }
    }
    let boxes: Vec<Vector> = points.iter().flat_map(CutPoint::corners).collect();
    Hull::new(Hull::new(&boxes)?.positions())
}

/// Returns the volume of a hull in units of `size`³, rounded.
pub(super) fn volume(hull: &Hull, size: f64) -> f64 {
    let positions = hull.positions();
    let local =
        |vertex: u32| -> Vector { std::array::from_fn(|k| (positions[vertex as usize][k] - positions[0][k]) / size) };
    let of_face = |face: &[u32; 3]| {
        let [a, b, c] = face.map(local);
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    hull.faces().iter().map(of_face).sum::<f64>() / 6.0
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;

    #[test]
    fn the_hull_contains_every_corner_of_every_box() {
        let mut rng = Rng::new(1);
        let (mut kept, mut enlarged, mut flat) = (0, 0, 0);
        for case in 0..300 {
            let mut points: Vec<CutPoint> = Vec::new();
            for at in 0..8 {
                let position =
                    std::array::from_fn(|k| if case % 3 == 0 && k == 2 { 0.0 } else { rng.uniform(-1.0, 1.0) });
                let error = if at % 2 == 0 { [0.0; 3] } else { [1e-15, 0.0, 1e-15] };
                points.push(CutPoint { at: position, error });
            }
            let hull = covering_hull(&points).expect("finite");
            assert!(points.iter().flat_map(CutPoint::corners).all(|corner| hull.contains(corner)), "case {case}");
            assert!(hull.vertices().iter().copied().eq(0..hull.positions().len() as u32));
            let plain = Hull::new(&points.iter().map(|point| point.at).collect::<Vec<_>>()).expect("finite");
            kept += usize::from(plain.positions() == hull.positions());
            flat += usize::from(hull.positions().len() > plain.positions().len());
            enlarged +=
                usize::from(hull.positions().len() == plain.positions().len() && plain.positions() != hull.positions());
        }
        assert!(enlarged > 100 && flat > 50, "{kept} {enlarged} {flat}");
    }
}

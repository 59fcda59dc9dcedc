//! The common unit of two meshes.

use impinge::Pose;
use impinge_files::Unit;

use crate::console;

/// Ratios of sizes that suggest a mistaken unit, each with the factor by which a ratio may differ
/// from it. 25.4 suggests inches taken for millimeters; 1000 suggests meters taken for millimeters.
/// For 1000 the window is wider, because meshes of unlike size may differ too.
const SUSPICIOUS: [(f64, f64); 2] = [(25.4, 1.1), (1000.0, 2.0)];

/// Returns the factors that convert lengths of A and of B to the finer of their units. A mesh
/// without a unit is taken to be in the unit of the other.
pub(crate) fn scales(units: [Option<Unit>; 2]) -> [f64; 2] {
    let [Some(a), Some(b)] = units else { return [1.0; 2] };
    let finer = a.min(b);
    // The quotient of whole numbers of micrometers is rounded only once.
    [a, b].map(|unit| (unit.meters() * 1e6).round() / (finer.meters() * 1e6).round())
}

/// Returns the unit of the common frame: the finer of the two units. Returns `None` if neither is
/// known.
pub(crate) fn common([a, b]: [Option<Unit>; 2]) -> Option<Unit> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        _ => a.or(b),
    }
}

/// Prints a note if a unit was converted or assumed.
pub(crate) fn note_choice(units: [Option<Unit>; 2]) {
    let scales = scales(units);
    for (side, name) in ["A", "B"].into_iter().enumerate() {
        let other = ["B", "A"][side];
        match (units[side], units[1 - side]) {
            (Some(own), Some(finer)) if scales[side] != 1.0 => console::note(&format!(
                "{name} is in {own} and {other} in {finer}: {name} is scaled by {} to {finer}",
                scales[side]
            )),
            (None, Some(stated)) => console::note(&format!(
                "{other} is in {stated} and {name} states no unit: it is taken to be in {stated} too (--unit-{} overrides it)",
                name.to_lowercase()
            )),
            _ => {}
        }
    }
}

/// Prints a warning if a unit is not stated and the sizes suggest a mistaken one. `sizes` are
/// diagonals, each in the unit of its mesh.
pub(crate) fn warn_of_mismatch(units: [Option<Unit>; 2], sizes: [f64; 2], poses: [&Pose; 2]) {
    if units.iter().all(Option::is_some) {
        return;
    }
    let [a, b] = std::array::from_fn(|side| sizes[side] * magnification(poses[side]));
    let (larger, ratio) = if a > b { ("A", a / b) } else { ("B", b / a) };
    let near = |&(factor, window): &(f64, f64)| ratio > factor / window && ratio < factor * window;
    if let Some((factor, _)) = SUSPICIOUS.iter().find(|suspicious| near(suspicious)) {
        console::warn(&format!(
            "{larger} is {ratio:.4} times as large as the other, and {factor} is the quotient of two units: are both in the \
             same one? (--unit-a and --unit-b state them)"
        ));
    }
}

/// Returns the factor by which a pose enlarges lengths on average: the cube root of its factor for
/// volumes.
fn magnification(pose: &Pose) -> f64 {
    let [u, v, w] = *pose.linear();
    let volume = (0..3).map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        u[k] * (v[i] * w[j] - v[j] * w[i])
    });
    volume.sum::<f64>().abs().cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_scaled_to_the_finer_unit() {
        let of = |a, b| scales([Some(a), Some(b)]);
        assert_eq!(of(Unit::Meter, Unit::Millimeter), [1000.0, 1.0]);
        assert_eq!(of(Unit::Millimeter, Unit::Inch), [1.0, 25.4]);
        assert_eq!(of(Unit::Foot, Unit::Inch), [12.0, 1.0]);
        assert_eq!(of(Unit::Foot, Unit::Micron), [304_800.0, 1.0]);
        assert_eq!(of(Unit::Centimeter, Unit::Centimeter), [1.0, 1.0]);
        assert_eq!(scales([Some(Unit::Inch), None]), [1.0, 1.0]);
    }

    #[test]
    fn a_pose_enlarges_by_the_cube_root_of_its_determinant() {
        let pose = Pose::new([[0.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, -1.0]], [7.0; 3]).unwrap();
        assert!((magnification(&pose) - 2.0).abs() < 1e-12);
    }
}

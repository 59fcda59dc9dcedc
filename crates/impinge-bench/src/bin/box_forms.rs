//! Cost of n rotations and m translations for each of the three forms of a box, counted and
//! measured (*Notes on Real Time Collision Detection*, example 2.1.1).
//!
//! `cargo run --release -p impinge-bench --bin box_forms`
//!
//! The formulas are the plain ones, rounded to nearest, so that only the form differs. The
//! library's own formulas round outward. The final boxes of the forms are compared.

#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, reason = "what a benchmark prints is what it is for")]

use std::hint::black_box;

use anyhow::{Result, ensure};
use impinge::Pose;
use impinge_bench::samples::timed;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;

/// Number of boxes that move together between two readings of the clock.
const BOXES: usize = 1000;

/// Number of runs of each sequence. The minimum time counts.
const REPEATS: usize = 300;

/// Numbers of rotations and translations of each sequence.
const SEQUENCES: [[usize; 2]; 4] = [[10, 0], [0, 10], [5, 5], [1, 9]];

type Vector = [f64; 3];

/// Form of a box: two vectors, and their transformations.
#[derive(Clone, Copy)]
struct Form {
    name: &'static str,
    from_corners: fn(Vector, Vector) -> [Vector; 2],
    corners: fn([Vector; 2]) -> [Vector; 2],
    rotated: fn(&[Vector; 2], &Pose) -> [Vector; 2],
    translated: fn(&[Vector; 2], &Vector) -> [Vector; 2],
    /// Numbers of products, comparisons and sums of a rotation, and of sums of a translation.
    counts: [usize; 4],
}

const FORMS: [Form; 3] = [
    Form {
        name: "min-max",
        from_corners: |min, max| [min, max],
        corners: |form| form,
        rotated: rotated_min_max,
        translated: |[min, max], t| [sum(min, t), sum(max, t)],
        counts: [18, 18, 18, 6],
    },
    Form {
        name: "min-widths",
        from_corners: |min, max| [min, difference(&max, &min)],
        corners: |[min, widths]| [min, sum(&min, &widths)],
        rotated: rotated_min_widths,
        translated: |[min, widths], t| [sum(min, t), *widths],
        counts: [18, 9, 24, 3],
    },
    Form {
        name: "center-radius",
        from_corners: |min, max| [sum(&min, &max).map(|x| 0.5 * x), difference(&max, &min).map(|x| 0.5 * x)],
        corners: |[center, radii]| [difference(&center, &radii), sum(&center, &radii)],
        rotated: rotated_center_radius,
        translated: |[center, radii], t| [sum(center, t), *radii],
        counts: [18, 0, 15, 3],
    },
];

fn main() -> Result<()> {
    let mut counted = Table::new(["", "rotation: products", "comparisons", "sums", "translation: sums"]);
    for form in FORMS {
        let [products, comparisons, sums, moves] = form.counts.map(|count| count.to_string());
        counted.row([form.name.to_owned(), products, comparisons, sums, moves]);
    }
    println!("{counted}");

    let mut rng = Rng::new(1);
    let mut vector = || -> Vector { std::array::from_fn(|_| rng.uniform(-1.0, 1.0)) };
    let boxes: Vec<[Vector; 2]> = (0..BOXES)
        .map(|_| {
            let (center, half) = (vector(), vector().map(f64::abs));
            [difference(&center, &half), sum(&center, &half)]
        })
        .collect();
    let poses: Vec<Pose> = (0..10)
        .map(|turn| Pose::from_axis_angle([1.0, 2.0, 3.0], 0.1 * f64::from(turn), vector()))
        .collect::<Result<_, _>>()?;
    let steps: Vec<Vector> = (0..10).map(|_| vector()).collect();

    let mut measured = Table::new(["n rotations, m translations", "min-max", "min-widths", "center-radius"]);
    for [rotations, translations] in SEQUENCES {
        let results = FORMS.map(|form| run(&form, &boxes, &poses[..rotations], &steps[..translations]));
        for (_, found) in &results {
            let is_same = found.iter().zip(&results[0].1).all(|(found, expected)| {
                found.as_flattened().iter().zip(expected.as_flattened()).all(|(x, y)| (x - y).abs() < 1e-12)
            });
            ensure!(is_same, "the forms disagree after {rotations} rotations and {translations} translations");
        }
        let [a, b, c] = results.map(|(seconds, _)| time(seconds / BOXES as f64));
        measured.row([format!("{rotations}, {translations}"), a, b, c]);
    }
    print!("{measured}");
    Ok(())
}

/// Returns the minimum time for all boxes in seconds, and their final corners. Each rotation starts
/// from the original box; each translation moves the result of the operation before.
fn run(form: &Form, boxes: &[[Vector; 2]], poses: &[Pose], steps: &[Vector]) -> (f64, Vec<[Vector; 2]>) {
    let originals: Vec<[Vector; 2]> = boxes.iter().map(|&[min, max]| (form.from_corners)(min, max)).collect();
    let mut moved = originals.clone();
    let mut best = f64::INFINITY;
    for _ in 0..REPEATS {
        moved.copy_from_slice(&originals);
        let (seconds, ()) = timed(|| {
            for pose in poses {
                for (moved, original) in moved.iter_mut().zip(black_box(&originals)) {
                    *moved = (form.rotated)(original, pose);
                }
            }
            for step in steps {
                for moved in black_box(&mut moved).iter_mut() {
                    *moved = (form.translated)(moved, step);
                }
            }
        });
        best = best.min(seconds);
    }
    (best, moved.into_iter().map(form.corners).collect())
}

fn rotated_min_max([min, max]: &[Vector; 2], pose: &Pose) -> [Vector; 2] {
    let (mut low, mut high) = (*pose.translation(), *pose.translation());
    for axis in 0..3 {
        for k in 0..3 {
            let (x, y) = (pose.linear()[axis][k] * min[k], pose.linear()[axis][k] * max[k]);
            low[axis] += x.min(y);
            high[axis] += x.max(y);
        }
    }
    [low, high]
}

fn rotated_min_widths([min, widths]: &[Vector; 2], pose: &Pose) -> [Vector; 2] {
    let (mut low, mut wide) = (*pose.translation(), [0.0; 3]);
    for axis in 0..3 {
        for k in 0..3 {
            let across = pose.linear()[axis][k] * widths[k];
            low[axis] += pose.linear()[axis][k] * min[k] + across.min(0.0);
            wide[axis] += across.abs();
        }
    }
    [low, wide]
}

fn rotated_center_radius([center, radii]: &[Vector; 2], pose: &Pose) -> [Vector; 2] {
    let (mut middle, mut reach) = (*pose.translation(), [0.0; 3]);
    for axis in 0..3 {
        for k in 0..3 {
            middle[axis] += pose.linear()[axis][k] * center[k];
            reach[axis] += pose.linear()[axis][k].abs() * radii[k];
        }
    }
    [middle, reach]
}

fn sum(x: &Vector, y: &Vector) -> Vector {
    std::array::from_fn(|k| x[k] + y[k])
}

fn difference(x: &Vector, y: &Vector) -> Vector {
    std::array::from_fn(|k| x[k] - y[k])
}

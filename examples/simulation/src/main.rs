//! Runs all scenes and prints how they end.
//!
//! ```console
//! $ cargo run --release -p impinge-simulation -- [SECONDS] [ENERGIES.csv]
//! ```
//!
//! The file gets the energy of each stack after each step, less the energy at the start.

#![allow(clippy::print_stdout, reason = "what an example prints is what it is for")]

use std::error::Error;
use std::fmt::Write as _;

use glam::DVec3;
use impinge_simulation::block::Material;
use impinge_simulation::scenes::{Floor, Stack, roll, slide};
use impinge_simulation::solver::{STEP, Simulation};

const MATERIALS: [Material; 2] = [Material::Hull, Material::Mesh(2)];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let seconds: f64 = arguments.next().map_or(Ok(10.0), |text| text.parse())?;
    let steps = (seconds / STEP) as usize;
    let mut energies = String::from("stack,material,seconds,energy\n");

    println!("after {seconds} s, lengths in thousandths of a block's side:");
    for stack in Stack::ALL {
        for material in MATERIALS {
            let mut simulation = stack.simulation(material)?;
            let start: Vec<DVec3> = simulation.bodies().iter().map(|body| body.position).collect();
            let energy = simulation.energy();
            for step in 1..=steps {
                simulation.step()?;
                let (time, change) = (step as f64 * STEP, simulation.energy() - energy);
                writeln!(energies, "{stack:?},{material:?},{time:.4},{change:e}")?;
            }
            let moved = simulation.bodies().iter().zip(&start).map(|(body, start)| (body.position - start).abs());
            let DVec3 { x, y, z } = moved.fold(DVec3::ZERO, DVec3::max) * 1e3;
            let speed = simulation.bodies().iter().map(|body| body.velocity.length()).fold(0.0, f64::max);
            println!(
                "{stack:?} of {material:?}: moved {:.3} sideways and {z:.3} in height; speed {speed:.0e}",
                x.max(y)
            );
        }
    }

    for material in MATERIALS {
        for floor in [Floor::Plane, Floor::Mesh, Floor::Tiles] {
            let (mut upward, mut spin) = (0.0_f64, 0.0_f64);
            let simulation = run(slide(material, floor)?, steps, |simulation| {
                upward = upward.max(simulation.bodies()[0].velocity.z.abs());
                spin = spin.max(simulation.bodies()[0].spin.length());
            })?;
            let DVec3 { x, y, .. } = simulation.bodies()[0].position;
            println!(
                "crate of {material:?} on {floor:?}: slides to {x:.4}, {y:.4}; at most {upward:.0e} upward, {spin:.0e} in spin"
            );
        }
    }

    let rolling = roll()?;
    let start = rolling.energy();
    let (mut highest, mut deepest) = (start, 0.0_f64);
    let rolling = run(rolling, steps, |simulation| {
        highest = highest.max(simulation.energy());
        deepest = deepest.max(simulation.deepest());
    })?;
    println!(
        "ball on hills: energy {start:.4}, at most {highest:.4}, {:.4} at the end; at most {deepest:.0e} deep",
        rolling.energy()
    );

    if let Some(file) = arguments.next() {
        std::fs::write(file, energies)?;
    }
    Ok(())
}

/// Runs a simulation and shows it after each step.
fn run(
    mut simulation: Simulation,
    steps: usize,
    mut look: impl FnMut(&Simulation),
) -> Result<Simulation, Box<dyn Error>> {
    for _ in 0..steps {
        simulation.step()?;
        look(&simulation);
    }
    Ok(simulation)
}

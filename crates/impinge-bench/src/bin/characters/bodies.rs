//! Crowds of characters as bodies of a world: a step in which every part of every character has
//! moved.

use anyhow::{Result, ensure};
use impinge::character::{Character, PartBodies, Posed, Rig, RigPose};
use impinge::world::{NarrowPhase, Options, Traits, World};
use impinge_bench::samples::timed;
use impinge_bench::table::{Table, time};
use rayon::prelude::*;

use super::{Member, members};

/// Returns a row for each narrow phase: posing, the step, and the intersecting pairs after the last
/// step.
pub(crate) fn table(rig: &Rig, character: &Character, count: usize, repeats: usize) -> Result<Table<5>> {
    let heading = format!("{count} characters");
    let mut table = Table::new([heading.as_str(), "bodies", "pose", "step", "pairs"]);
    let phases = [
        ("boxes alone", NarrowPhase::Boxes),
        ("which meet", NarrowPhase::Intersections),
        ("with contacts", NarrowPhase::Contacts),
    ];
    for (name, narrow_phase) in phases {
        let Stepped { pose, step, bodies, pairs } = crowd(rig, character, count, repeats, narrow_phase)?;
        table.row([name.to_owned(), bodies.to_string(), time(pose), time(step), pairs.to_string()]);
    }
    Ok(table)
}

/// Minimum times of posing and of a step in seconds, the number of bodies, and the number of
/// intersecting pairs after the last step.
struct Stepped {
    pose: f64,
    step: f64,
    bodies: usize,
    pairs: usize,
}

fn crowd(rig: &Rig, character: &Character, count: usize, repeats: usize, narrow_phase: NarrowPhase) -> Result<Stepped> {
    let (members, _) = members(rig, count);
    let rest = rig.rest_pose()?;
    let mut world = World::with_options(Options { narrow_phase, ..Options::default() });
    let mut posed: Vec<Posed<'_>> = members.iter().map(|_| Posed::new(character, &rest)).collect();
    let bones = character.bones(rig);
    let mut bodies = Vec::new();
    for (owner, (posed, member)) in (0..).zip(posed.iter_mut().zip(&members)) {
        posed.set_at(&rest, member.place);
        let traits = Traits { owner: Some(owner), tag: 1000 * owner, ..Traits::default() };
        bodies.push(PartBodies::insert(&mut world, posed, traits)?);
    }
    world.step(&[])?;
    let mut moves = Vec::new();
    let mut least = Stepped { pose: f64::INFINITY, step: f64::INFINITY, bodies: world.len(), pairs: 0 };
    for frame in 0..repeats.max(1) {
        let (pose_seconds, posing) = timed(|| {
            posed.par_iter_mut().zip(&members).try_for_each_init(
                RigPose::default,
                |pose, (posed, member): (_, &Member)| {
                    rig.pose_bones_into(member.animation, member.time(rig, frame), &bones, pose)?;
                    posed.set_at(pose, member.place);
                    anyhow::Ok(())
                },
            )?;
            moves.clear();
            posed.iter().zip(&bodies).try_for_each(|(posed, bodies)| bodies.moves(posed, &mut moves))?;
            anyhow::Ok(())
        });
        posing?;
        let (step_seconds, stepped) = timed(|| world.step(&moves).map(|_| ()));
        stepped?;
        least.pose = least.pose.min(pose_seconds);
        least.step = least.step.min(step_seconds);
        least.pairs = world.pairs().count();
    }
    if narrow_phase != NarrowPhase::Boxes && count <= 1000 {
        let mut all = 0;
        for (at, a) in posed.iter().enumerate() {
            for b in &posed[..at] {
                a.pairs_with(b, &mut |_, _| all += 1)?;
            }
        }
        ensure!(all == least.pairs, "{} pairs of parts in the world, where all against all finds {all}", least.pairs);
    }
    Ok(least)
}

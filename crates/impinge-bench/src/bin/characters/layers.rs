//! Intermediate volumes around groups of a character's parts: only the box around all parts, boxes
//! that wrap the parts' volumes, or volumes that contain the parts' vertices.

use std::hint::black_box;
use std::path::Path;

use anyhow::{Context, Result};
use impinge::character::{Character, HitPart, Mode, Plan, Posed, Rig, RigPose};
use impinge::mesh::Ray;
use impinge_bench::samples::{Samples, processor_timed};
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;

/// Fine parts of a character, and coarse parts that group them.
pub(crate) struct Layers {
    fine: Character,
    coarse: Character,
    /// Fine parts of each coarse part.
    groups: Vec<Character>,
}

/// All layers in one pose.
struct PosedLayers<'c> {
    fine: Posed<'c>,
    coarse: Posed<'c>,
    groups: Vec<Posed<'c>>,
}

#[derive(Clone, Copy)]
enum Arrangement {
    Flat,
    Wrapped,
    Layered,
}

impl Layers {
    fn new(rig: &Rig, volumes: usize, few: usize) -> Result<Self> {
        let fit = |volumes| Character::fit(rig, &Plan::automatic(rig, volumes)?, Mode::Conservative);
        let (fine, coarse) = (fit(volumes)?, fit(few)?);
        let mut groups: Vec<Vec<HitPart>> = vec![Vec::new(); coarse.parts().len()];
        for part in fine.parts() {
            let of_bone = |above: &HitPart| above.bones.contains(&part.bones[0]);
            groups[coarse.parts().iter().position(of_bone).context("a bone without a part")?].push(part.clone());
        }
        let groups = groups.into_iter().map(|parts| Character::of_parts(rig, parts)).collect::<Result<_, _>>()?;
        Ok(Self { fine, coarse, groups })
    }

    fn posed(&self, pose: &RigPose) -> PosedLayers<'_> {
        PosedLayers {
            fine: Posed::new(&self.fine, pose),
            coarse: Posed::new(&self.coarse, pose),
            groups: self.groups.iter().map(|group| Posed::new(group, pose)).collect(),
        }
    }
}

impl PosedLayers<'_> {
    fn set(&mut self, arrangement: Arrangement, pose: &RigPose, origin: [f64; 3]) {
        match arrangement {
            Arrangement::Flat => return self.fine.set_at(pose, origin),
            Arrangement::Wrapped => {}
            Arrangement::Layered => self.coarse.set_at(pose, origin),
        }
        self.groups.iter_mut().for_each(|group| group.set_at(pose, origin));
    }

    /// Returns the parameter at which a ray enters the first volume, in units of the direction's
    /// length, or `None` if it hits none.
    fn ray_cast(&self, arrangement: Arrangement, ray: &Ray) -> Option<f64> {
        let of_group = |group: &Posed<'_>| group.ray_cast(ray).map(|hit| hit.t);
        match arrangement {
            Arrangement::Flat => of_group(&self.fine),
            Arrangement::Wrapped => self.groups.iter().filter_map(of_group).min_by(f64::total_cmp),
            Arrangement::Layered => {
                let above = self.coarse.ray_cast_all(ray);
                above.iter().filter_map(|hit| of_group(&self.groups[hit.part as usize])).min_by(f64::total_cmp)
            }
        }
    }

    /// Returns the number of intersecting pairs of parts of two characters.
    fn pairs_with(&self, arrangement: Arrangement, other: &Self) -> Result<usize> {
        let mut found = 0;
        match arrangement {
            Arrangement::Flat => self.fine.pairs_with(&other.fine, &mut |_, _| found += 1)?,
            Arrangement::Wrapped => {
                for group in &self.groups {
                    for of_other in &other.groups {
                        group.pairs_with(of_other, &mut |_, _| found += 1)?;
                    }
                }
            }
            Arrangement::Layered => {
                let mut above = Vec::new();
                self.coarse.pairs_with(&other.coarse, &mut |a, b| above.push((a as usize, b as usize)))?;
                for (a, b) in above {
                    self.groups[a].pairs_with(&other.groups[b], &mut |_, _| found += 1)?;
                }
            }
        }
        Ok(found)
    }
}

/// Times each arrangement: posing, rays aimed at a character, and pairs of characters beside each
/// other.
pub(crate) fn table(name: &str, rig: &Rig, volumes: usize, few: usize, repeats: usize) -> Result<Table<9>> {
    const CASES: usize = 300;
    let layers = Layers::new(rig, volumes, few)?;
    let mut random = Rng::new(5);
    let mut share = || random.uniform(0.0, 1.0);
    let poses = (0..CASES).map(|_| {
        let animation = (share() * rig.animations().len() as f64) as usize;
        let [start, end] = rig.animations()[animation].span();
        rig.pose_at(animation, start + share() * (end - start))
    });
    let poses: Vec<RigPose> = poses.collect::<Result<_, _>>()?;
    let [low, high] = Posed::new(&layers.fine, &poses[0]).outer();
    let size = [0, 1, 2].map(|k| high[k] - low[k]);
    let mut inside = |grown: f64| [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]) + grown * (share() - 0.5) * size[k]);
    let rays = (0..CASES).map(|_| {
        let (from, to) = (inside(6.0), inside(0.9));
        Ray::new(from, [0, 1, 2].map(|k| to[k] - from[k]))
    });
    let rays: Vec<Ray> = rays.collect::<Result<_, _>>()?;
    let places: Vec<[f64; 3]> = (0..CASES).map(|_| [0, 2].map(|_| inside(1.0)[0])).map(|[x, z]| [x, 0.0, z]).collect();
    let mut table =
        Table::new([name, "volumes", "pose", "a ray", "hits", "a pair", "of parts", "rays lost", "pairs lost"]);
    let mut flat = None;
    for (arrangement, name) in
        [(Arrangement::Flat, "one box"), (Arrangement::Wrapped, "wrapped"), (Arrangement::Layered, "layered")]
    {
        let mut all: Vec<PosedLayers<'_>> = poses.iter().map(|pose| layers.posed(pose)).collect();
        let posing = Samples::take(repeats, || {
            let mut set = || {
                all.iter_mut().zip(&poses).zip(&places).for_each(|((one, pose), &at)| one.set(arrangement, pose, at))
            };
            anyhow::Ok(processor_timed(&mut set).0)
        })?;
        let (mut hits, mut pairs) = (0, 0);
        let mut shooting = || {
            let hit = |(one, ray): (&PosedLayers<'_>, &Ray)| one.ray_cast(arrangement, black_box(ray)).is_some();
            let (seconds, found) = processor_timed(|| all.iter().zip(&rays).filter(|&case| hit(case)).count());
            hits = found;
            anyhow::Ok(seconds)
        };
        let shooting = Samples::take(repeats, &mut shooting)?;
        let mut meeting = || {
            let (seconds, found) = processor_timed(|| {
                all.windows(2).map(|two| two[0].pairs_with(arrangement, &two[1])).sum::<Result<usize>>()
            });
            pairs = found?;
            anyhow::Ok(seconds)
        };
        let meeting = Samples::take(repeats, &mut meeting)?;
        let (all_hits, all_pairs) = *flat.get_or_insert((hits, pairs));
        let count = match arrangement {
            Arrangement::Flat | Arrangement::Wrapped => layers.fine.parts().len(),
            Arrangement::Layered => layers.fine.parts().len() + layers.coarse.parts().len(),
        };
        let each = |samples: Samples, count: usize| time(samples.min() / count as f64);
        table.row([
            name.to_owned(),
            count.to_string(),
            each(posing, CASES),
            each(shooting, CASES),
            hits.to_string(),
            each(meeting, CASES - 1),
            pairs.to_string(),
            (all_hits - hits).to_string(),
            (all_pairs - pairs).to_string(),
        ]);
    }
    Ok(table)
}

/// Returns the character of the repository, and one of the data folder if that is present.
pub(crate) fn characters(root: &Path) -> Result<Vec<(&'static str, Rig)>> {
    let mut found = vec![("robot", impinge_files::load_rig(root.join("data/robot.glb"))?)];
    match std::env::var_os("IMPINGE_DATA").map(|data| Path::new(&data).join("characters/greenman.glb")) {
        Some(path) if path.exists() => found.push(("greenman", impinge_files::load_rig(path)?)),
        _ => println!("without greenman.glb: IMPINGE_DATA names no folder that has it"),
    }
    Ok(found)
}

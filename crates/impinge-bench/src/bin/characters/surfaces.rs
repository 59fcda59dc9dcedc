//! Cost of finding the part that a ray hits, and the share of right answers: by volumes, by volumes
//! refined into hulls, by the faces near a ray, and by the whole surface.

use std::hint::black_box;

use anyhow::{Result, ensure};
use impinge::character::{Character, Mode, Plan, Posed, Rig, RigPose, Surface, SurfaceRays};
use impinge::mesh::Ray;
use impinge_bench::samples::processor_timed;
use impinge_bench::table::{Table, time};
use impinge_testkit::generate::Rng;

const POSES: usize = 100;
const RAYS: usize = 100;

/// Poses, rays at the surface in each pose, and the true part that each ray hits.
struct Cases(Vec<(RigPose, Vec<Aimed>)>);

/// Ray, and the part that it hits.
type Aimed = (Ray, Option<u32>);

/// Minimum times of a pose and of a ray in seconds, and the share of hits with the right part.
struct Measured {
    pose: f64,
    ray: f64,
    right: f64,
}

/// Returns the table of a character with at most `volumes` parts, on one thread.
pub(crate) fn table(name: &str, rig: &Rig, volumes: usize, repeats: usize) -> Result<Table<4>> {
    let character = Character::fit(rig, &Plan::automatic(rig, volumes)?, Mode::Conservative)?;
    let cases = cases(rig, &character)?;
    let rest = rig.rest_pose()?;
    let mut table = Table::new([name, "to pose", "a ray", "right"]);
    let mut row = |name: String, Measured { pose, ray, right }: Measured| {
        table.row([name, time(pose), time(ray), format!("{:.1} %", 100.0 * right)]);
    };
    let mut opened = character.clone();
    for faces in [usize::MAX, 64, 12] {
        let mut name = format!("{} volumes", character.parts().len());
        if faces < usize::MAX {
            opened.refine(rig, faces)?;
            name = format!("opened, {} hulls", opened.piece_count());
        }
        let set = |posed: &mut Posed<'_>, pose: &RigPose| {
            posed.set(pose);
            Ok(())
        };
        let ask = |posed: &Posed<'_>, ray: &Ray| posed.ray_cast(ray).map(|hit| hit.part);
        row(name, cases.measured(repeats, &mut Posed::new(&opened, &rest), set, ask)?);
    }
    let set = |near: &mut SurfaceRays<'_>, pose: &RigPose| {
        near.set_at(pose, [0.0; 3]);
        Ok(())
    };
    let ask = |near: &SurfaceRays<'_>, ray: &Ray| near.ray_cast(ray).map(|hit| hit.part);
    let near = cases.measured(repeats, &mut SurfaceRays::new(&character, rig, &rest), set, ask)?;
    ensure!(near.right == 1.0, "the faces near a ray say something else than all");
    row("faces near the ray".into(), near);
    let set = |surface: &mut Surface, pose: &RigPose| Ok(surface.set(rig, pose)?);
    let ask = |surface: &Surface, ray: &Ray| surface.ray_cast(&character, ray).map(|hit| hit.part);
    row("all faces, refitted".into(), cases.measured(repeats, &mut Surface::new(rig, &rest)?, set, ask)?);
    Ok(table)
}

/// Returns rays from outside at random points of the surface.
fn cases(rig: &Rig, character: &Character) -> Result<Cases> {
    let mut random = Rng::new(9);
    let mut share = || random.uniform(0.0, 1.0);
    let mut surface = Surface::new(rig, &rig.rest_pose()?)?;
    let (mut vertices, mut all) = (Vec::new(), Vec::new());
    for _ in 0..POSES {
        let animation = (share() * rig.animations().len() as f64) as usize;
        let [start, end] = rig.animations()[animation].span();
        let pose = rig.pose_at(animation, start + share() * (end - start))?;
        surface.set(rig, &pose)?;
        rig.skin().skinned(&pose, &mut vertices);
        let mut rays = Vec::new();
        while rays.len() < RAYS {
            let face = rig.skin().faces()[(share() * rig.skin().faces().len() as f64) as usize];
            let [a, b, c] = face.map(|corner| vertices[corner as usize]);
            let (u, v) = (share(), share());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let direction = [0; 3].map(|_| 2.0 * share() - 1.0);
            let squared: f64 = direction.iter().map(|x| x * x).sum();
            if !(0.01..1.0).contains(&squared) {
                continue;
            }
            let to = [0, 1, 2].map(|k| (1.0 - u - v) * a[k] + u * b[k] + v * c[k]);
            let ray = Ray::new([0, 1, 2].map(|k| to[k] - 20.0 * direction[k] / squared.sqrt()), direction)?;
            rays.push((ray, surface.ray_cast(character, &ray).map(|hit| hit.part)));
        }
        all.push((pose, rays));
    }
    Ok(Cases(all))
}

impl Cases {
    fn measured<S>(
        &self,
        repeats: usize,
        state: &mut S,
        set: impl Fn(&mut S, &RigPose) -> Result<()>,
        ask: impl Fn(&S, &Ray) -> Option<u32>,
    ) -> Result<Measured> {
        let mut least = Measured { pose: f64::INFINITY, ray: f64::INFINITY, right: 0.0 };
        for _ in 0..repeats.max(1) {
            let (mut posing, mut casting, mut right, mut hits) = (0.0, 0.0, 0, 0);
            for (pose, rays) in &self.0 {
                let (seconds, done) = processor_timed(|| set(state, pose));
                done?;
                posing += seconds;
                let (seconds, found) = processor_timed(|| {
                    rays.iter().map(|(ray, _)| ask(state, black_box(ray))).collect::<Vec<Option<u32>>>()
                });
                casting += seconds;
                for ((_, truth), part) in rays.iter().zip(found).filter(|((_, truth), _)| truth.is_some()) {
                    hits += 1;
                    right += usize::from(part == *truth);
                }
            }
            least.pose = least.pose.min(posing / POSES as f64);
            least.ray = least.ray.min(casting / (POSES * RAYS) as f64);
            least.right = right as f64 / hits as f64;
        }
        Ok(least)
    }
}

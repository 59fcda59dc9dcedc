//! Tests of rays that skin only the nearby part of the surface, against the surface that is skinned
//! as a whole.

use std::path::Path;

use impinge::character::{Mode, Rig, Surface, SurfaceRays};
use impinge::mesh::Ray;
use impinge::{Mesh, Positions};
use impinge_files::load_rig;

use super::holding::bulging;
use super::{Random, aimed, fitted, robot, sub};

/// Returns a ray: at points of the surface; at vertices and midpoints of edges, where faces tie;
/// along an axis; from the surface itself; or past it.
fn ray(rig: &Rig, vertices: &[[f64; 3]], random: &mut Random, case: usize) -> Ray {
    let face = rig.skin().faces()[(random.next() * rig.skin().faces().len() as f64) as usize];
    let [a, b, _] = face.map(|corner| vertices[corner as usize]);
    let middle = [0, 1, 2].map(|k| 0.5 * a[k] + 0.5 * b[k]);
    let axis = [0, 1, 2].map(|k| if k == case % 3 { 1.0 } else { 0.0 });
    match case % 8 {
        0 => Ray::new([0, 1, 2].map(|k| a[k] - 7.0 * axis[k]), axis).unwrap(),
        1 => Ray::new([0, 1, 2].map(|k| middle[k] + 3.0 * axis[k]), axis.map(|x| -x)).unwrap(),
        2 => Ray::new(a, random.unit()).unwrap(),
        3 => {
            let origin = random.vector(6.0);
            Ray::new(origin, sub(a, origin).map(|x| 1e-200 * x)).unwrap()
        }
        4 => Ray::new(random.vector(5.0), random.unit().map(|x| 1e80 * x)).unwrap(),
        _ => aimed(rig, vertices, random),
    }
}

/// Asserts that both methods agree for rays in random poses. Returns the number of rays that hit
/// the surface.
fn assert_all_agree(rig: &Rig, random: &mut Random, poses: usize, rays: usize) -> usize {
    let character = fitted(rig, 6, Mode::Snug);
    let rest = rig.rest_pose().unwrap();
    let mut whole = Surface::new(rig, &rest).unwrap();
    let mut near = SurfaceRays::new(&character, rig, &rest);
    let (mut vertices, mut hits) = (Vec::new(), 0);
    for _ in 0..poses {
        let pose = random.pose(rig);
        whole.set(rig, &pose).unwrap();
        near.set_at(&pose, [0.0; 3]);
        rig.skin().skinned(&pose, &mut vertices);
        for case in 0..rays {
            let ray = ray(rig, &vertices, random, case);
            let truth = whole.ray_cast(&character, &ray);
            assert_eq!(near.ray_cast(&ray), truth, "{ray:?}");
            hits += usize::from(truth.is_some());
        }
    }
    hits
}

#[test]
fn rays_hit_the_same_point_as_on_the_whole_surface() {
    let hits = assert_all_agree(&robot(), &mut Random(31), 100, 100);
    assert!((8_000..9_900).contains(&hits), "{hits}");
}

#[test]
fn rays_agree_if_vertices_are_shared_among_bones() {
    let Some(folder) = std::env::var_os("IMPINGE_DATA") else {
        eprintln!("skipped: IMPINGE_DATA names no folder of real files");
        return;
    };
    let rig = load_rig(Path::new(&folder).join("characters/greenman.glb")).unwrap();
    let hits = assert_all_agree(&rig, &mut Random(37), 250, 40);
    assert!((8_000..9_900).contains(&hits), "{hits}");
}

#[test]
fn rays_agree_on_surfaces_with_morph_targets_and_scales() {
    let mut random = Random(41);
    let hits: usize = (0..12).map(|_| assert_all_agree(&bulging(&mut random), &mut random, 20, 40)).sum();
    assert!((5_500..9_000).contains(&hits), "{hits}");
}

#[test]
fn a_moved_surface_equals_the_mesh_of_moved_vertices() {
    let rig = robot();
    let character = fitted(&rig, 6, Mode::Snug);
    let mut near = SurfaceRays::new(&character, &rig, &rig.rest_pose().unwrap());
    let (mut random, mut vertices, mut hits) = (Random(43), Vec::new(), 0);
    for origin in [[3.0, 0.0, -4.0], [1e6, 0.1, 1e6], [1e15; 3], [1e30, 0.0, 0.0]] {
        let pose = random.pose(&rig);
        near.set_at(&pose, origin);
        rig.skin().skinned(&pose, &mut vertices);
        vertices.iter_mut().for_each(|vertex| *vertex = [0, 1, 2].map(|k| vertex[k] + origin[k]));
        let mesh = Mesh::new(Positions::F64(vertices.clone()), rig.skin().faces().to_vec()).unwrap();
        for case in 0..400 {
            let ray = ray(&rig, &vertices, &mut random, case);
            let truth = mesh.ray_cast(&ray).map(|hit| (hit.face, hit.t, hit.point));
            assert_eq!(near.ray_cast(&ray).map(|hit| (hit.face, hit.t, hit.point)), truth, "{origin:?} {ray:?}");
            hits += usize::from(truth.is_some());
        }
    }
    assert!(hits > 600, "{hits}");
}

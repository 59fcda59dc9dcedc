//! Bounding volumes of a mesh: how tight each kind is, and the convex hull instead of the mesh.
//!
//! Each volume contains the whole mesh, so objects apart from the volume are apart from the mesh.

use std::error::Error;

use impinge::volume::BoundingVolume;
use impinge::{Mesh, Pose, Shape, query};

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let vertices = model.positions.len();
    let human = Mesh::new(model.positions, model.faces)?;
    let proxies = human.proxies().ok_or("the mesh has no faces")?;
    let (sphere, capsule, lozenge) = (proxies.sphere(), proxies.capsule(), proxies.lozenge());
    println!("box: {:.6}", proxies.bounds().volume());
    println!("sphere: {:.6}, of radius {:.6}", sphere.volume(), sphere.radius());
    println!("capsule: {:.6}, of radius {:.6}", capsule.volume(), capsule.radius());
    println!("lozenge: {:.6}, of radius {:.6}", lozenge.volume(), lozenge.radius());
    println!("oriented box: {:.6}", proxies.obb().volume());
    println!("18-DOP: {:.6}", proxies.kdop18().volume());
    println!("hull: {} of {vertices} vertices", proxies.hull().vertices().len());

    // The hull instead of the mesh: a lower bound of the distance at a fraction of the cost.
    let hull = Shape::hull(proxies.hull().clone()).at(Pose::IDENTITY)?;
    let ball = Shape::sphere([0.0; 3], 0.25)?.at(Pose::from_translation([0.75, -0.5, 0.125])?)?;
    println!("a ball is {:.6} from the hull", query::distance(&hull, &ball).distance());
    println!("a ball is {:.6} from the human", query::distance(&human, &ball).distance());
    Ok(())
}

//! The extension module `impinge._impinge`, which takes and returns arrays. It contains no
//! geometry. People import the package around it, `python/impinge`.

mod arrays;
mod blocks;
mod box_forms;
mod boxes;
mod character;
mod character_pose;
mod clash;
mod clash_files;
mod clash_shares;
mod command;
mod contacts;
mod decomposition;
mod deforming;
mod distances;
mod errors;
mod fcl_contacts;
mod fcl_distance;
mod fcl_geometry;
mod fcl_object;
mod fcl_work;
mod inspection;
mod lent_bytes;
mod limits;
mod manager_contacts;
mod manager_queries;
mod managers;
mod mesh;
mod model;
mod motions;
mod pace;
mod partition_queries;
mod partitions;
mod pictures;
mod planning_scene;
mod points;
mod poses;
mod question;
mod rays;
mod robot;
mod robot_checks;
mod robot_motions;
mod scene;
mod scene_file;
mod scene_shares;
mod shape_rays;
mod shapes;
mod solid_bsp;
mod verbs;
mod volumes;
mod workers;
mod world;
mod world_bodies;
mod world_casts;
mod world_margins;
mod world_queries;
mod world_state;
mod world_turn;

/// Everything that `python/impinge` imports. Every name is private to that package.
#[pyo3::pymodule]
mod _impinge {
    #[pymodule_export]
    use super::box_forms::{BatchCore, BoxCore, PackedCore};
    #[pymodule_export]
    use super::character::CharacterCore;
    #[pymodule_export]
    use super::character_pose::PosedCore;
    #[pymodule_export]
    use super::clash::clash;
    #[pymodule_export]
    use super::clash_files::ClashFiles;
    #[pymodule_export]
    use super::clash_shares::{clash_candidates, clash_pairs, clash_report};
    #[pymodule_export]
    use super::command::run_command;
    #[pymodule_export]
    use super::decomposition::convex_parts;
    #[pymodule_export]
    use super::deforming::DeformingCore;
    #[pymodule_export]
    use super::distances::{deeper, depth, distance, penetration, within};
    #[pymodule_export]
    use super::fcl_contacts::fcl_collide;
    #[pymodule_export]
    use super::fcl_distance::fcl_distance;
    #[pymodule_export]
    use super::fcl_geometry::GeometryBase;
    #[pymodule_export]
    use super::fcl_object::{ObjectBase, TransformBase};
    #[pymodule_export]
    use super::inspection::{closing_tolerance, health, repaired, tree_statistics};
    #[pymodule_export]
    use super::limits::Limits;
    #[pymodule_export]
    use super::manager_contacts::{ManagerContacts, manager_contacts};
    #[pymodule_export]
    use super::manager_queries::{manager_any, manager_each_by_gap, manager_each_near, manager_nearest, manager_pairs};
    #[pymodule_export]
    use super::managers::ManagerBase;
    #[pymodule_export]
    use super::mesh::MeshBase;
    #[pymodule_export]
    use super::model::{Model, bake, to_baked};
    #[pymodule_export]
    use super::motions::{MotionBase, edge_edge, time_of_impact, vertex_face};
    #[pymodule_export]
    use super::partition_queries::{
        partition_nearest, partition_overlapping, partition_pairs, partition_pairs_with, partition_ray_cast,
        partition_ray_cast_all,
    };
    #[pymodule_export]
    use super::partitions::{PartitionCore, box_pairs};
    #[pymodule_export]
    use super::pictures::{picture_of_pair, picture_of_robot, picture_of_scene, to_png};
    #[pymodule_export]
    use super::planning_scene::PlanningSceneFile;
    #[pymodule_export]
    use super::points::{closest_point, contains, signed_distance, winding_number};
    #[pymodule_export]
    use super::rays::{face_normals, ray_cast, ray_cast_all};
    #[pymodule_export]
    use super::robot::RobotCore;
    #[pymodule_export]
    use super::robot_checks::{robot_attached, robot_check, robot_of_parts};
    #[pymodule_export]
    use super::robot_motions::{robot_audit, robot_clearance, robot_motions, robot_verify};
    #[pymodule_export]
    use super::scene::check_scene;
    #[pymodule_export]
    use super::scene_file::SceneFile;
    #[pymodule_export]
    use super::scene_shares::{check_pairs, scene_candidates};
    #[pymodule_export]
    use super::shape_rays::shape_ray_cast;
    #[pymodule_export]
    use super::shapes::ShapeBase;
    #[pymodule_export]
    use super::solid_bsp::SolidBspCore;
    #[pymodule_export]
    use super::verbs::{
        contacts_of, intersecting_pairs, intersecting_pairs_in, intersection_curves, intersects, leading_axes,
        penetrates, self_intersecting_pairs,
    };
    #[pymodule_export]
    use super::volumes::{convex_hull, fit_volume, proxies};
    #[pymodule_export]
    use super::workers::after_fork;
    #[pymodule_export]
    use super::world::WorldCore;
    #[pymodule_export]
    use super::world_casts::{world_distances, world_nearest, world_shape_cast, world_shape_cast_all, world_within};
    #[pymodule_export]
    use super::world_margins::{world_margins, world_set_margin};
    #[pymodule_export]
    use super::world_queries::{
        world_at_points, world_in_boxes, world_overlapping, world_ray_cast, world_ray_cast_all,
    };
    #[pymodule_export]
    use super::world_state::WorldState;

    /// Limits rayon's default pool to one thread, so that work on the caller's thread stays there.
    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        super::workers::limit_default_pool();
        pyo3::types::PyModuleMethods::add(module, "__version__", env!("CARGO_PKG_VERSION"))
    }
}

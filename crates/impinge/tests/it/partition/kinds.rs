//! Every kind of partition, by name.

use impinge::partition::{
    Axis, BoxTree, BspTree, Dynamic, HashedGrid, HierarchicalGrid, KdTree, LooseOctree, Octree, Partition,
    SweepOneAxis, SweepThreeAxes, UniformGrid,
};
use impinge::volume::MinMax;

use crate::partition::scenes::Scene;

/// Returns an empty partition of each dynamic kind. Cell sizes suit the scene or do not.
pub(crate) fn dynamic(scene: Scene) -> Vec<(&'static str, Box<dyn Dynamic>)> {
    let (origin, size) = scene.place();
    let cells = MinMax::new(origin, origin.map(|x| x + size)).expect("in range");
    vec![
        ("uniform grid", Box::new(UniformGrid::over(&cells, 0.15 * size).expect("few cells"))),
        ("octree", Box::new(Octree::over(&cells))),
        ("loose octree", Box::new(LooseOctree::over(&cells))),
        ("hashed grid", Box::new(HashedGrid::new(2.0).expect("a size"))),
        ("small hashed grid", Box::new(HashedGrid::new(0.3).expect("a size"))),
        ("hierarchical grid", Box::new(HierarchicalGrid::new(1.0).expect("a size"))),
        ("deep hierarchical grid", Box::new(HierarchicalGrid::new(1e-6).expect("a size"))),
        ("tree", Box::new(BoxTree::new())),
        ("tree with margin", Box::new(BoxTree::with_margin(0.3))),
        ("one axis", Box::new(SweepOneAxis::along(Axis::X))),
        ("one axis, y", Box::new(SweepOneAxis::along(Axis::Y))),
        ("three axes", Box::new(SweepThreeAxes::new())),
    ]
}

/// Returns a partition of each static kind over the boxes.
pub(crate) fn built(boxes: &[MinMax]) -> Vec<(&'static str, Box<dyn Partition>)> {
    vec![
        ("k-d tree", Box::new(KdTree::build(boxes))),
        ("BSP tree", Box::new(BspTree::build(boxes))),
        ("built tree", Box::new(BoxTree::build(boxes))),
        ("built sweep of one axis", Box::new(SweepOneAxis::build(Axis::Z, boxes))),
        ("built sweep of three axes", Box::new(SweepThreeAxes::build(boxes))),
    ]
}

//! Flattens the nodes of a scene: each mesh with the map that places it.

use crate::{
    error::{LoadError, Place},
    instance::Affine,
    limits::Budget,
    model::{WarningKind, Warnings},
};

use super::{
    accessor::missing,
    document::{Document, Node},
};

/// A mesh in the scene.
pub(super) struct Instance {
    /// Index of the node; `None` if the file has meshes but no nodes.
    pub(super) node: Option<usize>,
    /// Index of the mesh, which exists.
    pub(super) mesh: usize,
    pub(super) world: Affine,
}

/// Returns all instances, parents before children, in the order of the file. A node that several
/// paths reach is returned once per path. Returns an error if the paths exceed the budget.
pub(super) fn instances(
    document: &Document,
    warnings: &mut Warnings,
    budget: Budget,
) -> Result<Vec<Instance>, LoadError> {
    // Without nodes the number of instances is known; a vector that doubles would take three times
    // the memory.
    let known = if document.nodes.is_empty() { document.meshes.len() } else { 0 };
    let mut instances = Vec::with_capacity(known);
    walk(document, warnings, budget, |instance, _| {
        instances.push(instance);
        Ok(())
    })?;
    Ok(instances)
}

/// Calls `visit` with all instances in the order of [`instances`], each with the nodes that contain
/// its node, the outermost first. Returns an error if the paths exceed the budget, or the first
/// error of `visit`.
///
/// The traversals keep their own stacks, so deep hierarchies of nodes cannot overflow the call
/// stack.
pub(super) fn walk(
    document: &Document,
    warnings: &mut Warnings,
    budget: Budget,
    mut visit: impl FnMut(Instance, &[u32]) -> Result<(), LoadError>,
) -> Result<(), LoadError> {
    if document.nodes.is_empty() {
        return (0..document.meshes.len())
            .try_for_each(|mesh| visit(Instance { node: None, mesh, world: Affine::IDENTITY }, &[]));
    }
    let roots = roots(document)?;
    count_paths(document, &roots, warnings, budget)?;
    // The nodes with children that contain the current node, and their maps, of which the first is
    // that of the scene. The stack holds nodes, each with the index of its parent's map.
    let (mut around, mut worlds) = (Vec::new(), vec![Affine::IDENTITY]);
    let mut stack: Vec<(u32, usize)> = roots.into_iter().rev().map(|root| (root, 0)).collect();
    while let Some((index, parent)) = stack.pop() {
        // Maps after that of the parent belong to nodes that are done.
        worlds.truncate(parent + 1);
        around.truncate(parent);
        let node = &document.nodes[index as usize];
        let place = || Place::Entry(format!("node {index}"));
        let world = worlds[parent].after(&local(node).map_err(|e| e.at(place()))?);
        if let Some(mesh) = node.mesh {
            if mesh as usize >= document.meshes.len() {
                return Err(missing("mesh", mesh).at(place()));
            }
            visit(Instance { node: Some(index as usize), mesh: mesh as usize, world }, &around)?;
        }
        if !node.children.is_empty() {
            worlds.push(world);
            around.push(index);
            stack.extend(node.children.iter().rev().map(|&child| (child, worlds.len() - 1)));
        }
    }
    Ok(())
}

/// Returns an error if a node does not exist, nodes form a cycle, or the paths to all nodes exceed
/// the budget.
fn count_paths(document: &Document, roots: &[u32], warnings: &mut Warnings, budget: Budget) -> Result<(), LoadError> {
    /// Progress of the search at a node.
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        Open,
        /// Done; holds the number of nodes on all paths from this node on.
        Done(u64),
    }
    let mut states = vec![State::New; document.nodes.len()];
    let mut shared = vec![false; document.nodes.len()];
    let mut total = 0_u64;
    // Each open node with the number of its children that are done, and the sum of their nodes.
    let mut stack: Vec<(u32, usize, u64)> = Vec::new();
    for &root in roots {
        let mut next = Some(root);
        loop {
            if let Some(index) = next.take() {
                match states.get(index as usize).copied() {
                    None => return Err(missing("node", index)),
                    Some(State::New) => {
                        states[index as usize] = State::Open;
                        stack.push((index, 0, 1));
                    }
                    Some(State::Open) => {
                        let error = LoadError::syntax("nodes that form no cycle", b"one that is inside of itself");
                        return Err(error.at(Place::Entry(format!("node {index}"))));
                    }
                    Some(State::Done(sum)) => {
                        let place = || Some(Place::Entry(format!("node {index}")));
                        let known = std::mem::replace(&mut shared[index as usize], true);
                        warnings.add(WarningKind::SharedNodes, (!known).into(), place);
                        match stack.last_mut() {
                            Some(parent) => parent.2 = parent.2.saturating_add(sum),
                            None => total = total.saturating_add(sum),
                        }
                    }
                }
            }
            let Some((index, done, sum)) = stack.last_mut() else { break };
            match document.nodes[*index as usize].children.get(*done) {
                Some(&child) => {
                    *done += 1;
                    next = Some(child);
                }
                None => {
                    let (index, sum) = (*index as usize, *sum);
                    states[index] = State::Done(sum);
                    stack.pop();
                    match stack.last_mut() {
                        Some(parent) => parent.2 = parent.2.saturating_add(sum),
                        None => total = total.saturating_add(sum),
                    }
                }
            }
        }
    }
    budget.check("nodes", total)
}

fn roots(document: &Document) -> Result<Vec<u32>, LoadError> {
    match (document.scene, document.scenes.first()) {
        (None, Some(scene)) => Ok(scene.nodes.clone()),
        (Some(scene), _) => {
            let scene = document.scenes.get(scene as usize).ok_or_else(|| missing("scene", scene))?;
            Ok(scene.nodes.clone())
        }
        (None, None) => {
            let mut is_root = vec![true; document.nodes.len()];
            for &child in document.nodes.iter().flat_map(|node| &node.children) {
                *is_root.get_mut(child as usize).ok_or_else(|| missing("node", child))? = false;
            }
            let roots: Vec<_> = (0..).zip(is_root).filter(|&(_, root)| root).map(|(i, _)| i).collect();
            if roots.is_empty() {
                return Err(LoadError::syntax("a node without parent", b"a cycle of nodes"));
            }
            Ok(roots)
        }
    }
}

/// Returns the map of a node: its matrix, or else its scale, rotation and translation, applied in
/// this order.
fn local(node: &Node) -> Result<Affine, LoadError> {
    if let Some(m) = node.matrix.as_deref() {
        let last_row = [m[3], m[7], m[11], m[15]];
        if last_row != [0.0, 0.0, 0.0, 1.0] {
            let found = format!("{last_row:?}");
            return Err(LoadError::syntax("a matrix with last row 0, 0, 0, 1", found.as_bytes()));
        }
        return Ok(Affine { rows: [0, 1, 2].map(|i| [m[i], m[4 + i], m[8 + i], m[12 + i]]) });
    }
    let t = node.translation.as_deref().copied().unwrap_or([0.0; 3]);
    let s = node.scale.as_deref().copied().unwrap_or([1.0; 3]);
    placement(t, node.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]), s)
}

/// Returns the map that scales by `s`, rotates by a quaternion of any length, and translates by
/// `t`. Returns an error if the quaternion is zero or not finite.
pub(super) fn placement(t: [f64; 3], [x, y, z, w]: [f64; 4], s: [f64; 3]) -> Result<Affine, LoadError> {
    let square = x * x + y * y + z * z + w * w;
    // Every nonzero quaternion of 32-bit floats has a much larger square. A shorter one has no
    // direction.
    if !(square.is_finite() && square > f64::MIN_POSITIVE) {
        return Err(LoadError::syntax("a quaternion of length 1", format!("{:?}", [x, y, z, w]).as_bytes()));
    }
    // Dividing by the square of the length gives a rotation for quaternions of any length, and an
    // exact one for rotations by 90 degrees.
    let k = 2.0 / square;
    let rotation = [
        [1.0 - k * (y * y + z * z), k * (x * y - z * w), k * (x * z + y * w)],
        [k * (x * y + z * w), 1.0 - k * (x * x + z * z), k * (y * z - x * w)],
        [k * (x * z - y * w), k * (y * z + x * w), 1.0 - k * (x * x + y * y)],
    ];
    Ok(Affine { rows: [0, 1, 2].map(|i| [rotation[i][0] * s[0], rotation[i][1] * s[1], rotation[i][2] * s[2], t[i]]) })
}

//! Flattens the nodes of a COLLADA scene: each instance of a geometry with the map that places it.

use std::{collections::HashMap, rc::Rc};

use crate::{
    error::{LoadError, LoadErrorKind},
    instance::Affine,
    limits::{Budget, Limits},
    model::{Faces, WarningKind},
    xml_tree::{Id, Tree},
};

use super::{
    geometry::{Arrays, Geometry},
    transform,
};

/// Maximum depth of nodes within nodes, and of controllers within controllers. It bounds the stack
/// and ends cycles. Exporters nest about ten nodes; skeletons nest up to a hundred joints.
const MAX_DEPTH: u32 = 256;

pub(super) struct Scene<'t, 'a> {
    tree: &'t Tree<'a>,
    geometries: HashMap<Id, Rc<Geometry>>,
    arrays: Arrays,
    nodes: HashMap<Id, Rc<Node>>,
    /// For each controller that was read, the geometry or controller that it deforms, and its bind
    /// shape matrix.
    deformed: HashMap<Id, (Id, Affine)>,
    budgets: Budgets,
    visited: u64,
    name_bytes: u64,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) parts: Vec<String>,
    pub(super) faces: Faces,
}

struct Budgets {
    elements: Budget,
    nodes: Budget,
    names: Budget,
}

/// A node. It is read once, even if several paths reach it.
struct Node {
    map: Affine,
    title: String,
    content: Vec<Content>,
}

/// An entry of a node, in the order of the file.
enum Content {
    Node(Id),
    Geometry {
        geometry: Id,
        /// The bind shape matrix of a skin; the identity for a mesh without one.
        map: Affine,
        /// Whether a skin or morph targets deform the mesh.
        deformed: bool,
        instance: Id,
    },
}

impl<'t, 'a> Scene<'t, 'a> {
    pub(super) fn new(tree: &'t Tree<'a>, bytes: u64, limits: &Limits) -> Self {
        let budgets = Budgets {
            elements: Budget::for_bytes(bytes, limits),
            nodes: Budget::for_nodes(bytes, limits),
            names: Budget::for_names(bytes, limits),
        };
        Self {
            tree,
            geometries: HashMap::new(),
            arrays: Arrays::new(budgets.elements, *limits),
            nodes: HashMap::new(),
            deformed: HashMap::new(),
            budgets,
            visited: 0,
            name_bytes: 0,
            positions: Vec::new(),
            parts: Vec::new(),
            faces: Faces::new(limits),
        }
    }

    /// Adds all nodes of the scene that the document names, or else of the first scene. If the
    /// document has no scenes, adds all geometries.
    pub(super) fn add_all(&mut self, root: Id, world: &Affine) -> Result<(), LoadError> {
        let tree = self.tree;
        let named = tree.child(root, "scene").and_then(|scene| tree.child(scene, "instance_visual_scene"));
        let library = || {
            let mut libraries = tree.children_named(root, "library_visual_scenes");
            libraries.find_map(|library| tree.child(library, "visual_scene"))
        };
        let scene = match named {
            Some(instance) => Some(self.target(instance, "url", "visual_scene")?),
            None => library(),
        };
        if let Some(scene) = scene {
            return tree.children_named(scene, "node").try_for_each(|node| self.node(node, world, 0));
        }
        for library in tree.children_named(root, "library_geometries") {
            for geometry in tree.children_named(library, "geometry") {
                self.faces.warnings.add(WarningKind::NoScene, 1, || Some(tree.place(geometry)));
                self.geometry(geometry, world, "", geometry)?;
            }
        }
        Ok(())
    }

    /// Adds a node with everything in it; `depth` is the number of nodes around it.
    fn node(&mut self, id: Id, around: &Affine, depth: u32) -> Result<(), LoadError> {
        let at = |e: LoadError| e.at(self.tree.place(id));
        if depth == MAX_DEPTH {
            let expected = format!("nodes nested at most {MAX_DEPTH} deep");
            return Err(at(LoadError::syntax(expected, b"more, or a cycle")));
        }
        self.visited += 1;
        self.budgets.nodes.check("nodes", self.visited).map_err(at)?;
        let node = match self.nodes.get(&id) {
            Some(node) => Rc::clone(node),
            None => {
                let node = Rc::new(self.read_node(id)?);
                self.nodes.insert(id, Rc::clone(&node));
                node
            }
        };
        let world = around.after(&node.map);
        for content in &node.content {
            match *content {
                Content::Node(inner) => self.node(inner, &world, depth + 1)?,
                Content::Geometry { geometry, map, deformed, instance } => {
                    let place = || Some(self.tree.place(instance));
                    self.faces.warnings.add(WarningKind::Unposed, deformed.into(), place);
                    self.visited += 1;
                    self.geometry(geometry, &world.after(&map), &node.title, instance)?;
                }
            }
        }
        Ok(())
    }

    fn read_node(&mut self, id: Id) -> Result<Node, LoadError> {
        let tree = self.tree;
        let mut content = Vec::new();
        for child in tree.children(id) {
            content.push(match tree.name(child) {
                "node" => Content::Node(child),
                "instance_node" => Content::Node(self.target(child, "url", "node")?),
                "instance_geometry" => {
                    let geometry = self.target(child, "url", "geometry")?;
                    Content::Geometry { geometry, map: Affine::IDENTITY, deformed: false, instance: child }
                }
                "instance_controller" => {
                    let controller = self.target(child, "url", "controller")?;
                    let (geometry, map) = self.controlled(controller)?;
                    Content::Geometry { geometry, map, deformed: true, instance: child }
                }
                _ => continue,
            });
        }
        Ok(Node { map: transform::of_node(tree, id)?, title: tree.title(id), content })
    }

    /// Returns the geometry of a controller, and its bind shape matrix. A skin may deform a morphed
    /// geometry.
    fn controlled(&mut self, controller: Id) -> Result<(Id, Affine), LoadError> {
        let (mut id, mut map) = (controller, Affine::IDENTITY);
        for _ in 0..MAX_DEPTH {
            let (source, own) = match self.deformed.get(&id) {
                Some(&known) => known,
                None => self.read_deformer(id)?,
            };
            self.deformed.insert(id, (source, own));
            map = map.after(&own);
            id = source;
            if self.tree.name(id) == "geometry" {
                return Ok((id, map));
            }
        }
        let error = LoadError::syntax("a geometry to deform", b"a cycle of controllers");
        Err(error.at(self.tree.place(controller)))
    }

    /// Returns the geometry or controller that a controller deforms, and its bind shape matrix.
    fn read_deformer(&self, controller: Id) -> Result<(Id, Affine), LoadError> {
        let tree = self.tree;
        let Some(deformer) = tree.child(controller, "skin").or_else(|| tree.child(controller, "morph")) else {
            return Err(LoadError::syntax("a skin or morph of the controller", b"").at(tree.place(controller)));
        };
        let map = match tree.child(deformer, "bind_shape_matrix") {
            Some(matrix) => transform::matrix(tree, matrix)?,
            None => Affine::IDENTITY,
        };
        let source = tree.target(deformer, "source")?;
        match tree.name(source) {
            "geometry" | "controller" => Ok((source, map)),
            other => {
                let error = LoadError::syntax("a geometry to deform", other.as_bytes());
                Err(error.at(tree.place(deformer)))
            }
        }
    }

    /// Returns the element that an attribute refers to. Returns an error if its name is not
    /// `expected`.
    fn target(&self, id: Id, attribute: &str, expected: &str) -> Result<Id, LoadError> {
        let target = self.tree.target(id, attribute)?;
        match self.tree.name(target) {
            name if name == expected => Ok(target),
            other => {
                let found = format!("the element {other}");
                Err(LoadError::syntax(format!("the id of a {expected}"), found.as_bytes()).at(self.tree.place(id)))
            }
        }
    }

    /// Adds a geometry as a part, named after its node or else itself.
    fn geometry(&mut self, id: Id, world: &Affine, title: &str, instance: Id) -> Result<(), LoadError> {
        let geometry = match self.geometries.get(&id) {
            Some(geometry) => Rc::clone(geometry),
            None => {
                let place = |e: LoadError| if e.place().is_none() { e.at(self.tree.place(id)) } else { e };
                let mut geometry = Geometry::read(self.tree, id, &mut self.arrays).map_err(place)?;
                self.faces.warnings.extend(std::mem::take(&mut geometry.faces.warnings).into_vec());
                let geometry = Rc::new(geometry);
                self.geometries.insert(id, Rc::clone(&geometry));
                geometry
            }
        };
        let at = |e: LoadError| e.at(self.tree.place(instance));
        let (vertices, triangles) = (geometry.positions.len(), geometry.faces.faces.len());
        self.budgets.elements.check("vertices", (self.positions.len() + vertices) as u64).map_err(at)?;
        self.budgets.elements.check("triangles", (self.faces.faces.len() + triangles) as u64).map_err(at)?;

        let (first, part) = (self.positions.len() as u32, self.parts.len() as u32);
        for (vertex, &position) in geometry.positions.iter().enumerate() {
            let position = world.apply(position);
            if !position.iter().all(|x| x.is_finite()) {
                let error = LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 });
                return Err(at(error).with_hint("after the transform of its node"));
            }
            self.positions.push(position);
        }
        if triangles > 0 {
            self.faces.append(&geometry.faces, first, part, world.mirrors()).map_err(at)?;
            let name = if title.is_empty() { geometry.title.clone() } else { title.to_owned() };
            self.name_bytes += (size_of::<String>() + name.len()) as u64;
            self.budgets.names.check("bytes of names", self.name_bytes).map_err(at)?;
            self.parts.push(name);
        }
        Ok(())
    }
}

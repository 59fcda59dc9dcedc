//! Reads a COLLADA geometry: its sources of positions and its primitives. Each geometry is
//! triangulated once, even if it is placed several times.

use std::{collections::HashMap, rc::Rc};

use crate::{
    error::{LoadError, LoadErrorKind},
    limits::{Budget, Limits},
    model::{Faces, WarningKind},
};

use crate::xml_tree::{INTEGERS, Id, Tree};

/// The vertices and triangles of a geometry in its own frame. All triangles belong to part 0.
pub(super) struct Geometry {
    pub(super) title: String,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) faces: Faces,
    /// The range in `positions` of each source.
    sources: HashMap<Id, Range>,
}

/// Arrays that geometries share: any geometry may refer to any array of the document, several
/// times.
pub(super) struct Arrays {
    /// Every array that was read.
    values: HashMap<Id, Rc<Vec<f64>>>,
    /// The positions of every source that was read.
    sources: HashMap<Id, Rc<Vec<[f64; 3]>>>,
    /// For every `<vertices>` that was read, its source of positions.
    vertices: HashMap<Id, Id>,
    /// Total number of positions that were read from sources or copied to geometries.
    positions: u64,
    budget: Budget,
    limits: Limits,
}

impl Arrays {
    pub(super) fn new(budget: Budget, limits: Limits) -> Self {
        Self { values: HashMap::new(), sources: HashMap::new(), vertices: HashMap::new(), positions: 0, budget, limits }
    }

    fn read(&mut self, tree: &Tree<'_>, array: Id) -> Result<Rc<Vec<f64>>, LoadError> {
        if let Some(values) = self.values.get(&array) {
            return Ok(Rc::clone(values));
        }
        let values = Rc::new(tree.floats(array)?);
        self.values.insert(array, Rc::clone(&values));
        Ok(values)
    }

    /// Returns the positions of a source, and reads them if necessary.
    fn positions(&mut self, tree: &Tree<'_>, source: Id) -> Result<Rc<Vec<[f64; 3]>>, LoadError> {
        if let Some(positions) = self.sources.get(&source) {
            return Ok(Rc::clone(positions));
        }
        let positions = Rc::new(read_positions(tree, source, self)?);
        self.sources.insert(source, Rc::clone(&positions));
        Ok(positions)
    }

    /// Returns the source of positions that a `<vertices>` refers to.
    fn source_of(&mut self, tree: &Tree<'_>, vertices: Id) -> Result<Id, LoadError> {
        if let Some(&source) = self.vertices.get(&vertices) {
            return Ok(source);
        }
        let position = tree
            .children_named(vertices, "input")
            .find(|&input| tree.attribute(input, "semantic").as_deref() == Some("POSITION"))
            .ok_or_else(|| LoadError::syntax("an input of semantic POSITION", b"").at(tree.place(vertices)))?;
        let source = tree.target(position, "source")?;
        self.vertices.insert(vertices, source);
        Ok(source)
    }

    fn count(&mut self, positions: usize) -> Result<(), LoadError> {
        self.positions += positions as u64;
        self.budget.check("positions of sources", self.positions)
    }
}

/// The range of a source's positions in [`Geometry::positions`].
#[derive(Clone, Copy)]
struct Range {
    first: usize,
    len: usize,
}

/// The layout of a primitive's lists of indices.
struct Corners {
    /// Number of indices per corner.
    stride: usize,
    /// Position among the corner's indices of the index that refers to the position.
    offset: usize,
    positions: Range,
}

impl Geometry {
    pub(super) fn read(tree: &Tree<'_>, id: Id, arrays: &mut Arrays) -> Result<Self, LoadError> {
        let (title, faces) = (tree.title(id), Faces::new(&arrays.limits));
        let mut geometry = Self { title, positions: Vec::new(), faces, sources: HashMap::new() };
        for child in tree.children(id) {
            match tree.name(child) {
                "convex_mesh" if tree.attribute(child, "convex_hull_of").is_some() => {
                    return Err(LoadError::unsupported("convex_hull_of").at(tree.place(child)));
                }
                "mesh" | "convex_mesh" => {
                    tree.children(child).try_for_each(|primitive| geometry.primitive(tree, primitive, arrays))?;
                }
                "spline" | "brep" => geometry.skip(tree, child),
                _ => {}
            }
        }
        Ok(geometry)
    }

    /// Counts an element without triangles in a warning.
    fn skip(&mut self, tree: &Tree<'_>, id: Id) {
        self.faces.warnings.add(WarningKind::NotTriangles, 1, || Some(tree.place(id)));
    }

    fn primitive(&mut self, tree: &Tree<'_>, id: Id, arrays: &mut Arrays) -> Result<(), LoadError> {
        let name = tree.name(id);
        let is_surface = matches!(name, "triangles" | "trifans" | "tristrips" | "polygons" | "polylist");
        let is_line = matches!(name, "lines" | "linestrips");
        // Some exporters write primitives without corners and without inputs.
        let is_empty = !tree.children(id).any(|child| matches!(tree.name(child), "p" | "ph"));
        if !(is_surface || is_line) || is_empty {
            return Ok(());
        }
        if is_line {
            self.skip(tree, id);
            return Ok(());
        }
        let layout = self.layout(tree, id, arrays)?;
        let mut corners = Vec::new();
        if name == "polylist" {
            for p in tree.children_named(id, "p") {
                self.corners(tree, id, p, &layout, &mut corners)?;
            }
            return self.polylist(tree, id, &corners);
        }
        for child in tree.children(id) {
            let list = match tree.name(child) {
                "p" => child,
                "ph" => match tree.child(child, "p") {
                    Some(outline) => {
                        let holes = tree.children_named(child, "h").count() as u64;
                        self.faces.warnings.add(WarningKind::FilledHoles, holes, || Some(tree.place(child)));
                        outline
                    }
                    None => continue,
                },
                _ => continue,
            };
            corners.clear();
            self.corners(tree, id, list, &layout, &mut corners)?;
            match name {
                "triangles" => self.triangles(tree, list, &corners)?,
                "trifans" => {
                    for pair in corners.get(1..).unwrap_or_default().windows(2) {
                        self.faces.triangle([corners[0], pair[0], pair[1]], 0)?;
                    }
                }
                "tristrips" => self.strip(tree, list, &corners)?,
                _ => self.polygon(tree, list, &corners)?,
            }
        }
        Ok(())
    }

    fn triangles(&mut self, tree: &Tree<'_>, list: Id, corners: &[u32]) -> Result<(), LoadError> {
        let (triangles, left) = corners.as_chunks::<3>();
        self.faces.reserve(triangles.len());
        triangles.iter().try_for_each(|&triangle| self.faces.triangle(triangle, 0))?;
        self.leftover(tree, list, left.len());
        Ok(())
    }

    /// Adds the triangles of a strip. Every other triangle has reversed winding. Triangles that
    /// repeat a corner join strips and have no surface, so they are skipped.
    fn strip(&mut self, tree: &Tree<'_>, list: Id, corners: &[u32]) -> Result<(), LoadError> {
        let mut joints = 0;
        for (i, window) in corners.windows(3).enumerate() {
            let (a, [b, c]) = (window[0], if i % 2 == 0 { [window[1], window[2]] } else { [window[2], window[1]] });
            if a == b || b == c || c == a {
                joints += 1;
            } else {
                self.faces.triangle([a, b, c], 0)?;
            }
        }
        self.faces.warnings.add(WarningKind::StripJoints, joints, || Some(tree.place(list)));
        Ok(())
    }

    fn polylist(&mut self, tree: &Tree<'_>, id: Id, corners: &[u32]) -> Result<(), LoadError> {
        let mut rest = corners;
        if let Some(vcount) = tree.child(id, "vcount") {
            tree.each_number(vcount, INTEGERS, |count| {
                let len = u64::try_from(count)
                    .map_err(|_| LoadError::syntax("a number of corners", count.to_string().as_bytes()))?;
                let Some((polygon, after)) = usize::try_from(len).ok().and_then(|len| rest.split_at_checked(len))
                else {
                    return Err(LoadError::truncated("corners of a polygon", len, rest.len() as u64));
                };
                rest = after;
                self.polygon(tree, id, polygon)
            })?;
        }
        self.leftover(tree, id, rest.len());
        Ok(())
    }

    fn polygon(&mut self, tree: &Tree<'_>, id: Id, corners: &[u32]) -> Result<(), LoadError> {
        let positions = &self.positions;
        self.faces.polygon(corners, |i| positions[i as usize], 0, || tree.place(id))
    }

    fn leftover(&mut self, tree: &Tree<'_>, id: Id, corners: usize) {
        self.faces.warnings.add(WarningKind::LeftoverCorners, corners as u64, || Some(tree.place(id)));
    }

    /// Appends the vertices of all corners of a list. Returns an error if a vertex does not exist.
    fn corners(
        &mut self,
        tree: &Tree<'_>,
        primitive: Id,
        list: Id,
        layout: &Corners,
        corners: &mut Vec<u32>,
    ) -> Result<(), LoadError> {
        let Range { first, len } = layout.positions;
        let before = u64::from(self.faces.polygons());
        let mut at = 0;
        tree.each_number(list, INTEGERS, |index| {
            if at == layout.offset {
                let vertex = usize::try_from(index).ok().filter(|&vertex| vertex < len).ok_or_else(|| {
                    let face = before + face_of(tree, primitive, corners.len());
                    LoadError::new(LoadErrorKind::IndexOutOfBounds { face, index, len: len as u64 })
                })?;
                corners.push((first + vertex) as u32);
            }
            at = if at + 1 == layout.stride { 0 } else { at + 1 };
            Ok(())
        })?;
        if at > 0 {
            // The last corner lacks some of its indices.
            if at > layout.offset {
                corners.pop();
            }
            self.leftover(tree, list, 1);
        }
        Ok(())
    }

    /// Reads the inputs of a primitive, and the positions that they refer to.
    fn layout(&mut self, tree: &Tree<'_>, id: Id, arrays: &mut Arrays) -> Result<Corners, LoadError> {
        let (mut stride, mut found) = (0, None);
        for input in tree.children_named(id, "input") {
            let offset = tree.count(input, "offset", 0)?;
            stride = stride.max(offset.saturating_add(1));
            let semantic = tree.attribute(input, "semantic").unwrap_or_default();
            if found.is_none() && matches!(&*semantic, "VERTEX" | "POSITION") {
                found = Some((tree.target(input, "source")?, offset));
            }
        }
        let Some((mut source, offset)) = found else {
            return Err(LoadError::syntax("an input of semantic VERTEX", b"").at(tree.place(id)));
        };
        if tree.name(source) == "vertices" {
            source = arrays.source_of(tree, source)?;
        }
        let positions = match self.sources.get(&source) {
            Some(&range) => range,
            None => {
                let read = arrays.positions(tree, source)?;
                arrays.count(read.len()).map_err(|e| e.at(tree.place(source)))?;
                let range = Range { first: self.positions.len(), len: read.len() };
                self.positions.extend_from_slice(&read);
                self.sources.insert(source, range);
                range
            }
        };
        Ok(Corners { stride, offset, positions })
    }
}

/// Returns the face of a corner of a primitive, counted from the primitive's first face.
fn face_of(tree: &Tree<'_>, primitive: Id, corner: usize) -> u64 {
    let corner = corner as u64;
    match tree.name(primitive) {
        "triangles" => corner / 3,
        "trifans" | "tristrips" => corner.saturating_sub(2),
        "polylist" => {
            let (mut faces, mut corners) = (0, 0_u64);
            let Some(vcount) = tree.child(primitive, "vcount") else { return 0 };
            let counted = tree.each_number(vcount, INTEGERS, |count| {
                corners = corners.saturating_add(count.unsigned_abs());
                faces += u64::from(corners <= corner);
                Ok(())
            });
            counted.map_or(0, |()| faces)
        }
        _ => 0,
    }
}

/// Returns the positions of a source, as its accessor selects them from an array.
fn read_positions(tree: &Tree<'_>, source: Id, arrays: &mut Arrays) -> Result<Vec<[f64; 3]>, LoadError> {
    let accessor = tree.child(source, "technique_common").and_then(|common| tree.child(common, "accessor"));
    let array = match accessor {
        Some(accessor) => tree.target(accessor, "source")?,
        None => tree.child(source, "float_array").ok_or_else(|| {
            LoadError::syntax("a source of positions", tree.name(source).as_bytes()).at(tree.place(source))
        })?,
    };
    let values = arrays.read(tree, array)?;
    let (axes, mut stride) = accessor.map_or(([0, 1, 2], 3), |accessor| axes(tree, accessor));
    let (mut offset, mut count) = (0, values.len() / stride);
    if let Some(accessor) = accessor {
        stride = tree.count(accessor, "stride", stride)?;
        offset = tree.count(accessor, "offset", 0)?;
        count = tree.count(accessor, "count", count)?;
        let needed = axes.iter().max().map_or(0, |axis| axis + 1);
        if stride < needed {
            let expected = format!("a stride of {needed} or more");
            return Err(LoadError::syntax(expected, stride.to_string().as_bytes()).at(tree.place(accessor)));
        }
    }
    // The last element may end with its last coordinate, before its stride is complete.
    let needed = axes.iter().max().map_or(0, |axis| axis + 1);
    let room = values.len().saturating_sub(offset);
    let room = if room < needed { 0 } else { (room - needed) / stride + 1 };
    if count > room {
        let error = LoadError::truncated("positions", count as u64, room as u64);
        return Err(error.at(tree.place(accessor.unwrap_or(source))));
    }
    arrays.count(count).map_err(|e| e.at(tree.place(source)))?;
    let mut positions = Vec::with_capacity(count);
    for vertex in 0..count {
        let position = axes.map(|axis| values[offset + vertex * stride + axis]);
        if !position.iter().all(|x| x.is_finite()) {
            return Err(LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 }).at(tree.place(array)));
        }
        positions.push(position);
    }
    Ok(positions)
}

/// Returns the indices of x, y and z in an element, and the number of values per element if the
/// accessor does not state it.
///
/// The parameters named X, Y and Z are used if all three exist, else the first three values.
fn axes(tree: &Tree<'_>, accessor: Id) -> ([usize; 3], usize) {
    let mut axes = [None; 3];
    let mut params = 0;
    for (at, param) in tree.children_named(accessor, "param").enumerate() {
        let name = tree.attribute(param, "name").unwrap_or_default();
        if let Some(axis) = ["X", "Y", "Z"].iter().position(|axis| name.eq_ignore_ascii_case(axis)) {
            axes[axis] = Some(at);
        }
        params = at + 1;
    }
    match axes {
        [Some(x), Some(y), Some(z)] => ([x, y, z], params),
        _ => ([0, 1, 2], params.max(3)),
    }
}

//! Circles: files of one module that need each other, directly or by way of others.
//!
//! The children of a module, each a file or a folder with all below it, and the file of the module
//! itself are the nodes of a graph. An import from below one node that names something defined below
//! another is an edge. A re-export is none: the file of a module may hand on whatever its children
//! define. A crate whose modules have no circle has none between any of its files.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;

use super::files::SourceFile;
use super::imports::Import;
use super::paths::Names;
use crate::sources::Violation;

/// Imports from one child of a module to another, the first of each pair.
struct Graph<'a> {
    /// File and import of each edge, by the children that it connects. An empty name is the file of the module itself.
    edges: BTreeMap<(&'a str, &'a str), (&'a SourceFile, &'a Import)>,
}

/// Returns a violation for every circle inside a module; files are shown relative to `root`.
pub(super) fn check(files: &[SourceFile], root: &Path) -> Vec<Violation> {
    let names = Names::of(files);
    let mut graphs: BTreeMap<&[String], Graph<'_>> = BTreeMap::new();
    for file in files {
        for import in file.imports.found.iter().chain(&file.imports.relative) {
            if import.reexported {
                continue;
            }
            let Some(target) = names.home(&import.path) else { continue };
            let (from, to) = (&file.module, &files[target].module);
            let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
            // The order of the top modules is checked elsewhere.
            if from != to && shared > 0 {
                let graph = graphs.entry(&from[..shared]).or_insert(Graph { edges: BTreeMap::new() });
                let [from, to] = [from, to].map(|module| module.get(shared).map_or("", String::as_str));
                graph.edges.entry((from, to)).or_insert((file, import));
            }
        }
    }
    let shown = |module: &[String], child: &str| {
        let path = if child.is_empty() { module.to_vec() } else { [module, &[child.to_owned()]].concat() };
        let file = files.iter().find(|file| file.module == path);
        let file = file.map(|file| file.path.strip_prefix(root).unwrap_or(&file.path));
        file.map(|file| name_of(file, child)).unwrap_or_default()
    };
    let mut violations = Vec::new();
    for (module, graph) in &graphs {
        for circle in graph.circles() {
            let (first, _) = graph.edges[&circle[0]];
            let line = graph.edges[&circle[0]].1.line;
            let path: Vec<String> =
                circle.iter().map(|edge| edge.0).chain([circle[0].0]).map(|child| shown(module, child)).collect();
            let imports: Vec<String> = circle
                .iter()
                .map(|edge| {
                    let (file, import) = graph.edges[edge];
                    let file = file.path.strip_prefix(root).unwrap_or(&file.path);
                    format!("\n    {}:{}: `{}`", file.display(), import.line, import.written)
                })
                .collect();
            violations.push(Violation {
                file: first.path.strip_prefix(root).unwrap_or(&first.path).to_path_buf(),
                line,
                what: format!("circle in `{}`: {}{}", module.join("::"), path.join(" -> "), imports.concat()),
            });
        }
    }
    violations
}

/// Name of a child's file, or of its folder if the file is called `mod.rs`.
fn name_of(file: &Path, child: &str) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    if name == "mod.rs" && !child.is_empty() { child.to_owned() } else { name.into_owned() }
}

impl<'a> Graph<'a> {
    /// Returns, for each edge that lies on a circle, a shortest circle through it; each circle once.
    fn circles(&self) -> Vec<Vec<(&'a str, &'a str)>> {
        let mut found = BTreeSet::new();
        for &(from, to) in self.edges.keys() {
            if let Some(back) = self.path(to, from) {
                let mut circle = [vec![(from, to)], back].concat();
                let least = (0..circle.len()).min_by_key(|&at| circle[at]).unwrap_or(0);
                circle.rotate_left(least);
                found.insert(circle);
            }
        }
        found.into_iter().collect()
    }

    /// Returns the edges of a shortest path, or `None` if there is no path.
    fn path(&self, from: &'a str, to: &'a str) -> Option<Vec<(&'a str, &'a str)>> {
        let mut reached = BTreeMap::from([(from, Vec::new())]);
        let mut queue = VecDeque::from([from]);
        while let Some(at) = queue.pop_front() {
            if at == to {
                return reached.remove(to);
            }
            for &edge in self.edges.range((at, "")..).map(|(edge, _)| edge).take_while(|edge| edge.0 == at) {
                if !reached.contains_key(edge.1) {
                    let path = [&reached[at][..], &[edge]].concat();
                    reached.insert(edge.1, path);
                    queue.push_back(edge.1);
                }
            }
        }
        None
    }
}

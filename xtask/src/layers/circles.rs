//! Circles: files of one module that import from each other, directly or through others.
//!
//! The children of a module, each a file or a folder with everything below it, and the file of the
//! module itself are the nodes of a graph. An import from below one node that names an item defined
//! below another node is an edge. A re-export is no edge: the file of a module may re-export the
//! items of its children. If no module of a crate has a circle, no circle exists between any of its
//! files.
//!
//! A method that is called by its name alone is not imported, so such a dependency is not found.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::Path;

use super::files::SourceFile;
use super::imports::Import;
use super::paths::Names;
use crate::sources::Violation;

/// First import from each child of a module to each other child, by the names of both children. An
/// empty name is the file of the module itself.
#[derive(Default)]
struct Graph<'a> {
    edges: BTreeMap<Edge<'a>, (&'a SourceFile, &'a Import)>,
}

/// Names of two children of one module. The first imports from the second.
type Edge<'a> = (&'a str, &'a str);

/// Returns a violation for every circle inside a module. Files are shown relative to `root`.
pub(super) fn check(files: &[SourceFile], root: &Path) -> Vec<Violation> {
    let graphs = graphs(files);
    let circles =
        graphs.iter().flat_map(|(module, graph)| graph.circles().into_iter().map(move |c| (module, graph, c)));
    circles.map(|(module, graph, circle)| violation(files, root, module, graph, &circle)).collect()
}

/// Returns the graph of each module whose children import from each other, by the path of the
/// module.
fn graphs(files: &[SourceFile]) -> BTreeMap<&[String], Graph<'_>> {
    let names = Names::of(files);
    let mut graphs: BTreeMap<&[String], Graph<'_>> = BTreeMap::new();
    for file in files {
        let imports = file.imports.found.iter().chain(&file.imports.relative);
        for import in imports.filter(|import| !import.reexported) {
            let Some(target) = names.home(&import.path) else { continue };
            let (from, to) = (&file.module, &files[target].module);
            let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
            // The order of the top modules is checked in `modules.rs`.
            if from != to && shared > 0 {
                let child = [from, to].map(|module| module.get(shared).map_or("", String::as_str));
                graphs.entry(&from[..shared]).or_default().edges.entry(child.into()).or_insert((file, import));
            }
        }
    }
    graphs
}

/// Returns the message about one circle: its files, and a line with the import of each step.
fn violation(
    files: &[SourceFile],
    root: &Path,
    module: &[String],
    graph: &Graph<'_>,
    circle: &[Edge<'_>],
) -> Violation {
    let shown = |file: &SourceFile| file.path.strip_prefix(root).unwrap_or(&file.path).to_path_buf();
    let name = |child: &str| {
        let below = (!child.is_empty()).then(|| child.to_owned());
        let path: Vec<String> = module.iter().cloned().chain(below).collect();
        files.iter().find(|file| file.module == path).map(|file| name_of(&file.path, child)).unwrap_or_default()
    };
    let steps: Vec<&str> = circle.iter().map(|edge| edge.0).chain(circle.iter().take(1).map(|edge| edge.0)).collect();
    let mut what =
        format!("circle in `{}`: {}", module.join("::"), steps.into_iter().map(name).collect::<Vec<_>>().join(" -> "));
    for edge in circle {
        let (file, import) = graph.edges[edge];
        what += &format!("\n    {}:{}: `{}`", shown(file).display(), import.line, import.written);
    }
    let (file, import) = graph.edges[&circle[0]];
    Violation { file: shown(file), line: import.line, what }
}

/// Returns the name of a child's file, or of its folder if the file is called `mod.rs`.
fn name_of(file: &Path, child: &str) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    if name == "mod.rs" && !child.is_empty() { child.to_owned() } else { name.into_owned() }
}

impl<'a> Graph<'a> {
    /// Returns a shortest circle through each edge that lies on a circle. Each circle occurs once.
    fn circles(&self) -> Vec<Vec<Edge<'a>>> {
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
    fn path(&self, from: &'a str, to: &'a str) -> Option<Vec<Edge<'a>>> {
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

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::layers::files;

    /// Returns the circles of a crate with the given files.
    fn found(sources: &[(&str, &str)]) -> Vec<String> {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in sources {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let (files, _) = files::read(root.path()).unwrap();
        check(&files, root.path()).iter().map(ToString::to_string).collect()
    }

    /// Returns the circles of a module `house` with the given files. Its `mod.rs` is `map`.
    fn found_in_house(map: &str, sources: &[(&str, &str)]) -> Vec<String> {
        let named: Vec<(String, &str)> = sources.iter().map(|(name, text)| (format!("house/{name}"), *text)).collect();
        let others = named.iter().map(|(name, text)| (name.as_str(), *text));
        found(&[("lib.rs", "mod house;"), ("house/mod.rs", map)].into_iter().chain(others).collect::<Vec<_>>())
    }

    #[test]
    fn two_files_that_need_each_other_are_shown_with_both_lines() {
        let map = "mod a;\nmod b;\nmod c;";
        let a = "use super::c::C;\nuse super::b::B;";
        let b = "\n\nfn f() { crate::house::a::g() }";
        let circle = "house/a.rs:2: circle in `house`: a.rs -> b.rs -> a.rs\n    house/a.rs:2: `super::b::B`\n    \
                      house/b.rs:3: `crate::house::a::g`";
        assert_eq!(found_in_house(map, &[("a.rs", a), ("b.rs", b), ("c.rs", "")]), [circle]);
    }

    #[test]
    fn a_long_way_round_is_a_circle_too() {
        let map = "mod a;\nmod b;\nmod c;";
        let sources = [("a.rs", "use super::b::B;"), ("b.rs", "use super::c::C;"), ("c.rs", "use super::a::A;")];
        let found = found_in_house(map, &sources);
        assert!(matches!(&found[..], [circle] if circle.contains("a.rs -> b.rs -> c.rs -> a.rs")), "{found:?}");
    }

    #[test]
    fn what_is_handed_on_is_led_to_the_file_that_defines_it() {
        let map = "mod a;\nmod b;\npub use a::A;\npub(crate) use b::B as C;";
        let sources = [("a.rs", "use super::C;"), ("b.rs", "use crate::house::A;")];
        let found = found_in_house(map, &sources);
        assert!(matches!(&found[..], [circle] if circle.contains("a.rs -> b.rs -> a.rs")), "{found:?}");
        assert_eq!(found_in_house(map, &[("a.rs", "use super::C;"), ("b.rs", "")]), [""; 0]);
    }

    #[test]
    fn the_file_of_a_module_may_hand_on_but_not_both_define_and_need() {
        let child = [("a.rs", "use super::Wall;")];
        assert_eq!(found_in_house("mod a;\npub use a::A;\npub struct Wall;", &child), [""; 0]);
        for need in ["use a::A;", "pub use a::A;\nstruct B(A);", "pub use a::f;\nfn g() { f() }", "fn g() { a::f() }"] {
            let found = found_in_house(&format!("mod a;\npub struct Wall;\n{need}"), &child);
            assert!(matches!(&found[..], [circle] if circle.contains("mod.rs -> a.rs -> mod.rs")), "{need}: {found:?}");
        }
        let by_name =
            found_in_house("mod a;\npub struct Wall;\nfn g() { assert!(a::f()) }", &[("a.rs", "use super::*;")]);
        assert_eq!(by_name.len(), 1, "{by_name:?}");
    }

    #[test]
    fn a_folder_counts_with_all_that_is_below_it() {
        let map = "mod room;\nmod a;";
        let sources = [("room/mod.rs", "pub mod deep;"), ("room/deep.rs", "use crate::house::a::A;")];
        let a = ("a.rs", "use super::room::deep::D;");
        let found = found_in_house(map, &[sources[0], sources[1], a]);
        assert!(matches!(&found[..], [circle] if circle.contains("`house`: a.rs -> room -> a.rs")), "{found:?}");
        assert_eq!(found_in_house(map, &[sources[0], sources[1], ("a.rs", "")]), [""; 0]);
    }

    #[test]
    fn what_is_compiled_for_tests_alone_closes_no_circle() {
        let a = "use super::b::B;";
        let b = "#[cfg(test)]\nmod tests { use super::super::a::A; }";
        assert_eq!(found_in_house("mod a;\nmod b;", &[("a.rs", a), ("b.rs", b)]), [""; 0]);
    }

    #[test]
    fn a_name_that_hands_on_itself_ends() {
        let map = "mod a;\npub use a::A;";
        assert_eq!(found_in_house(map, &[("a.rs", "pub use super::A;\nfn f(_: A) {}")]), [""; 0]);
    }
}
